!> Symmetric positive definite matrices and their Cholesky factors, in panels of columns or in fronts.
module epcont_linalg_factors
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: i8, rp => wp, wp
  use epcont_base_sorting, only: sorted_order
  use epcont_linalg_assembled, only: assembled_matrix, find_compliance, order_rows, probes, sparse_rows
  use epcont_linalg_front_layout, only: block_width, columns_along, front_layout, update_size
  use epcont_linalg_lapack, only: gemm => dgemm, gemv => dgemv, potrf => dpotrf, syrk => dsyrk, trsm => dtrsm
  use epcont_linalg_panel_layout, only: panel_layout
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

  !> The first half of a solve, in place.
  subroutine solve_lower(self, x)
    class(blocked_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)   !! [order, any]

    call self%go_forwards(x)
  end subroutine solve_lower

  !> The second half, in place.
  subroutine solve_upper(self, x, first)
    class(blocked_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)   !! [order, any]
    integer, intent(in) :: first                     !! row that is wanted

    call self%go_back(x, first)
  end subroutine solve_upper
end module epcont_linalg_factors
