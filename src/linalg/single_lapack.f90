!> Those of the routines of epcont_linalg_lapack that factors in single precision take.
module epcont_linalg_single_lapack
  use epcont_base_kinds, only: rp => sp
  implicit none
  private
  public :: sgemm, sgemv, ssyrk, strsm, spotrf

  include 'lapack_forms.inc'
  procedure(gemm) :: sgemm
  procedure(gemv) :: sgemv
  procedure(syrk) :: ssyrk
  procedure(trsm) :: strsm
  procedure(potrf) :: spotrf
end module epcont_linalg_single_lapack
