!> The start: which pairs touch first if the bodies are rigid.
!>
!> The ordinary two-phase simplex, with Dantzig's rule and, should that run in circles, Bland's, on
!>
!>     minimise g^'R   subject to   A'R = P,   R >= 0
!>
!> The first phase finds forces that carry the load at all, or a motion along which nothing resists it;
!> the second, bounded since g^ >= 0, the statically determinate set of pairs that closes first.
!>
!> There is no tableau, only the inverse of its basis, from which a column or a row of it is put together when
!> it is asked for: of many bodies each has few pairs, so A has few entries. A row of the inverse often has
!> few, too, far apart in memory: marks tell where they may be.
module epcont_contact_equilibrium
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: dependent, negligible, null_component
  use epcont_flexibility_motion_matrix, only: motion_matrix
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

  !> Columns of the inverse that are marked at a time.
  integer, parameter :: at_once = 64

contains

  !> Are there R >= 0 with A'R = P?
  logical function can_carry(motion, resultant) result(carried)
    type(motion_matrix), intent(in) :: motion   !! A, largest entry about one [n, m]
    real(wp), intent(in) :: resultant(:)    !! P [m]
    type(rigid_start) :: start

    call find_rigid_start(motion, resultant, spread(0.0_wp, 1, motion%pairs), start)
    carried = start%balanced
  end function can_carry

  !> Which pairs touch first if the bodies are rigid, or the motion along which nothing resists the load.
  subroutine find_rigid_start(motion, resultant, gap, start)
    type(motion_matrix), intent(in) :: motion   !! A, largest entry about one [n, m]
    real(wp), intent(in) :: resultant(:)    !! P [m]
    real(wp), intent(in) :: gap(:)          !! g^, >= 0 [n]
    type(rigid_start), intent(out) :: start   !! which pairs touch first, or the motion that nothing resists
    !> Which variable is basic in each equation: forces are 1..n, then one artificial force an equation. In
    !! phase 1 these carry all of the load and cost one a unit.
    integer :: basic(size(resultant))
    real(wp) :: value(size(resultant))      ! basic variables
    real(wp), allocatable :: inverse(:, :)  ! of the basis; equations have the signs that make P >= 0
    !> Its rows that have entries in so many columns at a time [m, m/at_once]
    logical, allocatable :: filled(:, :)
    logical, allocatable :: is_basic(:)     ! forces, then artificial ones [n + m]
    real(wp) :: cost(size(gap))             ! of a unit of each force
    real(wp) :: price(size(resultant))      ! what a unit of load costs by the basic variables
    type(motion_matrix) :: of_pair          ! the equations that each force is in
    integer :: i, n

    n = size(gap)
    of_pair = motion%turned()
    value = abs(resultant)
    if (any(value > 0.0_wp)) value = value/maxval(value)
    allocate (inverse(size(resultant), size(resultant)), source=0.0_wp)
    allocate (filled(size(resultant), (size(resultant) + at_once - 1)/at_once), source=.false.)
    do i = 1, size(resultant)
      inverse(i, i) = 1.0_wp
      filled(i, (i + at_once - 1)/at_once) = .true.
      basic(i) = n + i
    end do
    cost = 0.0_wp
    price = 1.0_wp
    call minimise()
    start%balanced = sum(value, mask=basic > n) <= dependent
    if (start%balanced) then
      call expel_artificials()
      ! Phase 2: forces cost their gaps; what is left of the artificials is zero and costs nothing.
      cost = gap
      associate (of_all => [gap, 0.0_wp*value])
        price = [(dot_product(of_all(basic), inverse(:, i)), i=1, size(basic))]
      end associate
      call minimise()
      allocate (is_basic(n + size(basic)), source=.false.)
      is_basic(basic) = .true.
      start%touching = is_basic(:n)
      start%redundant = is_basic(n + 1:)
    else
      start%escape = sign(1.0_wp, resultant)*price
    end if

  contains

    !> Exchange until no force lowers the cost. The force that lowers it most enters (Dantzig; of ties the
    !! first), so that the basis keeps clear of pairs that all but depend on each other: two opposite ones
    !! would have to carry a load across them by wedging. That may run in circles among ties; Bland's rule
    !! ends. The limit guards against rounding, and a set that is not quite the best serves as well, since the
    !! contact simplex lifts its start.
    subroutine minimise()
      real(wp) :: reduced_cost(n), pivot(size(basic)), resolved(size(basic))
      integer :: column, count, row
      logical :: by_index

      do count = 1, 100*(n + size(basic))
        reduced_cost = cost - row_of(price)
        reduced_cost(pack(basic, basic <= n)) = 0.0_wp
        by_index = count > 10*(n + size(basic))
        if (by_index) then
          column = findloc(reduced_cost < -negligible, .true., dim=1)
        else
          column = first_largest(-reduced_cost, negligible)
        end if
        if (column == 0) exit
        pivot = column_of(column)
        row = leaving_row(pivot, by_index)
        if (row == 0) exit
        call exchange(row, column, pivot, resolved)
        price = price + reduced_cost(column)*resolved
      end do
    end subroutine minimise

    !> What a combination of the equations has of each force.
    pure function row_of(combination) result(row)
      real(wp), intent(in) :: combination(:)   !! weights of the equations [m]
      real(wp) :: row(n)

      row = motion%times(sign(1.0_wp, resultant)*combination)
    end function row_of

    !> How far each basic variable falls as a force grows.
    pure function column_of(pair) result(pivot)
      integer, intent(in) :: pair
      real(wp) :: entry, pivot(size(basic))
      integer :: i, k

      pivot = 0.0_wp
      do k = of_pair%start(pair), of_pair%start(pair + 1) - 1
        associate (equation => of_pair%pair(k))
          entry = sign(1.0_wp, resultant(equation))*of_pair%closing(k)
          do i = 1, size(pivot)
            pivot(i) = pivot(i) + entry*inverse(i, equation)
          end do
        end associate
      end do
    end function column_of

    !> Least ratio; of ties, the first of the largest pivots, or the variable of least index (Bland). 0: none
    !! decreases.
    pure integer function leaving_row(pivot, by_index) result(row)
      real(wp), intent(in) :: pivot(:)   !! column of the entering force
      logical, intent(in) :: by_index
      real(wp) :: least, ratio, zero
      integer :: i

      row = 0
      least = huge(least)
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

    !> A force becomes basic in a row of the inverse.
    subroutine exchange(row, column, pivot, resolved)
      integer, intent(in) :: row, column   !! column: the force
      real(wp), intent(in) :: pivot(:)     !! its column
      real(wp), intent(out) :: resolved(:)   !! that row, then
      integer, allocatable :: falling(:)   ! the others that it changes
      integer :: equation, i, many

      falling = pack([(i, i=1, size(basic))], pivot /= 0.0_wp .and. [(i /= row, i=1, size(basic))])
      value(row) = value(row)/pivot(row)
      value(falling) = max(value(falling) - pivot(falling)*value(row), 0.0_wp)
      resolved = 0.0_wp
      do many = 1, size(filled, 2)
        if (.not. filled(row, many)) cycle
        filled(falling, many) = .true.
        do equation = (many - 1)*at_once + 1, min(many*at_once, size(basic))
          if (inverse(row, equation) == 0.0_wp) cycle
          inverse(row, equation) = inverse(row, equation)/pivot(row)
          resolved(equation) = inverse(row, equation)
          inverse(falling, equation) = inverse(falling, equation) - pivot(falling)*resolved(equation)
        end do
      end do
      basic(row) = column
    end subroutine exchange

    !> Replace each artificial force that is basic at zero by a true one; where none can, the equation is
    !! redundant and the artificial stays to mark it.
    subroutine expel_artificials()
      real(wp) :: resolved(size(basic)), row(n)
      integer :: column, i

      do i = 1, size(basic)
        if (basic(i) <= n) cycle
        value(i) = 0.0_wp
        row = row_of(inverse(i, :))
        column = first_largest(abs(row), null_component*maxval(abs(inverse(i, :))))
        if (column > 0) then
          call exchange(i, column, column_of(column), resolved)
        else
          inverse(i, :) = 0.0_wp
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
    largest = max(maxval(values), least)   ! -huge of no values
    if (largest > least) &
      at = findloc(values > max(largest - negligible*maxval(abs(values)), least), .true., dim=1)
  end function first_largest
end module epcont_contact_equilibrium
