!> Standard output and standard error. Fortran's WRITE does not say whether its text arrived; the system does.
module epcont_app_console
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_short, c_size_t
  use epcont_base_error, only: status_usage
  use epcont_base_version, only: program_name
  implicit none
  private
  public :: print_text, print_error, is_terminal, terminal_columns

  character(len=1), parameter, public :: newline = new_line('a')
  integer(c_int), parameter :: standard_output = 1, standard_error = 2

  !> What Linux says of a window.
  type, bind(c) :: window_type
    integer(c_short) :: rows, columns, width, height
  end type window_type

  interface
    integer(c_size_t) function c_write(descriptor, text, length) bind(c, name='write')
      import :: c_char, c_int, c_size_t
      integer(c_int), value :: descriptor
      character(kind=c_char), intent(in) :: text(*)
      integer(c_size_t), value :: length
    end function c_write
    integer(c_int) function c_isatty(descriptor) bind(c, name='isatty')
      import :: c_int
      integer(c_int), value :: descriptor
    end function c_isatty
    integer(c_int) function c_ioctl(descriptor, request, window) bind(c, name='ioctl')
      import :: c_int, c_long, window_type
      integer(c_int), value :: descriptor
      integer(c_long), value :: request
      type(window_type), intent(out) :: window
    end function c_ioctl
  end interface

contains

  !> Print text on standard output, at once, and a newline where it does not end with one.
  subroutine print_text(text, status)
    character(len=*), intent(in) :: text   !! one line or many
    integer, intent(inout) :: status   !! where that cannot be done, at least that of files afterwards
    integer :: last

    last = len(text)
    if (last > 0) last = last - merge(1, 0, text(last:) == newline)
    if (is_written(standard_output, text(:last)//newline)) return
    if (status < status_usage) call print_error(program_name//': standard output cannot be written'//newline)
    status = max(status, status_usage)
  end subroutine print_text

  !> Print on standard error, at once and as it is. Nothing comes of it where that cannot be written.
  subroutine print_error(text)
    character(len=*), intent(in) :: text   !! with its newlines
    logical :: ignored

    ignored = is_written(standard_error, text)
  end subroutine print_error

  !> Write text; a pipe may take it in parts.
  logical function is_written(descriptor, text)
    integer(c_int), intent(in) :: descriptor
    character(len=*), intent(in) :: text
    integer(c_size_t) :: done, part

    done = 0
    do while (done < len(text))
      part = c_write(descriptor, text(done + 1:), len(text, kind=c_size_t) - done)
      if (part <= 0) exit
      done = done + part
    end do
    is_written = done == len(text)
  end function is_written

  !> Is standard error a terminal?
  logical function is_terminal()
    is_terminal = c_isatty(standard_error) == 1
  end function is_terminal

  !> Columns of that terminal; where it does not say, as many as any has.
  integer function terminal_columns() result(columns)
    integer(c_long), parameter :: window_size = 21523_c_long   !! TIOCGWINSZ of Linux
    integer, parameter :: usual = 80
    type(window_type) :: window

    columns = 0
    if (c_ioctl(standard_error, window_size, window) == 0) columns = window%columns
    if (columns <= 0) columns = usual
  end function terminal_columns
end module epcont_app_console
