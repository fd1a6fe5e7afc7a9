!> Writes all tables. Columns are constants: the section of the listing, the file of comma separated values
!> and the manual page are made from them. A row has integers, numbers and words.
module epcont_report_columns
  use epcont_base_kinds, only: wp
  use epcont_base_decimal, only: decimal_text
  use epcont_base_text, only: formatted, short_real, text_of
  use epcont_base_tolerances, only: least_difference, rounded_off
  use epcont_report_file, only: text_file
  use epcont_messages_names, only: percent, when
  implicit none
  private
  public :: column, table_type, columns_text
  public :: right, listed_number, full_number, estimate_number, rounding_number

  !> Kinds of columns. Numbers are written in full in files, and in the listing with significant digits only.
  integer, parameter, public :: &
    state = -2, &      !! a word at the left of its column, after two blanks
    word = -1, &       !! at the right of its column
    whole = 0, &       !! an id, or a count
    number = 1, &      !! six digits
    known = 2, &       !! the same; unknown if it is negative
    estimate = 3, &    !! two digits; unknown if it is negative
    size_of = 4, &     !! four digits
    rounding = 5, &    !! the next higher power of ten if it is rounding
    off_curve = 6, &   !! the same: deviation from the stress-strain curve, relative
    factor = 7, &      !! of errors: two digits; unknown if it is negative
    part = 8, &        !! per cent
    no_number = 9      !! this model has no such number

  !> Value of an unknown number of any kind.
  real(wp), parameter, public :: unknown = -huge(1.0_wp)

  !> Characters of the longest word, which is a key of the summary.
  integer, parameter :: longest_cell = 40

  !> Units of columns.
  character(len=*), parameter, public :: length = 'length', force = 'force', stress = 'force/length2', &
    energy = 'force*length'

  !> Larger values are written as `> 10` and `> 1E6`: rounding changes their digits.
  real(wp), parameter :: largest_off_curve = 10.0_wp, largest_factor = 1.0e6_wp

  !> One column.
  type :: column
    integer :: kind = whole            !! one of those above
    character(len=23) :: name = ''     !! in the file; empty if only the listing has this column
    character(len=14) :: unit = ''     !! empty if it has none
    character(len=64) :: meaning = ''  !! for the manual page; empty if it is that of the column before
    character(len=23) :: head = ''     !! in the listing; empty if it is the name
    integer :: width = 13              !! in the listing; 0 if only the file has this column
  end type column

  !> A table that is being written, to the listing or to a file.
  type, extends(text_file) :: table_type
    logical :: listed = .true.                       !! in the listing
    integer :: subcase = 0                           !! of the rows; 0 if the file has one load case
    type(column), allocatable, private :: column(:)
    integer, allocatable, private :: nth(:)          !! index of its value among those of its sort
    real(wp), allocatable, private :: scale(:)       !! of each number in a row
  contains
    procedure :: begin
    procedure :: row
    procedure, private :: write_cells
  end type table_type

contains

  !> Describe the columns of a file for the manual page: `x, y (undeformed GRID B; length), force (...)`.
  pure function columns_text(columns) result(text)
    type(column), intent(in) :: columns(:)   !! in the order of the file
    character(len=:), allocatable :: meaning, text
    integer :: i

    text = ''
    meaning = ''
    do i = 1, size(columns)
      if (columns(i)%name == '') cycle
      if (columns(i)%meaning /= '') then
        text = text//meaning
        meaning = ' ('//trim(columns(i)%meaning)
        if (columns(i)%unit /= '') meaning = meaning//'; '//trim(columns(i)%unit)
        meaning = meaning//')'
      end if
      text = text//', '//trim(columns(i)%name)
    end do
    text = text(3:)//meaning
  end function columns_text

  !> Write the heading and the heads of the columns.
  subroutine begin(self, title, columns, scale)
    class(table_type), intent(inout) :: self
    character(len=*), intent(in) :: title        !! of the section of the listing; empty if it has none
    type(column), intent(in) :: columns(:)       !! in their order
    real(wp), intent(in), optional :: scale(:)   !! of each number: the largest of its column; default 0
    integer :: i, sort(size(columns))

    sort = max(word, min(columns%kind, 1))
    self%column = columns
    self%nth = [(count(sort(:i) == sort(i)), i=1, size(sort))]
    self%scale = spread(0.0_wp, 1, size(columns))
    if (present(scale)) self%scale = scale
    if (self%listed .and. title /= '') call self%heading(title)
    if (self%listed) call self%write_cells(merge(columns%head, columns%name, columns%head /= ''), .true.)
    if (.not. self%listed) call self%write_cells(columns%name, .true.)
  end subroutine begin

  !> Write a row.
  subroutine row(self, wholes, numbers, words)
    class(table_type), intent(inout) :: self
    integer, intent(in) :: wholes(:)           !! ids and counts, in this order; negative: unknown
    real(wp), intent(in) :: numbers(:)         !! in the order of the columns
    character(len=*), intent(in), optional :: words(:)   !! in the order of the columns; absent if no column
                                                         !! has words
    character(len=longest_cell) :: cell(size(self%column))
    integer :: i

    do i = 1, size(cell)
      cell(i) = ''
      if (self%listed .and. self%column(i)%width == 0) cycle
      associate (kind => self%column(i)%kind, n => self%nth(i))
        if (kind == whole) then
          if (wholes(n) >= 0) cell(i) = text_of(wholes(n))
          if (wholes(n) < 0 .and. self%listed) cell(i) = '-'
        else if (kind < whole) then
          cell(i) = words(n)
        else if (self%listed) then
          cell(i) = listed_number(kind, numbers(n), self%scale(n))
        else
          cell(i) = full_number(kind, numbers(n))
        end if
      end associate
    end do
    call self%write_cells(cell, .false.)
  end subroutine row

  !> Write the cells of a row, or the heads, of the columns that the listing or the file has.
  subroutine write_cells(self, cell, are_heads)
    class(table_type), intent(inout) :: self
    character(len=*), intent(in) :: cell(:)
    logical, intent(in) :: are_heads
    character(len=size(cell)*(len(cell) + maxval(self%column%width) + 2)) :: text
    integer :: i, last, n, width

    last = 0
    do i = 1, size(cell)
      n = len_trim(cell(i))
      associate (one => self%column(i))
        if (.not. self%listed) then
          if (one%name == '') cycle
          width = n + 1
          text(last + 1:last + width) = ','//cell(i)(:n)
        else if (one%kind == state) then
          width = 2 + max(one%width - 2, n)
          text(last + 1:last + width) = '  '//adjustl(cell(i)(:n))
        else
          width = merge(max(one%width, n), 0, one%width > 0)
          text(last + 1:last + width) = repeat(' ', max(0, width - n))//cell(i)(:n)
        end if
      end associate
      last = last + width
    end do
    if (self%listed) then
      call self%line(text(:last))
    else if (self%subcase == 0) then
      call self%line(text(2:last))
    else
      call self%line(when(are_heads, 'subcase', text_of(self%subcase))//text(:last))
    end if
  end subroutine write_cells

  !> Right-adjust text in `width` columns; longer text is kept.
  pure function right(text, width) result(field)
    character(len=*), intent(in) :: text   !! any text
    integer, intent(in) :: width           !! number of columns
    character(len=:), allocatable :: field

    field = repeat(' ', max(0, width - len(text)))//text
  end function right

  !> Write a number for the listing.
  pure function listed_number(kind, value, scale) result(text)
    integer, intent(in) :: kind   !! one of the kinds above
    real(wp), intent(in) :: value   !! the number
    real(wp), intent(in) :: scale   !! largest magnitude of its column; for an estimate: the estimated value
    character(len=:), allocatable :: text

    text = '-'
    if (value <= unknown) return
    select case (kind)
    case (number, known)
      if (kind == number .or. value >= 0.0_wp) text = column_number(value, scale)
    case (estimate)
      if (value >= 0.0_wp) text = '0.0'
      if (value > least_difference*scale) text = estimate_number(value)
    case (size_of)
      text = short_real(value)
    case (rounding)
      text = 'unknown'
      if (value >= 0.0_wp) text = rounding_number(value)
    case (off_curve)
      text = '> '//text_of(nint(largest_off_curve))
      if (value <= largest_off_curve) text = rounding_number(value)
    case (factor)
      text = estimate_number(value)
      if (value > largest_factor) text = '> '//estimate_number(largest_factor)
    case (part)
      text = right(percent(value, 1.0_wp), 15)   ! the per cent sign is right of the column
    end select
  end function listed_number

  !> Write a number for a file: 17 digits. It is empty if the number is unknown: errors or pressures below
  !! zero.
  pure function full_number(kind, value) result(text)
    integer, intent(in) :: kind     !! one of those above
    real(wp), intent(in) :: value   !! the number
    character(len=25) :: text

    text = ''
    if (kind == no_number .or. value <= unknown) return
    if (value >= 0.0_wp .or. all(kind /= [known, estimate, factor, part])) text = decimal_text(value, 17, 3)
  end function full_number

  !> Write a number for a column of the listing: six digits in 13 characters.
  pure function column_number(value, scale) result(text)
    real(wp), intent(in) :: value
    real(wp), intent(in) :: scale  !! largest magnitude of its column
    character(len=13) :: text

    if (abs(value) <= rounded_off*scale .or. value == 0.0_wp) then
      text = '          0.0'
    else if (abs(value) >= 0.999999e100_wp .or. abs(value) < 1.0e-99_wp) then
      write (text, '(es13.5e3)') value
    else
      text = right(trim(decimal_text(value, 6, 2)), len(text))
    end if
  end function column_number

  !> Write a number that is rounding in a valid answer as upper bound, `< 1E-12` or more, because rounding
  !! differs between builds. Larger numbers have two digits.
  pure function rounding_number(value) result(text)
    real(wp), intent(in) :: value   !! the number
    character(len=:), allocatable :: text

    text = formatted('(es9.1e2)', value)
    if (value < least_difference) text = '< 1E'//text_of(ceiling(log10(max(value, 0.999_wp*rounded_off))))
  end function rounding_number

  !> Write an estimate: two digits.
  pure function estimate_number(value) result(text)
    real(wp), intent(in) :: value   !! the number
    character(len=:), allocatable :: text

    text = formatted('(es9.1e2)', value)
    if (value >= 0.94e100_wp .or. value < 1.0e-99_wp) text = formatted('(es9.1e3)', value)
  end function estimate_number
end module epcont_report_columns
