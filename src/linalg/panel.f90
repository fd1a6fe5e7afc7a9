!> Symmetric positive definite matrices in panels of columns, each with its own height: blocked variable-band
!> Cholesky.
!>
!> The lower triangle is stored panel by panel: panel p has the columns first(p) to first(p+1)-1, and for all
!> of them the rows from first(p) to last(p), column by column from entries(start(p)) on. The last rows never
!> go back where panels overlap, so the factor fills what is stored and nothing else:
!>
!>     x .        x: stored, .: stored but above the diagonal, never read
!>     x x
!>     x x x .    Of a plain band all panels have the height of the highest; here that of their own:
!>         x x    about half the operations on graded meshes.
!>         x x
module epcont_linalg_panel
  use epcont_base_kinds, only: i8, rp => wp, wp
  use epcont_base_sorting, only: sorted_order
  use epcont_linalg_assembled, only: add_last => add_compliance, assembled_matrix, probes, sparse_rows
  use epcont_linalg_lapack, only: gemm => dgemm, gemv => dgemv, potrf => dpotrf, syrk => dsyrk, trsm => dtrsm
  use epcont_linalg_panel_layout, only: panel_layout
  use epcont_system_large_pages, only: use_large_pages
  implicit none
  private
  public :: panel_matrix

  include 'blocks.inc'
  include 'panel_kernel.inc'
  include 'blocks_kernel.inc'
end module epcont_linalg_panel
