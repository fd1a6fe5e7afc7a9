!> Contact search for bodies in one system, without a flexibility matrix.
!>
!> With known forces lambda, gaps g(u) and a spring of stiffness gamma at each pair,
!>
!>     K u = f + N'R,   R = max(lower, min(upper, lambda - gamma g(u)))
!>
!> has one solution, the minimum of a convex function of u; for lambda = R it is the contact solution. Newton
!> steps have the springs of the pairs whose force is between its bounds, the active set (Hintermueller, Ito
!> and Kunisch 2002). If a step does not change the set, lambda is set to R, and the remaining gaps fall by
!> gamma times the flexibility, thousands, in each step: the result does not depend on gamma. SUPORT
!> DOFs have springs, too, so weak that they matter only if no pair restrains a body yet; in each step they
!> act on the displacements of this step only.
!>
!> Lambda is fixed until the set stays: each step minimises that function, and is cut if full steps cycle.
module epcont_linear_joined_search
  use epcont_assembly_bodies, only: factored_bodies, half_solved_body, prescribe
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits, negligible, valid_to
  use epcont_contact_problem, only: contact_solved, contact_stalled
  use epcont_contact_uniqueness, only: find_undetermined_motions
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_flexibility, only: gap_opening, pair_forces
  use epcont_flexibility_motion_matrix, only: motion_matrix
  use epcont_linear_contact_ends, only: reach_ends
  use epcont_linear_joined_path, only: joined_path
  use epcont_linear_joined_springs, only: add_suport_forces, joined_springs, suport_values
  use epcont_linear_line_search, only: has_settled, least_at, part_of_largest
  use epcont_linear_solved_state, only: solved_state
  use epcont_model_springs, only: spring_forces
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_stopwatch, only: stopwatch
  implicit none
  private
  public :: joined_search

  !> Full steps; then an interior path leads to a set, which is kept for some steps, and cut steps follow.
  !! Most models take 1 to 10 steps.
  integer, parameter :: full_steps = 12, held_steps = 4, step_limit = 200
  !> Springs of pairs become firmer if a step leaves more than this fraction of the error of forces.
  real(wp), parameter :: slow = 0.1_wp
  !> If forces change by at most this fraction, displacements are updated: two more steps follow.
  real(wp), parameter :: nearly = 1.0e-3_wp

  !> While the set changes, only displacements of pairs and SUPORT DOFs are solved for; then all
  !! displacements, relative to those of the state, whose rounding is the only one in the result.
  type, extends(joined_springs) :: joined_search
    integer :: threads = 1                         !! number of threads
    type(motion_matrix) :: motion                  !! A, closing of the gaps by the rigid-body modes
    real(wp), allocatable :: lower(:), upper(:)    !! bounds of the forces [force] [pairs]
    real(wp), allocatable, private :: bound(:)     !! bound of the force of each open pair [pairs]
    real(wp), allocatable :: fixed_gap(:)          !! initial gap and prescribed part of it [length] [pairs]
    real(wp) :: correction = huge(1.0_wp)          !! of forces in the last step, over the largest
    !> Forces in balance; gaps; their change in a step [pairs]
    real(wp), allocatable, private :: borne(:), gap(:), opening(:)
    real(wp), allocatable, private :: pull(:)      !! lambda - gamma g [force] [pairs]
    !> Forces of the springs of SUPORT DOFs, and displacements of these in a step [modes]
    real(wp), allocatable, private :: held(:), moved(:)
    !> Residual at the displacements of the state, and a step from there [directions, nodes]
    real(wp), allocatable, private :: unbalanced(:, :), step(:, :)
    logical, allocatable, private :: wanted(:)     !! pairs closed in the next set [pairs]
    real(wp), allocatable, private :: nearer(:)    !! bounds of the others [pairs]
    real(wp), private :: change(2)                 !! of forces and strains in this step
    integer, private :: taken = 0                  !! number of steps
    integer, private :: last_held = 0              !! step up to which signs are not checked
    logical, private :: stays = .false.            !! the set stays, and lambda follows
    logical, private :: whole = .false.            !! the step has all displacements
    !> The step begins at the state, with its residual and all forces
    logical, private :: afresh = .false.
  contains
    procedure :: find_set
    procedure :: between
    procedure, private :: forces_of
    procedure, private :: begin
    procedure, private :: begin_set
    procedure, private :: begin_at_state
    procedure, private :: begin_afresh
    procedure, private :: balance
    procedure, private :: lead_to_set
    procedure, private :: find_wanted
    procedure, private :: choose_set
    procedure, private :: find_step
    procedure, private :: length_of_step
    procedure, private :: take_step
    procedure, private :: take_displacements
    procedure, private :: judge
  end type joined_search

contains

  !> Take Newton steps to the active set and its forces.
  subroutine find_set(self, scene, bodies, redundant, knows_set, state, watch)
    class(joined_search), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    logical, intent(in) :: redundant(:)           !! nothing restrains the mode [modes]
    logical, intent(in) :: knows_set              !! the state is near the solution
    type(solved_state), intent(inout) :: state
    class(stopwatch), intent(inout) :: watch
    real(wp) :: before(2), length
    logical :: sound

    call self%begin(scene, bodies, redundant, knows_set, state)
    do
      self%taken = self%taken + 1
      if (self%taken > step_limit) exit
      if (self%taken == full_steps) call self%lead_to_set(scene, bodies, state)
      call self%factor(scene, bodies, self%threads, sound, watch)
      if (.not. sound) exit
      call self%find_step(scene, bodies)
      before = self%change
      length = 1.0_wp
      if (self%taken >= full_steps + held_steps .and. .not. self%whole) length = self%length_of_step()
      call self%take_step(length, state)
      if (self%stays .and. self%whole) call self%judge(scene, bodies, before, state)
      if (state%contact%state == contact_solved) exit
      self%whole = self%stays .and. (self%whole .or. self%change(1) <= nearly .or. &
                                     self%change(1) > 0.5_wp*before(1))
      if (self%whole) call self%begin_at_state(scene, state)
      if (self%stays) cycle
      self%change = huge(1.0_wp)
      if (self%taken < full_steps) call reach_ends(self%closed, self%wanted)
      call self%choose_set(state)
    end do
    state%contact%gap = self%gap
    deallocate (self%unbalanced)
    if (allocated(self%step)) deallocate (self%step)
  end subroutine find_set

  !> Set the initial state and the first set.
  subroutine begin(self, scene, bodies, redundant, knows_set, state)
    class(joined_search), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    logical, intent(in) :: redundant(:), knows_set
    type(solved_state), intent(inout) :: state

    state%contact%state = contact_stalled
    state%contact%pivots = 0
    state%contact%sets = 0
    self%taken = 0
    self%last_held = 0
    call prescribe(scene, .true., state%deformation)
    state%strain = bodies%operator%strains(scene%model, state%deformation, .true.)
    call self%balance(scene, bodies, state)
    call self%begin_at_state(scene, state)
    call self%begin_afresh()
    if (.not. allocated(self%bound)) self%bound = self%lower
    call self%find_wanted(state%contact%force)
    if (knows_set) call self%choose_set(state)
    if (.not. knows_set) call self%begin_set(redundant)
  end subroutine begin

  !> Choose the first set: pairs that overlap or are as close as contact may deform, if they restrain all
  !! modes; else all pairs. Distant pairs would bend bodies into each other.
  subroutine begin_set(self, redundant)
    class(joined_search), intent(inout) :: self
    logical, intent(in) :: redundant(:)
    logical :: near(size(self%gap))

    near = self%gap <= maxval(self%compliance)*maxval(sum(abs(self%unbalanced), dim=2)) - &
           min(0.0_wp, minval(self%gap))
    associate (free => find_undetermined_motions(self%motion%over(self%motion%units()), near, near))
      if (all(free .eqv. redundant)) self%closed = near
    end associate
  end subroutine begin_set

  !> Begin the next step at the state.
  subroutine begin_at_state(self, scene, state)
    class(joined_search), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    type(solved_state), intent(in) :: state

    self%gap = self%fixed_gap + gap_opening(scene%model, state%deformation) - &
               self%motion%times(state%contact%approach)
    self%pull = state%contact%force - self%gamma*self%gap
  end subroutine begin_at_state

  !> Reset the history of steps.
  subroutine begin_afresh(self)
    class(joined_search), intent(inout) :: self

    self%afresh = .true.
    self%whole = .false.
    self%change = huge(1.0_wp)
    self%borne = 0.0_wp*self%gap
    self%held = 0.0_wp*self%hold
  end subroutine begin_afresh

  !> Compute the residual at the state.
  subroutine balance(self, scene, bodies, state)
    class(joined_search), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    type(solved_state), intent(in) :: state

    self%unbalanced = scene%model%loads%load - &
                      bodies%operator%nodal_forces(scene%model, bodies%law%stress(state%strain)) - &
                      spring_forces(scene%model, state%deformation)
  end subroutine balance

  !> If full steps cycle, as with opening contacts or rocking bodies, follow an interior path near the set.
  subroutine lead_to_set(self, scene, bodies, state)
    class(joined_search), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    type(solved_state), intent(inout) :: state
    type(joined_path) :: path

    call self%begin_at_state(scene, state)
    call self%begin_afresh()
    path = joined_path(self%gap, self%unbalanced, self%gamma, self%compliance, self%lower, self%upper)
    call path%follow(scene, self%threads, bodies)
    state%contact%force = path%force
    self%bound = path%force
    state%contact%sets = state%contact%sets + path%steps
    self%closed = path%closed
    self%unique = .false.
    self%last_held = self%taken + held_steps - 1
    self%pull = state%contact%force - self%gamma*self%gap
  end subroutine lead_to_set

  !> Choose the pairs whose force is between its bounds; if it is at one up to rounding, keep their state.
  subroutine find_wanted(self, force)
    class(joined_search), intent(inout) :: self
    real(wp), intent(in) :: force(:)     !! present forces [pairs]

    self%wanted = self%pull > self%lower .and. self%pull < self%upper
    self%nearer = merge(self%upper, self%lower, self%pull - self%lower > self%upper - self%pull)
    where (abs(self%pull - self%nearer) <= negligible*maxval([abs(force), tiny(1.0_wp)])) &
      self%wanted = self%closed
  end subroutine find_wanted

  !> Compute forces of the set: closed pairs have those of their springs, the others are at their bounds.
  pure function forces_of(self, pull) result(force)
    class(joined_search), intent(in) :: self
    real(wp), intent(in) :: pull(:)      !! of the springs [force] [pairs]
    real(wp) :: force(size(pull))

    force = merge(pull, self%bound, self%closed)
  end function forces_of

  !> Find forces between their bounds, farther from them than a fraction of the largest [pairs].
  pure function between(self, force, part)
    class(joined_search), intent(in) :: self
    real(wp), intent(in) :: force(:), part
    logical :: between(size(force))

    associate (away => part*maxval([abs(force), 0.0_wp]))
      between = force - self%lower > away .and. self%upper - force > away
    end associate
  end function between

  !> Choose the next set.
  subroutine choose_set(self, state)
    class(joined_search), intent(inout) :: self
    type(solved_state), intent(inout) :: state

    state%contact%pivots = state%contact%pivots + count(self%wanted .neqv. self%closed)
    self%closed = self%wanted
    self%bound = self%nearer
  end subroutine choose_set

  !> Solve for the residual: after a step, that of pairs and moved SUPORT DOFs only.
  subroutine find_step(self, scene, bodies)
    class(joined_search), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    type(half_solved_body), allocatable :: half(:)
    real(wp) :: force(directions, scene%model%mesh%nodes)

    if (self%whole .or. self%afresh) then
      force = self%unbalanced + pair_forces(scene%model, self%forces_of(self%pull))
    else
      force = pair_forces(scene%model, self%forces_of(self%pull) - self%borne)
    end if
    call add_suport_forces(scene, self%held, force)
    self%afresh = .false.
    call bodies%add_forces(scene, force, .false., half)
    self%step = bodies%finish(scene, half, .false., at_contact=.not. self%whole)
    self%opening = gap_opening(scene%model, self%step)
    self%moved = suport_values(scene, self%step)
  end subroutine find_step

  !> Fraction of a step that minimises the function.
  real(wp) function length_of_step(self) result(length)
    class(joined_search), intent(in) :: self
    real(wp) :: curvature, descent

    descent = sum(self%held*self%moved) - sum(self%borne*self%opening)
    curvature = descent + sum((self%pull - self%gamma*self%opening)*self%opening, mask=self%closed) - &
                sum(self%hold*self%moved**2)
    length = least_at(max(0.0_wp, curvature), descent, self%pull, self%gamma*self%opening, self%opening, &
                      self%lower, self%upper)
  end function length_of_step

  !> Add a step; lambda follows a full step with the same set, except the first with all displacements.
  subroutine take_step(self, length, state)
    class(joined_search), intent(inout) :: self
    real(wp), intent(in) :: length       !! fraction of the step
    type(solved_state), intent(inout) :: state
    real(wp), allocatable :: next(:)

    state%contact%sets = state%contact%sets + 1
    associate (force => state%contact%force)
      self%borne = (1.0_wp - length)*self%borne + &
                   length*self%forces_of(force - self%gamma*(self%gap + self%opening))
      self%held = (1.0_wp - length)*self%held + length*self%hold*self%moved
      self%gap = self%gap + length*self%opening
      self%pull = force - self%gamma*self%gap
      call self%find_wanted(force)
      if (self%taken <= self%last_held) self%wanted = self%closed
      if (self%taken <= self%last_held) self%nearer = self%bound
      self%stays = length >= 1.0_wp .and. all(self%wanted .eqv. self%closed) .and. &
                   all(self%closed .or. .not. abs(self%nearer - self%bound) > 0.0_wp)
      if (.not. self%stays .or. self%whole .and. self%change(2) > 1.0_wp) return
      next = self%forces_of(self%pull)
      ! Forces that vanish in this step: a change that is large, but no overflow.
      self%change(1) = maxval([abs(next - force), 0.0_wp])/ &
                       maxval([abs(next), epsilon(1.0_wp)*abs(force), tiny(1.0_wp)])
      force = next
      self%pull = force - self%gamma*self%gap
    end associate
  end subroutine take_step

  !> Update displacements after a full step. Check if the contact is found, or if springs must be firmer.
  subroutine judge(self, scene, bodies, before, state)
    class(joined_search), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    real(wp), intent(in) :: before(2)             !! change in the step before
    type(solved_state), intent(inout) :: state
    logical :: firmer

    call self%take_displacements(scene, bodies, state)
    if (all(has_settled(self%change, before))) then
      self%correction = self%change(1)
      associate (force => state%contact%force)
        if (self%taken > self%last_held .or. all(self%between(force, -valid_to))) &
          state%contact%state = contact_solved   ! no force is beyond its bounds
      end associate
      if (state%contact%state == contact_solved) return
      self%last_held = 0
    end if
    if (self%change(1) > max(slow*before(1), lost_digits) .and. before(1) < nearly) then
      call self%make_firmer(firmer)
      if (firmer) self%change(1) = huge(1.0_wp)
    end if
    call self%balance(scene, bodies, state)
  end subroutine judge

  !> Update all displacements.
  subroutine take_displacements(self, scene, bodies, state)
    class(joined_search), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    type(solved_state), intent(inout) :: state
    real(wp), allocatable :: strain(:, :)

    call scene%motions%add(scene%model, -self%moved, self%step)
    strain = bodies%operator%strains(scene%model, self%step, .false.)
    state%deformation = state%deformation + self%step
    state%strain = state%strain + strain
    state%contact%approach = state%contact%approach + self%moved
    self%held = 0.0_wp
    ! For stiff bodies among soft ones, stresses show changes that strains do not.
    self%change(2) = max(part_of_largest(strain, state%strain), &
                         part_of_largest(bodies%law%increment(strain), bodies%law%stress(state%strain)))
  end subroutine take_displacements
end module epcont_linear_joined_search
