!> Kinds of numbers.
module epcont_base_kinds
  use, intrinsic :: iso_fortran_env, only: int64, real64
  implicit none
  private
  public :: wp, i8, i16

  !> Working precision of all reals.
  integer, parameter :: wp = real64
  !> Long integer, for counts that may exceed 2**31 (operations, bytes, band entries).
  integer, parameter :: i8 = int64
  !> Integers of 38 digits, for writing reals as decimals.
  integer, parameter :: i16 = selected_int_kind(38)
end module epcont_base_kinds
