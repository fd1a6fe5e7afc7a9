!> Explicit interfaces of the BLAS and LAPACK routines in use, so that the compiler checks every call.
!>
!> Arguments are those of the LAPACK Users' Guide. `info` < 0 is a fault of the caller, `info` > 0 a
!> property of the matrix.
module epcont_linalg_lapack
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: dgemm, dsyrk, dtrsm
  public :: dpotrf, dpotrs, dpstrf, dgetrf, dgetrs, dgesvd

  ! Products, and solution with a triangle
  interface
    !> C = alpha op(A) op(B) + beta C
    pure subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
      import :: wp
      character, intent(in) :: transa, transb
      integer, intent(in) :: m, n, k, lda, ldb, ldc
      real(wp), intent(in) :: alpha, beta, a(lda, *), b(ldb, *)
      real(wp), intent(inout) :: c(ldc, *)
    end subroutine dgemm

    !> C = alpha A A' + beta C (or A'A), one triangle of C
    pure subroutine dsyrk(uplo, trans, n, k, alpha, a, lda, beta, c, ldc)
      import :: wp
      character, intent(in) :: uplo, trans
      integer, intent(in) :: n, k, lda, ldc
      real(wp), intent(in) :: alpha, beta, a(lda, *)
      real(wp), intent(inout) :: c(ldc, *)
    end subroutine dsyrk

    !> op(A) X = alpha B or X op(A) = alpha B, A triangular; X replaces B
    pure subroutine dtrsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb)
      import :: wp
      character, intent(in) :: side, uplo, transa, diag
      integer, intent(in) :: m, n, lda, ldb
      real(wp), intent(in) :: alpha, a(lda, *)
      real(wp), intent(inout) :: b(ldb, *)
    end subroutine dtrsm
  end interface

  ! Symmetric positive definite matrices
  interface
    !> Cholesky factor
    pure subroutine dpotrf(uplo, n, a, lda, info)
      import :: wp
      character, intent(in) :: uplo
      integer, intent(in) :: n, lda
      real(wp), intent(inout) :: a(lda, *)
      integer, intent(out) :: info
    end subroutine dpotrf

    !> Solution with the factor of dpotrf
    pure subroutine dpotrs(uplo, n, nrhs, a, lda, b, ldb, info)
      import :: wp
      character, intent(in) :: uplo
      integer, intent(in) :: n, nrhs, lda, ldb
      real(wp), intent(in) :: a(lda, *)
      real(wp), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
    end subroutine dpotrs

    !> Cholesky factor of a semidefinite matrix with complete pivoting, P'AP = LL'
    pure subroutine dpstrf(uplo, n, a, lda, piv, rank, tol, work, info)
      import :: wp
      character, intent(in) :: uplo
      integer, intent(in) :: n, lda
      real(wp), intent(inout) :: a(lda, *)
      integer, intent(out) :: piv(*), rank, info
      real(wp), intent(in) :: tol
      real(wp), intent(out) :: work(*)
    end subroutine dpstrf
  end interface

  ! General matrices
  interface
    !> LU factors with row interchanges, which replace A
    pure subroutine dgetrf(m, n, a, lda, ipiv, info)
      import :: wp
      integer, intent(in) :: m, n, lda
      real(wp), intent(inout) :: a(lda, *)
      integer, intent(out) :: ipiv(*), info
    end subroutine dgetrf

    !> Solution with the factors of dgetrf
    pure subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
      import :: wp
      character, intent(in) :: trans
      integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
      real(wp), intent(in) :: a(lda, *)
      real(wp), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
    end subroutine dgetrs

    !> Singular values, descending, and singular vectors
    pure subroutine dgesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
      import :: wp
      character, intent(in) :: jobu, jobvt
      integer, intent(in) :: m, n, lda, ldu, ldvt, lwork
      real(wp), intent(inout) :: a(lda, *)
      real(wp), intent(out) :: s(*), u(ldu, *), vt(ldvt, *), work(*)
      integer, intent(out) :: info
    end subroutine dgesvd
  end interface
end module epcont_linalg_lapack
