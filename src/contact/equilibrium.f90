!> Start of the contact solution: the pairs in contact first if the bodies are rigid.
!>
!> Two-phase simplex, with Dantzig's rule and, if it cycles, Bland's, on
!>
!>     minimise g^'R   subject to   A'R = P,   R >= 0
!>
!> The first phase finds forces that carry the load, or an unconstrained rigid-body mode;
!> the second, bounded since g^ >= 0, finds the statically determinate set of pairs that closes first.
!>
!> There is no tableau, only the inverse of the basis, from which a column or a row is computed when
!> needed: each of many bodies has few pairs, so A has few entries. A row of the inverse often has
!> few entries, too, far apart in memory: marks show where they may be.
module epcont_contact_equilibrium
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: dependent, negligible, null_component
  use epcont_flexibility_motion_matrix, only: motion_matrix
  implicit none
  private
  public :: rigid_start, find_rigid_start, can_carry

  !> Result for rigid bodies under the load.
  type :: rigid_start
    logical :: balanced = .false.          !! some R >= 0 carry P
    logical, allocatable :: touching(:)    !! pairs in contact first, one for each kept mode [n]
    logical, allocatable :: redundant(:)   !! modes neither restrained nor loaded [m]
    !> If not balanced: y with P'y > 0 that no contact force resists [m]
    real(wp), allocatable :: escape(:)
  end type rigid_start

  !> Columns of the inverse for each mark.
  integer, parameter :: at_once = 64

  !> Simplex with its current basis.
  type :: rigid_simplex
    integer :: n = 0                        !! forces
    type(motion_matrix) :: motion           !! A
    type(motion_matrix) :: of_pair          !! equations of each force
    real(wp), allocatable :: side(:)        !! signs of the equations that make P >= 0 [m]
    !> Basic variable of each equation: forces are 1..n, then one artificial force for each equation. In
    !! phase 1 the artificial forces carry all of the load, with unit cost [m]
    integer, allocatable :: basic(:)
    real(wp), allocatable :: value(:)       !! basic variables [m]
    real(wp), allocatable :: inverse(:, :)  !! of the basis [m, m]
    !> Rows of the inverse that have entries in each group of columns [m, m/at_once]
    logical, allocatable :: filled(:, :)
    real(wp), allocatable :: cost(:)        !! cost of each unit force [n]
    real(wp), allocatable :: price(:)       !! cost of each unit load, carried by the basic variables [m]
  contains
    procedure :: begin
    procedure :: minimise
    procedure :: row_of
    procedure :: column_of
    procedure :: blocking_row
    procedure :: exchange
    procedure :: expel_artificials
  end type rigid_simplex

contains

  !> Are there R >= 0 with A'R = P?
  logical function can_carry(motion, resultant) result(carried)
    type(motion_matrix), intent(in) :: motion   !! A, largest entry about one [n, m]
    real(wp), intent(in) :: resultant(:)    !! P [m]
    type(rigid_start) :: start

    call find_rigid_start(motion, resultant, spread(0.0_wp, 1, motion%pairs), start)
    carried = start%balanced
  end function can_carry

  !> Find the pairs in contact first if the bodies are rigid, or an unconstrained mode.
  subroutine find_rigid_start(motion, resultant, gap, start)
    type(motion_matrix), intent(in) :: motion   !! A, largest entry about one [n, m]
    real(wp), intent(in) :: resultant(:)    !! P [m]
    real(wp), intent(in) :: gap(:)          !! g^, >= 0 [n]
    type(rigid_start), intent(out) :: start   !! the result
    type(rigid_simplex) :: simplex
    logical :: is_basic(size(gap) + size(resultant))   ! forces, then artificial forces
    integer :: i

    call simplex%begin(motion, resultant)
    call simplex%minimise()
    associate (n => simplex%n, basic => simplex%basic)
      start%balanced = sum(simplex%value, mask=basic > n) <= dependent
      if (.not. start%balanced) then
        start%escape = simplex%side*simplex%price
        return
      end if
      call simplex%expel_artificials()
      ! Phase 2: forces cost their gaps; the remaining artificial forces are zero and cost nothing.
      simplex%cost = gap
      associate (of_all => [gap, 0.0_wp*resultant])
        simplex%price = [(dot_product(of_all(basic), simplex%inverse(:, i)), i=1, size(basic))]
      end associate
      call simplex%minimise()
      is_basic = .false.
      is_basic(basic) = .true.
      start%touching = is_basic(:n)
      start%redundant = is_basic(n + 1:)
    end associate
  end subroutine find_rigid_start

  !> Begin with artificial forces that carry all of the load.
  subroutine begin(self, motion, resultant)
    class(rigid_simplex), intent(inout) :: self
    type(motion_matrix), intent(in) :: motion
    real(wp), intent(in) :: resultant(:)
    real(wp) :: largest
    integer :: i, m

    self%n = motion%pairs
    m = size(resultant)
    self%motion = motion
    self%of_pair = motion%turned()
    self%side = sign(1.0_wp, resultant)
    self%value = abs(resultant)
    largest = maxval([self%value, 0.0_wp])
    if (largest <= 0.0_wp) largest = 1.0_wp
    self%value = self%value/largest
    allocate (self%inverse(m, m), source=0.0_wp)
    allocate (self%filled(m, (m + at_once - 1)/at_once), source=.false.)
    do i = 1, m
      self%inverse(i, i) = 1.0_wp
      self%filled(i, (i + at_once - 1)/at_once) = .true.
    end do
    self%basic = [(self%n + i, i=1, m)]
    self%cost = spread(0.0_wp, 1, self%n)
    self%price = spread(1.0_wp, 1, m)
  end subroutine begin

  !> Exchange until no force lowers the cost. The force with the largest gain enters (Dantzig; the first if
  !! equal), so that the basis avoids nearly dependent pairs: two opposite pairs
  !! would have to carry a load across them by wedging. This may cycle among ties; Bland's rule
  !! does not. The limit guards against rounding; a set that is not quite optimal is sufficient, since the
  !! contact simplex lifts its start.
  subroutine minimise(self)
    class(rigid_simplex), intent(inout) :: self
    real(wp) :: gain(self%n)   ! of a unit of each force
    real(wp), dimension(size(self%basic)) :: pivot, resolved
    integer :: column, count, row
    logical :: by_index

    do count = 1, 100*(self%n + size(self%basic))
      gain = self%row_of(self%price) - self%cost
      gain(pack(self%basic, self%basic <= self%n)) = 0.0_wp
      by_index = count > 10*(self%n + size(self%basic))
      if (by_index) then
        column = findloc(gain > negligible, .true., dim=1)
      else
        column = first_largest(gain, negligible)
      end if
      if (column == 0) exit
      pivot = self%column_of(column)
      row = self%blocking_row(pivot, by_index)
      if (row == 0) exit
      call self%exchange(row, column, pivot, resolved)
      self%price = self%price - gain(column)*resolved
    end do
  end subroutine minimise

  !> Row of the constraint matrix for a combination of equations.
  pure function row_of(self, combination) result(row)
    class(rigid_simplex), intent(in) :: self
    real(wp), intent(in) :: combination(:)   !! weights of the equations [m]
    real(wp) :: row(self%n)

    row = self%motion%times(self%side*combination)
  end function row_of

  !> Decrease of each basic variable for a unit of a force.
  pure function column_of(self, pair) result(pivot)
    class(rigid_simplex), intent(in) :: self
    integer, intent(in) :: pair
    real(wp) :: entry, pivot(size(self%basic))
    integer :: i, k

    pivot = 0.0_wp
    do k = self%of_pair%start(pair), self%of_pair%start(pair + 1) - 1
      associate (equation => self%of_pair%pair(k))
        entry = self%side(equation)*self%of_pair%closing(k)
        do i = 1, size(pivot)
          pivot(i) = pivot(i) + entry*self%inverse(i, equation)
        end do
      end associate
    end do
  end function column_of

  !> Row of the basic variable that becomes zero first; if equal, the first of the largest pivots, or the
  !! variable of least index (Bland). 0: no variable falls.
  pure integer function blocking_row(self, pivot, by_index) result(row)
    class(rigid_simplex), intent(in) :: self
    real(wp), intent(in) :: pivot(:)   !! column of the entering force
    logical, intent(in) :: by_index
    real(wp) :: least, ratio, zero
    integer :: i

    row = 0
    least = huge(least)
    zero = null_component*maxval([abs(pivot), 1.0_wp])
    do i = 1, size(pivot)
      if (pivot(i) <= zero) cycle
      ratio = self%value(i)/pivot(i)
      if (row > 0) then
        if (ratio > least + negligible) cycle
        if (ratio >= least - negligible) then
          if (by_index .and. self%basic(i) > self%basic(row)) cycle
          if (.not. by_index .and. pivot(i) <= pivot(row)*(1.0_wp + negligible)) cycle
        end if
      end if
      row = i
      least = ratio
    end do
  end function blocking_row

  !> Make a force basic in a row of the inverse.
  subroutine exchange(self, row, column, pivot, resolved)
    class(rigid_simplex), intent(inout) :: self
    integer, intent(in) :: row, column   !! column: the force
    real(wp), intent(in) :: pivot(:)     !! its column
    real(wp), intent(out) :: resolved(:)   !! the new row
    integer, allocatable :: falling(:)   ! other rows that change
    integer :: equation, i, many

    falling = pack([(i, i=1, size(pivot))], pivot /= 0.0_wp .and. [(i /= row, i=1, size(pivot))])
    self%value(row) = self%value(row)/pivot(row)
    self%value(falling) = max(self%value(falling) - pivot(falling)*self%value(row), 0.0_wp)
    self%basic(row) = column
    resolved = 0.0_wp
    do many = 1, size(self%filled, 2)
      if (.not. self%filled(row, many)) cycle
      self%filled(falling, many) = .true.
      do equation = (many - 1)*at_once + 1, min(many*at_once, size(pivot))
        if (self%inverse(row, equation) == 0.0_wp) cycle
        self%inverse(row, equation) = self%inverse(row, equation)/pivot(row)
        resolved(equation) = self%inverse(row, equation)
        self%inverse(falling, equation) = self%inverse(falling, equation) - pivot(falling)*resolved(equation)
      end do
    end do
  end subroutine exchange

  !> Replace each artificial force that is basic at zero by a contact force. If that is impossible, the
  !! equation is redundant and the artificial force marks it.
  subroutine expel_artificials(self)
    class(rigid_simplex), intent(inout) :: self
    real(wp) :: resolved(size(self%basic)), row(self%n)
    integer :: column, i

    do i = 1, size(self%basic)
      if (self%basic(i) <= self%n) cycle
      self%value(i) = 0.0_wp
      row = self%row_of(self%inverse(i, :))
      column = first_largest(abs(row), null_component*maxval(abs(self%inverse(i, :))))
      if (column > 0) then
        call self%exchange(i, column, self%column_of(column), resolved)
      else
        self%inverse(i, :) = 0.0_wp
      end if
    end do
  end subroutine expel_artificials

  !> First of the values that are largest up to rounding, so that it is the same on every processor; 0
  !! if no value is above `least`.
  pure integer function first_largest(values, least) result(at)
    real(wp), intent(in) :: values(:)
    real(wp), intent(in) :: least     !! > 0
    real(wp) :: largest

    at = 0
    largest = max(maxval(values), least)   ! `least` if there are no values
    if (largest > least) &
      at = findloc(values > max(largest - negligible*maxval(abs(values)), least), .true., dim=1)
  end function first_largest
end module epcont_contact_equilibrium
