!> Standard output, and how the program ends. Fortran's WRITE does not say whether its text arrived; C does.
module epcont_app_console
  use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_f_pointer, c_funloc, c_funptr, c_int, c_loc, &
                                         c_null_char, c_null_ptr, c_ptr
  use, intrinsic :: iso_fortran_env, only: error_unit
  use epcont_base_error, only: status_internal, status_usage
  use epcont_base_version, only: program_name
  implicit none
  private
  public :: print_text, watch_exit, stop_with

  interface
    integer(c_int) function c_puts(text) bind(c, name='puts')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: text(*)
    end function c_puts
    integer(c_int) function c_fflush(stream) bind(c, name='fflush')
      import :: c_int, c_ptr
      type(c_ptr), value :: stream
    end function c_fflush
    integer(c_int) function c_sigignore(signal) bind(c, name='sigignore')
      import :: c_int
      integer(c_int), value :: signal
    end function c_sigignore
    integer(c_int) function c_on_exit(handler, argument) bind(c, name='on_exit')
      import :: c_funptr, c_int, c_ptr
      type(c_funptr), value :: handler
      type(c_ptr), value :: argument
    end function c_on_exit
    subroutine c_exit(status) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: status
    end subroutine c_exit
    subroutine c_exit_now(status) bind(c, name='_exit')
      import :: c_int
      integer(c_int), value :: status
    end subroutine c_exit_now
  end interface

contains

  !> Print text on standard output, at once, and a newline where it does not end with one. Where that cannot be done,
  !! `status` becomes at least that of files.
  subroutine print_text(text, status)
    character(len=*), intent(in) :: text
    integer, intent(inout) :: status
    integer(c_int) :: printed
    integer :: last

    last = len(text)
    if (last > 0) last = last - merge(1, 0, text(last:) == new_line('a'))
    printed = c_puts(text(:last)//c_null_char)
    if (c_fflush(c_null_ptr) == 0 .and. printed >= 0) return
    if (status < status_usage) write (error_unit, '(a)') program_name//': standard output cannot be written'
    status = max(status, status_usage)
  end subroutine print_text

  !> From here on the program ends by `stop_with`, or else with the exit status of its fault: the Fortran runtime and OpenBLAS
  !! have statuses of their own, which here would mean that there is an answer. A closed pipe, or a file above the size allowed,
  !! is a fault of that file.
  subroutine watch_exit(ended)
    logical(c_bool), target, intent(in) :: ended   !! lives as long as the program; true when `stop_with` is called
    integer(c_int), parameter :: broken_pipe = 13, file_size = 25
    integer(c_int) :: ignored

    ignored = c_sigignore(broken_pipe)
    ignored = c_sigignore(file_size)
    ignored = c_on_exit(c_funloc(judge_exit), c_loc(ended))
  end subroutine watch_exit

  !> What `exit` calls. Status 1 is that of memory that could not be had, with the Fortran runtime and with OpenBLAS.
  subroutine judge_exit(status, ended) bind(c)
    integer(c_int), value :: status
    type(c_ptr), value :: ended
    logical(c_bool), pointer :: in_order

    call c_f_pointer(ended, in_order)
    if (in_order) return
    if (status == 1) then
      write (error_unit, '(a)') program_name//': there is not enough memory, or less is allowed (ulimit)'
      call c_exit_now(int(status_usage, c_int))
    else
      write (error_unit, '(a)') program_name//': internal error: please report it with the deck'
      call c_exit_now(int(status_internal, c_int))
    end if
  end subroutine judge_exit

  subroutine stop_with(status)
    integer, intent(in) :: status

    call c_exit(int(status, c_int))
  end subroutine stop_with
end module epcont_app_console
