!> The listing's headings, figures and columns.
module epcont_report_layout
  use epcont_report_file, only: text_file
  implicit none
  private
  public :: heading, figure, lines, right, wrap

  character(len=1), parameter, public :: newline = new_line('a')

contains

  !> A blank line and a heading, marked where the answer is not valid.
  subroutine heading(file, text)
    type(text_file), intent(in) :: file
    character(len=*), intent(in) :: text

    call file%line('')
    call file%line(text//file%mark)
  end subroutine heading

  !> A named figure.
  subroutine figure(file, name, value)
    type(text_file), intent(in) :: file
    character(len=*), intent(in) :: name, value
    character(len=44) :: label

    label = name
    call file%line('  '//label//value)
  end subroutine figure

  !> Lines that end in newlines.
  subroutine lines(file, text)
    type(text_file), intent(in) :: file
    character(len=*), intent(in) :: text
    integer :: from, to

    from = 1
    do while (from <= len(text))
      to = index(text(from:), newline) + from - 1
      if (to < from) to = len(text) + 1
      call file%line('  '//text(from:to - 1))
      from = to + 1
    end do
  end subroutine lines

  !> Text on lines of at most 132 columns.
  subroutine wrap(file, text)
    type(text_file), intent(in) :: file
    character(len=*), intent(in) :: text
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
    character(len=*), intent(in) :: text
    integer, intent(in) :: width
    character(len=:), allocatable :: field

    field = repeat(' ', max(0, width - len(text)))//text
  end function right
end module epcont_report_layout
