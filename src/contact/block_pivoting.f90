!> Block principal pivoting: all pairs in contact whose force is beyond a bound take this bound, and all other
!> pairs whose gap has the wrong sign close, in one step (Kostreva 1978; Judice and Pires 1994). It is used if
!> rounding misleads the simplex, as it does not follow a path: each active set is solved with its own
!> factor.
module epcont_contact_block_pivoting
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: new_basis
  use epcont_contact_scaling, only: active_set, scaled_problem
  use epcont_contact_state, only: contact_state, inner_forces, signed_gaps, solve_set
  implicit none
  private
  public :: exchange_blocks

  !> Forces and gaps may have the wrong sign up to this fraction of the largest force while sets are
  !! exchanged; the test of the fresh solution decides.
  real(wp), parameter :: exchange_tolerance = 1.0e-13_wp
  !> Maximum number of sets, and of sets without fewer wrong pairs.
  integer, parameter :: step_limit = 100, patience_limit = 10

contains

  !> Exchange pairs until no pair is wrong or there is no progress. Count the exchanges.
  subroutine exchange_blocks(scaled, set, exchanged)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    type(active_set), intent(inout) :: set       !! first set, then last set
    integer, intent(inout) :: exchanged          !! number of pairs so far
    type(contact_state) :: trial
    logical :: wrong(size(set%closed))
    integer :: fewest     ! least number of wrong pairs
    integer :: patience   ! steps left to find fewer
    integer :: step

    fewest = huge(fewest)
    patience = patience_limit
    do step = 1, step_limit
      trial%contact_basis = new_basis(scaled, set%closed)
      if (.not. trial%sound) then
        if (all(set%closed .or. .not. scaled%first%closed)) return
        set%closed = set%closed .or. scaled%first%closed
        cycle
      end if
      trial%at_upper = set%at_upper .and. .not. set%closed
      call solve_set(trial, scaled, scaled%gap, scaled%resultant, refinements=0)
      wrong = wrong_pairs(scaled, trial, set%closed)
      patience = merge(patience_limit, patience - 1, count(wrong) < fewest)
      if (patience < 0 .or. .not. any(wrong)) return
      fewest = min(fewest, count(wrong))
      exchanged = exchanged + count(wrong)
      set%at_upper = merge(trial%force > 0.5_wp*scaled%upper, trial%at_upper, wrong .and. set%closed)
      set%closed = set%closed .neqv. wrong
    end do
  end subroutine exchange_blocks

  !> Find pairs of the set whose force is beyond a bound, and others whose gap has the wrong sign.
  pure function wrong_pairs(scaled, trial, closed) result(wrong)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(in) :: trial
    logical, intent(in) :: closed(:)
    logical :: wrong(size(closed))
    real(wp) :: force_tolerance, gap_tolerance

    force_tolerance = exchange_tolerance*maxval([abs(trial%force), 1.0_wp])
    gap_tolerance = force_tolerance + exchange_tolerance*maxval([abs(scaled%gap), 0.0_wp])
    wrong = merge(.not. inner_forces(scaled, trial%force, -force_tolerance), &
                  signed_gaps(trial) < -gap_tolerance, closed)
  end function wrong_pairs
end module epcont_contact_block_pivoting
