!> The load path: the loads are applied in equal load steps. Each is iterated to equilibrium, and in flow
!> theory committed before the next one.
module epcont_plasticity_load_path
  use epcont_assembly_bodies, only: weak_pivot
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_solved, pivot_record
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_solved_state, only: committed_step, solved_state
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_planned_model, only: planned_model
  use epcont_plasticity_equilibrium_iteration, only: equilibrium_iteration
  use epcont_plasticity_observer, only: iteration_record, observer
  use epcont_plasticity_unloading, only: find_unloaded
  use epcont_system_stopwatch, only: stage_stiffness, stage_yielding
  implicit none
  private
  public :: followed_loads, follow_loads

  !> Result of the loads: the answer, or the state closest to it.
  type, extends(solved_state) :: followed_loads
    real(wp) :: load_factor = 0.0_wp       !! part of the loads of this state
    logical :: converged = .false.         !! for all loads, to the tolerance of the iteration
    logical :: carried = .false.           !! a part of the loads, to this tolerance
    logical :: runs_away = .false.         !! no equilibrium: the displacements grow without end
    integer :: failed_body = 0             !! body that could not be factored
    logical :: lacks_memory = .false.      !! the reason was too little memory
    integer :: factorizations = 0          !! of bodies
    real(wp) :: condition = 1.0_wp         !! of the stiffness, estimated in the 1-norm
    type(weak_pivot) :: weakest            !! of the stiffness
    type(iteration_record), allocatable :: history(:)   !! every solve
    type(pivot_record), allocatable :: pivot(:)         !! kept pivots of all solves
    !> Flow theory: load steps before the last, for the certificate [any]
    type(committed_step), allocatable :: committed(:)
    integer :: unloaded = 0                !! elements whose strain decreased after yielding, while the load
                                           !! grew
    integer :: first_unloaded = 0          !! one of them
  contains
    procedure, private :: keep_step, keep_committed
  end type followed_loads

contains

  !> Apply the loads step by step. The first load case starts without `linear`; the others get it from the
  !! previous one, with the factors of the unloaded state. The model keeps the loads of the state found.
  subroutine follow_loads(scene, plan, keeps, linear, virgin, answer, watch)
    type(planned_model), intent(inout) :: scene                !! model, with the loads at the end
    type(iteration_plan), intent(in) :: plan                   !! method and tolerances; may differ from the
                                                               !! model's
    logical, intent(in) :: keeps                               !! another load case may follow
    type(linear_problem), allocatable, intent(inout) :: linear   !! as after the last solve
    !> With factors of the unloaded state, if they will be needed and the model yields
    type(linear_problem), allocatable, intent(inout) :: virgin
    type(followed_loads), intent(out) :: answer                !! state and history
    class(observer), intent(inout) :: watch                    !! takes the time, called after each solve
    type(equilibrium_iteration) :: iteration
    real(wp) :: strained(scene%model%mesh%points)   ! e of points that yielded in the last load step, else 0
    integer :: step

    iteration%plan = plan
    iteration%keeps = keeps
    call move_alloc(linear, iteration%linear)
    call move_alloc(virgin, iteration%virgin)
    call iteration%begin(scene)
    call watch%lap(stage_stiffness)
    allocate (answer%committed(0))
    strained = 0.0_wp
    do step = 1, plan%load_steps
      if (scene%model%controls%flow_theory .and. step > 1) then
        call iteration%linear%materials%commit(answer%strain, answer%point)
        call answer%keep_committed(scene%model%loads%rise)
      end if
      if (step > 1) call iteration%take_loads(scene, real(step, wp)/plan%load_steps)
      call iteration%iterate(scene, watch)
      call answer%keep_step(scene, iteration, watch)
      if (.not. iteration%converged) exit
      if (plan%load_steps > 1 .and. .not. scene%model%controls%flow_theory) &
        call find_unloaded(scene%model, answer%point, plan%tolerance, strained, answer%unloaded, &
                           answer%first_unloaded)
      call watch%lap(stage_yielding)
    end do
    answer%converged = iteration%converged
    call move_alloc(iteration%history, answer%history)
    call move_alloc(iteration%pivot, answer%pivot)
    call iteration%finish(answer%failed_body == 0 .and. answer%contact%state == contact_solved, &
                          linear, virgin)
  end subroutine follow_loads

  !> Keep the last load step, which is now committed. gfortran 12 leaks an array constructor of such a type.
  pure subroutine keep_committed(self, rise)
    class(followed_loads), intent(inout) :: self
    real(wp), allocatable, intent(in) :: rise(:, :)   !! temperatures of this load step (`load_set%rise`)
    type(committed_step), allocatable :: more(:)
    integer :: k, n

    n = size(self%committed)
    allocate (more(n + 1))
    do k = 1, n
      call move_alloc(self%committed(k)%rise, more(k)%rise)
      call move_alloc(self%committed(k)%deformation, more(k)%deformation)
    end do
    if (allocated(rise)) more(n + 1)%rise = rise
    more(n + 1)%deformation = self%deformation
    call move_alloc(more, self%committed)
  end subroutine keep_committed

  !> Store the result of a load step. If it was not carried, nothing is stored, unless it is the first.
  subroutine keep_step(self, scene, iteration, watch)
    class(followed_loads), intent(inout) :: self
    type(planned_model), intent(inout) :: scene   !! gets the loads of the result
    type(equilibrium_iteration), intent(inout) :: iteration
    class(observer), intent(inout) :: watch

    self%runs_away = iteration%runs_away
    self%factorizations = iteration%factorizations()
    self%failed_body = iteration%failed_body
    self%lacks_memory = any(iteration%linear%body%lacks_memory)
    if (self%failed_body > 0) return
    associate (contact => iteration%state%contact)
      if (.not. (iteration%converged .or. .not. self%carried .or. contact%state /= contact_solved)) then
        call iteration%return_to(scene, self%solved_state, self%load_factor, watch)
        if (iteration%failed_body > 0) self%condition = huge(1.0_wp)
        return
      end if
    end associate
    call self%take(iteration%state)
    if (self%contact%state /= contact_solved) return
    self%load_factor = iteration%load_factor
    self%weakest = iteration%linear%weakest()
    self%carried = iteration%converged
  end subroutine keep_step
end module epcont_plasticity_load_path
