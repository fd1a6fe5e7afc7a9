!> Symmetric positive definite band matrices: Cholesky factor, solve, condition, trailing inverse.
!>
!> The lower triangle is stored by columns, as LAPACK has it: entry (i, j), j <= i <= j + w, stands in
!> entries(1 + i - j, j).
module epcont_linalg_band
  use epcont_base_kinds, only: wp
  use epcont_linalg_dense, only: cholesky_inverse
  use epcont_linalg_factored, only: factored_matrix
  use epcont_linalg_lapack, only: dpbtrf, dpbtrs
  implicit none
  private
  public :: band_matrix, new_band_matrix

  type, extends(factored_matrix) :: band_matrix
    integer :: half_bandwidth = 0
    real(wp), allocatable :: entries(:, :)  !! [half_bandwidth + 1, order]
  contains
    procedure :: factor
    procedure :: solve_upper
    procedure :: trailing_inverse
  end type band_matrix

contains

  !> A matrix of zeros.
  pure function new_band_matrix(order, half_bandwidth) result(matrix)
    integer, intent(in) :: order, half_bandwidth
    type(band_matrix) :: matrix

    matrix%order = order
    matrix%half_bandwidth = half_bandwidth
    allocate (matrix%entries(half_bandwidth + 1, order), source=0.0_wp)
  end function new_band_matrix

  !> Replace the matrix by its Cholesky factor. `dpbtrf` takes many singular matrices for definite, so the
  !! squared ratio of each pivot to its diagonal entry is returned as well.
  pure subroutine factor(self, smallest_ratio, at)
    class(band_matrix), intent(inout) :: self
    real(wp), intent(out) :: smallest_ratio  !! smallest pivot**2 / diagonal; 0 where the matrix is not definite
    integer, intent(out) :: at               !! its row
    real(wp), allocatable :: diagonal(:), row_sum(:)
    integer :: info, j, n, w

    n = self%order
    w = self%half_bandwidth
    smallest_ratio = 1.0_wp
    at = 0
    if (n == 0) return
    diagonal = self%entries(1, :)
    allocate (row_sum(n), source=0.0_wp)
    do j = 1, n
      associate (column => self%entries(:min(w + 1, n - j + 1), j))
        row_sum(j) = row_sum(j) + sum(abs(column))
        row_sum(j + 1:j + size(column) - 1) = row_sum(j + 1:j + size(column) - 1) + abs(column(2:))
      end associate
    end do
    self%norm = maxval(row_sum)
    call dpbtrf('L', n, w, self%entries, w + 1, info)
    if (info > 0) then
      smallest_ratio = 0.0_wp
      at = info
      return
    end if
    at = minloc(self%entries(1, :)**2/diagonal, dim=1)
    smallest_ratio = self%entries(1, at)**2/diagonal(at)
  end subroutine factor

  !> Both halves of a solve.
  pure subroutine solve_upper(self, x, first)
    class(band_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)  !! right-hand sides, then solutions [order, any]
    integer, intent(in) :: first                    !! all rows are solved for
    integer :: info

    if (size(x) == 0) return
    call dpbtrs('L', self%order, self%half_bandwidth, size(x, 2), self%entries, self%half_bandwidth + 1, &
                x, self%order, info)
  end subroutine solve_upper

  !> Trailing block of the inverse, from the factor: with L22 the trailing block of the factor it is
  !! (L22 L22')^-1, since all that stands before has been eliminated from it.
  pure function trailing_inverse(self, count) result(inverse)
    class(band_matrix), intent(in) :: self
    integer, intent(in) :: count              !! rows and columns wanted
    real(wp), allocatable :: inverse(:, :)    !! full symmetric [count, count]
    integer :: j, length, first

    allocate (inverse(count, count), source=0.0_wp)
    if (count == 0) return
    first = self%order - count
    do j = 1, count
      length = min(self%half_bandwidth + 1, count - j + 1)
      inverse(j:j + length - 1, j) = self%entries(:length, first + j)
    end do
    call cholesky_inverse(inverse)
  end function trailing_inverse
end module epcont_linalg_band
