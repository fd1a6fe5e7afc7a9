!> How many threads work on bodies side by side, and on the fronts of one. Bodies touch only through contact:
!> each is assembled, factored and asked for its flexibility by itself.
module epcont_plan_side_by_side
  use epcont_base_kinds, only: i8, wp
  use epcont_base_sorting, only: sorted_order
  use epcont_model_controls, only: solver_frontal
  use epcont_plan_forecast, only: most_memory
  use epcont_plan_numbering, only: numbering_type
  use epcont_system_memory, only: has_memory, memory_of_thread
  implicit none
  private
  public :: heaviest_first, plan_threads, threads_for

  !> Operations beside the largest piece from which on a second thread pays.
  real(wp), parameter :: least_beside = 2.0e7_wp

contains

  !> Threads for a scene: one where there is no memory for more.
  integer function plan_threads(numbering, bytes, granted) result(threads)
    type(numbering_type), intent(in) :: numbering   !! of its equations
    integer(i8), intent(in) :: bytes      !! that the run will hold on one thread
    integer, intent(in) :: granted   !! threads, by OMP_NUM_THREADS

    threads = threads_for(numbering%body%operations, numbering%body%solver == solver_frontal, granted)
    if (threads == 1) return
    if (.not. has_memory(most_memory(bytes) + (threads - 1)*memory_of_thread)) threads = 1
  end function plan_threads

  !> Threads for some bodies: no more than granted, nor than are over before the largest piece that one of
  !! them does alone; one where a second would have little to do.
  pure integer function threads_for(operations, shared, granted) result(threads)
    real(wp), intent(in) :: operations(:)   !! of each body
    logical, intent(in) :: shared(:)        !! threads share its fronts; else one has all of it
    integer, intent(in) :: granted   !! threads
    real(wp) :: all, largest

    threads = 1
    all = sum(operations)
    largest = maxval([merge(least_beside, operations, shared), least_beside])
    if (all - largest >= least_beside) threads = min(granted, ceiling(all/largest))
  end function threads_for

  !> The order in which threads take bodies up: the heaviest first, to a factor of two, so that none of them
  !! is left for the end.
  pure function heaviest_first(operations) result(order)
    real(wp), intent(in) :: operations(:)   !! of each body
    integer, allocatable :: order(:)

    order = sorted_order(-exponent(operations))
  end function heaviest_first
end module epcont_plan_side_by_side
