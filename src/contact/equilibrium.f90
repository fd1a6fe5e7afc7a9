!> The start: which pairs touch first if the bodies are rigid.
!>
!> The ordinary two-phase simplex, with Dantzig's rule and, should that run in circles, Bland's, on
!>
!>     minimise g^'R   subject to   A'R = P,   R >= 0
!>
!> The first phase finds forces that carry the load at all, or a motion along which nothing resists it;
!> the second, bounded since g^ >= 0, the statically determinate set of pairs that closes first.
!>
!> The tableau is kept row by row, and an exchange touches only rows and columns that are not zero there: of
!> many bodies each has few pairs, and few others feel it.
module epcont_contact_equilibrium
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: dependent, negligible, null_component
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

contains

  !> Are there R >= 0 with A'R = P?
  logical function can_carry(motion, resultant) result(carried)
    real(wp), intent(in) :: motion(:, :)    !! A, largest entry about one [n, m]
    real(wp), intent(in) :: resultant(:)    !! P [m]
    type(rigid_start) :: start

    call find_rigid_start(motion, resultant, spread(0.0_wp, 1, size(motion, 1)), start)
    carried = start%balanced
  end function can_carry

  !> Which pairs touch first if the bodies are rigid, or the motion along which nothing resists the load.
  subroutine find_rigid_start(motion, resultant, gap, start)
    real(wp), intent(in) :: motion(:, :)    !! A, largest entry about one [n, m]
    real(wp), intent(in) :: resultant(:)    !! P [m]
    real(wp), intent(in) :: gap(:)          !! g^, >= 0 [n]
    type(rigid_start), intent(out) :: start   !! which pairs touch first, or the motion that nothing resists
    !> Of a force in an equation of equilibrium, with the signs that make P >= 0: forces 1..n, then one
    !! artificial force an equation. In phase 1 these carry all of the load and cost one a unit.
    real(wp), allocatable :: entry(:, :)
    real(wp) :: reduced_cost(size(gap) + size(resultant))
    real(wp) :: value(size(resultant))      ! basic variables
    integer :: basic(size(resultant))       ! which variable is basic in each equation
    integer :: i, n

    n = size(gap)
    value = abs(resultant)
    if (any(value > 0.0_wp)) value = value/maxval(value)
    allocate (entry(n + size(resultant), size(resultant)), source=0.0_wp)
    reduced_cost = 0.0_wp
    do i = 1, size(resultant)
      entry(:n, i) = sign(1.0_wp, resultant(i))*motion(:, i)
      entry(n + i, i) = 1.0_wp
      basic(i) = n + i
      reduced_cost(:n) = reduced_cost(:n) - entry(:n, i)
    end do
    call minimise()
    start%balanced = sum(value, mask=basic > n) <= dependent
    if (start%balanced) then
      call expel_artificials()
      ! Phase 2: forces cost their gaps; what is left of the artificials is zero and costs nothing.
      reduced_cost(:n) = gap
      reduced_cost(n + 1:) = 0.0_wp
      do i = 1, size(basic)
        if (basic(i) <= n) reduced_cost = reduced_cost - gap(basic(i))*entry(:, i)
      end do
      call minimise()
      start%touching = [(any(basic == i), i=1, n)]
      start%redundant = [(any(basic == n + i), i=1, size(resultant))]
    else
      start%escape = sign(1.0_wp, resultant)*(1.0_wp - reduced_cost(n + 1:))
    end if

  contains

    !> Exchange until no force lowers the cost. The force that lowers it most enters (Dantzig; of ties the
    !! first), so that the basis keeps clear of pairs that all but depend on each other: two opposite ones
    !! would have to carry a load across them by wedging. That may run in circles among ties; Bland's rule
    !! ends. The limit guards against rounding, and a set that is not quite the best serves as well, since the
    !! contact simplex lifts its start.
    subroutine minimise()
      integer :: column, count, row
      logical :: by_index

      do count = 1, 100*size(reduced_cost)
        by_index = count > 10*size(reduced_cost)
        if (by_index) then
          column = findloc(reduced_cost(:n) < -negligible, .true., dim=1)
        else
          column = first_largest(-reduced_cost(:n), negligible)
        end if
        if (column == 0) exit
        row = leaving_row(column, by_index)
        if (row == 0) exit
        call exchange(row, column)
      end do
    end subroutine minimise

    !> Least ratio; of ties, the first of the largest pivots, or the variable of least index (Bland). 0: none
    !! decreases.
    pure integer function leaving_row(column, by_index) result(row)
      integer, intent(in) :: column
      logical, intent(in) :: by_index
      real(wp) :: least, pivot(size(basic)), ratio, zero
      integer :: i

      row = 0
      least = huge(least)
      pivot = entry(column, :)
      zero = null_component*maxval([abs(pivot), 1.0_wp])
      do i = 1, size(basic)
        if (pivot(i) <= zero) cycle
        ratio = value(i)/pivot(i)
        if (row > 0) then
          if (ratio > least + negligible) cycle
          if (ratio >= least - negligible) then
            if (by_index .and. basic(i) > basic(row)) cycle
            if (.not. by_index .and. pivot(i) <= pivot(row)*(1.0_wp + negligible)) cycle
          end if
        end if
        row = i
        least = ratio
      end do
    end function leaving_row

    !> The variable of a column becomes basic in a row.
    subroutine exchange(row, column)
      integer, intent(in) :: row, column
      integer :: filled(size(reduced_cost))   ! columns that are not zero in that row
      real(wp) :: factor
      integer :: i, j, last

      factor = entry(column, row)
      value(row) = value(row)/factor
      last = 0
      do j = 1, size(reduced_cost)
        if (entry(j, row) == 0.0_wp) cycle
        entry(j, row) = entry(j, row)/factor
        last = last + 1
        filled(last) = j
      end do
      do i = 1, size(basic)
        factor = entry(column, i)
        if (i == row .or. factor == 0.0_wp) cycle
        do j = 1, last
          entry(filled(j), i) = entry(filled(j), i) - factor*entry(filled(j), row)
        end do
        value(i) = max(value(i) - factor*value(row), 0.0_wp)
      end do
      factor = reduced_cost(column)
      reduced_cost(filled(:last)) = reduced_cost(filled(:last)) - factor*entry(filled(:last), row)
      basic(row) = column
    end subroutine exchange

    !> Replace each artificial force that is basic at zero by a true one; where none can, the equation is
    !! redundant and the artificial stays to mark it.
    subroutine expel_artificials()
      integer :: column, i

      do i = 1, size(basic)
        if (basic(i) <= n) cycle
        value(i) = 0.0_wp
        column = first_largest(abs(entry(:n, i)), null_component*maxval(abs(entry(n + 1:, i))))
        if (column > 0) then
          call exchange(i, column)
        else
          entry(:n, i) = 0.0_wp
        end if
      end do
    end subroutine expel_artificials
  end subroutine find_rigid_start

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
end module epcont_contact_equilibrium
