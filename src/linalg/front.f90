!> Symmetric positive definite matrices in fronts, by the multifrontal method: what `panel_matrix` does, for
!> large systems.
!>
!> The columns of front p are stored with the rows of its own equations and those that it reaches, one below
!> the other:
!>
!>     x .        own equations: x: stored, .: stored but above the diagonal, never read
!>     x x
!>     x x        the later equations that it reaches, close together however far apart they are in the matrix
!>     x x
!>
!> When they have been eliminated, what is left to the reached equations is a full matrix, which is passed on
!> to the parent. Where nested dissection has found the fronts, few operations are done, and all of them on
!> full matrices.
module epcont_linalg_front
  use epcont_base_kinds, only: i8, rp => wp, wp
  use epcont_linalg_assembled, only: assembled_matrix, probes
  use epcont_linalg_front_layout, only: front_layout
  use epcont_linalg_lapack, only: gemm => dgemm, gemv => dgemv, potrf => dpotrf, syrk => dsyrk, trsm => dtrsm
  use epcont_system_large_pages, only: use_large_pages
  implicit none
  private
  public :: front_matrix

  include 'blocks.inc'
  include 'front_kernel.inc'
  include 'blocks_kernel.inc'
end module epcont_linalg_front
