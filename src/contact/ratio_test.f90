!> How far the entering variable can grow, and which basic variable stops it.
module epcont_contact_ratio_test
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: negligible
  use epcont_contact_tableau, only: contact_tableau, entries_of_column, entries_of_rows, load_factor
  implicit none
  private
  public :: step_type, test_ratios

  type :: step_type
    integer :: row = 0                   !! of the variable that becomes zero first; 0: none does
    real(wp) :: ratio = huge(1.0_wp)     !! increase of the entering variable until then
    real(wp) :: load_rate = 0.0_wp       !! increase of the load factor with the entering variable
    real(wp) :: full_load = huge(1.0_wp) !! increase of the entering variable until the load factor is 1
    real(wp), allocatable :: slope(:)    !! change of the basic variables with the entering one [n]
  end type step_type

contains

  !> How far the variable of a column can grow.
  pure type(step_type) function test_ratios(tableau, column) result(step)
    type(contact_tableau), intent(in) :: tableau   !! as it stands
    integer, intent(in) :: column   !! of the entering variable
    logical, allocatable :: blocking(:), tied(:)
    real(wp), allocatable :: ratio(:)

    step%slope = entries_of_column(tableau, column)
    call test_load(tableau, column, step)
    blocking = step%slope < -negligible .and. tableau%basic /= load_factor
    if (.not. any(blocking)) return
    allocate (ratio(size(blocking)), source=huge(1.0_wp))
    where (blocking) ratio = max(tableau%value, 0.0_wp)/(-step%slope)
    step%ratio = minval(ratio)
    tied = ratio <= step%ratio + negligible*max(step%ratio, 1.0_wp)
    step%row = least_row(tableau, step%slope, tied)
    step%ratio = ratio(step%row)
  end function test_ratios

  !> Where the load is complete.
  pure subroutine test_load(tableau, column, step)
    type(contact_tableau), intent(in) :: tableau
    integer, intent(in) :: column
    type(step_type), intent(inout) :: step

    associate (row => tableau%place(load_factor))
      if (row == -column) then
        step%load_rate = 1.0_wp
        step%full_load = 1.0_wp
      else if (row > 0) then
        if (step%slope(row) <= negligible) return
        step%load_rate = step%slope(row)
        step%full_load = max(1.0_wp - tableau%value(row), 0.0_wp)/step%load_rate
      end if
    end associate
  end subroutine test_load

  !> The one of the tied rows that would block first if the basic variables of the start were larger by e,
  !! e^2, ...
  !> (lexicographic order). Without it ties could make the simplex go round in circles. Row i changes with
  !! such a variable
  !> by 1 if it is basic in it, not at all if it is basic elsewhere, and else by minus the entry of its
  !! column.
  pure integer function least_row(tableau, slope, tied) result(row)
    type(contact_tableau), intent(in) :: tableau
    real(wp), intent(in) :: slope(:)   !! of the entering column [n]
    logical, intent(in) :: tied(:)     !! [n]
    logical :: left(size(tied))
    integer, allocatable :: rows(:)
    real(wp), allocatable :: ratio(:)
    real(wp) :: least
    integer :: i, j, ties

    left = tied
    ties = count(left)
    do j = 1, size(tableau%first_basic)
      if (ties == 1) exit
      row = tableau%place(tableau%first_basic(j))
      if (row > 0) then
        if (.not. left(row) .or. -negligible*slope(row) >= 1.0_wp) cycle
        left(row) = .false.
        ties = ties - 1
      else
        rows = pack([(i, i=1, size(left))], left)
        ratio = entries_of_rows(tableau, rows, -row)/slope(rows)
        least = minval(ratio)
        left(rows) = ratio <= least + negligible*max(abs(least), 1.0_wp)
        ties = count(left)
      end if
    end do
    row = findloc(left, .true., dim=1)
  end function least_row
end module epcont_contact_ratio_test
