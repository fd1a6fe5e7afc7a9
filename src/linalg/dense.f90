!> Dense matrices: a thin wrapper for each LAPACK routine, which also accepts empty matrices.
!>
!> Factors are lower triangles. `info` and `rank` are returned unchanged: the caller says whether a singular
!> matrix is an error.
module epcont_linalg_dense
  use epcont_base_kinds, only: wp
  use epcont_linalg_lapack, only: dgemm, dgesvd, dgetrf, dgetrs, dpotrf, dpotrs, dpstrf, dsyrk, dtrsm
  implicit none
  private
  public :: cholesky_factor, cholesky_solve
  public :: factor_saddle, solve_saddle
  public :: lu_factor, lu_substitute, lu_solve, pivoted_cholesky, add_product, null_space

contains

  !> Replace the lower triangle of `a` by its Cholesky factor L, a = LL'.
  pure subroutine cholesky_factor(a, info)
    real(wp), contiguous, intent(inout) :: a(:, :)   !! symmetric [n, n]
    integer, intent(out) :: info          !! 0, or the order of the first minor that is not positive

    info = 0
    if (size(a) > 0) call dpotrf('L', size(a, 1), a, size(a, 1), info)
  end subroutine cholesky_factor

  !> Replace each column of `b` by the solution of LL'x = b, L being the leading rows of `factor`.
  pure subroutine cholesky_solve(factor, b)
    !> From `cholesky_factor` [>= n, >= n]
    real(wp), contiguous, intent(in) :: factor(:, :)
    real(wp), contiguous, intent(inout) :: b(:, :)    !! right-hand sides, then solutions [n, k]
    integer :: info

    if (size(b) > 0) call dpotrs('L', size(b, 1), size(b, 2), factor, size(factor, 1), b, size(b, 1), info)
  end subroutine cholesky_solve

  !> Cholesky factor of a semidefinite matrix, largest pivot first: a(order, order) = LL' to rounding.
  pure subroutine pivoted_cholesky(a, tolerance, order, rank)
    real(wp), contiguous, intent(inout) :: a(:, :)    !! symmetric, then L in its first `rank` columns [n, n]
    real(wp), intent(in) :: tolerance     !! a pivot of at most this is zero, in the unit of `a`
    integer, allocatable, intent(out) :: order(:)     !! rows in the order of their pivots [n]
    integer, intent(out) :: rank          !! number of pivots above `tolerance`
    real(wp), allocatable :: work(:)
    integer :: info, k, n

    n = size(a, 1)
    order = [(k, k=1, n)]
    rank = 0
    if (n == 0) return
    ! dpstrf does not compare its first pivot with the tolerance.
    if (.not. any([(a(k, k) > tolerance, k=1, n)])) return
    allocate (work(2*n))
    call dpstrf('L', n, a, n, order, rank, tolerance, work, info)
  end subroutine pivoted_cholesky

  !> Replace a matrix by its LU factors.
  pure subroutine lu_factor(a, pivots, info)
    real(wp), contiguous, intent(inout) :: a(:, :)    !! [n, n]
    integer, intent(out) :: pivots(size(a, 1))        !! exchanged rows [n]
    integer, intent(out) :: info   !! 0, or the first pivot that is exactly zero

    info = 0
    if (size(a) > 0) call dgetrf(size(a, 1), size(a, 1), a, size(a, 1), pivots, info)
  end subroutine lu_factor

  !> Replace each column of `b` by the solution of a x = b.
  pure subroutine lu_substitute(factor, pivots, b)
    real(wp), contiguous, intent(in) :: factor(:, :)  !! from `lu_factor` [n, n]
    integer, intent(in) :: pivots(:)                  !! [n]
    real(wp), contiguous, intent(inout) :: b(:, :)    !! right-hand sides, then solutions [n, k]
    integer :: info

    if (size(b) > 0) &
      call dgetrs('N', size(b, 1), size(b, 2), factor, size(factor, 1), pivots, b, size(b, 1), info)
  end subroutine lu_substitute

  !> Solve a x = b; `a` is overwritten by its LU factors.
  pure subroutine lu_solve(a, b, info)
    real(wp), contiguous, intent(inout) :: a(:, :)    !! [n, n]
    real(wp), contiguous, intent(inout) :: b(:, :)    !! right-hand sides, then solutions [n, k]
    integer, intent(out) :: info   !! 0, or the first pivot that is exactly zero (`b` is then untouched)
    integer :: pivots(size(a, 1))

    call lu_factor(a, pivots, info)
    if (info == 0) call lu_substitute(a, pivots, b)
  end subroutine lu_solve

  !> c = c + factor a b.
  pure subroutine add_product(factor, a, b, c)
    real(wp), intent(in) :: factor   !! factor of the product
    real(wp), contiguous, intent(in) :: a(:, :)       !! [n, k]
    real(wp), contiguous, intent(in) :: b(:, :)       !! [k, m]
    real(wp), contiguous, intent(inout) :: c(:, :)    !! [n, m]

    if (size(a) == 0 .or. size(b) == 0) return
    call dgemm('N', 'N', size(c, 1), size(c, 2), size(a, 2), factor, a, size(a, 1), b, size(b, 1), &
               1.0_wp, c, size(c, 1))
  end subroutine add_product

  !> Orthonormal basis of the x with a x = 0.
  pure function null_space(a, tolerance) result(basis)
    real(wp), intent(in) :: a(:, :)       !! [n, m]
    real(wp), intent(in) :: tolerance     !! a singular value of at most this is zero, in the unit of `a`
    real(wp), allocatable :: basis(:, :)  !! [m, m - rank]
    real(wp), allocatable :: copy(:, :), values(:), right(:, :), work(:)
    real(wp) :: left(1, 1)
    integer :: info, k, m, n

    m = size(a, 2)
    n = max(size(a, 1), m)
    ! Rows of zeros change nothing and make the matrix at least as tall as wide.
    allocate (copy(n, m), values(m), right(m, m), work(16*(n + m)))
    copy = 0.0_wp
    copy(:size(a, 1), :) = a
    info = 0
    if (m > 0) call dgesvd('N', 'A', n, m, copy, n, values, left, 1, right, m, work, size(work), info)
    if (info /= 0) values = 0.0_wp
    basis = transpose(right(pack([(k, k=1, m)], values <= tolerance), :))
  end function null_space

  !> Factor a symmetric matrix whose first n pivots are positive and the next m negative (forces, then modes
  !! that they restrain): K = L diag(I, -I) L', lower triangles. K11 is definite; K22 - K21 K11^-1 K21' must
  !! be negative definite.
  pure subroutine factor_saddle(lda, k, n, info)
    integer, intent(in) :: lda                 !! rows of K, n + m
    real(wp), intent(inout) :: k(lda, lda)     !! K, then L
    integer, intent(in) :: n                   !! rows of K11
    integer, intent(out) :: info   !! 0, or the order of the first minor with a wrong sign
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

  !> Solve K x = b with the factor of `factor_saddle`.
  pure subroutine solve_saddle(l, n, x)
    real(wp), contiguous, intent(in) :: l(:, :)      !! from `factor_saddle`
    integer, intent(in) :: n                         !! rows of K11
    real(wp), contiguous, intent(inout) :: x(:, :)   !! b, then x [n + m, any]

    if (size(x) == 0) return
    call dtrsm('L', 'L', 'N', 'N', size(l, 1), size(x, 2), 1.0_wp, l, size(l, 1), x, size(x, 1))
    x(n + 1:, :) = -x(n + 1:, :)
    call dtrsm('L', 'L', 'T', 'N', size(l, 1), size(x, 2), 1.0_wp, l, size(l, 1), x, size(x, 1))
  end subroutine solve_saddle
end module epcont_linalg_dense
