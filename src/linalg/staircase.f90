!> Right-hand sides that begin at ascending rows, and their products. Zeros before these rows are left out, so
!> L^-1 B and its product with itself take a third of the operations each, together as many as the inverse of
!> LL'.
!>
!>     x
!>     x x
!>     x x x        a block of columns begins at the first row of its first column
!>     x x x x
module epcont_linalg_staircase
  use epcont_base_kinds, only: wp
  use epcont_linalg_lapack, only: dgemm, dtrsm
  implicit none
  private
  public :: solve_staircase, multiply_staircase

  !> Columns of a block: with fewer the products are slow, with more no zeros are left out (the same time from
  !! 64 to 192, for 500 to 3 000 columns).
  integer, parameter :: width = 96

contains

  !> Replace X by L^-1 X.
  pure subroutine solve_staircase(n, l, begins, x)
    integer, intent(in) :: n             !! rows
    real(wp), intent(in) :: l(n, n)      !! lower triangle
    integer, intent(in) :: begins(:)     !! first row of each column, ascending, at most n + 1
    real(wp), intent(inout) :: x(n, *)   !! [n, columns]
    integer :: columns, first

    do first = 1, size(begins), width
      columns = min(width, size(begins) - first + 1)
      associate (b => begins(first))
        if (b <= n) call dtrsm('L', 'L', 'N', 'N', n - b + 1, columns, 1.0_wp, l(b, b), n, x(b, first), n)
      end associate
    end do
  end subroutine solve_staircase

  !> Compute X'X, with its columns in another order.
  pure subroutine multiply_staircase(n, x, begins, place, product)
    integer, intent(in) :: n             !! rows
    real(wp), intent(in) :: x(n, *)      !! [n, columns]
    integer, intent(in) :: begins(:)     !! first row of each column, ascending, at most n + 1
    integer, intent(in) :: place(:)      !! position of each column in the product
    real(wp), intent(out) :: product(:, :)   !! lower triangle, zeros above it [columns, columns]
    real(wp), allocatable :: rows(:, :)  ! of the product, columns from the first on
    integer :: first, i, j, last

    product = 0.0_wp
    allocate (rows(width, size(begins)))
    do first = 1, size(begins), width
      last = min(first + width - 1, size(begins))
      associate (b => begins(first))
        if (b > n) exit
        call dgemm('T', 'N', last - first + 1, last, n - b + 1, 1.0_wp, x(b, first), n, x(b, 1), n, 0.0_wp, &
                   rows, width)
      end associate
      do j = 1, last
        do i = max(first, j), last
          product(max(place(i), place(j)), min(place(i), place(j))) = rows(i - first + 1, j)
        end do
      end do
    end do
  end subroutine multiply_staircase
end module epcont_linalg_staircase
