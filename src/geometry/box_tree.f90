!> Which of many boxes meet a given one, without looking at all of them.
!>
!> The boxes are halved by their middles, across the longer way of their extent, again and again; node i of
!> the tree has the children 2i and 2i + 1, and each node has the box round all that lies below it. A leaf is
!> one box. Boxes may have directions, too: normals of what is in them.
module epcont_geometry_box_tree
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: halve
  implicit none
  private
  public :: box_tree, new_box_tree

  type :: box_tree
    integer, allocatable :: item(:)      !! which box a leaf is; 0: no leaf [nodes]
    real(wp), allocatable :: low(:, :)   !! corner of each node's box [length] [2, nodes]
    real(wp), allocatable :: high(:, :)  !! the opposite one [length] [2, nodes]
    !> Least and largest components of the directions of what is in each node's box; or none are known
    !! [2, 2, nodes]
    real(wp), allocatable :: way(:, :, :)
  contains
    procedure :: meeting
    procedure :: away
  end type box_tree

  !> Nodes that wait while a tree is walked, at most: one a level and one more.
  integer, parameter, public :: most_waiting = bit_size(1) + 1

contains

  !> The tree of boxes from `low` to `high`.
  pure function new_box_tree(low, high, way) result(tree)
    real(wp), intent(in) :: low(:, :), high(:, :)   !! [length] [2, boxes]
    !> Least and largest components of the directions of each [2, 2, boxes]
    real(wp), intent(in), optional :: way(:, :, :)
    type(box_tree) :: tree
    integer, allocatable :: first(:), last(:), order(:)
    integer :: axis, i, middle, nodes

    nodes = 2**(bit_size(1) - leadz(max(size(low, 2) - 1, 0)) + 1) - 1
    allocate (tree%item(nodes), first(nodes), last(nodes), source=0)
    allocate (tree%low(2, nodes), source=huge(1.0_wp))
    tree%high = -tree%low
    if (present(way)) allocate (tree%way(2, 2, nodes), source=0.0_wp)
    order = [(i, i=1, size(low, 2))]
    if (size(order) == 0) return   ! a root that nothing meets
    first(1) = 1
    last(1) = size(order)
    do i = 1, nodes
      if (first(i) == 0) cycle
      associate (own => order(first(i):last(i)))
        tree%low(:, i) = minval(low(:, own), dim=2)
        tree%high(:, i) = maxval(high(:, own), dim=2)
        if (present(way)) tree%way(:, 1, i) = minval(way(:, 1, own), dim=2)
        if (present(way)) tree%way(:, 2, i) = maxval(way(:, 2, own), dim=2)
        if (size(own) == 1) tree%item(i) = own(1)   ! a leaf
        if (size(own) == 1) cycle
        axis = maxloc(tree%high(:, i) - tree%low(:, i), dim=1)
        call halve(low(axis, own) + high(axis, own), own)
        middle = first(i) + size(own)/2
      end associate
      first(2*i:2*i + 1) = [first(i), middle]
      last(2*i:2*i + 1) = [middle - 1, last(i)]
    end do
  end function new_box_tree

  !> The boxes that meet the one from `low` to `high`, ascending by their place in the tree. With `from`, only
  !! those that a line may pass through which begins there: along `along`, or, where that is not given, along a
  !! direction of the box.
  pure function meeting(self, low, high, from, along) result(found)
    class(box_tree), intent(in) :: self
    real(wp), intent(in) :: low(2), high(2)   !! [length]
    real(wp), intent(in), optional :: from(2, 2)    !! low and high corner of a box, too [length]
    real(wp), intent(in), optional :: along(2, 2)   !! least and largest components of directions
    integer, allocatable :: found(:)
    integer :: count, i, waiting(most_waiting), waits

    allocate (found(16))
    count = 0
    waiting(1) = 1
    waits = 1
    do while (waits > 0)
      i = waiting(waits)
      waits = waits - 1
      if (any(high < self%low(:, i)) .or. any(low > self%high(:, i))) cycle
      if (present(along)) then
        if (.not. may_pass(from, along, self%low(:, i), self%high(:, i))) cycle
      else if (present(from)) then
        if (.not. may_pass(from, self%way(:, :, i), self%low(:, i), self%high(:, i))) cycle
      end if
      if (self%item(i) == 0) then
        waiting(waits + 1:waits + 2) = [2*i + 1, 2*i]
        waits = waits + 2
        cycle
      end if
      if (count == size(found)) found = [found, found]
      count = count + 1
      found(count) = self%item(i)
    end do
    found = found(:count)
  end function meeting

  !> May a line from a place in one box, along a direction between two, pass through another box? There the
  !! vector product of direction and way may be zero.
  pure logical function may_pass(from, along, low, high)
    real(wp), intent(in) :: from(2, 2), along(2, 2), low(2), high(2)
    real(wp) :: least(2), most(2), product(4), way(2)
    integer :: k

    do k = 1, 2
      way = [low(3 - k) - from(3 - k, 2), high(3 - k) - from(3 - k, 1)]
      product = [along(k, 1)*way, along(k, 2)*way]
      least(k) = minval(product)
      most(k) = maxval(product)
    end do
    may_pass = least(1) <= most(2) .and. least(2) <= most(1)
  end function may_pass

  !> Square of the distance of a point from the box of a node; 0 in it [length**2].
  pure real(wp) function away(self, node, point)
    class(box_tree), intent(in) :: self
    integer, intent(in) :: node   !! its node
    real(wp), intent(in) :: point(2)   !! [length]

    away = sum(max(self%low(:, node) - point, 0.0_wp, point - self%high(:, node))**2)
  end function away
end module epcont_geometry_box_tree
