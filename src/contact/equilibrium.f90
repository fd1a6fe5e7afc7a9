!> The start: which pairs touch first if the bodies are rigid.
!>
!> The ordinary two-phase simplex, with Dantzig's rule and, should that run in circles, Bland's, on
!>
!>     minimise g^'R   subject to   A'R = P,   R >= 0
!>
!> The first phase finds forces that carry the load at all, or a motion along which nothing resists it;
!> the second, bounded since g^ >= 0, the statically determinate set of pairs that closes first.
module epcont_contact_equilibrium
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: dependent, negligible
  use epcont_contact_scaling, only: scaled_problem
  implicit none
  private
  public :: rigid_start, find_rigid_start, can_carry

  !> What rigid bodies do under the load.
  type :: rigid_start
    logical :: balanced = .false.          !! some forces R >= 0 carry P
    logical, allocatable :: touching(:)    !! the pairs that touch first, one a kept motion [n]
    logical, allocatable :: redundant(:)   !! motions neither resisted nor loaded [m]
    real(wp), allocatable :: escape(:)     !! y with P'y > 0, A y <= 0, if not balanced [m]
  end type rigid_start

  !> Rows: equations of equilibrium, with the signs that make P >= 0. Columns: forces 1..n, then one
  !! artificial force a row.
  type :: programme
    integer :: n = 0                          !! true forces
    real(wp), allocatable :: entry(:, :)      !! [m, n + m]
    real(wp), allocatable :: value(:)         !! basic variables [m]
    integer, allocatable :: basic(:)          !! which variable is basic in each row [m]
    real(wp), allocatable :: reduced_cost(:)  !! [n + m]
  end type programme

contains

  !> Which pairs touch first if the bodies are rigid, or the motion along which nothing resists the load.
  pure subroutine find_rigid_start(problem, start)
    type(scaled_problem), intent(in) :: problem   !! in its own units
    type(rigid_start), intent(out) :: start   !! which pairs touch first, or the motion that nothing resists
    type(programme) :: lp
    integer :: k

    lp = first_programme(problem%motion, problem%resultant)
    call minimise(lp)
    start%balanced = is_balanced(lp)
    if (.not. start%balanced) then
      start%escape = sign(1.0_wp, problem%resultant)*(1.0_wp - lp%reduced_cost(lp%n + 1:))
      return
    end if
    call expel_artificials(lp)
    call price(lp, problem%unloaded_gap)
    call minimise(lp)
    start%touching = [(any(lp%basic == k), k=1, lp%n)]
    start%redundant = [(any(lp%basic == lp%n + k), k=1, size(problem%resultant))]
  end subroutine find_rigid_start

  !> Are there R >= 0 with A'R = P?
  pure logical function can_carry(motion, resultant) result(carried)
    real(wp), intent(in) :: motion(:, :)    !! A, largest entry about one [n, m]
    real(wp), intent(in) :: resultant(:)    !! P [m]
    type(programme) :: lp

    lp = first_programme(motion, resultant)
    call minimise(lp)
    carried = is_balanced(lp)
  end function can_carry

  !> Do the true forces carry all of the load?
  pure logical function is_balanced(lp) result(balanced)
    type(programme), intent(in) :: lp

    balanced = sum(lp%value, mask=lp%basic > lp%n) <= dependent
  end function is_balanced

  !> Phase 1: the artificial forces carry all of the load and cost one a unit.
  pure type(programme) function first_programme(motion, resultant) result(lp)
    real(wp), intent(in) :: motion(:, :)    !! [n, m]
    real(wp), intent(in) :: resultant(:)    !! [m]
    real(wp) :: size_of_load
    integer :: i, m, n

    n = size(motion, 1)
    m = size(resultant)
    lp%n = n
    size_of_load = maxval([abs(resultant), 0.0_wp])
    if (size_of_load <= 0.0_wp) size_of_load = 1.0_wp
    lp%value = abs(resultant)/size_of_load
    allocate (lp%entry(m, n + m), source=0.0_wp)
    do i = 1, m
      lp%entry(i, :n) = sign(1.0_wp, resultant(i))*motion(:, i)
      lp%entry(i, n + i) = 1.0_wp
    end do
    lp%basic = [(n + i, i=1, m)]
    allocate (lp%reduced_cost(n + m), source=0.0_wp)
    lp%reduced_cost(:n) = -sum(lp%entry(:, :n), dim=1)
  end function first_programme

  !> Phase 2: forces cost their gaps; what is left of the artificials is zero and costs nothing.
  pure subroutine price(lp, gap)
    type(programme), intent(inout) :: lp
    real(wp), intent(in) :: gap(:)   !! [n]
    integer :: i

    lp%reduced_cost = 0.0_wp
    lp%reduced_cost(:lp%n) = gap
    do i = 1, size(lp%basic)
      if (lp%basic(i) <= lp%n) lp%reduced_cost = lp%reduced_cost - gap(lp%basic(i))*lp%entry(i, :)
    end do
  end subroutine price

  !> Exchange until no force lowers the cost. The force that lowers it most enters (Dantzig; of ties the
  !! first), so that the basis
  !> keeps clear of pairs that all but depend on each other: two opposite ones would have to carry a load
  !! across them by wedging.
  !> That may run in circles among ties; Bland's rule ends. The limit guards against rounding, and a set that
  !! is not quite the best
  !> serves as well, since the contact simplex lifts its start.
  pure subroutine minimise(lp)
    type(programme), intent(inout) :: lp
    integer :: column, count, row
    logical :: by_index

    associate (cost => lp%reduced_cost(:lp%n), unknowns => size(lp%reduced_cost))
      do count = 1, 100*unknowns
        by_index = count > 10*unknowns
        if (by_index) then
          column = findloc(cost < -negligible, .true., dim=1)
        else
          column = first_largest(-cost, negligible)
        end if
        if (column == 0) exit
        row = leaving_row(lp, column, by_index)
        if (row == 0) exit
        call exchange(lp, row, column)
      end do
    end associate
  end subroutine minimise

  !> The first of those that are the largest but for rounding, so that it is the same on every processor; 0:
  !! none is above `least`.
  pure integer function first_largest(values, least) result(at)
    real(wp), intent(in) :: values(:)
    real(wp), intent(in) :: least     !! > 0
    real(wp) :: largest

    at = 0
    largest = maxval([values, least])
    if (largest > least) then
      at = findloc(values > max(largest - negligible*maxval(abs(values)), least), .true., dim=1)
    end if
  end function first_largest

  !> Least ratio; of ties, the first of the largest pivots, or the variable of least index (Bland). 0: none
  !! decreases.
  pure integer function leaving_row(lp, column, by_index) result(row)
    type(programme), intent(in) :: lp
    integer, intent(in) :: column
    logical, intent(in) :: by_index
    real(wp) :: least, ratio, zero
    integer :: i

    row = 0
    least = huge(least)
    zero = negligible*maxval([abs(lp%entry(:, column)), 1.0_wp])
    do i = 1, size(lp%basic)
      if (lp%entry(i, column) <= zero) cycle
      ratio = lp%value(i)/lp%entry(i, column)
      if (row > 0) then
        if (ratio > least + negligible) cycle
        if (ratio >= least - negligible) then
          if (by_index .and. lp%basic(i) > lp%basic(row)) cycle
          if (.not. by_index .and. lp%entry(i, column) <= lp%entry(row, column)*(1.0_wp + negligible)) cycle
        end if
      end if
      row = i
      least = ratio
    end do
  end function leaving_row

  pure subroutine exchange(lp, row, column)
    type(programme), intent(inout) :: lp
    integer, intent(in) :: row, column
    real(wp) :: factor
    integer :: i

    factor = lp%entry(row, column)
    lp%entry(row, :) = lp%entry(row, :)/factor
    lp%value(row) = lp%value(row)/factor
    do i = 1, size(lp%basic)
      if (i == row) cycle
      factor = lp%entry(i, column)
      lp%entry(i, :) = lp%entry(i, :) - factor*lp%entry(row, :)
      lp%value(i) = max(lp%value(i) - factor*lp%value(row), 0.0_wp)
    end do
    lp%reduced_cost = lp%reduced_cost - lp%reduced_cost(column)*lp%entry(row, :)
    lp%basic(row) = column
  end subroutine exchange

  !> Replace each artificial force that is basic at zero by a true one; where none can, the equation is
  !> redundant and the artificial stays to mark it.
  pure subroutine expel_artificials(lp)
    type(programme), intent(inout) :: lp
    integer :: column, i

    do i = 1, size(lp%basic)
      if (lp%basic(i) <= lp%n) cycle
      lp%value(i) = 0.0_wp
      column = first_largest(abs(lp%entry(i, :lp%n)), dependent)
      if (column > 0) then
        call exchange(lp, i, column)
      else
        lp%entry(i, :lp%n) = 0.0_wp
      end if
    end do
  end subroutine expel_artificials
end module epcont_contact_equilibrium
