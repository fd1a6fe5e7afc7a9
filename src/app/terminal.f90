!> Standard error, and whether somebody looks at it.
module epcont_app_terminal
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_short, c_size_t
  implicit none
  private
  public :: is_terminal, terminal_columns, print_error

  integer(c_int), parameter :: standard_error = 2

  !> What Linux says of a window.
  type, bind(c) :: window_type
    integer(c_short) :: rows, columns, width, height
  end type window_type

  interface
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
    integer(c_size_t) function c_write(descriptor, text, length) bind(c, name='write')
      import :: c_char, c_int, c_size_t
      integer(c_int), value :: descriptor
      character(kind=c_char), intent(in) :: text(*)
      integer(c_size_t), value :: length
    end function c_write
  end interface

contains

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

  !> Print on standard error, at once and as it is. Nothing comes of it where that cannot be written.
  subroutine print_error(text)
    character(len=*), intent(in) :: text
    integer(c_size_t) :: ignored

    ignored = c_write(standard_error, text, len(text, kind=c_size_t))
  end subroutine print_error
end module epcont_app_terminal
