!> Routines of LAPACK for comparison: a plain band's factor, eigenvalues.
module lapack_checks
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: dsyev, solve_band

  interface
    !> Eigenvalues, ascending, and eigenvectors of a symmetric matrix
    pure subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
      import :: wp
      character(len=1), intent(in) :: jobz, uplo
      integer, intent(in) :: n, lda, lwork
      real(wp), intent(inout) :: a(lda, *)
      real(wp), intent(out) :: w(*), work(*)
      integer, intent(out) :: info
    end subroutine dsyev

    !> Cholesky factor of a band matrix
    pure subroutine dpbtrf(uplo, n, kd, ab, ldab, info)
      import :: wp
      character(len=1), intent(in) :: uplo
      integer, intent(in) :: n, kd, ldab
      real(wp), intent(inout) :: ab(ldab, *)
      integer, intent(out) :: info
    end subroutine dpbtrf

    !> Solution with the factor of dpbtrf
    pure subroutine dpbtrs(uplo, n, kd, nrhs, ab, ldab, b, ldb, info)
      import :: wp
      character(len=1), intent(in) :: uplo
      integer, intent(in) :: n, kd, nrhs, ldab, ldb
      real(wp), intent(in) :: ab(ldab, *)
      real(wp), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
    end subroutine dpbtrs
  end interface

contains

  !> Solve by a plain band's Cholesky factor; the smallest pivot**2 over its diagonal entry, and its position.
  subroutine solve_band(full, w, x, smallest, at)
    real(wp), intent(in) :: full(:, :)       !! symmetric, definite [n, n]
    integer, intent(in) :: w                 !! half-bandwidth
    real(wp), intent(inout) :: x(:, :)       !! right-hand sides, then solutions [n, any]
    real(wp), intent(out) :: smallest
    integer, intent(out) :: at
    real(wp) :: band(w + 1, size(full, 1)), ratio(size(full, 1))
    integer :: info, j, n

    n = size(full, 1)
    band = 0.0_wp
    do j = 1, n
      band(:min(w + 1, n - j + 1), j) = full(j:min(n, j + w), j)
    end do
    ratio = band(1, :)
    call dpbtrf('L', n, w, band, w + 1, info)
    if (info /= 0) error stop 'not definite'
    ratio = band(1, :)**2/ratio
    at = minloc(ratio, dim=1)
    smallest = ratio(at)
    call dpbtrs('L', n, w, size(x, 2), band, w + 1, x, n, info)
  end subroutine solve_band
end module lapack_checks
