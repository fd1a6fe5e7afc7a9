!> Linear law about a state, for any method, and its stiffness.
module epcont_plasticity_law_of_state
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_solved_state, only: solved_state
  use epcont_plan_planned_model, only: planned_model
  use epcont_plasticity_observer, only: observer
  use epcont_plasticity_secant, only: secant_method
  use epcont_system_stopwatch, only: stage_yielding
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: factor_law, linearise

contains

  !> Find the law about a state.
  subroutine linearise(scene, method, about, linear, watch)
    type(planned_model), intent(in) :: scene           !! model
    class(secant_method), intent(inout) :: method      !! defines the linear law
    type(solved_state), intent(in) :: about             !! with strains and points
    type(linear_problem), intent(inout) :: linear      !! its law is set
    class(observer), intent(inout) :: watch            !! takes the time
    integer :: p

    !$omp parallel do num_threads(threads_over(scene%model%mesh%points))
    do p = 1, scene%model%mesh%points
      if (linear%materials%can_yield(p)) call method%linearise(p, about, linear)
    end do
    !$omp end parallel do
    call watch%lap(stage_yielding)
  end subroutine linearise

  !> Make the stiffness of this law; as long as it cannot be factored, make the law stiffer.
  subroutine factor_law(scene, method, about, linear, failed_body, watch)
    type(planned_model), intent(in) :: scene           !! model
    class(secant_method), intent(inout) :: method      !! defines the linear law
    type(solved_state), intent(in) :: about             !! with strains and points
    type(linear_problem), intent(inout) :: linear      !! with this law
    integer, intent(out) :: failed_body                !! body without factors; 0 if there is no such body
    class(observer), intent(inout) :: watch            !! takes the time
    logical :: possible

    do
      call linear%set_stiffness(scene, failed_body, watch)
      if (failed_body == 0 .or. any(linear%body%lacks_memory)) return
      call method%stiffen(possible)
      if (.not. possible) return
      call linearise(scene, method, about, linear, watch)
    end do
  end subroutine factor_law
end module epcont_plasticity_law_of_state
