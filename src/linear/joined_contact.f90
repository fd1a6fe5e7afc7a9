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
  use epcont_assembly_bodies, only: factored_bodies, half_solved_body, prescribe
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits, negligible, valid_to
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_problem, only: contact_no_equilibrium, contact_solved, contact_stalled, new_solution
  use epcont_contact_uniqueness, only: find_undetermined_motions
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_flexibility, only: gap_opening, pair_forces, terms_of_openings
  use epcont_flexibility_motion_matrix, only: motion_matrix
  use epcont_linear_contact_ends, only: reach_ends
  use epcont_linear_joined_path, only: joined_path
  use epcont_linear_joined_springs, only: add_suport_forces, find_springs, half_plane, hold_suports, &
    of_pairs, suport_values
  use epcont_linear_line_search, only: has_settled, least_at, part_of_largest
  use epcont_linear_load_line, only: load_line
  use epcont_linear_solved_state, only: solved_state
  use epcont_model_springs, only: spring_forces
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_stopwatch, only: stage_contact, stage_factor, stopwatch
  implicit none
  private
  public :: joined_contact, new_joined

  !> Full steps; then an interior path leads to a set, which is held for some steps, and cut steps follow.
  !! Most models take 1 to 10 steps.
  integer, parameter :: full_steps = 12, held_steps = 4, step_limit = 200
  !> So much stiffer are springs of SUPORT freedoms where rounding has left no pivot of a body that no pair
  !! holds, as often as that may help: they change no answer.
  real(wp), parameter :: stiffer = 1.0e3_wp
  integer, parameter :: most_stiffened = 2
  !> And so much stiffer are those of pairs if a step leaves more than this part of what is wrong of forces:
  !! where stiff bodies bear each other by soft ones some pairs give way by far less than their softer side.
  real(wp), parameter :: firmer = 100.0_wp, slow = 0.1_wp
  !> Forces that change by no more are good enough for displacements to follow: two steps are to come.
  real(wp), parameter :: nearly = 1.0e-3_wp

  type :: joined_contact
    integer :: threads = 1                         !! that share the fronts
    logical :: failed = .false.     !! to find a contact, or all that is to be told of it
    !> What a pair gives way by under a force of its own, about [length/force] [pairs]
    real(wp), allocatable :: compliance(:)
    real(wp) :: correction = huge(1.0_wp)          !! of forces by the last step, of the largest
    real(wp), allocatable :: gamma(:)              !! springs of the pairs [force/length] [pairs]
    real(wp), allocatable :: hold(:)               !! springs of SUPORT freedoms [force/length] [motions]
    logical, allocatable :: closed(:)              !! whose springs are to be in the factor [pairs]
    type(load_line), private :: line        !! from whose states the next contact is sought
    integer :: stiffened = 0                       !! how often gamma has grown
    logical :: unique = .false.                    !! forces are found to be, with the factor that there is
    type(motion_matrix), private :: motion         !! A, closing of the gaps by the motions [length]
    type(rigid_start), private :: rigid            !! whether rigid bodies can carry the loads
  contains
    procedure :: take_case
    procedure :: factor
    procedure :: solve
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
    self%stiffened = 0
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
    integer :: k

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
      do k = 1, most_stiffened
        if (bodies%body(1)%is_sound() .or. bodies%body(1)%lacks_memory .or. size(self%hold) == 0) exit
        self%hold = stiffer*self%hold
        call hold_suports(scene, self%hold, bodies)
        call bodies%factor_system(scene, self%threads)
      end do
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
    real(wp), dimension(scene%model%pairs) :: borne, gap, opening   ! forces in balance; a step adds to gaps
    real(wp), dimension(scene%model%pairs) :: pull                  ! lambda - gamma g
    real(wp), dimension(scene%motions%count) :: held, motion   ! springs of SUPORT freedoms bore, a step adds
    real(wp), allocatable :: unbalanced(:, :)   ! forces on the nodes, with the displacements of `state`
    real(wp), allocatable :: step(:, :)
    logical :: wanted(scene%model%pairs)
    real(wp) :: change(2), before(2)   ! of forces and strains, in this step and the one before
    real(wp) :: length
    integer :: last_held, taken   ! steps until signs are judged again, and in all
    logical :: stays          ! the set, and lambda follows
    logical :: whole          ! the step is one of all displacements
    logical :: afresh         ! it is from `state`, all forces that are not in balance there being new
    logical :: sound

    state%contact%state = contact_stalled
    state%contact%pivots = 0
    state%contact%joined_steps = 0
    call prescribe(scene, load_factor, state%deformation)
    state%strain = bodies%operator%strains(scene%model, state%deformation, load_factor)
    call balance()
    call begin_at_state()
    call begin_afresh()
    call find_wanted()
    if (allocated(self%line%last)) call choose_set()
    if (.not. allocated(self%line%last)) call begin_set()
    last_held = 0
    do taken = 1, step_limit
      if (taken == full_steps) call lead_to_set()
      call self%factor(scene, bodies, sound, watch)
      if (.not. sound) exit
      call find_step()
      before = change
      length = 1.0_wp
      if (taken >= full_steps + held_steps .and. .not. whole) length = length_of_step()
      call take_step()
      if (stays .and. whole) then
        call take_displacements()
        if (all(has_settled(change, before))) then
          self%correction = change(1)
          sound = minval(state%contact%force) >= -valid_to*maxval(state%contact%force)   ! no pair pulls
          if (taken > last_held .or. sound) state%contact%state = contact_solved
          if (taken > last_held .or. sound) exit
          last_held = 0
        end if
        if (change(1) > max(slow*before(1), lost_digits) .and. before(1) < nearly .and. &
            self%stiffened < most_stiffened) then
          self%stiffened = self%stiffened + 1
          self%gamma = firmer*self%gamma
          change(1) = huge(1.0_wp)
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
                   bodies%operator%nodal_forces(scene%model, bodies%law%stress(state%strain)) - &
                   spring_forces(scene%model, state%deformation)
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

    !> Nothing is known of the steps to come.
    subroutine begin_afresh()
      afresh = .true.
      whole = .false.
      change = huge(1.0_wp)
      borne = 0.0_wp
      held = 0.0_wp
    end subroutine begin_afresh

    !> Full steps run in circles, as where contacts open or bodies rock: an interior path leads near the set.
    subroutine lead_to_set()
      type(joined_path) :: path

      call begin_at_state()
      call begin_afresh()
      path = joined_path(gap, unbalanced, self%gamma, self%compliance)
      call path%follow(scene, self%threads, bodies)
      state%contact%force = path%force
      state%contact%joined_steps = state%contact%joined_steps + path%steps
      self%closed = path%closed
      self%unique = .false.
      last_held = taken + held_steps - 1
      pull = state%contact%force - self%gamma*gap
    end subroutine lead_to_set

    !> The pairs that press; those that do so by rounding alone keep their state.
    subroutine find_wanted()
      wanted = pull > 0.0_wp
      where (abs(pull) <= negligible*maxval([abs(state%contact%force), tiny(1.0_wp)])) wanted = self%closed
    end subroutine find_wanted

    !> The next set has the pairs that press.
    subroutine choose_set()
      state%contact%pivots = state%contact%pivots + count(wanted .neqv. self%closed)
      self%closed = wanted
    end subroutine choose_set

    !> What is out of balance is solved for: after a step that of pairs and moved SUPORT freedoms alone.
    subroutine find_step()
      type(half_solved_body), allocatable :: half(:)
      real(wp) :: force(directions, scene%model%nodes)

      if (whole .or. afresh) then
        force = unbalanced + pair_forces(scene%model, merge(pull, 0.0_wp, self%closed))
      else
        force = pair_forces(scene%model, merge(pull, 0.0_wp, self%closed) - borne)
      end if
      call add_suport_forces(scene, held, force)
      afresh = .false.
      call bodies%add_forces(scene, force, 0.0_wp, half)
      step = bodies%finish(scene, half, 0.0_wp, at_contact=.not. whole)
      opening = gap_opening(scene%model, step)
      motion = suport_values(scene, step)
    end subroutine find_step

    !> Go along it; lambda follows a full one with the same set, but the first of all displacements.
    subroutine take_step()
      real(wp), allocatable :: next(:)

      state%contact%joined_steps = state%contact%joined_steps + 1
      associate (force => state%contact%force)
        borne = (1.0_wp - length)*borne + &
                length*merge(force - self%gamma*(gap + opening), 0.0_wp, self%closed)
        held = (1.0_wp - length)*held + length*self%hold*motion
        gap = gap + length*opening
        pull = force - self%gamma*gap
        call find_wanted()
        if (taken <= last_held) wanted = self%closed
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
      held = 0.0_wp
      ! Of stiff bodies among soft ones stresses tell what strains do not.
      change(2) = max(part_of_largest(strain, state%strain), &
                      part_of_largest(bodies%law%increment(strain), bodies%law%stress(state%strain)))
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
      where (self%motion%sizes() <= 0.0_wp) contact%approach = 0.0_wp
      terms = abs(fixed_gap) + terms_of_openings(scene%model, state%deformation) + &
              self%motion%times(contact%approach, magnitudes=.true.)
      contact%touching = contact%force > 0.0_wp .or. contact%gap <= negligible*terms
      where (contact%touching) contact%gap = 0.0_wp
      contact%motion_free = find_undetermined_motions(self%motion%over(self%motion%units()), &
          contact%touching, contact%force > lost_digits*maxval([contact%force, 0.0_wp]))
      contact%joined = .true.
    end associate
  end subroutine settle

end module epcont_linear_joined_contact
