!> In the place of `mumps.f90` where the program is built without MUMPS: analysis always fails, so nothing after it is called.
module epcont_linalg_mumps_none
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_loc, c_null_char, c_ptr
  implicit none
  private
  public :: mumps_fault, mumps_analyse, mumps_factor, mumps_solve, mumps_inverse_entries, mumps_release

  character(kind=c_char, len=33), target :: reason = 'this epcont was built without it'//c_null_char

contains

  function mumps_fault() result(fault) bind(c, name='epcont_mumps_fault')
    type(c_ptr) :: fault

    fault = c_loc(reason)
  end function mumps_fault

  subroutine mumps_analyse(solver, order, start, row, blocks, first, megabytes) bind(c, name='epcont_mumps_analyse')
    type(c_ptr), intent(inout) :: solver
    integer(c_int), value, intent(in) :: order
    integer(c_int), intent(in) :: start(order + 1), row(*)
    integer(c_int), value, intent(in) :: blocks
    integer(c_int), intent(in) :: first(blocks + 1)
    integer(c_int), intent(out) :: megabytes

    megabytes = 0
  end subroutine mumps_analyse

  subroutine mumps_factor(solver, entries, a, smallest_ratio, info) bind(c, name='epcont_mumps_factor')
    type(c_ptr), value, intent(in) :: solver
    integer(c_int), value, intent(in) :: entries
    real(c_double), intent(in) :: a(entries)
    real(c_double), intent(out) :: smallest_ratio
    integer(c_int), intent(out) :: info

    smallest_ratio = 0.0_c_double
    info = -1
  end subroutine mumps_factor

  subroutine mumps_solve(solver, order, columns, x) bind(c, name='epcont_mumps_solve')
    type(c_ptr), value, intent(in) :: solver
    integer(c_int), value, intent(in) :: order, columns
    real(c_double), intent(inout) :: x(order*columns)
  end subroutine mumps_solve

  subroutine mumps_inverse_entries(solver, order, count, equation, packed) bind(c, name='epcont_mumps_inverse_entries')
    type(c_ptr), value, intent(in) :: solver
    integer(c_int), value, intent(in) :: order, count
    integer(c_int), intent(in) :: equation(count)
    real(c_double), intent(out) :: packed(count*(count + 1)/2)

    packed = 0.0_c_double
  end subroutine mumps_inverse_entries

  subroutine mumps_release(solver) bind(c, name='epcont_mumps_release')
    type(c_ptr), intent(inout) :: solver
  end subroutine mumps_release
end module epcont_linalg_mumps_none
