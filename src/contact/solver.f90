!> Solution of a contact problem: scaling, rigid start, active set by the simplex, units.
module epcont_contact_solver
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, lost_digits, negligible, null_component
  use epcont_contact_basis, only: contact_basis, move_basis, new_basis, respond
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_friction, only: solve_friction
  use epcont_contact_problem, only: contact_no_equilibrium, contact_overlap, contact_problem, &
    contact_solution, contact_solved, new_solution
  use epcont_contact_scaling, only: drop_motions, scale_problem, scaled_problem
  use epcont_contact_simplex, only: find_contacts
  use epcont_contact_state, only: contact_state, gaps_under, solve_set, terms_of_gaps
  use epcont_contact_uniqueness, only: find_undetermined_motions, find_indeterminate_forces, share_equally
  use epcont_flexibility_motion_matrix, only: motion_matrix
  implicit none
  private
  public :: solve_contact

contains

  !> Find forces, gaps and modes of a contact problem, or the reason why there is no solution. A reason may be
  !! that pairs hardly restrain a mode, so that rounding of the loads along it causes a large force.
  subroutine solve_contact(problem, solution, start, basis, any_forces)
    type(contact_problem), intent(in), target :: problem   !! in the deck's units
    type(contact_solution), intent(out) :: solution   !! its state says if there is a solution
    logical, intent(in), optional :: start(:)   !! guess of the pairs in contact [n]
    !> Of the last solution with this F, or empty; then of this one
    type(contact_basis), intent(inout), optional :: basis
    logical, intent(in), optional :: any_forces   !! true: do not check if there are other forces
    type(scaled_problem) :: scaled
    type(rigid_start) :: rigid
    type(contact_state) :: state
    type(motion_matrix) :: motion   ! A of all modes, scaled [n, m]
    real(wp), allocatable :: ray(:)

    if (allocated(problem%friction)) then
      call solve_friction(problem, solution, start, any_forces)
      return
    end if
    scaled = scale_problem(problem)
    motion = scaled%motion
    if (present(start)) scaled%guess = start
    solution = new_solution(size(scaled%gap), size(scaled%resultant))
    solution%gap = scaled%gap*scaled%gap_unit
    call find_rigid_start(motion, scaled%resultant, scaled%unloaded_gap, rigid)
    if (.not. rigid%balanced) then
      solution%state = contact_no_equilibrium
      solution%escape = rigid%escape/scaled%motion_size
      return
    end if
    scaled%first = rigid%touching
    call drop_motions(scaled, rigid%redundant)
    if (present(basis)) call move_basis(basis, state%contact_basis)
    call find_contacts(scaled, solution, state, ray)
    select case (solution%state)
    case (contact_overlap)
      solution%overlapping = ray > null_component*maxval(ray)
    case (contact_solved)
      call settle(scaled, motion, state, solution, .not. present(any_forces))
      if (present(basis)) call move_basis(state%contact_basis, basis)
    end select
  end subroutine solve_contact

  !> Convert the solution to the deck's units, and find its undetermined forces and modes.
  subroutine settle(scaled, motion, state, solution, asks_for_others)
    type(scaled_problem), intent(in) :: scaled
    type(motion_matrix), intent(in) :: motion       !! A of all modes, scaled
    type(contact_state), intent(inout) :: state
    type(contact_solution), intent(inout) :: solution
    logical, intent(in) :: asks_for_others          !! check if there are other forces
    !> Sum of magnitudes of the terms of gaps; modes have the rounding of the restraining gaps [n]
    real(wp), allocatable :: terms(:)
    real(wp) :: zero                    ! force that is only rounding

    zero = negligible*maxval([state%force, 1.0_wp])
    call cut_rounding(scaled, state, terms)
    solution%approach(scaled%kept) = state%approach
    call find_touching(state, terms, solution%touching)
    solution%motion_free = find_undetermined_motions(motion, solution%touching, &
      state%force > lost_digits*maxval([state%force, 1.0_wp]))
    if (any(solution%motion_free)) then
      call remove_forces(scaled, state, state%force <= zero)
      call close_by_motions(scaled, state)
      solution%approach(scaled%kept) = state%approach
    end if
    if (asks_for_others) then
      solution%indeterminate = find_indeterminate_forces(scaled, solution%touching, state%force > zero)
      call share_equally(scaled, solution%indeterminate, state%force)
      where (solution%indeterminate) state%change = state%force - scaled%known_force
    end if
    ! In the deck's units.
    solution%force = state%force*scaled%force_unit
    solution%change = state%change*scaled%force_unit
    solution%gap = state%gap*scaled%gap_unit
    solution%approach = solution%approach*scaled%gap_unit/scaled%motion_size
  end subroutine settle

  !> Set the force of some pairs to zero.
  pure subroutine remove_forces(scaled, state, chosen)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(inout) :: state
    logical, intent(in) :: chosen(:)        !! [n]

    where (chosen)
      state%force = 0.0_wp
      state%change = -scaled%known_force
    end where
  end subroutine remove_forces

  !> Close the gaps that appear if forces are removed from other pairs: in a slender body they are
  !! large. Pairs of the basis restrain the modes, also those without force.
  pure subroutine close_by_motions(scaled, state)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(inout) :: state
    real(wp), allocatable :: approach(:, :), change(:, :), gap(:), before(:)

    if (.not. state%sound) return
    before = gaps_under(scaled, scaled%gap, state%change, state%approach)
    call respond(state%contact_basis, reshape(before(state%pairs), [size(state%pairs), 1]), &
                 reshape(0*state%approach, [size(state%approach), 1]), change, approach)
    gap = gaps_under(scaled, scaled%gap, state%change, state%approach + approach(:, 1))
    associate (pressed => state%force > 0.0_wp)
      if (maxval([abs(gap), 0.0_wp], mask=[pressed, .true.]) >= &
          maxval([abs(before), 0.0_wp], mask=[pressed, .true.])) return
    end associate
    state%approach = state%approach + approach(:, 1)
    where (abs(state%gap) > 0.0_wp) state%gap = gap
  end subroutine close_by_motions

  !> Find the pairs in contact, that is, with zero gap.
  pure subroutine find_touching(state, terms, touching)
    type(contact_state), intent(inout) :: state
    real(wp), intent(in) :: terms(:)        !! sum of magnitudes of the terms of gaps [n]
    logical, intent(out) :: touching(:)     !! [n]

    where (state%force > 0.0_wp) state%gap = 0.0_wp
    touching = state%gap <= negligible*max(terms, maxval([terms(state%pairs), 0.0_wp]))
    where (touching) state%gap = 0.0_wp
  end subroutine find_touching

  !> Set forces and modes to zero if they are only rounding. A force that is cut off may have been
  !! negative: its pair need not be closed. If rigid stops take the load, gaps may be far below the gap
  !! unit, and this force may have kept other pairs closed: then the set is solved again.
  subroutine cut_rounding(scaled, state, terms)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(inout) :: state
    real(wp), allocatable, intent(out) :: terms(:)   !! sum of magnitudes of the terms of gaps [n]
    type(contact_state) :: fewer
    logical, allocatable :: moving(:), pressed(:)

    do
      pressed = state%force > cancelled
      call remove_forces(scaled, state, .not. pressed)
      terms = terms_of_gaps(scaled, state)
      moving = abs(state%approach) > cancelled*maxval([terms(state%pairs), cancelled])
      if (all(moving) .and. all(pressed(state%pairs))) return
      where (.not. moving) state%approach = 0.0_wp
      terms = terms_of_gaps(scaled, state)
      state%gap = gaps_under(scaled, scaled%gap, state%change, state%approach)
      if (all(abs(state%gap) <= negligible*terms .or. .not. pressed) .or. &
          all(pressed(state%pairs))) return
      fewer%contact_basis = new_basis(scaled, pressed)
      if (.not. fewer%sound) return   ! a mode is restrained by rounding
      call solve_set(fewer, scaled, scaled%gap, scaled%resultant, refinements=1)
      call move_basis(fewer%contact_basis, state%contact_basis)
      state%force = fewer%force
      state%change = fewer%change
      state%gap = fewer%gap
      state%approach = fewer%approach
    end do
  end subroutine cut_rounding
end module epcont_contact_solver
