!> The fronts of epcont_linalg_front with their entries in single precision: half of the memory and of the
!> time to factor them.
module epcont_linalg_single_front
  use epcont_base_kinds, only: i8, rp => sp, wp
  use epcont_linalg_assembled, only: assembled_matrix, probes
  use epcont_linalg_front_layout, only: front_layout
  use epcont_linalg_lapack, only: gemm => sgemm, gemv => sgemv, potrf => spotrf, syrk => ssyrk, trsm => strsm
  use epcont_system_large_pages, only: use_large_pages
  implicit none
  private
  public :: front_matrix

  include 'blocks.inc'
  include 'front_kernel.inc'
  include 'blocks_kernel.inc'
end module epcont_linalg_single_front
