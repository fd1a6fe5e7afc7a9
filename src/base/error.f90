!> The error that ends a run: message and exit status.
!>
!> A procedure that can fail has an allocatable `error_type` as its last argument, which stays unallocated if
!> it succeeds. Only the driver prints it. Errors in a deck are diagnostics (`epcont_base_diagnostic`), which
!> are collected so that one run reports all of them.
module epcont_base_error
  implicit none
  private
  public :: error_type, raise

  !> Exit statuses of the program.
  integer, parameter, public :: &
    status_valid = 0, &      !! the answer is valid
    status_no_answer = 1, &  !! not converged, or no equilibrium
    status_deck = 2, &       !! deck rejected
    status_usage = 3, &      !! usage, files, or memory
    status_numerical = 4, &  !! numerical breakdown, or certificate beyond tolerance
    status_internal = 5      !! internal error

  !> Meanings for the user.
  character(len=*), parameter, public :: status_meaning(0:5) = [ &
    'answer valid, or what was asked for was printed      ', &
    'not converged, limit load passed, or no equilibrium  ', &
    'deck rejected: every fault with file, line, columns  ', &
    'usage, files or memory                               ', &
    'numerical breakdown, or certificate beyond tolerance ', &
    'internal error: please report it with the deck       ']

  !> Exit status and message.
  type :: error_type
    integer :: status = status_internal
    character(len=:), allocatable :: message
  end type error_type

contains

  !> Set `error`.
  pure subroutine raise(error, status, message)
    type(error_type), allocatable, intent(out) :: error   !! allocated afterwards
    integer, intent(in) :: status            !! one of the exit statuses above
    character(len=*), intent(in) :: message  !! object, fault, and remedy

    allocate (error)
    error%status = status
    error%message = message
  end subroutine raise
end module epcont_base_error
