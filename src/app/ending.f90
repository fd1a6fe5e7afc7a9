!> How the program ends.
module epcont_app_ending
  use, intrinsic :: iso_c_binding, only: c_bool, c_f_pointer, c_funloc, c_funptr, c_int, c_loc, c_ptr
  use epcont_app_console, only: newline, print_error
  use epcont_base_error, only: status_internal, status_usage
  use epcont_base_version, only: program_name
  implicit none
  private
  public :: watch_exit, stop_with, stop_now

  interface
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

  !> From here on the program ends by `stop_with`, or else with the exit status of its fault: the Fortran
  !! runtime and OpenBLAS have statuses of their own, which here would mean that there is an answer. A closed
  !! pipe, or a file above the size allowed, is a fault of that file.
  subroutine watch_exit(ended)
    !> lives as long as the program; true when `stop_with` is called
    logical(c_bool), target, intent(in) :: ended
    integer(c_int), parameter :: broken_pipe = 13, file_size = 25
    integer(c_int) :: ignored

    ignored = c_sigignore(broken_pipe)
    ignored = c_sigignore(file_size)
    ignored = c_on_exit(c_funloc(judge_exit), c_loc(ended))
  end subroutine watch_exit

  !> What `exit` calls. Status 1 is that of memory that could not be had, with the Fortran runtime and with
  !! OpenBLAS.
  subroutine judge_exit(status, ended) bind(c)
    integer(c_int), value :: status
    type(c_ptr), value :: ended
    logical(c_bool), pointer :: in_order

    call c_f_pointer(ended, in_order)
    if (in_order) return
    if (status == 1) call stop_now(status_usage, 'there is not enough memory, or less is allowed (ulimit)')
    call stop_now(status_internal, 'internal error: please report it with the deck')
  end subroutine judge_exit

  !> End in good order.
  subroutine stop_with(status)
    integer, intent(in) :: status   !! of the program

    call c_exit(int(status, c_int))
  end subroutine stop_with

  !> End at once, and say why.
  subroutine stop_now(status, message)
    integer, intent(in) :: status            !! of the program
    character(len=*), intent(in) :: message   !! one line

    call print_error(program_name//': '//message//newline)
    call c_exit_now(int(status, c_int))
  end subroutine stop_now
end module epcont_app_ending
