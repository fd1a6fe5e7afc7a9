!> RULE JOINED: all bodies are one sparse system, and contact is found without a flexibility matrix, which
!> takes longest if there are many pairs.
module epcont_linear_joined_rule
  use epcont_assembly_bodies, only: factored_bodies
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits, negligible
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_friction, only: forces_in_cones
  use epcont_contact_problem, only: contact_no_equilibrium, contact_solved, contact_stalled, &
    new_solution
  use epcont_contact_uniqueness, only: find_undetermined_motions
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_flexibility, only: gap_opening, terms_of_openings
  use epcont_linalg_anderson, only: anderson_mixer
  use epcont_linear_contact_rule, only: contact_loads, contact_rule, contact_sensitivity
  use epcont_linear_joined_response, only: are_unique, respond_joined, sensitivity_probe
  use epcont_linear_joined_search, only: joined_search
  use epcont_linear_joined_springs, only: new_springs
  use epcont_linear_load_line, only: load_line
  use epcont_linear_solved_state, only: solved_state
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_stopwatch, only: stage_contact, stopwatch
  implicit none
  private
  public :: joined_rule

  type, extends(contact_rule) :: joined_rule
    type(joined_search), private :: search    !! with the friction limits of the present solve
    type(load_line), private :: line          !! predicts the start of the next contact
    type(rigid_start), private :: rigid       !! shows if rigid bodies can carry the loads
    type(sensitivity_probe), private :: probe
  contains
    procedure :: take_case
    procedure :: factor
    procedure :: solve
    procedure :: is_unique
    procedure :: respond
    procedure :: sensitivity
    procedure :: compliance
    procedure, private :: find_set
    procedure, private :: limit_friction
    procedure, private :: settle
  end type joined_rule

  !> Largest number of solves with given friction limits. They end if no limit changes by more than `exact` of
  !! the largest force, or by more than `rounding`, which no longer falls.
  integer, parameter :: most_limits = 30
  real(wp), parameter :: exact = 1.0e-14_wp, rounding = 1.0e-11_wp
  !> A fall of the change to more than this fraction is slow.
  real(wp), parameter :: slowly = 1.0_wp/3
  !> Number of sets after which only half of a change is taken: else limits may jump to and fro.
  integer, parameter :: whole_changes = 5
  !> First limit of friction forces, over the loads on rigid-body modes, if only friction can carry these.
  real(wp), parameter :: unlimited = 1.0e4_wp

contains

  !> Take a load case: check if rigid bodies can carry it, and set the springs of modes without load.
  subroutine take_case(self, scene, bodies)
    class(joined_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene           !! numbered as one system
    class(factored_bodies), intent(inout) :: bodies    !! with a law; gets the springs
    logical, allocatable :: redundant(:)               ! of the case before
    type(rigid_start) :: smooth                        ! without friction

    self%failed = .false.
    call self%line%take_load(scene%model%loads%load)
    if (allocated(self%rigid%redundant)) redundant = self%rigid%redundant   ! not if it was not balanced
    associate (motion => self%problem%motion, unit => self%problem%motion%units())
      self%search%lower = spread(0.0_wp, 1, motion%pairs)
      self%search%upper = spread(huge(1.0_wp), 1, motion%pairs)
      if (allocated(self%problem%friction)) then
        associate (mu => self%problem%friction, pair => self%problem%pair_of)
          self%rigid = forces_in_cones(motion%over(unit), self%resultant/unit, pair, mu)
          smooth = forces_in_cones(motion%over(unit), self%resultant/unit, pair, 0*mu)
          call self%limit_friction(0*mu)
          if (.not. smooth%balanced) &
            call self%limit_friction(0*mu + unlimited*maxval([0.0_wp, abs(self%resultant)/unit]))
          if (allocated(self%line%last)) &
            call self%limit_friction(mu*max(self%line%last%contact%force(pair), 0.0_wp))
        end associate
      else
        call find_rigid_start(motion%over(unit), self%resultant/unit, 0*self%search%lower, self%rigid)
      end if
    end associate
    if (.not. self%rigid%balanced) return
    if (allocated(redundant)) then
      if (all(redundant .eqv. self%rigid%redundant)) return
    end if
    if (allocated(self%line%last)) deallocate (self%line%last)
    self%search%threads = self%threads
    self%search%motion = self%problem%motion
    call new_springs(scene, bodies, self%rigid%redundant, self%search%joined_springs)
  end subroutine take_case

  !> Factor the bodies with the springs of the active set, if law or springs have changed. The
  !! contact may factor them for another set.
  subroutine factor(self, scene, bodies, failed_body, watch)
    class(joined_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    integer, intent(out) :: failed_body
    class(stopwatch), intent(inout) :: watch
    logical :: sound

    if (bodies%factorizations == 0) call self%take_case(scene, bodies)   ! springs depend on the first law
    sound = .true.
    if (self%rigid%balanced) call self%search%factor(scene, bodies, self%threads, sound, watch)
    failed_body = merge(0, 1, sound)
  end subroutine factor

  !> Find deformation, approach and contact forces. `failed` if no active set is found.
  subroutine solve(self, scene, bodies, start, state, watch)
    class(joined_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    logical, allocatable, intent(in) :: start(:)
    type(solved_state), intent(inout) :: state
    class(stopwatch), intent(inout) :: watch

    associate (search => self%search, motion => self%problem%motion)
      search%fixed_gap = self%problem%initial_gap + self%travel_gap
      if (allocated(self%line%last)) then
        state = self%line%next()
        associate (opened => search%fixed_gap + gap_opening(scene%model, state%deformation) - &
                             motion%times(state%contact%approach))
          if (any(search%between(state%contact%force - search%gamma*opened, 0.0_wp) .neqv. search%closed)) &
            state = self%line%last
        end associate
      else
        allocate (state%deformation(directions, scene%model%mesh%nodes), source=0.0_wp)
        state%contact = new_solution(scene%model%contact%rows(), scene%motions%count)
      end if
      if (.not. self%rigid%balanced) then
        state%contact%state = contact_no_equilibrium
        state%contact%escape = self%rigid%escape/motion%units()
        return
      end if
    end associate
    call self%find_set(scene, bodies, state, watch)
    if (state%contact%state == contact_solved) then
      call self%settle(scene, state)
      call self%line%keep(state)
    else
      self%failed = .true.
    end if
    call watch%lap(stage_contact)
  end subroutine solve

  !> Find the active set. With friction, the limits of the forces found are given to the next search.
  subroutine find_set(self, scene, bodies, state, watch)
    class(joined_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    type(solved_state), intent(inout) :: state
    class(stopwatch), intent(inout) :: watch
    type(anderson_mixer) :: fresh, mixer
    real(wp), allocatable :: given(:), limit(:)
    logical, allocatable :: closed(:)
    real(wp) :: before, change
    integer :: i, sets

    call self%search%find_set(scene, bodies, self%rigid%redundant, allocated(self%line%last), state, watch)
    if (.not. allocated(self%problem%friction)) return
    change = huge(change)
    sets = 0
    closed = self%search%closed
    do i = 1, most_limits
      if (state%contact%state /= contact_solved) return
      associate (n => scene%model%contact%pairs)
        given = self%search%upper(n + 1:)
        limit = self%problem%friction*max(state%contact%force(self%problem%pair_of), 0.0_wp)
        before = change
        change = maxval(abs(limit - given))   ! below 1/epsilon, if there are no forces
        change = change/max(maxval(state%contact%force), epsilon(change)*change, tiny(change))
        call self%limit_friction(limit)
        if (change <= exact .or. change <= rounding .and. change > slowly*before) return
        ! While the set stays, forces are linear in the limits, and differences of steps lead to the solution.
        if (any(closed .neqv. self%search%closed)) then
          sets = sets + 1
          mixer = fresh
        end if
        closed = self%search%closed
        ! Limits of rows that stick have no effect.
        if (change > rounding) call mixer%mix(merge(0.0_wp, limit - given, closed(n + 1:)), limit)
        if (sets > whole_changes .and. mixer%steps == 0) limit = 0.5_wp*(given + limit)
        call self%limit_friction(max(limit, 0.0_wp))
      end associate
      call self%search%find_set(scene, bodies, self%rigid%redundant, .true., state, watch)
    end do
    state%contact%state = contact_stalled
  end subroutine find_set

  !> Set the friction limits.
  subroutine limit_friction(self, limit)
    class(joined_rule), intent(inout) :: self
    real(wp), intent(in) :: limit(:)   !! [force] [tangential rows]

    associate (n => size(self%search%upper) - size(limit))
      self%search%lower(n + 1:) = -limit
      self%search%upper(n + 1:) = limit
    end associate
  end subroutine limit_friction

  !> Complete the solution from forces and gaps: pairs in contact, and undetermined modes.
  subroutine settle(self, scene, state)
    class(joined_rule), intent(in) :: self
    type(planned_model), intent(in) :: scene
    type(solved_state), intent(inout) :: state
    real(wp) :: terms(scene%model%contact%rows())   ! sum of magnitudes of the terms of gaps

    associate (contact => state%contact, motion => self%problem%motion)
      contact%at_upper = .false.
      where (.not. self%search%between(contact%force, negligible))
        contact%at_upper = contact%force - self%search%lower > self%search%upper - contact%force
        contact%force = merge(self%search%upper, self%search%lower, contact%at_upper)
      end where
      where (motion%sizes() <= 0.0_wp) contact%approach = 0.0_wp
      terms = abs(self%search%fixed_gap) + terms_of_openings(scene%model, state%deformation) + &
              motion%times(contact%approach, magnitudes=.true.)
      contact%touching = self%search%between(contact%force, 0.0_wp) .or. &
                         self%search%lower < self%search%upper .and. &
                         merge(-contact%gap, contact%gap, contact%at_upper) <= negligible*terms
      where (contact%touching) contact%gap = 0.0_wp
      associate (pressed => self%search%between(contact%force, lost_digits))   ! at its limit, friction slips
        contact%motion_free = find_undetermined_motions(motion%over(motion%units()), &
          contact%touching .and. (pressed .or. self%search%lower >= 0.0_wp), pressed)
      end associate
    end associate
  end subroutine settle

  !> Are the contact forces unique? If not, the solution does not show which ones are indeterminate.
  logical function is_unique(self, scene, bodies)
    class(joined_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies

    ! The load case before may have had the same factor.
    if (.not. self%search%unique) self%search%unique = are_unique(self%search, scene, bodies)
    is_unique = self%search%unique
  end function is_unique

  !> Find forces and displacements under unit loads.
  subroutine respond(self, scene, bodies, state, loads, known)
    class(joined_rule), intent(inout), target :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    class(solved_state), intent(in) :: state
    type(contact_loads), intent(inout) :: loads
    logical, intent(in) :: known
    type(sensitivity_probe) :: none

    if (.not. known) self%probe = none
    call respond_joined(self%search, scene, bodies, self%problem, state, self%probe, loads)
  end subroutine respond

  !> Compute the sensitivity of the contact forces to errors of the stiffness and of the gaps.
  function sensitivity(self, state, condition) result(found)
    class(joined_rule), intent(inout), target :: self
    class(solved_state), intent(in) :: state
    real(wp), intent(in) :: condition
    type(contact_sensitivity) :: found

    found = self%probe%found(condition, self%search%correction)
  end function sensitivity

  !> Compliance of a half-plane at each pair.
  pure function compliance(self)
    class(joined_rule), intent(in) :: self
    real(wp), allocatable :: compliance(:)

    compliance = self%search%compliance
  end function compliance
end module epcont_linear_joined_rule
