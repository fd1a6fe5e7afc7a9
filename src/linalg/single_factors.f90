!> The factors of epcont_linalg_factors with their entries in single precision: half of the memory and of the
!> time to factor them.
module epcont_linalg_single_factors
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: i8, rp => sp, wp
  use epcont_base_sorting, only: sorted_order
  use epcont_linalg_assembled, only: assembled_matrix, find_compliance, order_rows, probes, sparse_rows
  use epcont_linalg_front_layout, only: block_width, columns_along, front_layout, update_size
  use epcont_linalg_panel_layout, only: panel_layout
  use epcont_linalg_single_lapack, only: gemm => sgemm, gemv => sgemv, potrf => spotrf, syrk => ssyrk, &
      trsm => strsm
  use epcont_system_large_pages, only: use_large_pages, use_small_pages
  use epcont_system_threads, only: use_one_thread_each
  !$ use omp_lib, only: omp_get_num_threads
  implicit none
  private
  public :: front_matrix, panel_matrix

  include 'blocks.inc'

contains

  include 'blocks_kernel.inc'
  include 'panel_kernel.inc'
  include 'columns_kernel.inc'
  include 'front_kernel.inc'
  include 'front_solve_kernel.inc'

  !> The first half of a solve. What is solved for has the size of 1, so that single precision has room for
  !! it.
  subroutine solve_lower(self, x)
    class(blocked_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)   !! [order, any]
    real(rp) :: y(size(x, 1), size(x, 2))
    real(wp) :: unit

    unit = power_of_two(maxval(abs(x)))
    y = real(x/unit, rp)
    call self%go_forwards(y)
    x = unit*real(y, wp)
  end subroutine solve_lower

  !> The second half.
  subroutine solve_upper(self, x, first)
    class(blocked_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)   !! [order, any]
    integer, intent(in) :: first                     !! row that is wanted
    real(rp) :: y(size(x, 1), size(x, 2))
    real(wp) :: unit

    unit = power_of_two(maxval(abs(x)))
    y = real(x/unit, rp)
    call self%go_back(y, first)
    x = unit*real(y, wp)
  end subroutine solve_upper

  !> A power of two near a size: dividing by it rounds nothing, and takes less than `scale` of each number.
  pure real(wp) function power_of_two(size)
    real(wp), intent(in) :: size
    integer, parameter :: highest = maxexponent(size) - 2

    power_of_two = scale(1.0_wp, min(highest, max(-highest, exponent(size))))
  end function power_of_two
end module epcont_linalg_single_factors
