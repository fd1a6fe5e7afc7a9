!> Solution of the contact equations for a set of pairs in contact, and the test of its signs.
module epcont_contact_state
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled
  use epcont_contact_basis, only: contact_basis, new_basis, renew_basis, respond
  use epcont_contact_scaling, only: gaps_by_forces, scaled_problem
  implicit none
  private
  public :: contact_state, renew_state, solve_set, basic_values, gaps_under, has_right_signs, terms_of_gaps

  !> Fraction of the largest force by which forces and gaps may have the wrong sign, in scaled units: the best
  !! that is possible for badly conditioned flexibilities (1e10: tests/contact/hard_problem), and required
  !! of a guess, from which better sets may be found.
  real(wp), parameter, public :: guess_tolerance = 1.0e-12_wp

  !> A set with its solution at full load; without forces if the basis is not sound.
  type, extends(contact_basis) :: contact_state
    real(wp), allocatable :: force(:)           !! outside the basis zero [n]
    !> Forces minus the known forces: if these are large, the sum loses all digits of it [n]
    real(wp), allocatable :: change(:)
    real(wp), allocatable :: gap(:)             !! in the basis zero up to rounding [n]
    real(wp), allocatable :: approach(:)        !! [m]
  end type contact_state

contains

  !> Find forces, gaps and modes of an active set; if it does not restrain all modes, add the pairs in contact
  !! first.
  subroutine renew_state(state, scaled, closed)
    type(contact_state), intent(inout) :: state   !! its basis is kept if it is of this set
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    logical, intent(in) :: closed(:)             !! [n]

    call renew_basis(state%contact_basis, scaled, closed)
    if (.not. state%sound) state%contact_basis = new_basis(scaled, closed .or. scaled%first)
    call solve_set(state, scaled, scaled%gap, scaled%resultant, refinements=1)
  end subroutine renew_state

  !> Solve with the pairs of the basis closed and the others without force.
  pure subroutine solve_set(state, scaled, opening, load, refinements)
    type(contact_state), intent(inout) :: state   !! has the basis
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    real(wp), intent(in) :: opening(:)            !! gaps under the known forces [n]
    real(wp), intent(in) :: load(:)               !! [m]
    integer, intent(in) :: refinements            !! steps of iterative refinement
    real(wp), allocatable :: change(:, :), approach(:, :)
    real(wp) :: unbalanced(size(load), 1)         ! load not carried yet
    integer :: step

    state%change = -scaled%known_force
    state%approach = spread(0.0_wp, 1, size(load))
    if (state%sound) state%change(state%pairs) = 0.0_wp
    state%force = scaled%known_force + state%change
    state%gap = opening
    if (any(abs(state%change) > 0.0_wp)) &
      state%gap = gaps_under(scaled, opening, state%change, state%approach)
    if (.not. state%sound) return
    associate (pairs => state%pairs)
      do step = 0, refinements
        unbalanced(:, 1) = load - scaled%motion%carried(state%force)
        call respond(state%contact_basis, reshape(state%gap(pairs), [size(pairs), 1]), unbalanced, &
                     change, approach)
        state%change(pairs) = state%change(pairs) + change(:, 1)
        state%force(pairs) = scaled%known_force(pairs) + state%change(pairs)
        state%approach = state%approach + approach(:, 1)
        state%gap = gaps_under(scaled, opening, state%change, state%approach)
      end do
    end associate
  end subroutine solve_set

  !> w = g + F R - A q, with R minus the known forces, which are included in g.
  pure function gaps_under(scaled, opening, change, approach) result(gap)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    real(wp), intent(in) :: opening(:)            !! g [n]
    real(wp), intent(in) :: change(:)             !! R [n]
    real(wp), intent(in) :: approach(:)           !! q [m]
    real(wp), allocatable :: gap(:)

    gap = opening - scaled%motion%times(approach) + gaps_by_forces(scaled, change)
  end function gaps_under

  !> Basic variable of each pair: force if it is in the basis, else gap.
  pure function basic_values(state) result(values)
    type(contact_state), intent(in) :: state   !! set and solution
    real(wp), allocatable :: values(:)

    values = state%gap
    values(state%pairs) = state%force(state%pairs)
  end function basic_values

  !> Test the fresh solution: its pairs restrain all modes; R >= 0 and w >= 0, up to the rounding of the
  !! largest force and gap.
  pure logical function has_right_signs(scaled, state, tolerance) result(right)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    type(contact_state), intent(in) :: state   !! set and solution
    real(wp), intent(in) :: tolerance   !! one of the above
    real(wp), allocatable :: terms(:)
    real(wp) :: force_tolerance, gap_noise, widest

    force_tolerance = tolerance*maxval([abs(state%force), 1.0_wp])
    gap_noise = cancelled*maxval([abs(scaled%gap), 0.0_wp])
    right = state%sound .and. all(state%force >= -force_tolerance)
    if (.not. right) return
    ! At pairs that hardly deform, a gap far below the others is a sign of a wrong force.
    terms = terms_of_gaps(scaled, state)
    widest = force_tolerance + gap_noise
    right = all(state%gap >= -max(scaled%softness*widest, min(widest, cancelled*terms)))
    if (.not. right .or. maxval([state%force, 0.0_wp]) <= 1.0_wp) return
    ! The largest force, at a rigid stop, does not count for gaps that it does not affect.
    right = all(state%gap >= -(tolerance*max(terms, 1.0_wp) + gap_noise))
  end function has_right_signs

  !> Sum of magnitudes of the terms of each gap.
  pure function terms_of_gaps(scaled, state) result(terms)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    type(contact_state), intent(in) :: state   !! set and solution
    real(wp), allocatable :: terms(:)

    terms = scaled%gap_terms + scaled%motion%times(state%approach, magnitudes=.true.) &
            + gaps_by_forces(scaled, state%change, magnitudes=.true.)
  end function terms_of_gaps
end module epcont_contact_state
