!> Block principal pivoting: all pairs in contact whose force is negative open, and all other pairs whose gap
!> is negative close, in one step (Kostreva 1978; Judice and Pires 1994). It is used if
!> rounding misleads the simplex, as it does not follow a path: each active set is solved with its own
!> factor.
module epcont_contact_block_pivoting
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: new_basis
  use epcont_contact_scaling, only: scaled_problem
  use epcont_contact_state, only: contact_state, solve_set
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
  subroutine exchange_blocks(scaled, closed, exchanged)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    logical, intent(inout) :: closed(:)          !! first set, then last set [n]
    integer, intent(inout) :: exchanged          !! number of pairs so far
    type(contact_state) :: trial
    logical :: wrong(size(closed))
    real(wp) :: least(size(closed))   ! force or gap that is only rounding
    integer :: fewest     ! least number of wrong pairs
    integer :: patience   ! steps left to find fewer
    integer :: step

    fewest = huge(fewest)
    patience = patience_limit
    do step = 1, step_limit
      trial%contact_basis = new_basis(scaled, closed)
      if (.not. trial%sound) then
        if (all(closed .or. .not. scaled%first)) return
        closed = closed .or. scaled%first
        cycle
      end if
      call solve_set(trial, scaled, scaled%gap, scaled%resultant, refinements=0)
      least = maxval([abs(trial%force), 1.0_wp])
      where (.not. closed) least = least + maxval([abs(scaled%gap), 0.0_wp])
      wrong = merge(trial%force, trial%gap, closed) < -exchange_tolerance*least
      patience = merge(patience_limit, patience - 1, count(wrong) < fewest)
      if (patience < 0 .or. .not. any(wrong)) return
      fewest = min(fewest, count(wrong))
      exchanged = exchanged + count(wrong)
      closed = closed .neqv. wrong
    end do
  end subroutine exchange_blocks
end module epcont_contact_block_pivoting
