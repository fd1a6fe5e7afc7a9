!> Kinds of numbers used throughout.
module epcont_base_kinds
  use, intrinsic :: iso_fortran_env, only: int64, real32, real64
  implicit none
  private
  public :: wp, sp, i8

  !> Working precision of all reals.
  integer, parameter :: wp = real64
  !> Single precision, of factors that PARAM PRECIS asks for.
  integer, parameter :: sp = real32
  !> Long integer, for counts that outgrow 2**31 (operations, bytes, band entries).
  integer, parameter :: i8 = int64
end module epcont_base_kinds
