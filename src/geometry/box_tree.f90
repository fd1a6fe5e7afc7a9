!> Tree of boxes that finds the boxes that meet a given box or a moving box.
!>
!> The boxes are divided repeatedly into halves by their centres, along their larger extent. Node i of the
!> tree has the children 2i and 2i + 1, and the box of all its descendants. A leaf is one box. Boxes may have
!> displacements.
module epcont_geometry_box_tree
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: halve
  implicit none
  private
  public :: box_tree, box_query, motion_query, new_box_tree

  type :: box_tree
    integer, allocatable :: item(:)      !! number of the box of each leaf; 0 for other nodes [nodes]
    real(wp), allocatable :: low(:, :)   !! low corner of each node's box [length] [2, nodes]
    real(wp), allocatable :: high(:, :)  !! high corner [length] [2, nodes]
    !> Least and largest components of the displacements in each node's box; not allocated if boxes do not
    !! move [2, 2, nodes]
    real(wp), allocatable :: span(:, :, :)
  contains
    procedure :: set_spans
    procedure :: meeting
    procedure :: away
  end type box_tree

  !> Query: boxes that meet this one.
  type :: box_query
    real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp   !! [length]
  contains
    procedure :: may_meet
  end type box_query

  !> Query: boxes that a moving box meets, while each of them moves by its displacements. Boxes are given at
  !! time 1; motions are straight and begin at time 0.
  type, extends(box_query) :: motion_query
    real(wp) :: motion(2) = 0.0_wp                 !! displacement of the given box [length]
    real(wp) :: time(2) = [0.0_wp, 1.0_wp]         !! start and end of the time range
  contains
    procedure :: may_meet => may_be_met
  end type motion_query

  !> Largest number of nodes that wait during a walk through a tree: one on each level, and one more.
  integer, parameter, public :: most_waiting = bit_size(1) + 1

contains

  !> Make the tree of boxes between `low` and `high`.
  pure function new_box_tree(low, high) result(tree)
    real(wp), intent(in) :: low(:, :), high(:, :)   !! [length] [2, boxes]
    type(box_tree) :: tree
    integer, allocatable :: first(:), last(:), order(:)
    integer :: axis, i, middle, nodes

    nodes = 2**(bit_size(1) - leadz(max(size(low, 2) - 1, 0)) + 1) - 1
    allocate (tree%item(nodes), first(nodes), last(nodes), source=0)
    allocate (tree%low(2, nodes), source=huge(1.0_wp))
    tree%high = -tree%low
    order = [(i, i=1, size(low, 2))]
    if (size(order) == 0) return   ! a root that no box meets
    first(1) = 1
    last(1) = size(order)
    do i = 1, nodes
      if (first(i) == 0) cycle
      associate (own => order(first(i):last(i)))
        tree%low(:, i) = minval(low(:, own), dim=2)
        tree%high(:, i) = maxval(high(:, own), dim=2)
        if (size(own) == 1) tree%item(i) = own(1)   ! leaf
        if (size(own) == 1) cycle
        axis = maxloc(tree%high(:, i) - tree%low(:, i), dim=1)
        call halve(low(axis, own) + high(axis, own), own)
        middle = first(i) + size(own)/2
      end associate
      first(2*i:2*i + 1) = [first(i), middle]
      last(2*i:2*i + 1) = [middle - 1, last(i)]
    end do
  end function new_box_tree

  !> Set the displacements of the boxes.
  pure subroutine set_spans(self, span)
    class(box_tree), intent(inout) :: self
    real(wp), intent(in) :: span(:, :, :)   !! least and largest components for each box [2, 2, boxes]
    integer :: i

    allocate (self%span(2, 2, size(self%item)))
    self%span(:, 1, :) = huge(1.0_wp)
    self%span(:, 2, :) = -huge(1.0_wp)
    do i = size(self%item), 1, -1
      if (self%item(i) > 0) then
        self%span(:, :, i) = span(:, :, self%item(i))
      else if (2*i < size(self%item)) then
        self%span(:, 1, i) = min(self%span(:, 1, 2*i), self%span(:, 1, 2*i + 1))
        self%span(:, 2, i) = max(self%span(:, 2, 2*i), self%span(:, 2, 2*i + 1))
      end if
    end do
  end subroutine set_spans

  !> Boxes that meet a query, in the order of the tree.
  pure function meeting(self, query) result(found)
    class(box_tree), intent(in) :: self
    class(box_query), intent(in) :: query   !! box to be met
    integer, allocatable :: found(:)
    integer :: count, i, waiting(most_waiting), waits

    allocate (found(16))
    count = 0
    waiting(1) = 1
    waits = 1
    do while (waits > 0)
      i = waiting(waits)
      waits = waits - 1
      if (.not. query%may_meet(self, i)) cycle
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

  !> Does the box of the query meet that of a node?
  pure logical function may_meet(self, tree, node)
    class(box_query), intent(in) :: self
    type(box_tree), intent(in) :: tree
    integer, intent(in) :: node          !! number of the node

    may_meet = all(self%low <= tree%high(:, node)) .and. all(self%high >= tree%low(:, node))
  end function may_meet

  !> Does a moving box meet that of a node? Distances along an axis are linear in time: each axis leaves a
  !! part of the time range.
  pure logical function may_be_met(self, tree, node)
    class(motion_query), intent(in) :: self
    type(box_tree), intent(in) :: tree
    integer, intent(in) :: node          !! number of the node
    real(wp) :: ends(2), now(4), rate(4), time(2)
    integer :: k

    now = [self%high - tree%low(:, node), tree%high(:, node) - self%low]
    rate = [self%motion - tree%span(:, 2, node), tree%span(:, 1, node) - self%motion]
    time = self%time
    may_be_met = .false.
    do k = 1, 4
      ends = now(k) - (1.0_wp - time)*rate(k)
      if (all(ends < 0.0_wp)) return
      if (all(ends >= 0.0_wp)) cycle
      time(minloc(ends, dim=1)) = time(1) - (time(2) - time(1))*ends(1)/(ends(2) - ends(1))
    end do
    may_be_met = .true.
  end function may_be_met

  !> Square of the distance of a point from the box of a node; 0 inside [length**2].
  pure real(wp) function away(self, node, point)
    class(box_tree), intent(in) :: self
    integer, intent(in) :: node   !! number of the node
    real(wp), intent(in) :: point(2)   !! [length]

    away = sum(max(self%low(:, node) - point, 0.0_wp, point - self%high(:, node))**2)
  end function away
end module epcont_geometry_box_tree
