!> Contact of bodies that are one system, without their flexibility: of many pairs that takes longer than all
!> factors.
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
!> Lambda waits until the set stays, so that each step is one of that function. Where full ones run in circles
!> they are cut where it is least along them: then each makes it less.
module epcont_linear_joined_contact
  use epcont_assembly_bodies, only: factored_bodies, force_fields, prescribe
  use epcont_base_bracket, only: bracket
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits, negligible, no_effect
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_problem, only: contact_no_equilibrium, contact_solved, contact_stalled, new_solution
  use epcont_contact_uniqueness, only: find_free_motions
  use epcont_element_kinematics, only: components, directions
  use epcont_flexibility_flexibility, only: gap_opening, pair_forces, terms_of_openings
  use epcont_flexibility_motion_matrix, only: motion_matrix
  use epcont_linear_joined_springs, only: find_springs, of_pairs, spring_of_motion
  use epcont_linear_scene_state, only: scene_state
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_system_stopwatch, only: stage_contact, stage_factor, stopwatch
  implicit none
  private
  public :: joined_contact, new_joined

  !> Full steps, then cut ones: scenes take 1 to 20.
  integer, parameter :: full_steps = 25, step_limit = 200
  !> A step is cut where the slope at its end is more than this part of that where it begins.
  real(wp), parameter :: flat_enough = 0.1_wp
  !> Strains so many times as large leave rounding that counts.
  real(wp), parameter :: far_larger = 10.0_wp
  !> What a solve leaves of forces of size one, at most, where they open gaps.
  real(wp), parameter :: most_left = 0.1_wp
  !> What a half-plane gives way by at a force on a node of its boundary, against what is a hundred sides
  !! below it (2 ln(200)/pi), over what the node's own stiffness would let it.
  real(wp), parameter :: half_plane = 3.4_wp

  type :: joined_contact
    integer :: threads = 1                         !! that share the fronts
    logical :: failed = .false.     !! to find a contact, or all that is to be told of it
    real(wp), allocatable, private :: gamma(:)     !! springs of the pairs [force/length] [pairs]
    logical, allocatable, private :: closed(:)     !! whose springs are to be in the factor [pairs]
    type(scene_state), allocatable, private :: last   !! from which the next contact is sought
    type(motion_matrix), private :: motion         !! A, closing of the gaps by the motions [length]
    type(rigid_start), private :: rigid            !! whether rigid bodies can carry the loads
  contains
    procedure :: factor
    procedure :: solve
    procedure :: respond
    procedure :: are_unique
    procedure :: compliance
    procedure, private :: find_set
    procedure, private :: settle
  end type joined_contact

contains

  !> Springs for bodies with the first law that they have.
  subroutine new_joined(scene, motion, resultant, threads, bodies, joined)
    type(planned_scene), intent(in) :: scene           !! numbered as one system
    type(motion_matrix), intent(in) :: motion          !! A, closing of the gaps by unit motions
    real(wp), intent(in) :: resultant(:)               !! P, loads along the motions [force] [motions]
    integer, intent(in) :: threads                     !! that share the fronts
    class(factored_bodies), intent(inout) :: bodies    !! with a law; their springs are made
    type(joined_contact), intent(out) :: joined
    type(motion_matrix) :: scaled

    joined%threads = threads
    joined%motion = motion
    scaled = motion%over(motion%units())
    call find_rigid_start(scaled, resultant/motion%units(), spread(0.0_wp, 1, motion%pairs), &
                          joined%rigid)
    if (.not. joined%rigid%balanced) return
    call find_springs(scene, bodies, joined%rigid%redundant, joined%gamma)
    allocate (joined%closed(scene%model%pairs), source=.true.)
  end subroutine new_joined

  !> Factor the bodies with the springs of the set of contacts, as far as law or springs have changed.
  subroutine factor(self, scene, bodies, sound, watch)
    class(joined_contact), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
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
      call watch%lap(stage_factor)
    end if
    sound = bodies%body(1)%is_sound()
  end subroutine factor

  !> Find deformation, approach and contact forces. `failed` where there are none, or motions are neutral.
  subroutine solve(self, scene, bodies, gap, load_factor, state, watch)
    class(joined_contact), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    real(wp), intent(in) :: gap(:)               !! initial, and what supports travel [length] [pairs]
    real(wp), intent(in) :: load_factor          !! of the loads
    type(scene_state), intent(inout) :: state    !! what is found
    class(stopwatch), intent(inout) :: watch     !! takes the time

    if (allocated(self%last)) then
      state = self%last
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
    if (state%contact%state == contact_solved) then
      self%last = state
    else
      self%failed = .true.
    end if
    call watch%lap(stage_contact)
  end subroutine solve

  !> Newton steps to the set of contacts and its forces.
  subroutine find_set(self, scene, bodies, fixed_gap, load_factor, state, watch)
    class(joined_contact), intent(inout) :: self
    type(planned_scene), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    real(wp), intent(in) :: fixed_gap(:), load_factor
    type(scene_state), intent(inout) :: state
    class(stopwatch), intent(inout) :: watch
    !> What the deformation is in equilibrium with; lambda - gamma g
    real(wp), dimension(scene%model%pairs) :: borne, gap, opening, pull
    real(wp), allocatable :: step(:, :), strain(:, :), motion(:)
    logical :: wanted(scene%model%pairs)
    real(wp) :: before, change, descent, length
    real(wp) :: largest       ! deformation that a step has added
    integer :: taken
    logical :: afresh         ! what is out of balance is found from stresses, else from `borne`
    logical :: set_is_given, sound

    state%contact%state = contact_stalled
    state%contact%pivots = 0
    state%contact%block_steps = 0
    call prescribe(scene, load_factor, state%deformation)
    before = huge(1.0_wp)
    largest = 0.0_wp
    afresh = .true.
    set_is_given = .not. allocated(self%last)
    do taken = 1, step_limit
      gap = fixed_gap + gap_opening(scene%model, state%deformation) - &
            self%motion%times(state%contact%approach)
      pull = state%contact%force - self%gamma*gap
      if (.not. set_is_given) call choose_set()
      set_is_given = .false.
      call self%factor(scene, bodies, sound, watch)
      if (.not. sound) exit
      call find_step()
      length = 1.0_wp
      if (taken > full_steps) length = length_of_step()
      call take_step()
      if (afresh .and. length >= 1.0_wp .and. all(wanted .eqv. self%closed)) then
        ! The next step would change as much less.
        if (change*merge(min(1.0_wp, change/before), 1.0_wp, before <= 1.0_wp) <= negligible .or. &
            change <= no_effect .and. change > 0.5_wp*before) then
          state%contact%state = contact_solved
          exit
        end if
        before = change
        call begin_anew()
      end if
      afresh = taken >= full_steps .or. all(wanted .eqv. self%closed)
    end do
    state%contact%gap = gap

  contains

    !> The pairs that press; of those that do so by rounding alone, as they are.
    subroutine choose_set()
      wanted = pull > 0.0_wp
      where (abs(pull) <= negligible*maxval([abs(state%contact%force), tiny(1.0_wp)])) wanted = self%closed
      state%contact%pivots = state%contact%pivots + count(wanted .neqv. self%closed)
      self%closed = wanted
    end subroutine choose_set

    !> Where the deformation has been far larger than it is, it has the rounding of that: with the forces that
    !! are known by now, it is solved for from none.
    subroutine begin_anew()
      if (largest <= far_larger*maxval(abs(state%deformation))) return
      largest = 0.0_wp
      set_is_given = .true.
      state%deformation = 0.0_wp
      state%contact%approach = 0.0_wp
      call prescribe(scene, load_factor, state%deformation)
    end subroutine begin_anew

    !> What is out of balance is solved for. All but the pairs is linear: after a full step they, and springs
    !! of SUPORT freedoms that have moved, alone have forces that are not borne, but for rounding.
    subroutine find_step()
      real(wp), allocatable :: unbalanced(:, :)
      integer :: k

      if (afresh) then
        state%strain = bodies%operator%strains(scene%model, state%deformation)
        unbalanced = load_factor*scene%model%load - &
                     bodies%operator%nodal_forces(scene%model, bodies%law%stress(state%strain))
      else
        unbalanced = pair_forces(scene%model, -borne)
        do k = 1, scene%motions%count
          associate (load => unbalanced(scene%motions%component(k), scene%motions%node(k)))
            load = load + bodies%spring%stiffness(spring_of_motion(scene, k))*motion(k)
          end associate
        end do
      end if
      step = bodies%displacements(scene, unbalanced + &
                                  pair_forces(scene%model, merge(pull, 0.0_wp, self%closed)), 0.0_wp)
      descent = sum(unbalanced*step)
      motion = [(step(scene%motions%component(k), scene%motions%node(k)), k=1, scene%motions%count)]
      call scene%motions%add(scene%model, -motion, step)
      if (afresh) strain = bodies%operator%strains(scene%model, step)
      largest = max(largest, maxval(abs(step)))
      opening = gap_opening(scene%model, step) - self%motion%times(motion)
    end subroutine find_step

    !> Go along it; lambda follows after a full one.
    subroutine take_step()
      real(wp), allocatable :: next(:)

      state%deformation = state%deformation + length*step
      if (afresh) state%strain = state%strain + length*strain
      state%contact%approach = state%contact%approach + length*motion
      state%contact%block_steps = state%contact%block_steps + 1
      gap = gap + length*opening
      associate (force => state%contact%force)
        pull = force - self%gamma*gap
        borne = merge(pull, 0.0_wp, self%closed)
        wanted = pull > 0.0_wp
        if (length < 1.0_wp .or. any(wanted .neqv. self%closed)) return
        next = merge(pull, 0.0_wp, self%closed .and. wanted)
        change = maxval([abs(next - force), 0.0_wp])/maxval([next, tiny(1.0_wp)])
        if (afresh) change = max(change, maxval(abs(strain))/max(maxval(abs(state%strain)), tiny(1.0_wp)))
        force = next
      end associate
    end subroutine take_step

    !> Up to where the function is least along the step, by regula falsi and geometric means.
    real(wp) function length_of_step() result(t)
      type(bracket) :: zero   ! of the slope
      real(wp) :: begin, curvature, now
      integer :: i

      curvature = sum(spread(bodies%operator%volume, 1, components)*strain*bodies%law%increment(strain))
      t = 1.0_wp
      begin = slope(0.0_wp, curvature)
      zero = bracket([0.0_wp, 1.0_wp], [begin, slope(1.0_wp, curvature)])
      if (zero%values(2) <= flat_enough*abs(begin)) return
      do i = 1, step_limit
        t = zero%likely()
        if (mod(i, 3) == 0) t = sqrt(max(zero%at(1), tiny(1.0_wp)))*sqrt(zero%at(2))
        now = slope(t, curvature)
        if (abs(now) <= flat_enough*abs(begin)) return
        call zero%take(t, now)
      end do
    end function length_of_step

    !> Of that function there.
    pure real(wp) function slope(t, curvature)
      real(wp), intent(in) :: t, curvature   !! of all but the pairs' part

      slope = t*curvature - descent - &
              sum(max(0.0_wp, state%contact%force - self%gamma*(gap + t*opening))*opening)
    end function slope
  end subroutine find_set

  !> What follows from the forces and gaps that were found: which pairs touch, and which motions are free.
  subroutine settle(self, scene, fixed_gap, state)
    class(joined_contact), intent(in) :: self
    type(planned_scene), intent(in) :: scene
    real(wp), intent(in) :: fixed_gap(:)
    type(scene_state), intent(inout) :: state
    real(wp) :: terms(size(fixed_gap))   ! what gaps are the sum of

    associate (contact => state%contact)
      where (contact%force <= negligible*maxval([contact%force, 0.0_wp])) contact%force = 0.0_wp
      where (self%rigid%redundant) contact%approach = 0.0_wp
      terms = abs(fixed_gap) + terms_of_openings(scene%model, state%deformation) + &
              self%motion%times(contact%approach, magnitudes=.true.)
      contact%touching = contact%force > 0.0_wp .or. contact%gap <= negligible*terms
      where (contact%touching) contact%gap = 0.0_wp
      contact%motion_free = find_free_motions(self%motion%over(self%motion%units()), contact%touching, &
          contact%force > lost_digits*maxval([contact%force, 0.0_wp]))
      contact%joined = .true.
      if (any(contact%motion_free .neqv. self%rigid%redundant)) contact%state = contact_stalled
    end associate
  end subroutine settle

  !> What a pair gives way by under a force of its own, about [length/force] [pairs].
  pure function compliance(self)
    class(joined_contact), intent(in) :: self
    real(wp), allocatable :: compliance(:)

    compliance = half_plane*of_pairs/self%gamma
  end function compliance

  !> Contact forces and displacements, the set of contacts frozen, under loads along the free motions and
  !! openings of the gaps, in one solve: of what is wrong of the forces it leaves a thousandth or less.
  subroutine respond(self, scene, bodies, load, opening, force, u)
    class(joined_contact), intent(in) :: self
    type(planned_scene), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies !! factored with that set
    real(wp), intent(in) :: load(:, :)              !! [force] [motions, any]
    real(wp), intent(in) :: opening(:, :)           !! [length] [pairs, any]
    real(wp), intent(inout) :: force(:, :)          !! as far as known; then better [force] [pairs, any]
    !> As far as known, for what springs at SUPORT freedoms bear [length] [directions, any, nodes]
    real(wp), intent(inout) :: u(:, :, :)
    type(force_fields) :: loads
    integer, allocatable :: pair(:)
    integer :: k

    pair = pack([(k, k=1, size(self%closed))], self%closed)
    loads%node = [scene%motions%node, [(scene%model%row_node(scene%model%row_start(pair(k)): &
                                    scene%model%row_start(pair(k) + 1) - 1), k=1, size(pair))]]
    allocate (loads%force(directions, size(load, 2), size(loads%node)), source=0.0_wp)
    call put_loads()
    call bodies%body_displacements(scene, 1, loads, [(k, k=1, scene%model%nodes)], u)
    do k = 1, size(load, 2)
      where (self%closed) force(:, k) = force(:, k) - self%gamma*gap_opening(scene%model, u(:, k, :))
    end do

  contains

    !> The loads, and forces with those of the springs.
    subroutine put_loads()
      integer :: c, i, n

      do n = 1, scene%motions%count
        associate (c => scene%motions%component(n), node => scene%motions%node(n))
          loads%force(c, :, n) = load(n, :) + &
                                 bodies%spring%stiffness(spring_of_motion(scene, n))*u(c, :, node)
        end associate
      end do
      n = scene%motions%count
      do k = 1, size(pair)
        force(pair(k), :) = force(pair(k), :) - self%gamma(pair(k))*opening(pair(k), :)
        do i = scene%model%row_start(pair(k)), scene%model%row_start(pair(k) + 1) - 1
          n = n + 1
          do c = 1, directions
            loads%force(c, :, n) = scene%model%row_weight(i)*scene%model%normal(c, pair(k))*force(pair(k), :)
          end do
        end do
      end do
    end subroutine put_loads
  end subroutine respond

  !> Are the contact forces the only ones? Forces that open no gaps are what a solve leaves of any; of two
  !! that are given no one is likely to have none of these.
  logical function are_unique(self, scene, bodies)
    class(joined_contact), intent(in) :: self
    type(planned_scene), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies !! factored with the set of contacts
    real(wp) :: force(scene%model%pairs, 2), u(directions, 2, scene%model%nodes)
    integer :: k

    do k = 1, size(force, 1)
      force(k, :) = cos(k*[1.0_wp, sqrt(2.0_wp)])
    end do
    where (.not. spread(self%closed, 2, 2)) force = 0.0_wp
    u = 0.0_wp
    call self%respond(scene, bodies, spread(spread(0.0_wp, 1, 2), 1, scene%motions%count), 0*force, force, u)
    are_unique = maxval(abs(force)) <= most_left
  end function are_unique
end module epcont_linear_joined_contact
