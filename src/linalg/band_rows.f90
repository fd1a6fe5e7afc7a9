!> R of A = QR for a matrix whose rows span few columns each: rows are rotated in one by one (Givens), and Q
!> is not kept. Null vectors have the accuracy of A itself, not that of A'A.
module epcont_linalg_band_rows
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: rotate_in, null_vectors

contains

  !> Rotate a row of A into R.
  pure subroutine rotate_in(r, first, row)
    real(wp), intent(inout) :: r(:, :)   !! r(1 + d, j): row j, column j + d [band, columns]
    integer, intent(in) :: first         !! column of the row's first entry
    real(wp), intent(in) :: row(:)       !! [band]
    real(wp), dimension(size(row)) :: left, old   ! remainder of the row, from column j on
    real(wp) :: c, s
    integer :: j

    left = row
    do j = first, size(r, 2)
      if (all(left == 0.0_wp)) return
      if (left(1) /= 0.0_wp) then
        c = r(1, j)/hypot(r(1, j), left(1))
        s = left(1)/hypot(r(1, j), left(1))
        old = r(:, j)
        r(:, j) = c*old + s*left
        left = c*left - s*old
      end if
      left = eoshift(left, 1)
    end do
  end subroutine rotate_in

  !> Find a basis of the x with A x = 0: vectors of length one. Columns that depend on those before have no
  !! pivot in R; the rest of their row is rotated into the rows below (Heath 1982).
  function null_vectors(r, tolerance) result(basis)
    real(wp), intent(inout) :: r(:, :)    !! of all rows of A [band, columns]
    real(wp), intent(in) :: tolerance     !! a pivot of at most this is zero
    real(wp), allocatable :: basis(:, :)  !! [columns, any]
    integer, allocatable :: free(:)
    real(wp) :: rest(size(r, 1))
    integer :: i, j, last

    free = [integer ::]
    do j = 1, size(r, 2)
      if (abs(r(1, j)) > tolerance) cycle
      free = [free, j]
      rest = eoshift(r(:, j), 1)
      r(:, j) = 0.0_wp
      call rotate_in(r, j + 1, rest)
    end do
    allocate (basis(size(r, 2), size(free)), source=0.0_wp)
    do j = 1, size(free)
      associate (x => basis(:, j))
        x(free(j)) = 1.0_wp
        do i = free(j) - 1, 1, -1
          if (r(1, i) == 0.0_wp) cycle
          last = min(size(r, 1), free(j) - i + 1)
          x(i) = -dot_product(r(2:last, i), x(i + 1:i + last - 1))/r(1, i)
        end do
        x = x/norm2(x)
      end associate
    end do
  end function null_vectors
end module epcont_linalg_band_rows
