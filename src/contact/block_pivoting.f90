!> Block principal pivoting: of a set of contacts all pairs that pull open, and of the others all that overlap
!> close, at once (Kostreva 1978; Judice and Pires 1994). It decides where rounding hides the set from the
!> simplex, whose path it does not follow: each set is solved by a factor of its own.
module epcont_contact_block_pivoting
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: new_basis
  use epcont_contact_scaling, only: scaled_problem
  use epcont_contact_state, only: contact_state, solve_set
  implicit none
  private
  public :: exchange_blocks

  !> Part of the largest force by which forces and gaps may have the wrong sign while there is something to
  !! gain; the test of the fresh solution decides.
  real(wp), parameter :: exchange_tolerance = 1.0e-13_wp
  !> Sets at most, and those without fewer wrong pairs before exchanges are given up.
  integer, parameter :: step_limit = 100, patience_limit = 10

contains

  !> Exchange pairs until none is wrong, or that leads nowhere. The exchanges are counted.
  subroutine exchange_blocks(scaled, closed, exchanged)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    logical, intent(inout) :: closed(:)          !! the first set, then the last [n]
    integer, intent(inout) :: exchanged          !! pairs so far
    type(contact_state) :: trial
    logical :: wrong(size(closed))
    integer :: fewest     ! wrong pairs, at best
    integer :: patience   ! steps left to come below it
    integer :: step

    fewest = huge(fewest)
    patience = patience_limit
    do step = 1, step_limit
      trial%contact_basis = new_basis(scaled, closed)
      if (.not. trial%sound) then
        if (all(closed .or. .not. scaled%first_touching)) return
        closed = closed .or. scaled%first_touching
        cycle
      end if
      call solve_set(trial, scaled, scaled%gap, scaled%resultant, refinements=0)
      wrong = wrong_pairs(scaled, trial, closed)
      patience = merge(patience_limit, patience - 1, count(wrong) < fewest)
      if (patience < 0 .or. .not. any(wrong)) return
      fewest = min(fewest, count(wrong))
      exchanged = exchanged + count(wrong)
      closed = closed .neqv. wrong
    end do
  end subroutine exchange_blocks

  !> Pairs of the set that pull, and others that overlap.
  pure function wrong_pairs(scaled, trial, closed) result(wrong)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(in) :: trial
    logical, intent(in) :: closed(:)
    logical :: wrong(size(closed))
    real(wp) :: force_tolerance, gap_tolerance

    force_tolerance = exchange_tolerance*maxval([abs(trial%force), 1.0_wp])
    gap_tolerance = force_tolerance + exchange_tolerance*maxval([abs(scaled%gap), 0.0_wp])
    wrong = merge(trial%force < -force_tolerance, trial%gap < -gap_tolerance, closed)
  end function wrong_pairs
end module epcont_contact_block_pivoting
