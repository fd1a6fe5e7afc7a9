!> F, between pairs in levels: those of a body are in one level or in two that follow each other, so that F is
!> block tridiagonal:
!>
!>     +--------+
!>     | within |
!>     +--------+--------+
!>     | beyond | within |
!>     +--------+--------+--------+
!>              | beyond | within |
!>              +--------+--------+
!>
!> Of one or two bodies all pairs are one level. Of many, those at the same distance from the first, counted
!> in bodies that lie between, are one; small ones are joined.
module epcont_contact_flexibility_matrix
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: flexibility_matrix, dense_flexibility, new_flexibility

  !> Pairs of a level, at least, so that most of the work is done by blocks. (1 000 bodies of 7 pairs each: 32
  !! and 128 take no longer by more than a fifth.)
  integer, parameter :: least_level = 64
  !> Rows and columns that are copied across the diagonal at once: both places fit into the nearest cache.
  integer, parameter :: tile = 32

  type :: pair_level
    integer, allocatable :: pair(:)          !! ascending [own]
    real(wp), allocatable :: within(:, :)    !! F of the own pairs, both triangles [length/force] [own, own]
    real(wp), allocatable :: beyond(:, :)    !! opening of the next level's pairs by the own [next, own]
  end type pair_level

  type :: flexibility_matrix
    type(pair_level), allocatable :: level(:)
    integer, allocatable :: level_of(:)      !! of each pair [pairs]
    integer, allocatable :: place(:)         !! of each pair in its level [pairs]
  contains
    procedure :: clear
    procedure :: add
    procedure :: complete
    procedure :: times
    procedure :: diagonal
    procedure :: block
    procedure :: dense
  end type flexibility_matrix

contains

  !> Zeros, for pairs between these bodies.
  type(flexibility_matrix) function new_flexibility(body, bodies) result(new)
    integer, intent(in) :: body(:, :)   !! of each pair; 0 ends them [any, pairs]
    integer, intent(in) :: bodies       !! in all
    integer :: k, l, next

    new%level_of = joined_levels(levels_of_pairs(body, bodies))
    allocate (new%level(maxval([new%level_of, 1])), new%place(size(new%level_of)))
    do l = 1, size(new%level)
      new%level(l)%pair = pack([(k, k=1, size(new%level_of))], new%level_of == l)
      new%place(new%level(l)%pair) = [(k, k=1, size(new%level(l)%pair))]
    end do
    do l = 1, size(new%level)
      k = size(new%level(l)%pair)
      next = 0
      if (l < size(new%level)) next = size(new%level(l + 1)%pair)
      allocate (new%level(l)%within(k, k), new%level(l)%beyond(next, k), source=0.0_wp)
    end do
  end function new_flexibility

  !> All pairs in one level.
  pure type(flexibility_matrix) function dense_flexibility(matrix) result(new)
    real(wp), intent(in) :: matrix(:, :)   !! F [length/force] [pairs, pairs]
    integer :: k, n

    n = size(matrix, 1)
    allocate (new%level_of(n), source=1)
    new%place = [(k, k=1, n)]
    allocate (new%level(1))
    new%level(1)%pair = new%place
    new%level(1)%within = matrix
    allocate (new%level(1)%beyond(0, n))
  end function dense_flexibility

  !> Of each pair: how many bodies are between its farthest and the first of those that hang together with it,
  !! and so much more that all levels of the bodies that do come behind those of others.
  function levels_of_pairs(body, bodies) result(level)
    integer, intent(in) :: body(:, :), bodies
    integer :: level(size(body, 2))
    type(incidence) :: pairs         ! of each body
    integer :: distance(bodies)      ! level of each body; 0: not met
    integer :: queue(bodies)         ! bodies in the order in which they were met
    integer :: b, first, k, last, met

    pairs = new_incidence(body, bodies)
    distance = 0
    met = 0
    last = 0
    do b = 1, bodies
      if (distance(b) > 0) cycle
      first = met
      call walk(from=b)
      ! Once more from the one that is farthest away: more levels, and smaller ones.
      distance(queue(first + 1:met)) = 0
      k = queue(met)
      met = first
      call walk(from=k)
      last = distance(queue(met))
    end do
    level = 1
    do k = 1, size(level)
      level(k) = maxval([distance(pack(body(:, k), body(:, k) > 0)), 1])
    end do

  contains

    !> Meet all bodies that hang together with one, the nearest first.
    subroutine walk(from)
      integer, intent(in) :: from
      integer :: at, i, j, next, pair

      met = met + 1
      queue(met) = from
      distance(from) = last + 1
      at = met
      do while (at <= met)
        do i = pairs%start(queue(at)), pairs%start(queue(at) + 1) - 1
          pair = pairs%group(i)
          do j = 1, size(body, 1)
            next = body(j, pair)
            if (next == 0) exit
            if (distance(next) > 0) cycle
            met = met + 1
            queue(met) = next
            distance(next) = distance(queue(at)) + 1
          end do
        end do
        at = at + 1
      end do
    end subroutine walk
  end function levels_of_pairs

  !> Levels of some size, without empty ones; one alone where there would be two: nothing is zero then.
  pure function joined_levels(level) result(joined)
    integer, intent(in) :: level(:)   !! of each pair
    integer :: joined(size(level))
    integer, allocatable :: number(:), pairs(:)   ! of each level
    integer :: gathered, k, l, last

    allocate (pairs(maxval([level, 1])), source=0)
    do k = 1, size(level)
      pairs(level(k)) = pairs(level(k)) + 1
    end do
    allocate (number(size(pairs)))
    last = 1
    gathered = 0
    do l = 1, size(pairs)
      if (gathered >= least_level .and. pairs(l) > 0) then
        last = last + 1
        gathered = 0
      end if
      number(l) = last
      gathered = gathered + pairs(l)
    end do
    if (last == 2) number = 1
    joined = number(level)
  end function joined_levels

  !> Begin anew with zeros.
  pure subroutine clear(self)
    class(flexibility_matrix), intent(inout) :: self
    integer :: l

    do l = 1, size(self%level)
      self%level(l)%within = 0.0_wp
      self%level(l)%beyond = 0.0_wp
    end do
  end subroutine clear

  !> Add what one body gives; of each level the lower triangle, until all is `complete`.
  pure subroutine add(self, pair, matrix)
    class(flexibility_matrix), intent(inout) :: self
    integer, intent(in) :: pair(:)          !! of the body, ascending
    real(wp), intent(in) :: matrix(:, :)    !! its part, the lower triangle [length/force]
    integer :: i, k, l
    integer :: at(size(pair)), of(size(pair))   ! places and levels

    at = self%place(pair)
    of = self%level_of(pair)
    do k = 1, size(pair)
      l = of(k)
      do i = k, size(pair)
        if (of(i) == l) then
          self%level(l)%within(at(i), at(k)) = self%level(l)%within(at(i), at(k)) + matrix(i, k)
        else if (of(i) > l) then
          self%level(l)%beyond(at(i), at(k)) = self%level(l)%beyond(at(i), at(k)) + matrix(i, k)
        else
          self%level(of(i))%beyond(at(k), at(i)) = self%level(of(i))%beyond(at(k), at(i)) + matrix(i, k)
        end if
      end do
    end do
  end subroutine add

  !> When all parts have been added: copy the lower triangles to the upper ones.
  pure subroutine complete(self)
    class(flexibility_matrix), intent(inout) :: self
    integer :: i, j, k, l, n

    do l = 1, size(self%level)
      n = size(self%level(l)%pair)
      associate (f => self%level(l)%within)
        do k = 1, n, tile
          do i = k, n, tile
            do j = k, min(k + tile - 1, n)
              f(j, max(i, j + 1):min(i + tile - 1, n)) = f(max(i, j + 1):min(i + tile - 1, n), j)
            end do
          end do
        end do
      end associate
    end do
  end subroutine complete

  !> F R, the gaps that forces open; or |F| |R|, what these are the sum of.
  pure function times(self, force, magnitudes) result(gap)
    class(flexibility_matrix), intent(in) :: self
    real(wp), intent(in) :: force(:)   !! R [force] [pairs]
    logical, intent(in), optional :: magnitudes   !! true: of F and R
    real(wp) :: gap(size(force))       !! [length]
    integer, allocatable :: own(:), next(:)
    integer :: l
    logical :: absolute

    absolute = .false.
    if (present(magnitudes)) absolute = magnitudes
    gap = 0.0_wp
    do l = 1, size(self%level)
      own = self%level(l)%pair
      gap(own) = gap(own) + product_of(self%level(l)%within, force(own), absolute)
      if (l == size(self%level)) exit
      next = self%level(l + 1)%pair
      gap(next) = product_of(self%level(l)%beyond, force(own), absolute)
      gap(own) = gap(own) + product_of(transpose(self%level(l)%beyond), force(next), absolute)
    end do
  end function times

  !> A matrix times forces; or their magnitudes.
  pure function product_of(matrix, force, absolute) result(gap)
    real(wp), intent(in) :: matrix(:, :), force(:)
    logical, intent(in) :: absolute
    real(wp) :: gap(size(matrix, 1))
    integer :: k

    gap = 0.0_wp
    do k = 1, size(force)
      if (force(k) == 0.0_wp) cycle
      if (absolute) then
        gap = gap + abs(force(k)*matrix(:, k))
      else
        gap = gap + force(k)*matrix(:, k)
      end if
    end do
  end function product_of

  !> Opening of each pair by a unit force of its own [length/force] [pairs].
  pure function diagonal(self)
    class(flexibility_matrix), intent(in) :: self
    real(wp) :: diagonal(size(self%place))
    integer :: k

    do k = 1, size(diagonal)
      diagonal(k) = self%level(self%level_of(k))%within(self%place(k), self%place(k))
    end do
  end function diagonal

  !> Opening of some pairs by unit forces of others [length/force] [rows, columns].
  pure function block(self, rows, columns)
    class(flexibility_matrix), intent(in) :: self
    integer, intent(in) :: rows(:), columns(:)   !! pairs
    real(wp), allocatable :: block(:, :)
    integer :: i, k

    allocate (block(size(rows), size(columns)))
    do k = 1, size(columns)
      do i = 1, size(rows)
        block(i, k) = entry_of(self, rows(i), columns(k))
      end do
    end do
  end function block

  pure real(wp) function entry_of(self, i, k) result(entry)
    type(flexibility_matrix), intent(in) :: self
    integer, intent(in) :: i, k   !! pairs
    integer :: l

    l = self%level_of(k)
    select case (self%level_of(i) - l)
    case (0)
      entry = self%level(l)%within(self%place(i), self%place(k))
    case (1)
      entry = self%level(l)%beyond(self%place(i), self%place(k))
    case (-1)
      entry = self%level(l - 1)%beyond(self%place(k), self%place(i))
    case default
      entry = 0.0_wp
    end select
  end function entry_of

  !> All of it [length/force] [pairs, pairs].
  pure function dense(self)
    class(flexibility_matrix), intent(in) :: self
    real(wp), allocatable :: dense(:, :)
    integer :: k

    dense = self%block([(k, k=1, size(self%place))], [(k, k=1, size(self%place))])
  end function dense
end module epcont_contact_flexibility_matrix
