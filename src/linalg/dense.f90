!> Dense matrices: one thin wrapper a LAPACK routine, empty matrices included.
!>
!> Factors are lower triangles. `info` and `rank` are handed back as they are: whether a singular matrix
!> is a fault is for the caller to say, in the words of the problem.
module epcont_linalg_dense
  use epcont_base_kinds, only: wp
  use epcont_linalg_lapack, only: dgemm, dgesv, dgesvd, dpotrf, dpotri, dpotrs, dpstrf
  implicit none
  private
  public :: cholesky_factor, cholesky_inverse, cholesky_solve
  public :: lu_solve, pivoted_cholesky, add_inner_products, add_product, null_space

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

  !> Replace a Cholesky factor L by the inverse of LL'.
  pure subroutine cholesky_inverse(a)
    real(wp), contiguous, intent(inout) :: a(:, :)   !! lower triangle: L, then the inverse [n, n]
    integer :: info

    if (size(a) > 0) call dpotri('L', size(a, 1), a, size(a, 1), info)
  end subroutine cholesky_inverse

  !> Cholesky factor of a semidefinite matrix, largest pivot first: a(order, order) = LL' to rounding.
  pure subroutine pivoted_cholesky(a, tolerance, order, rank)
    real(wp), contiguous, intent(inout) :: a(:, :)    !! symmetric, then L in its first `rank` columns [n, n]
    real(wp), intent(in) :: tolerance     !! a pivot up to this is zero, in the unit of `a`
    integer, allocatable, intent(out) :: order(:)     !! rows in the order of their pivots [n]
    integer, intent(out) :: rank          !! number of pivots beyond `tolerance`
    real(wp), allocatable :: work(:)
    integer :: info, k, n

    n = size(a, 1)
    order = [(k, k=1, n)]
    rank = 0
    if (n == 0) return
    ! dpstrf takes its first pivot without looking at the tolerance.
    if (.not. any([(a(k, k) > tolerance, k=1, n)])) return
    allocate (work(2*n))
    call dpstrf('L', n, a, n, order, rank, tolerance, work, info)
  end subroutine pivoted_cholesky

  !> Solve a x = b; `a` is overwritten by its LU factors.
  pure subroutine lu_solve(a, b, info)
    real(wp), contiguous, intent(inout) :: a(:, :)    !! [n, n]
    real(wp), contiguous, intent(inout) :: b(:, :)    !! right-hand sides, then solutions [n, k]
    integer, intent(out) :: info   !! 0, or the first pivot that is exactly zero (`b` is then untouched)
    integer :: pivots(size(a, 1))

    info = 0
    if (size(a) > 0) call dgesv(size(a, 1), size(b, 2), a, size(a, 1), pivots, b, size(a, 1), info)
  end subroutine lu_solve

  !> c = c + factor a b.
  pure subroutine add_product(factor, a, b, c)
    real(wp), intent(in) :: factor   !! of the product
    real(wp), contiguous, intent(in) :: a(:, :)       !! [n, k]
    real(wp), contiguous, intent(in) :: b(:, :)       !! [k, m]
    real(wp), contiguous, intent(inout) :: c(:, :)    !! [n, m]

    if (size(a) == 0 .or. size(b) == 0) return
    call dgemm('N', 'N', size(c, 1), size(c, 2), size(a, 2), factor, a, size(a, 1), b, size(b, 1), &
               1.0_wp, c, size(c, 1))
  end subroutine add_product

  !> c = c + a' b, of the leading rows of both.
  pure subroutine add_inner_products(rows, a, b, c)
    integer, intent(in) :: rows                       !! that count
    real(wp), contiguous, intent(in) :: a(:, :)       !! [>= rows, n]
    real(wp), contiguous, intent(in) :: b(:, :)       !! [>= rows, m]
    real(wp), contiguous, intent(inout) :: c(:, :)    !! [n, m]

    if (rows == 0 .or. size(a) == 0 .or. size(b) == 0) return
    call dgemm('T', 'N', size(c, 1), size(c, 2), rows, 1.0_wp, a, size(a, 1), b, size(b, 1), &
               1.0_wp, c, size(c, 1))
  end subroutine add_inner_products

  !> Orthonormal basis of the x with a x = 0.
  pure function null_space(a, tolerance) result(basis)
    real(wp), intent(in) :: a(:, :)       !! [n, m]
    real(wp), intent(in) :: tolerance     !! a singular value up to this is zero, in the unit of `a`
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
end module epcont_linalg_dense
