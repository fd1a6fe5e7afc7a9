!> Factor of a symmetric matrix whose first n pivots are positive and the next m negative, as equations with
!> constraints have them (forces, then motions that these must hold):
!>
!>     +---------+
!>     | K11     |  n           K = L diag(I, -I) L'
!>     +---------+---------+
!>     | K21     | K22     |  m
!>     +---------+---------+
!>
!> Lower triangles. K11 is definite, and K22 - K21 K11^-1 K21' is negatively so, where it can be factored.
module epcont_linalg_saddle
  use epcont_base_kinds, only: wp
  use epcont_linalg_lapack, only: dpotrf, dsyrk, dtrsm
  implicit none
  private
  public :: factor_saddle, solve_saddle

contains

  !> Replace K by L.
  pure subroutine factor_saddle(lda, k, n, info)
    integer, intent(in) :: lda                 !! rows of K, n + m
    real(wp), intent(inout) :: k(lda, lda)     !! K, then L
    integer, intent(in) :: n                   !! rows of K11
    integer, intent(out) :: info   !! 0, or the order of the first minor that is not of its sign
    integer :: m

    m = lda - n
    info = 0
    if (lda == 0) return
    if (n > 0) call dpotrf('L', n, k, lda, info)
    if (info > 0 .or. m == 0) return
    if (n > 0) call dtrsm('R', 'L', 'T', 'N', m, n, 1.0_wp, k, lda, k(n + 1, 1), lda)
    call dsyrk('L', 'N', m, n, 1.0_wp, k(n + 1, 1), lda, -1.0_wp, k(n + 1, n + 1), lda)
    call dpotrf('L', m, k(n + 1, n + 1), lda, info)
    if (info > 0) info = info + n
  end subroutine factor_saddle

  !> Solve K x = b.
  pure subroutine solve_saddle(l, n, x)
    real(wp), contiguous, intent(in) :: l(:, :)      !! from `factor_saddle`
    integer, intent(in) :: n                         !! rows of K11
    real(wp), contiguous, intent(inout) :: x(:, :)   !! b, then x [n + m, any]

    if (size(x) == 0) return
    call dtrsm('L', 'L', 'N', 'N', size(l, 1), size(x, 2), 1.0_wp, l, size(l, 1), x, size(x, 1))
    x(n + 1:, :) = -x(n + 1:, :)
    call dtrsm('L', 'L', 'T', 'N', size(l, 1), size(x, 2), 1.0_wp, l, size(l, 1), x, size(x, 1))
  end subroutine solve_saddle
end module epcont_linalg_saddle
