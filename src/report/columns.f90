!> The one way to write a table. What its columns are is said once, by data: a section of the listing, a file
!> of comma separated values and the manual page all come from that. Rows are values of mixed kind.
module epcont_report_columns
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_report_file, only: text_file
  use epcont_report_layout, only: heading, right
  use epcont_report_number, only: full_numbers, listed_number
  implicit none
  private
  public :: column, table_type, columns_text

  !> What the values of a column are, where they are no numbers (`epcont_report_number` has these).
  integer, parameter, public :: whole = 0     !! an id, or a count
  integer, parameter, public :: word = -1     !! at the right of its column
  integer, parameter, public :: state = -2    !! a word at the left of its column, behind two blanks

  !> One column.
  type :: column
    integer :: kind = whole            !! one of those above, or of number
    character(len=21) :: name = ''     !! in the file; empty: the listing alone has this column
    character(len=14) :: unit = ''     !! empty: none
    character(len=64) :: meaning = ''  !! for the manual page; empty: that of the column before, and its unit
    character(len=21) :: head = ''     !! in the listing; empty: the name
    integer :: width = 13              !! in the listing; 0: the file alone has this column
  end type column

  !> A table that is being written, to the listing or to a file of its own.
  type, extends(text_file) :: table_type
    logical :: listed = .true.                       !! in the listing
    type(column), allocatable, private :: column(:)
    integer, allocatable, private :: nth(:)          !! which value of its sort each of them has in a row
    real(wp), allocatable, private :: scale(:)       !! of each number in a row
  contains
    procedure :: describe
    procedure :: begin
    procedure :: row
    procedure :: head_text
    procedure :: row_text
    procedure, private :: line_text
  end type table_type

contains

  !> The columns of a file in words, for the manual page: `x, y (GRID B as drawn; length), force (...)`.
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

  !> Say what the columns are.
  pure subroutine describe(self, columns, scale)
    class(table_type), intent(inout) :: self
    type(column), intent(in) :: columns(:)       !! in their order
    real(wp), intent(in), optional :: scale(:)   !! of each number: the largest of its column; not given: 0
    integer :: i, sort(size(columns))

    sort = max(word, min(columns%kind, 1))
    self%column = columns
    self%nth = [(count(sort(:i) == sort(i)), i=1, size(sort))]
    self%scale = spread(0.0_wp, 1, size(columns))
    if (present(scale)) self%scale = scale
  end subroutine describe

  !> Write the heading, and the heads of the columns.
  subroutine begin(self, title, columns, scale)
    class(table_type), intent(inout) :: self
    character(len=*), intent(in) :: title        !! of the section of the listing; empty: none
    type(column), intent(in) :: columns(:)       !! as `describe` has them
    real(wp), intent(in), optional :: scale(:)   !! as `describe` has it

    call self%describe(columns, scale)
    if (self%listed .and. len(title) > 0) call heading(self, title)
    call self%line(self%head_text())
  end subroutine begin

  !> Write a row.
  subroutine row(self, wholes, numbers, words)
    class(table_type), intent(in) :: self
    integer, intent(in) :: wholes(:)           !! as `row_text` has them
    real(wp), intent(in) :: numbers(:)         !! as `row_text` has them
    character(len=*), intent(in) :: words(:)   !! as `row_text` has them

    call self%line(self%row_text(wholes, numbers, words))
  end subroutine row

  !> The heads of the columns.
  pure function head_text(self) result(text)
    class(table_type), intent(in) :: self
    character(len=:), allocatable :: text

    associate (one => self%column)
      text = self%line_text(merge(one%head, one%name, self%listed .and. one%head /= ''))
    end associate
  end function head_text

  !> A row, as `row` writes it.
  pure function row_text(self, wholes, numbers, words) result(text)
    class(table_type), intent(in) :: self
    integer, intent(in) :: wholes(:)           !! ids and counts, in the order of the columns
    real(wp), intent(in) :: numbers(:)         !! in that order
    character(len=*), intent(in) :: words(:)   !! in that order
    character(len=:), allocatable :: text
    character(len=25) :: cell(size(self%column)), full(size(numbers))
    integer :: i

    if (.not. self%listed) full = full_numbers(pack(self%column%kind, self%column%kind > whole), numbers)
    do i = 1, size(cell)
      if (self%listed .and. self%column(i)%width == 0) cycle
      associate (kind => self%column(i)%kind, n => self%nth(i))
        if (kind == whole) then
          cell(i) = text_of(wholes(n))
        else if (kind < whole) then
          cell(i) = words(n)
        else if (self%listed) then
          cell(i) = listed_number(kind, numbers(n), self%scale(n))
        else
          cell(i) = full(n)
        end if
      end associate
    end do
    text = self%line_text(cell)
  end function row_text

  !> What stands in each column, of those that the listing or the file has.
  pure function line_text(self, cell) result(text)
    class(table_type), intent(in) :: self
    character(len=*), intent(in) :: cell(:)
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(cell)
      associate (one => self%column(i))
        if (.not. self%listed) then
          if (one%name /= '') text = text//','//trim(cell(i))
        else if (one%kind == state) then
          text = text//'  '//adjustl(right(trim(cell(i)), one%width - 2))
        else if (one%width > 0) then
          text = text//right(trim(cell(i)), one%width)
        end if
      end associate
    end do
    text = trim(text)
    if (.not. self%listed) text = text(2:)
  end function line_text
end module epcont_report_columns
