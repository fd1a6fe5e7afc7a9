!> The listing's headings, figures and columns.
module epcont_report_layout
  use epcont_report_file, only: text_file
  implicit none
  private
  public :: heading, figure, right, wrap

  character(len=1), parameter, public :: newline = new_line('a')

contains

  !> A blank line and a heading, marked where the answer is not valid.
  subroutine heading(file, text)
    class(text_file), intent(in) :: file    !! the listing
    character(len=*), intent(in) :: text   !! of the heading

    call file%line('')
    call file%line(text//file%mark)
  end subroutine heading

  !> A named figure: its value at the right of 13 columns, and what is to be said of it.
  subroutine figure(file, name, value, note)
    class(text_file), intent(in) :: file              !! the listing
    character(len=*), intent(in) :: name, value      !! in at most 44 characters; any text
    character(len=*), intent(in), optional :: note   !! behind the value
    character(len=44) :: label

    label = name
    if (present(note)) then
      call file%line('  '//label//right(value, 13)//note)
    else
      call file%line('  '//label//right(value, 13))
    end if
  end subroutine figure

  !> Text on lines of at most 132 columns.
  subroutine wrap(file, text)
    class(text_file), intent(in) :: file    !! the listing
    character(len=*), intent(in) :: text   !! what would be a long line
    integer, parameter :: columns = 132
    integer :: from, to

    from = 1
    do while (len(text) - from >= columns - 4)
      to = from + index(text(from:from + columns - 4), ' ', back=.true.) - 1
      if (to <= from) to = from + columns - 4
      call file%line(repeat(' ', merge(4, 0, from > 1))//text(from:to))
      from = to + 1
    end do
    call file%line(repeat(' ', merge(4, 0, from > 1))//text(from:))
  end subroutine wrap

  !> Text at the right of `width` columns; wider text is kept whole.
  pure function right(text, width) result(field)
    character(len=*), intent(in) :: text   !! any text
    integer, intent(in) :: width           !! number of columns
    character(len=:), allocatable :: field

    field = repeat(' ', max(0, width - len(text)))//text
  end function right
end module epcont_report_layout
