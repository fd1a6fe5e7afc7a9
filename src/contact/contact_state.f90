!> A set of contacts with its solution at full load, fresh from F and A, and the test of its signs.
module epcont_contact_contact_state
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: basic_solution, contact_basis, new_basis
  use epcont_contact_scaling, only: scaled_problem
  implicit none
  private
  public :: contact_state, fresh_state, basic_values, has_right_signs, terms_of_gaps

  !> Part of the largest force by which forces and gaps may have the wrong sign, in scaled units: all that can be asked where
  !! the flexibility is badly conditioned, and what is asked of a guess, from which better sets may be found.
  real(wp), parameter, public :: sign_tolerance = 1.0e-10_wp, guess_tolerance = 1.0e-12_wp
  !> Part of a quantity that rounding leaves where it should cancel.
  real(wp), parameter, public :: noise = 100*epsilon(1.0_wp)

  !> Without forces where the basis is not sound.
  type :: contact_state
    type(contact_basis) :: basis
    real(wp), allocatable :: force(:), gap(:)   !! [n]
    real(wp), allocatable :: approach(:)        !! [m]
  end type contact_state

contains

  !> Forces, gaps and motions of a set of contacts, from F and A.
  pure function fresh_state(scaled, closed, first_touching) result(state)
    type(scaled_problem), intent(in) :: scaled
    logical, intent(in) :: closed(:)
    logical, intent(in) :: first_touching(:)   !! pairs that hold every motion, should `closed` not do so
    type(contact_state) :: state

    state%basis = new_basis(scaled, closed)
    if (.not. state%basis%sound) state%basis = new_basis(scaled, closed .or. first_touching)
    if (state%basis%sound) then
      call basic_solution(state%basis, scaled, scaled%gap, scaled%resultant, state%force, state%gap, state%approach)
    else
      state%gap = scaled%gap
      allocate (state%force(size(scaled%gap)), state%approach(size(scaled%resultant)), source=0.0_wp)
    end if
  end function fresh_state

  !> The basic variable of each pair: force where it is in the basis, gap elsewhere.
  pure function basic_values(state) result(values)
    type(contact_state), intent(in) :: state
    real(wp), allocatable :: values(:)

    values = state%gap
    values(state%basis%pairs) = state%force(state%basis%pairs)
  end function basic_values

  !> The test of the fresh solution: its pairs hold every motion; R >= 0 and w >= 0, to the rounding of the largest force and gap.
  pure function has_right_signs(scaled, state, tolerance) result(right)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(in) :: state
    real(wp), intent(in) :: tolerance   !! one of the above
    logical :: right
    real(wp) :: force_tolerance, gap_noise

    force_tolerance = tolerance*maxval([abs(state%force), 1.0_wp])
    gap_noise = noise*maxval([abs(scaled%gap), 0.0_wp])
    right = state%basis%sound .and. all(state%force >= -force_tolerance) .and. all(state%gap >= -(force_tolerance + gap_noise))
    if (.not. right .or. maxval([state%force, 0.0_wp]) <= 1.0_wp) return
    ! The largest force, at a stop that hardly gives way, says nothing of gaps that it has no part in.
    right = all(state%gap >= -(tolerance*max(terms_of_gaps(scaled, state), 1.0_wp) + gap_noise))
  end function has_right_signs

  !> The sum of the magnitudes that each gap is the sum of.
  pure function terms_of_gaps(scaled, state) result(terms)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(in) :: state
    real(wp), allocatable :: terms(:)
    integer :: k

    terms = scaled%gap_terms + matmul(abs(scaled%motion), abs(state%approach))
    do k = 1, size(state%force)
      if (state%force(k) /= 0.0_wp) terms = terms + abs(state%force(k)*scaled%flexibility(:, k))
    end do
  end function terms_of_gaps
end module epcont_contact_contact_state
