!> The one way to write a table. What its columns are is said once, by data: a section of the listing, a file
!> of comma separated values and the manual page all come from that. Rows are values of mixed kind.
module epcont_report_columns
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_report_file, only: text_file
  use epcont_report_layout, only: heading, right
  use epcont_report_number, only: full_numbers, is_known, listed_number
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
  type :: table_type
    type(text_file) :: file
    logical :: listed = .true.                       !! in the listing
    type(column), allocatable, private :: column(:)  !! that are shown, in their order
    integer, allocatable, private :: nth(:)          !! which value of its sort each of them has in a row
    real(wp), allocatable, private :: scale(:)       !! of each number in a row
  contains
    procedure :: describe
    procedure :: begin
    procedure :: row
    procedure :: head_text
    procedure :: row_text
    procedure, private :: placed
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
  pure subroutine describe(self, columns, scale, order)
    class(table_type), intent(inout) :: self
    type(column), intent(in) :: columns(:)  !! in the order of the file
    real(wp), intent(in), optional :: scale(:)   !! of each number: the largest of its column; not given: 0
    integer, intent(in), optional :: order(:)    !! of the listing's columns; not given: that of the file
    integer :: i, sort(size(columns))
    integer, allocatable :: shown(:)

    shown = [(i, i=1, size(columns))]
    if (self%listed .and. present(order)) shown = order
    shown = pack(shown, merge(columns(shown)%width > 0, columns(shown)%name /= '', self%listed))
    sort = min(columns%kind, 1)
    where (sort == state) sort = word
    self%column = columns(shown)
    self%nth = [(count(sort(:shown(i)) == sort(shown(i))), i=1, size(shown))]
    self%scale = spread(0.0_wp, 1, size(columns))
    if (present(scale)) self%scale = scale
  end subroutine describe

  !> Write the heading, and the heads of the columns.
  subroutine begin(self, title, columns, scale, order)
    class(table_type), intent(inout) :: self
    character(len=*), intent(in) :: title        !! of the section of the listing; empty: none
    type(column), intent(in) :: columns(:)       !! as `describe` has them
    real(wp), intent(in), optional :: scale(:)   !! as `describe` has it
    integer, intent(in), optional :: order(:)    !! as `describe` has it

    call self%describe(columns, scale, order)
    if (self%listed .and. len(title) > 0) call heading(self%file, title)
    call self%file%line(self%head_text())
  end subroutine begin

  !> Write a row.
  subroutine row(self, wholes, numbers, words)
    class(table_type), intent(in) :: self
    integer, intent(in) :: wholes(:)           !! as `row_text` has them
    real(wp), intent(in) :: numbers(:)         !! as `row_text` has them
    character(len=*), intent(in) :: words(:)   !! as `row_text` has them
    character(len=:), allocatable :: text

    text = self%row_text(wholes, numbers, words)
    call self%file%line(text)
  end subroutine row

  !> The heads of the columns.
  pure function head_text(self) result(text)
    class(table_type), intent(in) :: self
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(self%column)
      associate (one => self%column(i))
        text = text//self%placed(i, trim(merge(one%head, one%name, self%listed .and. one%head /= '')))
      end associate
    end do
    text = trim(text)
  end function head_text

  !> A row, as `row` writes it.
  pure function row_text(self, wholes, numbers, words) result(text)
    class(table_type), intent(in) :: self
    integer, intent(in) :: wholes(:)           !! ids and counts, in the order of the file's columns
    real(wp), intent(in) :: numbers(:)         !! in that order
    character(len=*), intent(in) :: words(:)   !! in that order
    character(len=:), allocatable :: text
    character(len=25) :: full(size(numbers))
    integer :: i

    if (.not. self%listed) full = full_numbers(numbers)
    text = ''
    do i = 1, size(self%column)
      associate (kind => self%column(i)%kind, n => self%nth(i))
        if (kind == whole) then
          text = text//self%placed(i, text_of(wholes(n)))
        else if (kind < whole) then
          text = text//self%placed(i, trim(words(n)))
        else if (self%listed) then
          text = text//self%placed(i, listed_number(kind, numbers(n), self%scale(n)))
        else
          if (.not. is_known(kind, numbers(n))) full(n) = ''
          text = text//self%placed(i, trim(full(n)))
        end if
      end associate
    end do
    text = trim(text)
  end function row_text

  !> A text in its column.
  pure function placed(self, i, text) result(field)
    class(table_type), intent(in) :: self
    integer, intent(in) :: i
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: field

    if (.not. self%listed) then
      field = trim(merge(' ', ',', i == 1))//text
    else if (self%column(i)%kind == state) then
      field = '  '//text//repeat(' ', max(0, self%column(i)%width - len(text) - 2))
    else
      field = right(text, self%column(i)%width)
    end if
  end function placed
end module epcont_report_columns
