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
!> (`linalg/levels.f90`).
module epcont_contact_flexibility_matrix
  use epcont_base_kinds, only: wp
  use epcont_linalg_levels, only: levels_of_pairs
  implicit none
  private
  public :: flexibility_matrix, dense_flexibility, new_flexibility

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

    new%level_of = levels_of_pairs(body, bodies)
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
