!> Forward and backward substitution, compared with whole solves.
module solve_halves
  use epcont_base_kinds, only: wp
  use epcont_linalg_assembled, only: assembled_matrix, probes
  implicit none
  private
  public :: condition_of, error_of_halves

contains

  !> Two right-hand sides, the second zero except in the last rows, added after forward substitution; needed rows from each third:
  !! largest difference from the whole solve of their sum, relative to its largest value.
  function error_of_halves(matrix) result(error)
    class(assembled_matrix), intent(in) :: matrix   !! factored
    real(wp) :: error
    real(wp), dimension(matrix%order, 1) :: early, late, half, whole
    integer :: first, i, k, n

    n = matrix%order
    early(:, 1) = [(cos(real(i, wp)), i=1, n)]
    late(:, 1) = [(merge(sin(real(i, wp)), 0.0_wp, 3*i > 2*n), i=1, n)]
    whole = early + late
    call matrix%solve(whole)
    call matrix%solve_lower(early)
    call matrix%solve_lower(late)
    error = 0.0_wp
    do k = 0, 3
      first = 1 + k*n/3
      half = early + late
      call matrix%solve_upper(half, first)
      if (first <= n) error = max(error, maxval(abs(half(first:, 1) - whole(first:, 1)))/maxval(abs(whole)))
    end do
  end function error_of_halves

  !> The condition estimate.
  real(wp) function condition_of(matrix) result(condition)
    class(assembled_matrix), intent(in) :: matrix   !! factored
    real(wp) :: inverse_norm, x(matrix%order, 2)

    x = probes(matrix%order)
    call matrix%solve(x)
    inverse_norm = maxval(sum(abs(x), dim=1))
    x = sign(1.0_wp, x)
    call matrix%solve(x)
    condition = matrix%norm*max(inverse_norm, maxval(abs(x)))
  end function condition_of
end module solve_halves
