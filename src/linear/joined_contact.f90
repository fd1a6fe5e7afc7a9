!> Contact of bodies that are one system, without their flexibility: of many pairs that takes longest.
!>
!> With forces lambda that are known, gaps g(u) and a spring of stiffness gamma at each pair,
!>
!>     K u = f + N'R,   R = max(0, lambda - gamma g(u))
!>
!> has one solution, where a convex function of u is least; for lambda = R it is that of the contact. Newton
!> steps have the springs of the pairs that press alone, the set of contacts (Hintermueller, Ito and Kunisch
!> 2002). Where a step does not change the set, lambda follows R, and gaps that are left fall by gamma times
!> the flexibility, thousands, with each step: of gamma nothing is left in the answer. SUPORT freedoms have
!> springs, too, so weak that they matter where no pair holds a body yet; each step has them where it begins.
!>
!> Lambda waits until the set stays: each step is one of that function, cut where full ones run in circles.
module epcont_linear_joined_contact
  use epcont_assembly_bodies, only: factored_bodies, force_fields, half_solved_body, prescribe
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits, negligible
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_problem, only: contact_no_equilibrium, contact_solved, contact_stalled, new_solution
  use epcont_contact_uniqueness, only: find_undetermined_motions
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_flexibility, only: gap_opening, pair_forces, terms_of_openings
  use epcont_flexibility_motion_matrix, only: motion_matrix
  use epcont_linear_contact_ends, only: reach_ends
  use epcont_linear_joined_springs, only: find_springs, frozen_response, put_on_nodes, half_plane, of_pairs
  use epcont_linear_line_search, only: has_settled, least_at
  use epcont_linear_load_line, only: load_line
  use epcont_linear_solved_state, only: solved_state
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_stopwatch, only: stage_contact, stage_factor, stopwatch
  implicit none
  private
  public :: joined_contact, new_joined

  !> Full steps, then cut ones: scenes take 1 to 20.
  integer, parameter :: full_steps = 25, step_limit = 200
  !> Forces that change by no more are good enough for displacements to follow: two steps are to come.
  real(wp), parameter :: nearly = 1.0e-3_wp
  !> What a solve leaves of forces of size one, at most, where they open gaps.
  real(wp), parameter :: most_left = 0.1_wp

  type :: joined_contact
    integer :: threads = 1                         !! that share the fronts
    logical :: failed = .false.     !! to find a contact, or all that is to be told of it
    !> What a pair gives way by under a force of its own, about [length/force] [pairs]
    real(wp), allocatable :: compliance(:)
    real(wp) :: correction = huge(1.0_wp)          !! of forces by the last step, of the largest
    real(wp), allocatable, private :: gamma(:)     !! springs of the pairs [force/length] [pairs]
    real(wp), allocatable, private :: hold(:)      !! springs of SUPORT freedoms [force/length] [motions]
    logical, allocatable, private :: closed(:)     !! whose springs are to be in the factor [pairs]
    type(load_line), private :: line        !! from whose states the next contact is sought
    logical, private :: unique = .false.           !! forces are found to be, with the factor that there is
    type(motion_matrix), private :: motion         !! A, closing of the gaps by the motions [length]
    type(rigid_start), private :: rigid            !! whether rigid bodies can carry the loads
  contains
    procedure :: take_case
    procedure :: factor
    procedure :: solve
    procedure :: respond
    procedure :: are_unique
    procedure, private :: find_set
    procedure, private :: settle
  end type joined_contact

contains

  !> Springs for bodies with the first law that they have.
  subroutine new_joined(scene, motion, resultant, threads, bodies, joined)
    type(planned_model), intent(in) :: scene           !! numbered as one system
    type(motion_matrix), intent(in) :: motion          !! A, closing of the gaps by unit motions
    real(wp), intent(in) :: resultant(:)               !! P, loads along the motions [force] [motions]
    integer, intent(in) :: threads                     !! that share the fronts
    class(factored_bodies), intent(inout) :: bodies    !! with a law; their springs are made
    type(joined_contact), intent(out) :: joined

    joined%threads = threads
    joined%motion = motion
    call joined%take_case(scene, resultant, bodies)
  end subroutine new_joined

  !> A load case: whether rigid bodies can carry it, and the springs of motions that it does not need held.
  subroutine take_case(self, scene, resultant, bodies)
    class(joined_contact), intent(inout) :: self
    type(planned_model), intent(in) :: scene           !! numbered as one system
    real(wp), intent(in) :: resultant(:)               !! P, loads along the motions [force] [motions]
    class(factored_bodies), intent(inout) :: bodies    !! with a law; their springs are made
    logical, allocatable :: redundant(:)               ! of the case before

    self%failed = .false.
    call self%line%take_load(scene%model%load)
    if (allocated(self%gamma)) redundant = self%rigid%redundant
    associate (unit => self%motion%units())
      call find_rigid_start(self%motion%over(unit), resultant/unit, spread(0.0_wp, 1, self%motion%pairs), &
                            self%rigid)
    end associate
    if (.not. self%rigid%balanced) return
    if (allocated(redundant)) then
      if (all(redundant .eqv. self%rigid%redundant)) return
    end if
    if (allocated(self%line%last)) deallocate (self%line%last)
    call find_springs(scene, bodies, self%rigid%redundant, self%gamma, self%hold)
    self%compliance = half_plane*of_pairs/self%gamma
    self%closed = spread(.true., 1, scene%model%pairs)
  end subroutine take_case

  !> Factor the bodies with the springs of the set of contacts, as far as law or springs have changed.
  subroutine factor(self, scene, bodies, sound, watch)
    class(joined_contact), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    logical, intent(out) :: sound                !! the factor can be solved with
    class(stopwatch), intent(inout) :: watch     !! takes the time
    real(wp) :: wanted(scene%model%pairs)

    sound = .true.
    if (.not. self%rigid%balanced) return
    wanted = merge(self%gamma, 0.0_wp, self%closed)
    associate (stiffness => bodies%spring%stiffness(:size(wanted)), &
               changed => bodies%spring%changed(:size(wanted)))
      changed = changed .or. abs(stiffness - wanted) > 0.0_wp
      stiffness = wanted
    end associate
    if (any(bodies%spring%changed) .or. any(bodies%law%changed)) then
      call watch%lap(stage_contact)
      call bodies%factor_system(scene, self%threads)
      self%unique = .false.
      call watch%lap(stage_factor)
    end if
    sound = bodies%body(1)%is_sound()
  end subroutine factor

  !> Find deformation, approach and contact forces. `failed` where there are none, or motions are neutral.
  subroutine solve(self, scene, bodies, gap, load_factor, state, watch)
    class(joined_contact), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    real(wp), intent(in) :: gap(:)               !! initial, and what supports travel [length] [pairs]
    real(wp), intent(in) :: load_factor          !! of the loads
    type(solved_state), intent(inout) :: state    !! what is found
    class(stopwatch), intent(inout) :: watch     !! takes the time

    if (allocated(self%line%last)) then
      state = self%line%next()
      associate (opened => gap + gap_opening(scene%model, state%deformation) - &
                           self%motion%times(state%contact%approach))
        if (any(state%contact%force > self%gamma*opened .neqv. self%closed)) state = self%line%last
      end associate
    else
      allocate (state%deformation(directions, scene%model%nodes), source=0.0_wp)
      state%contact = new_solution(scene%model%pairs, scene%motions%count)
    end if
    if (.not. self%rigid%balanced) then
      state%contact%state = contact_no_equilibrium
      state%contact%escape = self%rigid%escape/self%motion%units()
      return
    end if
    call self%find_set(scene, bodies, gap, load_factor, state, watch)
    if (state%contact%state == contact_solved) call self%settle(scene, gap, state)
    if (state%contact%state == contact_solved) call self%line%keep(state)
    if (state%contact%state /= contact_solved) self%failed = .true.
    call watch%lap(stage_contact)
  end subroutine solve

  !> Newton steps to the set of contacts and its forces. While the set changes, only what pairs and SUPORT
  !> freedoms do is solved for; where it stays, all displacements, from those of `state`, whose rounding is
  !! all that the answer has.
  subroutine find_set(self, scene, bodies, fixed_gap, load_factor, state, watch)
    class(joined_contact), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    real(wp), intent(in) :: fixed_gap(:), load_factor
    type(solved_state), intent(inout) :: state
    class(stopwatch), intent(inout) :: watch
    !> What the deformation is in equilibrium with; lambda - gamma g; what a step adds to the gaps
    real(wp), dimension(scene%model%pairs) :: borne, gap, opening, pull
    !> What a step adds to the approach, and forces that springs of SUPORT freedoms bore
    real(wp), dimension(scene%motions%count) :: held, motion
    real(wp), allocatable :: unbalanced(:, :)   ! forces on the nodes, with the displacements of `state`
    real(wp), allocatable :: step(:, :)
    logical :: wanted(scene%model%pairs)
    real(wp) :: change(2), before(2)   ! of forces and strains, in this step and the one before
    real(wp) :: length
    integer :: taken
    logical :: stays          ! the set, and lambda follows
    logical :: whole          ! the step is one of all displacements
    logical :: sound

    state%contact%state = contact_stalled
    state%contact%pivots = 0
    state%contact%block_steps = 0
    call prescribe(scene, load_factor, state%deformation)
    state%strain = bodies%operator%strains(scene%model, state%deformation, load_factor)
    change = huge(1.0_wp)
    whole = .false.
    borne = 0.0_wp
    held = 0.0_wp
    call balance()
    call begin_at_state()
    wanted = pull > 0.0_wp
    if (allocated(self%line%last)) call choose_set()
    if (.not. allocated(self%line%last)) call begin_set()
    do taken = 1, step_limit
      call self%factor(scene, bodies, sound, watch)
      if (.not. sound) exit
      call find_step()
      before = change
      length = 1.0_wp
      if (taken > full_steps .and. .not. whole) length = length_of_step()
      call take_step()
      if (stays .and. whole) then
        call take_displacements()
        if (all(has_settled(change, before))) then
          state%contact%state = contact_solved
          self%correction = change(1)
          exit
        end if
        call balance()
      end if
      whole = stays .and. (whole .or. change(1) <= nearly .or. change(1) > 0.5_wp*before(1))
      if (whole) call begin_at_state()
      if (stays) cycle
      change = huge(1.0_wp)
      if (taken < full_steps) call reach_ends(self%closed, wanted)
      call choose_set()
    end do
    state%contact%gap = gap

  contains

    !> What is out of balance where `state` is.
    subroutine balance()
      unbalanced = load_factor*scene%model%load - &
                   bodies%operator%nodal_forces(scene%model, bodies%law%stress(state%strain))
    end subroutine balance

    !> The next step is one from there.
    subroutine begin_at_state()
      gap = fixed_gap + gap_opening(scene%model, state%deformation) - &
            self%motion%times(state%contact%approach)
      pull = state%contact%force - self%gamma*gap
    end subroutine begin_at_state

    !> The first set: pairs that are as near as contact may give way, and overlap, if they hold all motions;
    !! else all pairs. Those that are far apart would bend bodies into each other.
    subroutine begin_set()
      logical :: near(size(gap))

      near = gap <= maxval(self%compliance)*maxval(sum(abs(unbalanced), dim=2)) - min(0.0_wp, minval(gap))
      associate (free => find_undetermined_motions(self%motion%over(self%motion%units()), near, near))
        if (all(free .eqv. self%rigid%redundant)) self%closed = near
      end associate
    end subroutine begin_set

    !> The pairs that press; of those that do so by rounding alone, as they are.
    subroutine choose_set()
      where (abs(pull) <= negligible*maxval([abs(state%contact%force), tiny(1.0_wp)])) wanted = self%closed
      state%contact%pivots = state%contact%pivots + count(wanted .neqv. self%closed)
      self%closed = wanted
    end subroutine choose_set

    !> What is out of balance is solved for. All but the pairs is linear: after a step they, and springs of
    !! SUPORT freedoms that have moved, alone have forces that are not borne, but for rounding.
    subroutine find_step()
      type(half_solved_body), allocatable :: half(:)
      real(wp) :: force(directions, scene%model%nodes)
      integer :: k

      if (whole .or. taken == 1) then
        force = unbalanced + pair_forces(scene%model, merge(pull, 0.0_wp, self%closed))
      else
        force = pair_forces(scene%model, merge(pull, 0.0_wp, self%closed) - borne)
        associate (c => scene%motions%component, node => scene%motions%node)
          do k = 1, size(held)
            force(c(k), node(k)) = force(c(k), node(k)) + held(k)
          end do
        end associate
      end if
      call bodies%add_forces(scene, force, 0.0_wp, half)
      step = bodies%finish(scene, half, 0.0_wp, at_contact=.not. whole)
      opening = gap_opening(scene%model, step)
      motion = [(step(scene%motions%component(k), scene%motions%node(k)), k=1, scene%motions%count)]
    end subroutine find_step

    !> Go along it; lambda follows after a full one that does not change the set, but not the first of all
    !! displacements: these have the rounding of what they are in all.
    subroutine take_step()
      real(wp), allocatable :: next(:)

      state%contact%block_steps = state%contact%block_steps + 1
      associate (force => state%contact%force)
        borne = (1.0_wp - length)*borne + &
                length*merge(force - self%gamma*(gap + opening), 0.0_wp, self%closed)
        held = (1.0_wp - length)*held + length*self%hold*motion
        gap = gap + length*opening
        pull = force - self%gamma*gap
        wanted = pull > 0.0_wp
        stays = length >= 1.0_wp .and. all(wanted .eqv. self%closed)
        if (.not. stays .or. whole .and. change(2) > 1.0_wp) return
        next = merge(pull, 0.0_wp, self%closed)
        change(1) = maxval([abs(next - force), 0.0_wp])/maxval([next, tiny(1.0_wp)])
        force = next
        pull = force - self%gamma*gap
      end associate
    end subroutine take_step

    !> The displacements follow.
    subroutine take_displacements()
      real(wp), allocatable :: strain(:, :)

      call scene%motions%add(scene%model, -motion, step)
      strain = bodies%operator%strains(scene%model, step, 0.0_wp)
      state%deformation = state%deformation + step
      state%strain = state%strain + strain
      state%contact%approach = state%contact%approach + motion
      change(2) = maxval(abs(strain))/max(maxval(abs(state%strain)), tiny(1.0_wp))
    end subroutine take_displacements

    !> How much of it makes the function least.
    real(wp) function length_of_step() result(length)
      real(wp) :: curvature, descent

      descent = sum(held*motion) - sum(borne*opening)
      curvature = descent + sum((pull - self%gamma*opening)*opening, mask=self%closed) - &
                  sum(self%hold*motion**2)
      length = least_at(max(0.0_wp, curvature), descent, pull, self%gamma*opening, opening)
    end function length_of_step
  end subroutine find_set

  !> What follows from the forces and gaps that were found: which pairs touch, and which motions are free.
  subroutine settle(self, scene, fixed_gap, state)
    class(joined_contact), intent(in) :: self
    type(planned_model), intent(in) :: scene
    real(wp), intent(in) :: fixed_gap(:)
    type(solved_state), intent(inout) :: state
    real(wp) :: terms(size(fixed_gap))   ! what gaps are the sum of

    associate (contact => state%contact)
      where (contact%force <= negligible*maxval([contact%force, 0.0_wp])) contact%force = 0.0_wp
      where (self%rigid%redundant) contact%approach = 0.0_wp
      terms = abs(fixed_gap) + terms_of_openings(scene%model, state%deformation) + &
              self%motion%times(contact%approach, magnitudes=.true.)
      contact%touching = contact%force > 0.0_wp .or. contact%gap <= negligible*terms
      where (contact%touching) contact%gap = 0.0_wp
      contact%motion_free = find_undetermined_motions(self%motion%over(self%motion%units()), &
          contact%touching, contact%force > lost_digits*maxval([contact%force, 0.0_wp]))
      contact%joined = .true.
      if (any(contact%motion_free .neqv. self%rigid%redundant)) contact%state = contact_stalled
    end associate
  end subroutine settle

  !> Find forces and displacements under loads and openings in one solve; of what is wrong of forces as far as
  !> known it leaves a thousandth or less. Springs at SUPORT freedoms bear what known displacements say.
  subroutine respond(self, scene, bodies, found, at_contact)
    class(joined_contact), intent(in) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies !! factored with the set of contacts
    type(frozen_response), intent(inout) :: found
    logical, intent(in) :: at_contact               !! only displacements that gaps depend on are wanted
    type(force_fields) :: loads
    integer :: c, k

    associate (force => found%force, u => found%displacement)
      do k = 1, size(self%gamma)
        if (self%closed(k)) force(k, :) = force(k, :) - self%gamma(k)*found%opening(k, :)
      end do
      call put_on_nodes(scene, self%closed, force, loads)
      do k = 1, scene%motions%count
        c = scene%motions%component(k)
        loads%force(c, :, k) = found%load(k, :) + self%hold(k)*u(c, :, scene%motions%node(k))
      end do
      call bodies%body_displacements(scene, 1, loads, [(k, k=1, scene%model%nodes)], u, at_contact)
      do k = 1, size(force, 2)
        where (self%closed) force(:, k) = force(:, k) - self%gamma*gap_opening(scene%model, u(:, k, :))
      end do
    end associate
  end subroutine respond

  !> Are the contact forces the only ones? Forces that open no gaps are what a solve leaves of any; of two
  !! that are given no one is likely to have none of these.
  logical function are_unique(self, scene, bodies)
    class(joined_contact), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies    !! factored with the set of contacts
    type(half_solved_body), allocatable :: half(:)
    real(wp) :: force(scene%model%pairs)
    integer :: j, k

    are_unique = .true.
    if (self%unique) return   ! as in the load case before
    do j = 1, 2
      force = merge(cos([(k*sqrt(real(j, wp)), k=1, size(force))]), 0.0_wp, self%closed)
      if (j > 1) deallocate (half)
      call bodies%add_forces(scene, pair_forces(scene%model, force), 0.0_wp, half)
      force = force - self%gamma*gap_opening(scene%model, bodies%finish(scene, half, 0.0_wp, .true.))
      are_unique = are_unique .and. all(abs(force) <= most_left .or. .not. self%closed)
    end do
    self%unique = are_unique
  end function are_unique
end module epcont_linear_joined_contact
