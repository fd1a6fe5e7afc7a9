!> Tree of boxes that finds the boxes that meet a given box.
!>
!> The boxes are divided repeatedly into halves by their centres, along their larger extent. Node i of the
!> tree has the children 2i and 2i + 1, and the box of all its descendants. A leaf is one box.
module epcont_geometry_box_tree
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: halve
  implicit none
  private
  public :: box_tree, new_box_tree

  type :: box_tree
    integer, allocatable :: item(:)      !! number of the box of each leaf; 0 for other nodes [nodes]
    real(wp), allocatable :: low(:, :)   !! low corner of each node's box [length] [2, nodes]
    real(wp), allocatable :: high(:, :)  !! high corner [length] [2, nodes]
  contains
    procedure :: meeting
    procedure :: away
  end type box_tree

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

  !> Boxes that meet a given box, in the order of the tree.
  pure function meeting(self, low, high) result(found)
    class(box_tree), intent(in) :: self
    real(wp), intent(in) :: low(2), high(2)   !! of the given box [length]
    integer, allocatable :: found(:)
    integer :: count, i, waiting(most_waiting), waits

    allocate (found(16))
    count = 0
    waiting(1) = 1
    waits = 1
    do while (waits > 0)
      i = waiting(waits)
      waits = waits - 1
      if (.not. (all(low <= self%high(:, i)) .and. all(high >= self%low(:, i)))) cycle
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

  !> Square of the distance of a point from the box of a node; 0 inside [length**2].
  pure real(wp) function away(self, node, point)
    class(box_tree), intent(in) :: self
    integer, intent(in) :: node   !! number of the node
    real(wp), intent(in) :: point(2)   !! [length]

    away = sum(max(self%low(:, node) - point, 0.0_wp, point - self%high(:, node))**2)
  end function away
end module epcont_geometry_box_tree
