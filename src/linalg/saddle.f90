!> Factor of a symmetric matrix whose first n pivots are positive and the next m negative, as equations with
!> constraints have them (forces, then motions that these must hold), and of what comes below:
!>
!>     +---------+
!>     | K11     |  n           K = L diag(I, -I) L'
!>     +---------+---------+
!>     | K21     | K22     |  m
!>     +---------+---------+
!>     | K31     | K32     |  rows of what is eliminated later
!>     +---------+---------+
!>
!> Lower triangles, in an array that may be larger. K11 is definite, and K22 - K21 K11^-1 K21' is negatively
!> so, where it can be factored.
module epcont_linalg_saddle
  use epcont_base_kinds, only: wp
  use epcont_linalg_dense, only: extend_cholesky
  use epcont_linalg_lapack, only: dgemm, dpotrf, dsyrk, dtrsm
  implicit none
  private
  public :: factor_saddle, pass_on, substitute, substitute_back

contains

  !> Replace K by L.
  pure subroutine factor_saddle(lda, k, done, n, m, below, info)
    integer, intent(in) :: lda                  !! rows of the array
    real(wp), intent(inout) :: k(lda, *)        !! K, then L [lda, >= n + m]
    integer, intent(in) :: done                 !! of the first n rows so many hold L already
    integer, intent(in) :: n, m, below          !! rows of K11, K21 and K31
    integer, intent(out) :: info   !! 0, or the order of the first minor that is not of its sign

    call extend_cholesky(lda, k, done, n, info)
    if (info > 0 .or. m + below == 0) return
    if (n > 0) call dtrsm('R', 'L', 'T', 'N', m + below, n, 1.0_wp, k, lda, k(n + 1, 1), lda)
    if (m == 0) return
    call dsyrk('L', 'N', m, n, 1.0_wp, k(n + 1, 1), lda, -1.0_wp, k(n + 1, n + 1), lda)
    call dpotrf('L', m, k(n + 1, n + 1), lda, info)
    if (info > 0) then
      info = info + n
    else if (below > 0) then
      call dgemm('N', 'T', below, m, n, 1.0_wp, k(n + m + 1, 1), lda, k(n + 1, 1), lda, &
                 -1.0_wp, k(n + m + 1, n + 1), lda)
      call dtrsm('R', 'L', 'T', 'N', below, m, 1.0_wp, k(n + 1, n + 1), lda, k(n + m + 1, n + 1), lda)
    end if
  end subroutine factor_saddle

  !> Take from the first `rows` rows and columns of the matrix of what is eliminated later what the rows
  !! L31, L32 have of them.
  pure subroutine pass_on(lda, below, n, m, rows, ldb, later)
    integer, intent(in) :: lda, ldb             !! rows of the arrays
    real(wp), intent(in) :: below(lda, *)       !! from the row of L31 on [lda, n + m]
    integer, intent(in) :: n, m, rows           !! columns of L31 and L32, and their rows
    real(wp), intent(inout) :: later(ldb, *)    !! [ldb, >= rows]

    if (rows == 0) return
    if (n > 0) call dsyrk('L', 'N', rows, n, -1.0_wp, below, lda, 1.0_wp, later, ldb)
    if (m > 0) call dsyrk('L', 'N', rows, m, 1.0_wp, below(1, n + 1), lda, 1.0_wp, later, ldb)
  end subroutine pass_on

  !> First half of a solution: x = L^-1 x of the own rows, and the rows below less their part of that.
  pure subroutine substitute(lda, l, own, below, columns, ldx, x)
    integer, intent(in) :: lda, ldx             !! rows of the arrays
    real(wp), intent(in) :: l(lda, *)           !! from `factor_saddle`
    integer, intent(in) :: own, below           !! n + m, and the rows of L31
    integer, intent(in) :: columns              !! of x
    real(wp), intent(inout) :: x(ldx, *)        !! right-hand sides, from the own rows on

    if (own == 0 .or. columns == 0) return
    call dtrsm('L', 'L', 'N', 'N', own, columns, 1.0_wp, l, lda, x, ldx)
    if (below > 0) call dgemm('N', 'N', below, columns, own, -1.0_wp, l(own + 1, 1), lda, x, ldx, 1.0_wp, &
                              x(own + 1, 1), ldx)
  end subroutine substitute

  !> Second half: x = L'^-1 diag(I, -I) x of the own rows, once the rows below are solved; a solution then.
  pure subroutine substitute_back(lda, l, own, below, columns, ldx, x)
    integer, intent(in) :: lda, ldx             !! rows of the arrays
    real(wp), intent(in) :: l(lda, *)           !! from `factor_saddle`
    integer, intent(in) :: own(2), below        !! n and m, and the rows of L31
    integer, intent(in) :: columns              !! of x
    real(wp), intent(inout) :: x(ldx, *)        !! from the own rows on
    integer :: rows

    rows = sum(own)
    if (rows == 0 .or. columns == 0) return
    x(own(1) + 1:rows, :columns) = -x(own(1) + 1:rows, :columns)
    if (below > 0) call dgemm('T', 'N', rows, columns, below, -1.0_wp, l(rows + 1, 1), lda, &
                              x(rows + 1, 1), ldx, 1.0_wp, x, ldx)
    call dtrsm('L', 'L', 'T', 'N', rows, columns, 1.0_wp, l, lda, x, ldx)
  end subroutine substitute_back
end module epcont_linalg_saddle
