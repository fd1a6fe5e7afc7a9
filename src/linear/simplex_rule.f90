!> RULE CONRY: each body is factored separately, F is found by inversion, and a simplex finds the contact.
module epcont_linear_simplex_rule
  use epcont_assembly_bodies, only: factored_bodies, half_solved_body
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: contact_basis, renew_basis
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_problem, only: contact_no_equilibrium, contact_solution, contact_solved
  use epcont_contact_scaling, only: diagonal_of, drop_motions, scale_problem, scaled_problem
  use epcont_contact_solver, only: solve_contact
  use epcont_flexibility_flexibility, only: gap_opening, pair_forces
  use epcont_flexibility_motion_matrix, only: dense_motions
  use epcont_linear_contact_rule, only: contact_loads, contact_rule, contact_sensitivity
  use epcont_linear_simplex_response, only: find_sensitivity, load_pairs
  use epcont_linear_solved_state, only: solved_state
  use epcont_linear_whole_flexibility, only: add_flexibilities, complete_flexibility
  use epcont_model_controls, only: solver_frontal
  use epcont_model_springs, only: spring_forces
  use epcont_plan_planned_model, only: planned_model
  use epcont_plan_side_by_side, only: threads_for
  use epcont_system_stopwatch, only: stage_contact, stage_displacements, stage_factor, stage_flexibility, &
    stopwatch
  use epcont_system_threads, only: use_one_thread_each
  implicit none
  private
  public :: simplex_rule

  type, extends(contact_rule) :: simplex_rule
    !> Contribution of elastic bodies, if others can yield [length/force] [pairs, pairs]
    real(wp), allocatable, private :: lasting_flexibility(:, :)
    type(contact_basis), private :: basis      !! of the last contact with this flexibility
  contains
    procedure :: take_case
    procedure :: factor
    procedure :: solve
    procedure :: refine
    procedure :: find_others
    procedure :: respond
    procedure :: sensitivity
    procedure :: compliance
    procedure, private :: find_flexibility
    procedure, private :: find_contact
    procedure, private :: scale_pressed
  end type simplex_rule

contains

  !> Take another load case, with the factors of the case before.
  subroutine take_case(self, scene, bodies)
    class(simplex_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies

    self%failed = .false.
    call bodies%settle(scene)
  end subroutine take_case

  !> Factor the bodies and compute the flexibility; after the first time only of bodies that can yield, and
  !! whose law has changed.
  subroutine factor(self, scene, bodies, failed_body, watch)
    class(simplex_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    integer, intent(out) :: failed_body
    class(stopwatch), intent(inout) :: watch

    if (allocated(self%basis%factor)) deallocate (self%basis%factor)   ! belongs to the old flexibility
    call factor_bodies(scene, scene%numbering%body%can_yield .or. .not. allocated(self%problem%flexibility), &
                       self%threads, bodies, failed_body)
    bodies%law%changed = .false.
    call watch%lap(stage_factor)
    if (failed_body > 0) return
    call bodies%settle(scene)
    call watch%lap(stage_displacements)
    call self%find_flexibility(scene, bodies)
    call watch%lap(stage_flexibility)
  end subroutine factor

  !> Assemble and factor some bodies, in parallel if this is faster.
  subroutine factor_bodies(scene, chosen, threads, bodies, failed_body)
    type(planned_model), intent(in) :: scene
    logical, intent(in) :: chosen(:)     !! [bodies]
    integer, intent(in) :: threads       !! number of threads
    class(factored_bodies), intent(inout) :: bodies
    integer, intent(out) :: failed_body
    integer, allocatable :: body(:)
    integer :: i, many

    body = pack([(i, i=1, size(chosen))], chosen)
    many = threads_for(scene%numbering%body(body)%operations, &
                       scene%numbering%body(body)%solver == solver_frontal, threads)
    !$omp parallel do num_threads(many) if (many > 1) schedule(dynamic)
    do i = 1, size(body)
      call use_one_thread_each()
      call bodies%body(body(i))%assemble(scene, bodies%operator, bodies%law, bodies%spring, body(i))
      call bodies%body(body(i))%factor()
    end do
    !$omp end parallel do
    bodies%factorizations = bodies%factorizations + count(chosen .and. scene%numbering%body%equations > 0)
    failed_body = findloc([(chosen(i) .and. .not. bodies%body(i)%is_sound(), i=1, size(chosen))], &
                          .true., dim=1)
  end subroutine factor_bodies

  !> Compute F of all bodies; the contribution of elastic bodies is computed once.
  subroutine find_flexibility(self, scene, bodies)
    class(simplex_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies

    associate (yields => scene%numbering%body%can_yield, n => scene%model%contact%rows())
      if (.not. allocated(self%problem%flexibility)) then
        allocate (self%problem%flexibility(n, n), source=0.0_wp)
        call add_flexibilities(scene, bodies%body, .not. yields, self%threads, self%problem%flexibility)
        if (any(yields) .and. .not. all(yields)) self%lasting_flexibility = self%problem%flexibility
      else if (all(yields)) then
        self%problem%flexibility = 0.0_wp
      else if (any(yields)) then
        self%problem%flexibility = self%lasting_flexibility
      end if
      call add_flexibilities(scene, bodies%body, yields, self%threads, self%problem%flexibility)
      call complete_flexibility(self%problem%flexibility)
    end associate
  end subroutine find_flexibility

  !> Find the contact from the gaps under loads alone, then the deformation under loads and contact forces.
  subroutine solve(self, scene, bodies, start, state, watch)
    class(simplex_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    logical, allocatable, intent(in) :: start(:)
    type(solved_state), intent(inout) :: state
    class(stopwatch), intent(inout) :: watch
    real(wp), allocatable :: force(:, :)
    type(half_solved_body), allocatable :: half(:)

    force = scene%model%loads%load
    if (allocated(scene%model%loads%free_strain)) then   ! stresses without deformation
      force = force - bodies%operator%nodal_forces(scene%model, bodies%law%stress( &
              bodies%operator%strains(scene%model, 0.0_wp*force, .true.)))
    else if (any(bodies%law%initial_stress /= 0.0_wp)) then
      force = force - bodies%operator%nodal_forces(scene%model, bodies%law%initial_stress)
    end if
    call bodies%add_forces(scene, force, .true., half)
    if (allocated(self%problem%known_gap)) deallocate (self%problem%known_force, self%problem%known_gap)
    self%problem%load_gap = self%travel_gap + &
                            gap_opening(scene%model, bodies%finish(scene, half, .true., at_contact=.true.))
    call watch%lap(stage_displacements)
    call self%find_contact(start, state%contact)
    call watch%lap(stage_contact)
    if (state%contact%state /= contact_solved) return
    call bodies%add_forces(scene, pair_forces(scene%model, state%contact%force), .false., half)
    ! Strains come from the deformation: added to a large rigid-body displacement, they would lose digits.
    state%deformation = bodies%finish(scene, half, .true., .false.)
    state%strain = bodies%operator%strains(scene%model, state%deformation, .true.)
  end subroutine solve

  !> Find the contact with the present gaps of the problem.
  subroutine find_contact(self, start, contact)
    class(simplex_rule), intent(inout) :: self
    logical, allocatable, intent(in) :: start(:)       !! guess of the pairs in contact, if allocated [pairs]
    type(contact_solution), intent(inout) :: contact

    self%problem%resultant = self%resultant
    if (.not. allocated(self%problem%friction)) then
      call solve_contact(self%problem, contact, start, self%basis)
      return
    end if
    call solve_contact(self%problem, contact, start, any_forces=.true.)
    if (contact%state == contact_solved) self%problem%guess_force = contact%force
    ! Forces in the friction cones carry the loads, so there may be an answer that was not found.
    self%failed = contact%state == contact_no_equilibrium .and. contact%sets > 0
  end subroutine find_contact

  !> Take one step of iterative refinement: add the deformation under the residual, solve the contact with it,
  !! and add the deformation under the change of contact forces.
  subroutine refine(self, scene, bodies, state, refined, watch)
    class(simplex_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    type(solved_state), intent(inout) :: state
    logical, intent(out) :: refined
    class(stopwatch), intent(inout) :: watch
    logical, allocatable :: guess(:)

    call deform(scene, bodies, scene%model%loads%load + pair_forces(scene%model, state%contact%row_forces()) &
                - bodies%operator%nodal_forces(scene%model, bodies%law%stress(state%strain)) &
                - spring_forces(scene%model, state%deformation), state)
    call watch%lap(stage_displacements)
    ! F gives the opening by a change of the forces.
    call move_alloc(state%contact%touching, guess)
    associate (problem => self%problem, &
               opening => gap_opening(scene%model, state%deformation) + self%travel_gap)
      problem%known_force = state%contact%row_forces()
      problem%known_gap = problem%initial_gap + opening
      problem%load_gap = opening - matmul(problem%flexibility, problem%known_force)
    end associate
    call self%find_contact(guess, state%contact)
    call watch%lap(stage_contact)
    refined = state%contact%state == contact_solved
    ! Only under the change: in a slender body, even the rounding of all forces opens gaps.
    if (refined) call deform(scene, bodies, pair_forces(scene%model, state%contact%change), state)
  end subroutine refine

  !> Search for other answers with friction, and mark the pairs at which they differ.
  subroutine find_others(self, contact)
    class(simplex_rule), intent(inout) :: self
    type(contact_solution), intent(inout) :: contact
    type(contact_solution) :: again

    if (.not. allocated(self%problem%friction)) return
    self%problem%guess_force = contact%row_forces()
    call solve_contact(self%problem, again)
    if (allocated(again%several)) contact%several = again%several
    contact%searched = again%searched
  end subroutine find_others

  !> Add the deformation under some forces.
  subroutine deform(scene, bodies, force, state)
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    real(wp), intent(in) :: force(:, :)         !! [directions, nodes]
    type(solved_state), intent(inout) :: state   !! deformation, strain
    real(wp), allocatable :: step(:, :)

    step = bodies%displacements(scene, force)
    state%deformation = state%deformation + step
    state%strain = state%strain + bodies%operator%strains(scene%model, step, .false.)
  end subroutine deform

  !> Find forces under unit loads, with the contact's own factor of the pairs with a force.
  subroutine respond(self, scene, bodies, state, loads, known)
    class(simplex_rule), intent(inout), target :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    class(solved_state), intent(in) :: state
    type(contact_loads), intent(inout) :: loads
    logical, intent(in) :: known
    type(scaled_problem) :: scaled

    if (known) return
    call self%scale_pressed(state%contact, scaled)
    call load_pairs(scaled, self%basis, loads)
  end subroutine respond

  !> Compute the sensitivity of the contact forces to errors of the stiffness and of the gaps.
  function sensitivity(self, state, condition) result(found)
    class(simplex_rule), intent(inout), target :: self
    class(solved_state), intent(in) :: state
    real(wp), intent(in) :: condition
    type(contact_sensitivity) :: found
    type(scaled_problem) :: scaled

    call self%scale_pressed(state%contact, scaled)
    found = find_sensitivity(scaled, self%basis, state%contact%row_forces(), &
                             abs(self%problem%initial_gap) + abs(self%problem%load_gap) + &
                             self%problem%motion%times(state%contact%approach, magnitudes=.true.), condition)
  end function sensitivity

  !> Scale the problem, with a basis of the pairs that have a force. Modes that these pairs do not
  !! restrain are kept as long as they are independent; the results do not depend on the others.
  subroutine scale_pressed(self, contact, scaled)
    class(simplex_rule), intent(inout), target :: self
    type(contact_solution), intent(in) :: contact
    type(scaled_problem), intent(out) :: scaled
    type(rigid_start) :: start
    integer, allocatable :: row(:)
    logical, allocatable :: pressed(:)
    integer :: k

    scaled = scale_problem(self%problem)
    pressed = self%problem%between(contact%row_forces())
    if (any(contact%motion_free)) then
      row = pack([(k, k=1, size(pressed))], pressed)
      call find_rigid_start(dense_motions(scaled%motion%rows(row)), 0*scaled%resultant, &
                            0*scaled%gap(row), start)
      call drop_motions(scaled, start%redundant)
    end if
    call renew_basis(self%basis, scaled, pressed)
  end subroutine scale_pressed

  !> Diagonal of F.
  pure function compliance(self)
    class(simplex_rule), intent(in) :: self
    real(wp), allocatable :: compliance(:)

    compliance = diagonal_of(self%problem%flexibility)
  end function compliance
end module epcont_linear_simplex_rule
