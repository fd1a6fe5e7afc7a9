!> The error that ends a run: what to say and with which exit status.
!>
!> A procedure that can fail takes an allocatable `error_type` as its last argument and leaves it
!> unallocated when all went well. Only the driver prints it. Faults of a deck are diagnostics
!> (`epcont_base_diagnostic`), collected so that all of them are reported in one run.
module epcont_base_error
  implicit none
  private
  public :: error_type, raise

  !> Exit statuses of the program.
  integer, parameter, public :: &
    status_valid = 0, &      !! the answer is valid
    status_no_answer = 1, &  !! not converged, or no equilibrium
    status_deck = 2, &       !! deck rejected
    status_usage = 3, &      !! usage, files, or memory refused
    status_numerical = 4, &  !! breakdown, or certificate beyond tolerance
    status_internal = 5      !! a fault of the program

  !> What they mean, for whoever runs the program.
  character(len=*), parameter, public :: status_meaning(0:5) = [ &
    'answer valid, or what was asked for was printed      ', &
    'not converged, limit load passed, or no equilibrium  ', &
    'deck rejected: every fault with file, line, columns  ', &
    'usage, files or memory                               ', &
    'numerical breakdown, or certificate beyond tolerance ', &
    'internal error: please report it with the deck       ']

  !> An error: the exit status it leads to, and the message.
  type :: error_type
    integer :: status = status_internal
    character(len=:), allocatable :: message
  end type error_type

contains

  !> Set `error`.
  pure subroutine raise(error, status, message)
    type(error_type), allocatable, intent(out) :: error   !! allocated afterwards
    integer, intent(in) :: status            !! one of the exit statuses above
    character(len=*), intent(in) :: message  !! what is wrong, where, and what would be right

    allocate (error)
    error%status = status
    error%message = message
  end subroutine raise
end module epcont_base_error
