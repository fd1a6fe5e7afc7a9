!> The bodies of a scene with a linear law, their contact solved exactly: one step of every iteration.
module epcont_linear_linear_problem
  use epcont_assembly_bodies, only: factored_bodies, half_solved_body, new_bodies
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, negligible
  use epcont_contact_basis, only: contact_basis
  use epcont_contact_neutral_motions, only: choose_neutral
  use epcont_contact_problem, only: contact_problem, contact_solved
  use epcont_contact_solver, only: solve_contact
  use epcont_flexibility_flexibility, only: gap_opening, pair_forces, see_motions, terms_of_openings
  use epcont_linear_borne_loads, only: borne_loads
  use epcont_linear_joined_contact, only: joined_contact, new_joined
  use epcont_linear_solved_state, only: force_change, relative_change, solved_state
  use epcont_linear_whole_flexibility, only: add_flexibilities, complete_flexibility
  use epcont_material_model_materials, only: find_materials, model_materials
  use epcont_model_controls, only: solver_frontal
  use epcont_model_springs, only: spring_forces
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_planned_model, only: planned_model
  use epcont_plan_side_by_side, only: heaviest_first, threads_for
  use epcont_system_stopwatch, only: stage_contact, stage_displacements, stage_factor, stage_flexibility, &
    stopwatch
  use epcont_system_threads, only: use_one_thread_each
  implicit none
  private
  public :: linear_problem, new_linear_problem

  type, extends(factored_bodies) :: linear_problem
    type(iteration_plan), private :: plan
    type(model_materials) :: materials
    type(contact_problem) :: problem
    !> Of bodies that cannot yield, if others can [length/force] [pairs, pairs]
    real(wp), allocatable, private :: lasting_flexibility(:, :)
    type(contact_basis) :: basis   !! of the last contact with this flexibility
    logical, allocatable :: touching(:)      !! pairs in contact then: the next begins with them [pairs]
    type(borne_loads) :: borne               !! in a load case before
    type(joined_contact) :: joined   !! instead, where bodies are one system
    real(wp), allocatable, private :: travel_gap(:)  !! opened by what supports travel [length] [pairs]
    real(wp), allocatable, private :: resultant(:)   !! of all loads along the free motions [motions]
  contains
    procedure :: take_case
    procedure :: set_stiffness
    procedure :: solve
    procedure :: sharpen
  end type linear_problem

contains

  !> What does not change with the law.
  subroutine new_linear_problem(scene, plan, linear)
    type(planned_model), intent(in) :: scene       !! what is to be solved
    type(iteration_plan), intent(in) :: plan       !! how; it may differ from the scene's
    type(linear_problem), intent(out) :: linear    !! all but its law

    linear%plan = plan
    call find_materials(scene%model, linear%materials)
    linear%factored_bodies = new_bodies(scene)
    linear%problem%initial_gap = scene%model%initial_gap
    linear%problem%travel = scene%motions%travels(scene%model)
    linear%problem%body = scene%motions%body
    call see_case(linear, scene)
  end subroutine new_linear_problem

  !> What loads and supports of the scene's load case do to gaps and motions.
  subroutine see_case(self, scene)
    class(linear_problem), intent(inout) :: self
    type(planned_model), intent(in) :: scene

    self%travel_gap = gap_opening(scene%model, scene%model%travel)
    call see_motions(scene%model, scene%motions, self%problem%motion, self%resultant)
  end subroutine see_case

  !> Another load case of the scene, with the factors that there are: those of the elastic bodies.
  subroutine take_case(self, scene)
    class(linear_problem), intent(inout) :: self
    type(planned_model), intent(in) :: scene    !! that it was made for, with that case

    call see_case(self, scene)
    if (scene%numbering%joined) then
      call self%joined%take_case(scene, self%resultant, self%factored_bodies)
    else
      call self%settle(scene)
    end if
  end subroutine take_case

  !> Factor the bodies and invert for the flexibility; after the first time only bodies that can yield, as far
  !! as the law of their elements has changed.
  subroutine set_stiffness(self, scene, failed_body, watch)
    class(linear_problem), intent(inout) :: self
    type(planned_model), intent(in) :: scene    !! that it was made for
    integer, intent(out) :: failed_body            !! first body that could not be factored; 0: all could
    class(stopwatch), intent(inout) :: watch    !! takes the time

    if (scene%numbering%joined) then
      call factor_joined()
      return
    end if
    associate (yields => scene%numbering%body%can_yield, &
               first => .not. allocated(self%problem%flexibility), n => scene%model%pairs)
      call factor_bodies(yields .or. first)
      self%law%changed = .false.
      call watch%lap(stage_factor)
      if (failed_body > 0) return
      call self%settle(scene)
      call watch%lap(stage_displacements)
      if (first) then
        allocate (self%problem%flexibility(n, n), source=0.0_wp)
        call add_flexibilities(scene, self%body, .not. yields, self%plan%threads, self%problem%flexibility)
        if (any(yields) .and. .not. all(yields)) self%lasting_flexibility = self%problem%flexibility
      else if (all(yields)) then
        self%problem%flexibility = 0.0_wp
      else if (any(yields)) then
        self%problem%flexibility = self%lasting_flexibility
      end if
      call add_flexibilities(scene, self%body, yields, self%plan%threads, self%problem%flexibility)
      call complete_flexibility(self%problem%flexibility)
    end associate
    call watch%lap(stage_flexibility)

  contains

    !> Factor bodies that are one system. The contact may have another set factored.
    subroutine factor_joined()
      logical :: sound

      if (self%factorizations == 0) call new_joined( &
        scene, self%problem%motion, self%resultant, self%plan%threads, self%factored_bodies, self%joined)
      call self%joined%factor(scene, self%factored_bodies, sound, watch)
      failed_body = merge(0, 1, sound)
    end subroutine factor_joined

    !> Assemble and factor some bodies, side by side where that pays.
    subroutine factor_bodies(chosen)
      logical, intent(in) :: chosen(:)     !! [bodies]
      real(wp), allocatable :: operations(:)
      integer, allocatable :: body(:)
      integer :: i, threads

      if (allocated(self%basis%factor)) deallocate (self%basis%factor)   ! of the flexibility before
      body = pack([(i, i=1, size(chosen))], chosen)
      body = body(heaviest_first(scene%numbering%body(body)%operations))
      operations = scene%numbering%body(body)%operations
      threads = threads_for(operations, scene%numbering%body(body)%solver == solver_frontal, &
                            self%plan%threads)
      !$omp parallel do num_threads(threads) if (threads > 1) schedule(dynamic)
      do i = 1, size(body)
        call use_one_thread_each()
        call self%body(body(i))%assemble(scene, self%operator, self%law, self%spring, body(i))
        call self%body(body(i))%factor()
      end do
      !$omp end parallel do
      self%factorizations = self%factorizations + count(chosen .and. scene%numbering%body%equations > 0)
      failed_body = findloc([(chosen(i) .and. .not. self%body(i)%is_sound(), i=1, size(chosen))], &
                            .true., dim=1)
    end subroutine factor_bodies
  end subroutine set_stiffness

  !> Find displacements, stresses and contact under a part of the loads and prescribed displacements. Without
  !! contact equilibrium (`state%contact%state`) there are no displacements.
  subroutine solve(self, scene, load_factor, start, state, watch)
    class(linear_problem), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! that it was made for
    real(wp), intent(in) :: load_factor            !! of the loads
    logical, allocatable, intent(in) :: start(:)   !! guess of the pairs in contact, if allocated [pairs]
    type(solved_state), intent(inout) :: state      !! what is found
    class(stopwatch), intent(inout) :: watch       !! takes the time

    if (scene%numbering%joined) then
      call self%joined%solve(scene, self%factored_bodies, self%problem%initial_gap + &
                             load_factor*self%travel_gap, load_factor, state, watch)
    else
      call solve_once()
    end if
    if (state%contact%state /= contact_solved) return
    call complete(self, scene, load_factor, state)
    call watch%lap(stage_displacements)

  contains

    !> Contact with the gaps that the loads open alone, then the deformation under loads and contact forces.
    subroutine solve_once()
      real(wp), allocatable :: force(:, :), opening(:)
      type(half_solved_body), allocatable :: half(:)

      force = load_factor*scene%model%load
      if (allocated(scene%model%free_strain)) then   ! stresses where nothing gives way
        force = force - self%operator%nodal_forces(scene%model, self%law%stress( &
                self%operator%strains(scene%model, 0.0_wp*force, load_factor)))
      else if (any(self%law%initial_stress /= 0.0_wp)) then
        force = force - self%operator%nodal_forces(scene%model, self%law%initial_stress)
      end if
      call self%borne%bear(scene, self%factored_bodies, force, load_factor, half, opening)
      if (allocated(self%problem%known_gap)) deallocate (self%problem%known_force, self%problem%known_gap)
      self%problem%load_gap = opening + load_factor*self%travel_gap
      self%problem%resultant = load_factor*self%resultant
      call watch%lap(stage_displacements)
      call solve_contact(self%problem, state%contact, start, self%basis)
      call watch%lap(stage_contact)
      if (state%contact%state /= contact_solved) return
      call self%add_forces(scene, pair_forces(scene%model, state%contact%force), 0.0_wp, half)
      ! Strains are of the deformation: added to a long travel it would lose their digits.
      state%deformation = self%finish(scene, half, load_factor, .false.)
      state%strain = self%operator%strains(scene%model, state%deformation, load_factor)
    end subroutine solve_once
  end subroutine solve

  !> One step of refinement of what `solve` has found: where a body is long and its elements fine, rounding
  !! leaves forces out of balance, and gaps, though the factors are in double. The contact follows the
  !! deformation, and that the contact.
  subroutine sharpen(self, scene, load_factor, state, change, watch)
    class(linear_problem), intent(inout) :: self
    type(planned_model), intent(in) :: scene    !! that it was made for
    real(wp), intent(in) :: load_factor         !! of the loads
    type(solved_state), intent(inout) :: state   !! as it was where the contact is not found again
    real(wp), intent(out) :: change             !! of displacements and contact forces, of the largest of each
    class(stopwatch), intent(inout) :: watch    !! takes the time
    type(solved_state) :: balanced, refined
    real(wp) :: strained   ! by a correction: the displacements tell what the step has done

    change = huge(1.0_wp)
    if (scene%numbering%joined) return   ! its steps end where nothing changes
    balanced = state
    call correct(self, scene, load_factor, balanced, strained)
    call watch%lap(stage_displacements)
    refined = balanced
    call correct_contact(self, scene, load_factor, refined)
    call watch%lap(stage_contact)
    if (refined%contact%state /= contact_solved) return
    ! Not under all forces again: in a slender body even the rounding of these opens gaps.
    call deform(self, scene, pair_forces(scene%model, refined%contact%change), refined, strained)
    call complete(self, scene, load_factor, refined)
    change = max(relative_change(state%displacement, refined%displacement, of=refined%displacement), &
                 force_change(state%contact, refined%contact, of=refined%contact))
    if (allocated(refined%point)) deallocate (refined%point)   ! those of the strain before
    state = refined
    call watch%lap(stage_displacements)
  end subroutine sharpen

  !> One step of refinement: the deformation under the forces that are out of balance is added.
  subroutine correct(self, scene, load_factor, state, change)
    type(linear_problem), intent(in) :: self
    type(planned_model), intent(in) :: scene
    real(wp), intent(in) :: load_factor
    type(solved_state), intent(inout) :: state   !! deformation, strain, contact forces
    real(wp), intent(out) :: change             !! largest of a strain / largest strain

    call deform(self, scene, load_factor*scene%model%load + pair_forces(scene%model, state%contact%force) &
                - self%operator%nodal_forces(scene%model, self%law%stress(state%strain)) &
                - spring_forces(scene%model, state%deformation), state, change)
  end subroutine correct

  !> Add the deformation under some forces.
  subroutine deform(self, scene, force, state, change)
    type(linear_problem), intent(in) :: self
    type(planned_model), intent(in) :: scene
    real(wp), intent(in) :: force(:, :)         !! [directions, nodes]
    type(solved_state), intent(inout) :: state   !! deformation, strain
    real(wp), intent(out) :: change             !! largest of a strain / largest strain
    real(wp), allocatable :: step(:, :), strain(:, :)

    step = self%displacements(scene, force, 0.0_wp)
    strain = self%operator%strains(scene%model, step, 0.0_wp)
    state%deformation = state%deformation + step
    state%strain = state%strain + strain
    change = maxval(abs(strain))/max(maxval(abs(state%strain)), tiny(1.0_wp))
  end subroutine deform

  !> The contact with the gaps of a deformation, about the contact forces that made it: what F says is what a
  !! change of these opens.
  subroutine correct_contact(self, scene, load_factor, state)
    type(linear_problem), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    real(wp), intent(in) :: load_factor
    type(solved_state), intent(inout) :: state   !! its touching pairs, if allocated, are a guess
    logical, allocatable :: guess(:)

    call move_alloc(state%contact%touching, guess)
    associate (problem => self%problem, force => state%contact%force, &
               opening => gap_opening(scene%model, state%deformation) + load_factor*self%travel_gap)
      problem%known_force = force
      problem%known_gap = problem%initial_gap + opening
      problem%load_gap = opening - matmul(problem%flexibility, force)
      problem%resultant = load_factor*self%resultant
    end associate
    call solve_contact(self%problem, state%contact, guess, self%basis)
  end subroutine correct_contact

  !> What follows from deformation, strains and contact: stresses, displacements and gaps.
  subroutine complete(self, scene, load_factor, state)
    type(linear_problem), intent(in) :: self
    type(planned_model), intent(in) :: scene
    real(wp), intent(in) :: load_factor
    type(solved_state), intent(inout) :: state
    real(wp), dimension(scene%model%pairs) :: gap, rounding
    real(wp) :: off(0:scene%model%bodies)   ! rounding of displacements of each body, at most [length]
    integer :: i

    state%point_stress = self%law%stress(state%strain)
    associate (contact => state%contact, travel => load_factor*self%travel_gap, motion => self%problem%motion)
      gap = self%problem%initial_gap + (gap_opening(scene%model, state%deformation) + travel) - &
            motion%times(contact%approach)
      if (any(contact%motion_free)) then
        contact%gap = merge(0.0_wp, gap, contact%force > 0.0_wp)
        call choose_neutral(self%problem, contact)
        gap = contact%gap
      end if
      state%displacement = state%deformation + load_factor*scene%model%travel
      call scene%motions%add(scene%model, contact%approach, state%displacement)
      ! A pair without force touches where its gap is none but for rounding, as the displacements have it,
      ! whatever a rule makes of it by the flexibility.
      off = 0.0_wp
      do i = 1, scene%model%nodes
        associate (b => scene%model%body(i))
          off(b) = max(off(b), negligible*maxval(abs(state%deformation(:, i))), &
                       cancelled*maxval(abs(state%displacement(:, i))))
        end associate
      end do
      rounding = negligible*(abs(self%problem%initial_gap) + abs(travel) + &
                             motion%times(contact%approach, magnitudes=.true.) + &
                             terms_of_openings(scene%model, state%deformation)) + largest_of_bodies(off)
      contact%touching = contact%force > 0.0_wp .or. gap <= rounding
      contact%gap = merge(0.0_wp, max(gap, 0.0_wp), contact%touching)
    end associate

  contains

    !> The largest value of the bodies that each pair has nodes of [pairs].
    pure function largest_of_bodies(value) result(largest)
      real(wp), intent(in) :: value(0:)   !! [bodies]
      real(wp) :: largest(scene%model%pairs)
      integer, allocatable :: body(:, :)
      integer :: k

      body = scene%model%bodies_of_pairs()
      largest = [(maxval(value(body(:, k))), k=1, size(largest))]
    end function largest_of_bodies
  end subroutine complete
end module epcont_linear_linear_problem
