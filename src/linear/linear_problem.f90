!> The bodies of a scene with a linear law of the material, their contact solved exactly: one step of every
!> iteration, and all of an elastic analysis.
module epcont_linear_linear_problem
  use epcont_assembly_bodies, only: factored_bodies, half_solution, new_bodies
  use epcont_assembly_strain_operator, only: new_strain_operator, strain_operator
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: negligible, solved_to
  use epcont_contact_problem, only: contact_problem, contact_solved, contact_stalled
  use epcont_contact_solver, only: solve_contact
  use epcont_flexibility_flexibility, only: add_flexibility, body_flexibility, find_flexibility, &
    gap_opening, pair_forces, see_motions
  use epcont_material_linear_law, only: elastic_law, linear_law
  use epcont_material_scene_materials, only: find_materials, scene_materials
  use epcont_model_controls, only: precision_double, precision_mixed
  use epcont_model_model, only: model_type
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_plan_side_by_side, only: heaviest_first, threads_for
  use epcont_linear_completion, only: complete_state
  use epcont_linear_scene_state, only: scene_state
  use epcont_system_stopwatch, only: stage_contact, stage_displacements, stage_factor, stage_flexibility, stage_stiffness, &
                                   stopwatch
  implicit none
  private
  public :: linear_problem, new_linear_problem

  !> Where two steps of refinement change the strains by more than this part of what the two before did,
  !! rounding is reached, or single precision leaves too little to begin with.
  real(wp), parameter :: slowest_rate = 0.5_wp

  type :: linear_problem
    type(strain_operator) :: operator
    type(scene_materials) :: materials
    type(linear_law) :: law                          !! of the next solve, or the last
    type(factored_bodies) :: bodies
    type(contact_problem) :: problem
    logical, allocatable :: yields(:)                !! the body has elements that can yield [bodies]
    real(wp), allocatable :: lasting_flexibility(:, :)  !! of the bodies that cannot, where others can [pairs, pairs]
    logical :: by_blocks = .false.                   !! contact by RULE BLOCK, else CONRY
    integer :: precision = precision_double          !! of the factors
    integer :: threads = 1                           !! that bodies may be worked on by
    type(scene_state), allocatable :: last           !! found by refinement, from which the next begins
    real(wp), allocatable :: travel_gap(:)           !! opening of the gaps by what supports travel [length] [pairs]
    real(wp), allocatable :: resultant(:)            !! of all loads along the free motions [motions]
  contains
    procedure :: set_stiffness
    procedure :: solve
    procedure :: sharpen
    procedure :: rounding_error
    procedure :: estimate_condition
    procedure, private :: factor_bodies
    procedure, private :: add_flexibilities
  end type linear_problem

contains

  !> What does not change with the law.
  pure subroutine new_linear_problem(scene, plan, linear)
    type(planned_scene), intent(in) :: scene
    type(iteration_plan), intent(in) :: plan
    type(linear_problem), intent(out) :: linear

    linear%operator = new_strain_operator(scene%model)
    call find_materials(scene%model, linear%materials)
    linear%law = elastic_law(linear%materials)
    linear%bodies = new_bodies(scene%model, plan%precision /= precision_double)
    linear%precision = plan%precision
    linear%threads = plan%threads
    linear%yields = plan%body
    linear%by_blocks = plan%contact%by_blocks
    linear%problem%initial_gap = scene%model%initial_gap
    linear%travel_gap = gap_opening(scene%model, scene%model%travel)
    call see_motions(scene%model, scene%motions, linear%problem%motion, linear%resultant)
  end subroutine new_linear_problem

  !> Factor the bodies and invert for the flexibility; after the first time only bodies that can yield, as far
  !! as the law of their elements has changed. `singular` is a body whose stiffness could not be factored, 0
  !! where all could.
  subroutine set_stiffness(self, scene, singular, watch)
    class(linear_problem), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
    integer, intent(out) :: singular
    class(stopwatch), intent(inout) :: watch
    logical, allocatable :: changed(:), chosen(:)
    logical :: first

    first = .not. allocated(self%problem%flexibility)
    changed = changed_elements(scene%model, self%law)
    self%law%changed = .false.
    chosen = self%yields .or. first
    call watch%lap(stage_stiffness)
    call self%factor_bodies(scene, changed, chosen, singular)
    call watch%lap(stage_factor)
    if (singular > 0) return
    call self%bodies%settle(scene%model, self%operator, self%law)
    call watch%lap(stage_displacements)
    if (first) then
      allocate (self%problem%flexibility(scene%model%pairs, scene%model%pairs), source=0.0_wp)
      call self%add_flexibilities(scene, .not. self%yields, self%problem%flexibility)
      if (any(self%yields)) self%lasting_flexibility = self%problem%flexibility
    else if (any(self%yields)) then
      self%problem%flexibility = self%lasting_flexibility
    end if
    call self%add_flexibilities(scene, self%yields, self%problem%flexibility)
    call watch%lap(stage_flexibility)
  end subroutine set_stiffness

  !> Assemble and factor some bodies, side by side where that pays. `singular` is the first that could not be
  !! factored, or 0.
  subroutine factor_bodies(self, scene, changed, chosen, singular)
    class(linear_problem), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
    logical, intent(in) :: changed(:)    !! [elements]
    logical, intent(in) :: chosen(:)     !! [bodies]
    integer, intent(out) :: singular
    real(wp), allocatable :: operations(:)
    integer, allocatable :: body(:)
    integer :: i, threads

    body = pack([(i, i=1, size(chosen))], chosen)
    operations = scene%numbering%body(body)%operations
    body = body(heaviest_first(operations))
    threads = threads_for(operations, self%threads)
    !$omp parallel do num_threads(threads) if (threads > 1) schedule(dynamic)
    do i = 1, size(body)
      call self%bodies%factor_body(scene%model, self%operator, self%law, changed, scene%numbering, body(i))
    end do
    !$omp end parallel do
    self%bodies%factorizations = self%bodies%factorizations + count(chosen .and. scene%numbering%body%equations > 0)
    singular = findloc([(chosen(i) .and. .not. self%bodies%body(i)%is_sound(), i=1, size(chosen))], .true., dim=1)
  end subroutine factor_bodies

  !> Add what some bodies give to the flexibility, each found by itself, in their order: so all roundings are
  !! the same on any number of threads.
  subroutine add_flexibilities(self, scene, chosen, flexibility)
    class(linear_problem), intent(in) :: self
    type(planned_scene), intent(in) :: scene
    logical, intent(in) :: chosen(:)     !! [bodies]
    real(wp), intent(inout) :: flexibility(:, :)
    type(body_flexibility) :: part
    real(wp), allocatable :: operations(:)
    integer :: b, threads

    operations = merge(scene%numbering%body%operations, 0.0_wp, chosen)
    threads = threads_for(operations, self%threads)
    !$omp parallel do num_threads(threads) if (threads > 1) schedule(dynamic) ordered private(part)
    do b = 1, scene%model%bodies
      if (chosen(b)) call find_flexibility(scene%model, scene%numbering, b, self%bodies%body(b), part)
      !$omp ordered
      if (chosen(b)) call add_flexibility(part, flexibility)
      !$omp end ordered
    end do
    !$omp end parallel do
  end subroutine add_flexibilities

  !> Elements whose law is not that of the factors [elements].
  pure function changed_elements(model, law) result(changed)
    type(model_type), intent(in) :: model
    type(linear_law), intent(in) :: law
    logical, allocatable :: changed(:)
    integer :: p

    allocate (changed(model%elements), source=.false.)
    do p = 1, model%points
      if (law%changed(p)) changed(model%point_element(p)) = .true.
    end do
  end function changed_elements

  !> Find displacements, stresses and contact under a part of the loads and prescribed displacements. Without
  !! contact equilibrium (`state%contact%state`) there are no displacements.
  subroutine solve(self, scene, part, start, state, watch)
    class(linear_problem), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
    real(wp), intent(in) :: part
    logical, allocatable, intent(in) :: start(:)   !! guess of the pairs in contact, if allocated [pairs]
    type(scene_state), intent(inout) :: state
    class(stopwatch), intent(inout) :: watch

    if (self%precision == precision_mixed) then
      call refine(self, scene, part, start, state, watch)
    else
      call solve_once(self, scene, part, start, state, watch)
    end if
    if (state%contact%state /= contact_solved) return
    call complete_state(scene, self%law, self%problem, part, state)
    call watch%lap(stage_displacements)
  end subroutine solve

  !> One step of refinement of what `solve` has found: where a body is long and its elements fine, rounding
  !! leaves forces out of balance though the factors are in double. The contact follows the deformation, and
  !! that the contact.
  subroutine sharpen(self, scene, part, state, change, watch)
    class(linear_problem), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
    real(wp), intent(in) :: part
    type(scene_state), intent(inout) :: state   !! as it was where the contact is not found again
    real(wp), intent(out) :: change             !! of displacements and contact forces, of the largest of each
    class(stopwatch), intent(inout) :: watch
    type(scene_state) :: refined
    logical, allocatable :: touching(:)
    real(wp) :: strained   ! part of the strains that a correction changes: the displacements tell what the step has done

    change = huge(1.0_wp)
    refined = state
    touching = state%contact%touching
    call correct(self, scene, part, refined, strained)
    call watch%lap(stage_displacements)
    call solve_contact_about(self, scene%model, part, touching, refined)
    call watch%lap(stage_contact)
    if (refined%contact%state /= contact_solved) return
    call correct(self, scene, part, refined, strained)
    call complete_state(scene, self%law, self%problem, part, refined)
    change = change_of(state, refined)
    if (allocated(refined%point)) deallocate (refined%point)   ! those of the strain before
    state = refined
    call watch%lap(stage_displacements)
  end subroutine sharpen

  !> Largest change of the displacements and of the contact forces, over the largest of each.
  pure real(wp) function change_of(before, after) result(change)
    type(scene_state), intent(in) :: before, after

    change = maxval(abs(after%displacement - before%displacement))/max(maxval(abs(after%displacement)), tiny(1.0_wp))
    if (.not. any(after%contact%force > 0.0_wp)) return
    change = max(change, maxval(abs(after%contact%force - before%contact%force))/maxval(after%contact%force))
  end function change_of

  !> Contact with the gaps that the loads open alone, then the deformation under loads and contact forces.
  subroutine solve_once(self, scene, part, start, state, watch)
    type(linear_problem), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
    real(wp), intent(in) :: part
    logical, allocatable, intent(in) :: start(:)
    type(scene_state), intent(inout) :: state
    class(stopwatch), intent(inout) :: watch
    real(wp), allocatable :: force(:, :)
    type(half_solution) :: half

    force = part*scene%model%load
    if (any(self%law%initial_stress /= 0.0_wp)) force = force - self%operator%nodal_forces(scene%model, self%law%initial_stress)
    call self%bodies%add_forces(scene%numbering, force, part, half)
    self%problem%load_gap = gap_opening(scene%model, self%bodies%finish(scene%model, scene%numbering, half, part, .true.)) + &
                            part*self%travel_gap
    self%problem%resultant = part*self%resultant
    call watch%lap(stage_displacements)
    call solve_contact(self%problem, state%contact, start, self%by_blocks)   ! without a guess `start` is not there
    call watch%lap(stage_contact)
    if (state%contact%state /= contact_solved) return
    call self%bodies%add_forces(scene%numbering, pair_forces(scene%model, state%contact%force), 0.0_wp, half)
    ! Strains are of the deformation: added to a long travel it would lose their digits.
    state%deformation = self%bodies%finish(scene%model, scene%numbering, half, part, .false.)
    state%strain = self%operator%strains(scene%model, state%deformation)
  end subroutine solve_once

  !> The same to double precision with factors in single: step by step the forces out of balance, in double,
  !! are solved for, and the contact with them. `contact_stalled` where that does not converge.
  subroutine refine(self, scene, part, start, state, watch)
    type(linear_problem), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
    real(wp), intent(in) :: part
    logical, allocatable, intent(in) :: start(:)
    type(scene_state), intent(inout) :: state
    class(stopwatch), intent(inout) :: watch
    logical, allocatable :: touching(:)
    real(wp) :: change, before(2)   !! of this step, of the two before
    integer :: step

    if (allocated(self%last)) then
      state = self%last
    else
      allocate (state%deformation(2, scene%model%nodes), state%contact%force(scene%model%pairs), source=0.0_wp)
    end if
    call self%bodies%prescribe(scene%model, part, state%deformation)
    state%strain = self%operator%strains(scene%model, state%deformation)
    if (allocated(start)) touching = start
    before = 0.0_wp
    step = 0
    do
      step = step + 1
      call correct(self, scene, part, state, change)
      call watch%lap(stage_displacements)
      if (step > 1 .and. change <= negligible) exit
      ! Steps come in pairs: what one has refined moves the contact forces, and those the next; the first
      ! brings them in.
      if (step > 4 .and. .not. change <= slowest_rate*before(1)) then
        if (change <= solved_to) exit
        state%contact%state = contact_stalled
        return
      end if
      before = [before(2), change]
      call solve_contact_about(self, scene%model, part, touching, state)
      call watch%lap(stage_contact)
      if (state%contact%state /= contact_solved) return
      touching = state%contact%touching
    end do
    self%last = state
  end subroutine refine

  !> One step of refinement: the deformation under the forces that are out of balance is added.
  pure subroutine correct(self, scene, part, state, change)
    type(linear_problem), intent(in) :: self
    type(planned_scene), intent(in) :: scene
    real(wp), intent(in) :: part
    type(scene_state), intent(inout) :: state   !! deformation, strain, contact forces
    real(wp), intent(out) :: change             !! largest of a strain / largest strain
    real(wp), allocatable :: force(:, :), step(:, :), strain(:, :)

    force = part*scene%model%load + pair_forces(scene%model, state%contact%force) &
            - self%operator%nodal_forces(scene%model, self%law%stress(state%strain))
    step = self%bodies%displacements(scene%model, scene%numbering, force, 0.0_wp)
    strain = self%operator%strains(scene%model, step)
    state%deformation = state%deformation + step
    state%strain = state%strain + strain
    change = maxval(abs(strain))/max(maxval(abs(state%strain)), tiny(1.0_wp))
  end subroutine correct

  !> Contact with the gaps of a deformation, of which the contact forces' part goes by the flexibility.
  subroutine solve_contact_about(self, model, part, touching, state)
    type(linear_problem), intent(inout) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: part
    logical, allocatable, intent(in) :: touching(:)   !! guess of the pairs in contact, if allocated [pairs]
    type(scene_state), intent(inout) :: state

    self%problem%load_gap = gap_opening(model, state%deformation) + part*self%travel_gap - &
                            matmul(self%problem%flexibility, state%contact%force)
    self%problem%resultant = part*self%resultant
    call solve_contact(self%problem, state%contact, touching, self%by_blocks)
  end subroutine solve_contact_about

  !> What single precision has left: the change of displacements, strains and contact forces, of the largest
  !! of each, by two steps of refinement, of which the second must change less: else the factors do not tell
  !! the error either, and it is 1.
  subroutine rounding_error(self, scene, part, state, error)
    class(linear_problem), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
    real(wp), intent(in) :: part
    type(scene_state), intent(in) :: state
    real(wp), intent(out) :: error
    type(scene_state) :: refined
    logical, allocatable :: touching(:)
    real(wp) :: second

    refined = state
    call correct(self, scene, part, refined, error)
    call correct(self, scene, part, refined, second)
    if (second > max(slowest_rate*error, solved_to)) error = 1.0_wp
    error = max(error, maxval(abs(refined%deformation - state%deformation)) &
                /max(maxval(abs(state%deformation)), tiny(1.0_wp)))
    if (scene%model%pairs == 0) return
    touching = state%contact%touching
    call solve_contact_about(self, scene%model, part, touching, refined)
    if (refined%contact%state /= contact_solved) error = 1.0_wp
    if (maxval(state%contact%force) > 0.0_wp) &
      error = max(error, maxval(abs(refined%contact%force - state%contact%force))/maxval(state%contact%force))
  end subroutine rounding_error

  !> Estimate of the condition of the stiffness in the 1-norm.
  pure subroutine estimate_condition(self, scene, condition)
    class(linear_problem), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
    real(wp), intent(out) :: condition

    call self%bodies%estimate_condition(scene%model, self%operator, self%law, scene%numbering, condition)
  end subroutine estimate_condition
end module epcont_linear_linear_problem
