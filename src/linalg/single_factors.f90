!> The factors of epcont_linalg_factors with their entries in single precision: half of the memory and of the
!> time to factor them.
module epcont_linalg_single_factors
  use epcont_base_kinds, only: i8, rp => sp, wp
  use epcont_base_sorting, only: sorted_order
  use epcont_linalg_assembled, only: assembled_matrix, find_compliance, order_rows, probes, sparse_rows
  use epcont_linalg_front_layout, only: block_width, columns_along, front_layout, update_size
  use epcont_linalg_panel_layout, only: panel_layout
  use epcont_linalg_single_lapack, only: gemm => sgemm, gemv => sgemv, potrf => spotrf, syrk => ssyrk, &
      trsm => strsm
  use epcont_system_large_pages, only: use_large_pages, use_small_pages
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
end module epcont_linalg_single_factors
