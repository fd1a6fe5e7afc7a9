!> How far the entering variable can grow, and which basic variable stops it.
module epcont_contact_ratio_test
  use epcont_base_kinds, only: wp
  use epcont_contact_scaling, only: negligible
  use epcont_contact_tableau, only: column_of, contact_tableau, load_factor, row_of
  implicit none
  private
  public :: step_type, test_ratios

  type :: step_type
    integer :: row = 0                   !! of the variable that becomes zero first; 0: none does
    real(wp) :: ratio = huge(1.0_wp)     !! increase of the entering variable until then
    real(wp) :: load_rate = 0.0_wp       !! increase of the load factor with the entering variable
    real(wp) :: full_load = huge(1.0_wp) !! increase of the entering variable until the load factor is 1
  end type step_type

contains

  pure function test_ratios(tableau, column) result(step)
    type(contact_tableau), intent(in) :: tableau
    integer, intent(in) :: column   !! of the entering variable
    type(step_type) :: step
    logical, allocatable :: blocking(:), tied(:)
    real(wp), allocatable :: ratio(:)
    real(wp) :: zero

    zero = zero_of_column(tableau, column)
    call test_load(tableau, column, zero, step)
    blocking = tableau%entry(:, column) < -zero .and. tableau%basic /= load_factor
    if (.not. any(blocking)) return
    allocate (ratio(size(blocking)), source=huge(1.0_wp))
    where (blocking) ratio = max(tableau%value, 0.0_wp)/(-tableau%entry(:, column))
    step%ratio = minval(ratio)
    tied = ratio <= step%ratio + negligible*max(step%ratio, 1.0_wp)
    step%row = least_row(tableau, column, tied)
    step%ratio = ratio(step%row)
  end function test_ratios

  !> Entries up to this are zero. The load factor goes from 0 to 1, so its column is measured by 1.
  pure function zero_of_column(tableau, column) result(zero)
    type(contact_tableau), intent(in) :: tableau
    integer, intent(in) :: column
    real(wp) :: zero

    zero = negligible
    if (tableau%nonbasic(column) /= load_factor) zero = negligible*maxval(abs(tableau%entry(:, column)))
  end function zero_of_column

  !> Where the load is complete.
  pure subroutine test_load(tableau, column, zero, step)
    type(contact_tableau), intent(in) :: tableau
    integer, intent(in) :: column
    real(wp), intent(in) :: zero
    type(step_type), intent(inout) :: step
    integer :: row

    row = row_of(tableau, load_factor)
    if (row == 0) then
      if (tableau%nonbasic(column) /= load_factor) return
      step%load_rate = 1.0_wp
      step%full_load = 1.0_wp
    else if (tableau%entry(row, column) > zero) then
      step%load_rate = tableau%entry(row, column)
      step%full_load = max(1.0_wp - tableau%value(row), 0.0_wp)/step%load_rate
    end if
  end subroutine test_load

  !> The one of the tied rows that would block first if the basic variables of the start were larger by e, e^2, ...
  !> (lexicographic order). Without it ties could make the simplex go round in circles.
  pure function least_row(tableau, column, tied) result(row)
    type(contact_tableau), intent(in) :: tableau
    integer, intent(in) :: column
    logical, intent(in) :: tied(:)   !! [n]
    integer :: row
    integer, allocatable :: rows(:)
    real(wp), allocatable :: ratio(:)
    real(wp) :: least
    integer :: i, j

    rows = pack([(i, i=1, size(tied))], tied)
    do j = 1, size(tableau%first_basic)
      if (size(rows) == 1) exit
      ratio = perturbation(tableau, rows, tableau%first_basic(j))/(-tableau%entry(rows, column))
      least = minval(ratio)
      rows = pack(rows, ratio <= least + negligible*max(abs(least), 1.0_wp))
    end do
    row = rows(1)
  end function least_row

  !> Change of the basic variables in `rows` with the perturbation of a variable that was basic at the start.
  pure function perturbation(tableau, rows, variable) result(change)
    type(contact_tableau), intent(in) :: tableau
    integer, intent(in) :: rows(:), variable
    real(wp) :: change(size(rows))
    integer :: column

    column = column_of(tableau, variable)
    if (column > 0) then
      change = -tableau%entry(rows, column)
    else
      change = merge(1.0_wp, 0.0_wp, rows == row_of(tableau, variable))
    end if
  end function perturbation
end module epcont_contact_ratio_test
