!> The load path: the loads grow from those at its start to those at its end, in load steps. Each step is
!> iterated to equilibrium. In flow theory a step is an increment: it is committed before the next one, and
!> halved if it does not converge.
module epcont_plasticity_load_path
  use epcont_assembly_bodies, only: weak_pivot
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_no_equilibrium, contact_solved
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_solved_state, only: solved_state
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_planned_model, only: planned_model
  use epcont_plasticity_equilibrium_iteration, only: equilibrium_iteration
  use epcont_plasticity_observer, only: iteration_record, observer
  use epcont_plasticity_path_end, only: path_end
  use epcont_system_stopwatch, only: stage_yielding
  implicit none
  private
  public :: followed_loads, load_path

  !> Contact is lost if its last force was at most this part of the largest: an increment is small enough.
  real(wp), parameter :: little = 0.05_wp

  !> Parts of a load step; an increment is at least one of them.
  integer, parameter :: parts = 64

  !> Result of the loads: the answer, or the state closest to it.
  type, extends(solved_state) :: followed_loads
    real(wp) :: load_factor = 0.0_wp       !! part of the path up to this state
    logical :: converged = .false.         !! for the whole path, to the tolerance of the iteration
    logical :: carried = .false.           !! for a part of it, to this tolerance
    logical :: runs_away = .false.         !! no equilibrium: the displacements grow without end
    logical :: lost_contact = .false.      !! flow theory: no contact is left under more of the loads
    integer :: failed_body = 0             !! body that could not be factored
    logical :: lacks_memory = .false.      !! the reason was too little memory
    integer :: factorizations = 0          !! of bodies
    real(wp) :: condition = 1.0_wp         !! of the stiffness, estimated in the 1-norm
    type(weak_pivot) :: weakest            !! of the stiffness
    type(iteration_record), allocatable :: history(:)   !! every solve
    real(wp), private :: largest_force = 0.0_wp         !! largest sum of the contact forces on the path
    real(wp), allocatable :: elastic_stress(:, :)       !! of elastic bodies under the loads of the first load
                                                        !! step [stress] [components, points]
  contains
    procedure :: begin_at
    procedure, private :: keep_step
  end type followed_loads

  type :: load_path
    private
    type(equilibrium_iteration) :: iteration
    integer :: place = 0                     !! part of the path that is done
    integer :: stride = parts                !! of the next load step
  contains
    procedure :: begin
    procedure :: advance
    procedure :: commit
    procedure :: is_complete
    procedure :: iterations
    procedure :: finish
    procedure, private :: part_of_loads
  end type load_path

contains

  !> Begin a path. The first load case starts without `linear`; the others get it from the previous one, with
  !! the factors of the unloaded state.
  subroutine begin(self, scene, plan, linear, virgin, from)
    class(load_path), intent(out) :: self
    !> With the loads at the end of the path; gets those of the first load step
    type(planned_model), intent(inout) :: scene
    type(iteration_plan), intent(in) :: plan          !! method and tolerances; may differ from the model's
    type(linear_problem), allocatable, intent(inout) :: linear   !! as after the last solve
    !> With factors of the unloaded state, if they will be needed and the model yields
    type(linear_problem), allocatable, intent(inout) :: virgin
    class(path_end), intent(in), optional :: from     !! start of the path; absent: unloaded

    self%iteration%plan = plan
    call move_alloc(linear, self%iteration%linear)
    call move_alloc(virgin, self%iteration%virgin)
    call self%iteration%begin(scene, from)
    call move_alloc(self%iteration%linear, linear)
  end subroutine begin

  !> Make the next load step. The model gets the loads of the state found.
  subroutine advance(self, scene, linear, answer, watch)
    class(load_path), intent(inout) :: self
    type(planned_model), intent(inout) :: scene
    type(linear_problem), allocatable, intent(inout) :: linear   !! as after the last solve
    class(followed_loads), intent(inout) :: answer               !! state found
    class(observer), intent(inout) :: watch                      !! takes the time, called after each solve

    call move_alloc(linear, self%iteration%linear)
    associate (iteration => self%iteration, flow => scene%model%controls%by_increments)
      do
        if (self%place > 0 .or. self%stride < parts) &
          call iteration%take_loads(scene, self%part_of_loads(self%place + self%stride))
        call iteration%iterate(scene, watch)
        if (iteration%converged .or. .not. flow .or. self%stride == 1 .or. iteration%failed_body > 0) exit
        self%stride = self%stride/2
        call iteration%go_back()
      end do
      call answer%keep_step(scene, iteration, watch)
      answer%converged = iteration%converged .or. answer%lost_contact
      if (iteration%converged) then
        self%place = self%place + self%stride
        if (mod(self%place, 2*self%stride) == 0) self%stride = min(parts, 2*self%stride)
      end if
      call move_alloc(iteration%linear, linear)
    end associate
    call watch%lap(stage_yielding)
  end subroutine advance

  !> Commit an increment: the next one starts from its state.
  subroutine commit(self, scene, linear, answer)
    class(load_path), intent(inout) :: self
    type(planned_model), intent(inout) :: scene
    type(linear_problem), intent(inout) :: linear
    class(followed_loads), intent(in) :: answer   !! its state

    if (linear%materials%yields) call linear%materials%commit(answer%point)
    scene%model%contact%slipped = scene%model%contact%slides(answer%displacement)
    self%iteration%committed = answer%solved_state
  end subroutine commit

  !> Are all loads applied?
  pure logical function is_complete(self)
    class(load_path), intent(in) :: self

    is_complete = self%place == parts*self%iteration%plan%load_steps
  end function is_complete

  !> Number of solves so far.
  pure integer function iterations(self)
    class(load_path), intent(in) :: self

    iterations = size(self%iteration%history)
  end function iterations

  !> Part of the loads after some parts of load steps.
  pure real(wp) function part_of_loads(self, place)
    class(load_path), intent(in) :: self
    integer, intent(in) :: place

    part_of_loads = real(place, wp)/(parts*self%iteration%plan%load_steps)
  end function part_of_loads

  !> Pass on the history of the iteration, and the data for another load case.
  subroutine finish(self, linear, virgin, answer)
    class(load_path), intent(inout) :: self
    type(linear_problem), allocatable, intent(inout) :: linear, virgin
    class(followed_loads), intent(inout) :: answer

    call move_alloc(self%iteration%history, answer%history)
    call move_alloc(self%iteration%first_stress, answer%elastic_stress)
    call move_alloc(self%iteration%virgin, virgin)
    ! The last active set belongs to an equilibrium state.
    if (answer%failed_body == 0 .and. answer%contact%state == contact_solved) &
      call move_alloc(self%iteration%touching, linear%touching)
  end subroutine finish

  !> Begin at the end of the loads before, which is the result as long as no load step is carried. If there
  !! are other pairs now, the end is not an equilibrium.
  pure subroutine begin_at(self, from, pairs)
    class(followed_loads), intent(inout) :: self
    class(path_end), intent(in) :: from
    integer, intent(in) :: pairs   !! of the model

    if (size(from%state%contact%force) /= pairs) return
    self%solved_state = from%state
    self%carried = .true.
    self%largest_force = sum(from%state%contact%force)
  end subroutine begin_at

  !> Store the result of a load step. If it was not carried, nothing is stored, unless it is the first.
  subroutine keep_step(self, scene, iteration, watch)
    class(followed_loads), intent(inout) :: self
    type(planned_model), intent(inout) :: scene   !! gets the loads of the result
    type(equilibrium_iteration), intent(inout) :: iteration
    class(observer), intent(inout) :: watch
    logical :: escapes   !! more of the loads move a body that is in equilibrium so far

    self%runs_away = iteration%runs_away
    self%factorizations = iteration%factorizations()
    self%failed_body = iteration%failed_body
    self%lacks_memory = any(iteration%linear%body%lacks_memory)
    if (self%failed_body > 0) return
    associate (contact => iteration%state%contact)
      escapes = self%carried .and. scene%model%controls%by_increments .and. &
                contact%state == contact_no_equilibrium
      if (escapes) then
        self%lost_contact = sum(self%contact%force) <= little*self%largest_force
        self%runs_away = .not. self%lost_contact
        self%contact%escape = contact%escape
      end if
      if (escapes .or. &
          .not. (iteration%converged .or. .not. self%carried .or. contact%state /= contact_solved)) then
        call iteration%return_to(scene, self%solved_state, self%load_factor, watch)
        if (iteration%failed_body > 0) self%condition = huge(1.0_wp)
        ! Its plastic strains are committed.
        if (scene%model%controls%by_increments) self%point = iteration%linear%materials%states(self%strain)
        return
      end if
    end associate
    self%solved_state = iteration%state
    if (self%contact%state /= contact_solved) return
    self%load_factor = iteration%load_factor
    self%weakest = iteration%linear%weakest()
    self%carried = iteration%converged
    self%largest_force = max(self%largest_force, sum(self%contact%force))
  end subroutine keep_step
end module epcont_plasticity_load_path
