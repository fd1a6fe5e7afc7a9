!> The start: which pairs touch first if the bodies are rigid.
!>
!> The ordinary two-phase simplex with bounded variables, with Dantzig's rule and, should that run in circles,
!> Bland's, on
!>
!>     minimise g^'R   subject to   A'R = P,   0 <= R <= u
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
    logical :: balanced = .false.          !! some forces within their bounds carry P
    logical, allocatable :: touching(:)    !! the pairs that touch first, one a kept motion [n]
    logical, allocatable :: at_upper(:)    !! others whose force is at its upper bound [n]
    logical, allocatable :: redundant(:)   !! motions neither resisted nor loaded [m]
    !> y with P'y > 0, along which no force can grow that resists it, if not balanced [m]
    real(wp), allocatable :: escape(:)
  end type rigid_start

  !> Columns of the inverse that are marked at a time.
  integer, parameter :: at_once = 64

  !> The simplex at a basis.
  type :: rigid_simplex
    integer :: n = 0                        !! forces
    type(motion_matrix) :: motion           !! A
    type(motion_matrix) :: of_pair          !! the equations that each force is in
    real(wp), allocatable :: side(:)        !! signs of the equations, that make P >= 0 [m]
    !> Which variable is basic in each equation: forces are 1..n, then one artificial force an equation. In
    !! phase 1 these carry all of the load and cost one a unit [m]
    integer, allocatable :: basic(:)
    real(wp), allocatable :: value(:)       !! basic variables [m]
    real(wp), allocatable :: upper(:)       !! bounds of forces, then artificial ones [n + m]
    logical, allocatable :: at_upper(:)     !! not basic, and there; else at zero [n + m]
    real(wp), allocatable :: inverse(:, :)  !! of the basis [m, m]
    !> Its rows that have entries in so many columns at a time [m, m/at_once]
    logical, allocatable :: filled(:, :)
    real(wp), allocatable :: cost(:)        !! of a unit of each force [n]
    real(wp), allocatable :: price(:)       !! what a unit of load costs by the basic variables [m]
  contains
    procedure :: begin
    procedure :: minimise
    procedure :: row_of
    procedure :: column_of
    procedure :: find_event
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

  !> Which pairs touch first if the bodies are rigid, or the motion along which nothing resists the load.
  subroutine find_rigid_start(motion, resultant, gap, start, upper)
    type(motion_matrix), intent(in) :: motion   !! A, largest entry about one [n, m]
    real(wp), intent(in) :: resultant(:)    !! P [m]
    real(wp), intent(in) :: gap(:)          !! g^, >= 0 [n]
    type(rigid_start), intent(out) :: start   !! which pairs touch first, or the motion that nothing resists
    real(wp), intent(in), optional :: upper(:)   !! bounds of the forces; not given: none [n]
    type(rigid_simplex) :: simplex
    logical :: is_basic(size(gap) + size(resultant))   ! forces, then artificial ones
    integer :: i

    call simplex%begin(motion, resultant, upper)
    call simplex%minimise()
    associate (n => simplex%n, basic => simplex%basic)
      start%balanced = sum(simplex%value, mask=basic > n) <= dependent
      if (.not. start%balanced) then
        start%escape = simplex%side*simplex%price
        return
      end if
      call simplex%expel_artificials()
      ! Phase 2: forces cost their gaps; what is left of the artificials is zero and costs nothing.
      simplex%cost = gap
      associate (of_all => [gap, 0.0_wp*resultant])
        simplex%price = [(dot_product(of_all(basic), simplex%inverse(:, i)), i=1, size(basic))]
      end associate
      call simplex%minimise()
      is_basic = .false.
      is_basic(basic) = .true.
      start%touching = is_basic(:n)
      start%at_upper = simplex%at_upper(:n)
      start%redundant = is_basic(n + 1:)
    end associate
  end subroutine find_rigid_start

  !> Artificial forces carry all of the load.
  subroutine begin(self, motion, resultant, upper)
    class(rigid_simplex), intent(inout) :: self
    type(motion_matrix), intent(in) :: motion
    real(wp), intent(in) :: resultant(:)
    real(wp), intent(in), optional :: upper(:)
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
    self%upper = spread(huge(1.0_wp), 1, self%n + m)
    if (present(upper)) then
      where (upper < huge(1.0_wp)) self%upper(:self%n) = upper/largest
    end if
    self%at_upper = spread(.false., 1, self%n + m)
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

  !> Exchange until no force lowers the cost. The force that lowers it most enters (Dantzig; of ties the
  !! first), so that the basis keeps clear of pairs that all but depend on each other: two opposite ones
  !! would have to carry a load across them by wedging. That may run in circles among ties; Bland's rule
  !! ends. The limit guards against rounding, and a set that is not quite the best serves as well, since the
  !! contact simplex lifts its start.
  subroutine minimise(self)
    class(rigid_simplex), intent(inout) :: self
    real(wp) :: gain(self%n)   ! by a unit of each force, towards its other bound
    real(wp), dimension(size(self%basic)) :: pivot, resolved
    integer :: column, count, row
    logical :: by_index

    do count = 1, 100*(self%n + size(self%basic))
      gain = self%row_of(self%price) - self%cost
      where (self%at_upper(:self%n)) gain = -gain
      gain(pack(self%basic, self%basic <= self%n)) = 0.0_wp
      by_index = count > 10*(self%n + size(self%basic))
      if (by_index) then
        column = findloc(gain > negligible, .true., dim=1)
      else
        column = first_largest(gain, negligible)
      end if
      if (column == 0) exit
      pivot = self%column_of(column)
      row = self%find_event(column, pivot, by_index)
      if (row < 0) exit
      if (row == 0) then   ! all the way to the other bound
        associate (growth => merge(-1.0_wp, 1.0_wp, self%at_upper(column))*self%upper(column))
          self%value = within(self%value - growth*pivot, self%upper(self%basic))
        end associate
        self%at_upper(column) = .not. self%at_upper(column)
      else
        if (self%at_upper(column)) gain(column) = -gain(column)
        call self%exchange(row, column, pivot, resolved)
        self%price = self%price - gain(column)*resolved
      end if
    end do
  end subroutine minimise

  !> What a combination of the equations has of each force.
  pure function row_of(self, combination) result(row)
    class(rigid_simplex), intent(in) :: self
    real(wp), intent(in) :: combination(:)   !! weights of the equations [m]
    real(wp) :: row(self%n)

    row = self%motion%times(self%side*combination)
  end function row_of

  !> How far each basic variable falls as a force grows.
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

  !> The row of the basic variable that comes to a bound first; of ties, the first of the largest pivots, or
  !! the variable of least index (Bland). 0: the entering force comes to its other bound before; negative:
  !! nothing comes to any.
  pure integer function find_event(self, column, pivot, by_index) result(row)
    class(rigid_simplex), intent(in) :: self
    integer, intent(in) :: column      !! the entering force
    real(wp), intent(in) :: pivot(:)   !! its column
    logical, intent(in) :: by_index
    real(wp) :: falls, least, ratio, room, zero
    integer :: i

    row = -1
    least = huge(least)
    zero = null_component*maxval([abs(pivot), 1.0_wp])
    do i = 1, size(pivot)
      falls = merge(-pivot(i), pivot(i), self%at_upper(column))
      if (abs(falls) <= zero) cycle
      room = self%value(i)
      if (falls < 0.0_wp) then
        if (self%upper(self%basic(i)) >= huge(1.0_wp)) cycle
        room = max(self%upper(self%basic(i)) - self%value(i), 0.0_wp)
      end if
      ratio = room/abs(falls)
      if (row > 0) then
        if (ratio > least + negligible) cycle
        if (ratio >= least - negligible) then
          if (by_index .and. self%basic(i) > self%basic(row)) cycle
          if (.not. by_index .and. abs(falls) <= abs(pivot(row))*(1.0_wp + negligible)) cycle
        end if
      end if
      row = i
      least = ratio
    end do
    if (self%upper(column) < least) row = 0
  end function find_event

  !> A force becomes basic in a row of the inverse. The variable that leaves is at the bound that it was near.
  subroutine exchange(self, row, column, pivot, resolved)
    class(rigid_simplex), intent(inout) :: self
    integer, intent(in) :: row, column   !! column: the force
    real(wp), intent(in) :: pivot(:)     !! its column
    real(wp), intent(out) :: resolved(:)   !! that row, then
    integer, allocatable :: falling(:)   ! the others that it changes
    real(wp) :: growth                   ! of the force
    integer :: equation, i, many

    falling = pack([(i, i=1, size(pivot))], pivot /= 0.0_wp .and. [(i /= row, i=1, size(pivot))])
    associate (leaving => self%basic(row))
      self%at_upper(leaving) = pivot(row) > 0.0_wp .eqv. self%at_upper(column)
      if (self%upper(leaving) >= huge(1.0_wp)) self%at_upper(leaving) = .false.
      growth = self%value(row)
      if (self%at_upper(leaving)) growth = growth - self%upper(leaving)
      growth = growth/pivot(row)
    end associate
    self%value(falling) = within(self%value(falling) - pivot(falling)*growth, self%upper(self%basic(falling)))
    self%value(row) = growth
    if (self%at_upper(column)) self%value(row) = self%upper(column) + growth
    self%at_upper(column) = .false.
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

  !> Replace each artificial force that is basic at zero by a true one; where none can, the equation is
  !! redundant and the artificial stays to mark it.
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

  !> A value, or the bound that it has passed.
  elemental real(wp) function within(value, upper)
    real(wp), intent(in) :: value, upper

    within = min(max(value, 0.0_wp), upper)
  end function within

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
