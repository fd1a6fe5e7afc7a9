!> Number of threads for the bodies, and for the fronts of one body. Bodies are coupled only by contact, so
!> each is assembled and factored, and its flexibility computed, on its own.
module epcont_plan_side_by_side
  use epcont_base_kinds, only: i8, wp
  use epcont_model_controls, only: solver_frontal
  use epcont_plan_forecast, only: most_memory
  use epcont_plan_numbering, only: numbering_type
  use epcont_system_memory, only: has_memory, memory_of_thread
  implicit none
  private
  public :: plan_threads, threads_for

  !> Operations besides the largest task above which a second thread saves time.
  real(wp), parameter :: least_beside = 2.0e7_wp

contains

  !> Threads for a model; one if memory does not suffice for more.
  integer function plan_threads(numbering, bytes, granted) result(threads)
    type(numbering_type), intent(in) :: numbering   !! of its equations
    integer(i8), intent(in) :: bytes      !! memory of the run on one thread
    integer, intent(in) :: granted   !! threads granted by OMP_NUM_THREADS

    threads = threads_for(numbering%body%operations, numbering%body%solver == solver_frontal, granted)
    if (threads == 1) return
    if (.not. has_memory(most_memory(bytes) + (threads - 1)*memory_of_thread)) threads = 1
  end function plan_threads

  !> Threads for some bodies: at most those granted, and at most the operations of all bodies divided by those
  !! of the largest serial task; one if a second thread would have little work.
  pure integer function threads_for(operations, shared, granted) result(threads)
    real(wp), intent(in) :: operations(:)   !! of each body
    logical, intent(in) :: shared(:)        !! threads share its fronts; otherwise one thread has all of it
    integer, intent(in) :: granted   !! threads
    real(wp) :: all, largest

    threads = 1
    all = sum(operations)
    largest = maxval([merge(least_beside, operations, shared), least_beside])
    if (all - largest >= least_beside) threads = min(granted, ceiling(all/largest))
  end function threads_for
end module epcont_plan_side_by_side
