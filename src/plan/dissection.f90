!> Nested dissection: an order of a body's nodes in which elimination fills little, and the fronts it falls into.
!>
!> A set of nodes is halved at the median of the coordinate across which the fewest elements lie. The nodes of one half that
!> elements join to the other are its separator: with them out of the way the halves know nothing of each other, so each is
!> eliminated by itself, and in the same manner, before the separator (George, SIAM J. Numer. Anal. 10 (1973) 345).
module epcont_plan_dissection
  use epcont_base_incidence, only: incidence
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: halve
  implicit none
  private
  public :: dissection, dissect

  type :: dissection
    integer, allocatable :: node(:)    !! in the order of elimination
    integer, allocatable :: first(:)   !! the first of each front in it, and one behind the last [fronts + 1]
  end type dissection

  !> Sets of so few nodes are not halved. From 12 to 24 it matters little: fewer operations against more and smaller matrices.
  integer, parameter :: few = 16
  !> Sets of more are halved where the fewest elements are cut, others along the coordinate of the plane that spreads most: which
  !! elements are cut takes longer to find, and is soon repaid only where separators are long.
  integer, parameter :: many = 100
  !> A half may not have more of its set than this.
  real(wp), parameter :: largest_half = 0.6_wp

  !> Coordinates along which sets may be halved.
  integer, parameter :: axes = 3

  !> Where a node is, seen from the set that is being halved. At the edge of their half are nodes that have neighbours across; of
  !! these, those of the separator then belong to neither half.
  integer, parameter :: outside = 0, left = 1, right = 2, both = 3, edge = 4
  !> The neighbours that a node has in a half, where it is not one.
  integer, parameter :: none = 0, several = -1

  type :: workspace
    integer, allocatable :: node(:), element(:)   !! those of a set stand together
    integer, allocatable :: side(:)               !! one of its kind above, and for none [0:all nodes]
    integer, allocatable :: order(:), first(:)    !! what is found so far
    integer :: ordered = 0, fronts = 0
  end type workspace

contains

  !> Dissect a body. The nodes that are wanted last are a front of their own, the last.
  pure function dissect(coordinate, member, around, elements, nodes, wanted_last) result(found)
    real(wp), intent(in) :: coordinate(:, :)   !! x, y and one more, along which nodes are parted [3, all nodes]
    integer, contiguous, intent(in) :: member(:, :)   !! nodes of each element, zeros behind [any, all elements]
    type(incidence), intent(in) :: around      !! elements at each node
    integer, intent(in) :: elements(:)         !! of the body
    integer, intent(in) :: nodes(:)            !! of the body
    logical, intent(in) :: wanted_last(:)      !! [all nodes]
    type(dissection) :: found
    type(workspace) :: work

    work%node = pack(nodes, .not. wanted_last(nodes))
    work%element = elements
    allocate (work%side(0:size(wanted_last)), source=outside)
    allocate (work%order(size(nodes)), work%first(size(nodes) + 1))
    call dissect_set(coordinate, member, around, 1, size(work%node), 1, size(work%element), work)
    call add_front(pack(nodes, wanted_last(nodes)), work)
    found%node = work%order
    found%first = [work%first(:work%fronts), size(nodes) + 1]
  end function dissect

  pure recursive subroutine dissect_set(coordinate, member, around, first, last, first_element, last_element, work)
    real(wp), intent(in) :: coordinate(:, :)
    integer, contiguous, intent(in) :: member(:, :)
    type(incidence), intent(in) :: around
    integer, intent(in) :: first, last                   !! the set in the list of nodes
    integer, intent(in) :: first_element, last_element   !! and its elements, all that have a node in it
    type(workspace), intent(inout) :: work
    integer, allocatable :: separator(:)
    integer :: nodes(left:right), middle, middle_element, end_element

    if (last - first + 1 <= few) then
      call add_front(work%node(first:last), work)
      return
    end if
    associate (node => work%node(first:last), element => work%element(first_element:last_element))
      nodes = 0
      if (size(node) > many) call cut_least(coordinate, member, node, element, work%side, nodes)
      if (any(nodes == 0)) call cut_midway(coordinate, node, work%side, nodes)
      call find_separator(member, around, node, element, nodes, work%side)
    end associate
    call part_elements(member, first_element, last_element, middle_element, end_element, work)
    call part_nodes(first, last, middle, separator, work)
    call dissect_set(coordinate, member, around, first, middle, first_element, middle_element, work)
    call dissect_set(coordinate, member, around, middle + 1, last - size(separator), middle_element + 1, end_element, work)
    call add_front(separator, work)
  end subroutine dissect_set

  !> Halve a set where the fewest elements lie across: at the median of one of the coordinates. Those of some of the nodes serve;
  !! where many nodes have the same coordinate, they may part the set too unevenly, and none is taken.
  pure subroutine cut_least(coordinate, member, node, element, side, nodes)
    real(wp), intent(in) :: coordinate(:, :)
    integer, contiguous, intent(in) :: member(:, :)
    integer, intent(in) :: node(:), element(:)     !! of the set
    integer, contiguous, intent(inout) :: side(0:) !! on the way two bits for each coordinate
    integer, intent(inout) :: nodes(left:right)    !! in each half
    integer, parameter :: sample = 128
    real(wp) :: at(axes)
    integer :: below(axes), cut(axes), axis, e, i, k, sides
    integer, allocatable :: some(:)

    do k = 1, axes
      some = node(::size(node)/sample + 1)
      call halve(coordinate(k, some), some)
      at(k) = maxval(coordinate(k, some(:size(some)/2)))
    end do
    below = 0
    do i = 1, size(node)
      sides = outside
      do k = 1, axes
        if (coordinate(k, node(i)) <= at(k)) then
          below(k) = below(k) + 1
          sides = ior(sides, shiftl(left, 2*(k - 1)))
        else
          sides = ior(sides, shiftl(right, 2*(k - 1)))
        end if
      end do
      side(node(i)) = sides
    end do
    cut = 0
    do e = 1, size(element)
      sides = sides_of(member, element(e), side)
      do k = 1, axes
        if (ibits(sides, 2*(k - 1), 2) == both) cut(k) = cut(k) + 1
      end do
    end do
    axis = minloc(cut, dim=1, mask=max(below, size(node) - below) <= largest_half*size(node))
    if (axis == 0) return
    nodes = [below(axis), size(node) - below(axis)]
    side(node) = ibits(side(node), 2*(axis - 1), 2)
  end subroutine cut_least

  !> Halve a set at the median of that coordinate of the plane along which it spreads most.
  pure subroutine cut_midway(coordinate, node, side, nodes)
    real(wp), intent(in) :: coordinate(:, :)
    integer, intent(inout) :: node(:)              !! of the set
    integer, contiguous, intent(inout) :: side(0:)
    integer, intent(out) :: nodes(left:right)      !! in each half
    integer :: axis

    axis = maxloc([spread_along(coordinate(1, :), node), spread_along(coordinate(2, :), node)], dim=1)
    call halve(coordinate(axis, node), node)
    nodes = [size(node)/2, size(node) - size(node)/2]
    side(node(:nodes(left))) = left
    side(node(nodes(left) + 1:)) = right
  end subroutine cut_midway

  !> Mark the separator: the shorter of the edges that the halves have where elements join them, moved to where it is shorter.
  pure subroutine find_separator(member, around, node, element, nodes, side)
    integer, contiguous, intent(in) :: member(:, :)
    type(incidence), intent(in) :: around
    integer, intent(in) :: node(:), element(:)     !! of the set
    integer, intent(inout) :: nodes(left:right)    !! in each half
    integer, contiguous, intent(inout) :: side(0:)
    integer :: at_edge(size(node)), edges(left:right)
    integer :: e, i, n, shorter

    n = 0
    edges = 0
    do e = 1, size(element)
      if (iand(sides_of(member, element(e), side), both) /= both) cycle
      do i = 1, size(member, 1)
        if (member(i, element(e)) == 0) exit
        associate (here => side(member(i, element(e))))
          if (here /= left .and. here /= right) cycle
          edges(here) = edges(here) + 1
          here = here + edge
        end associate
        n = n + 1
        at_edge(n) = member(i, element(e))
      end do
    end do
    shorter = merge(left, right, edges(left) <= edges(right))
    nodes(shorter) = nodes(shorter) - edges(shorter)
    do i = 1, n
      associate (here => side(at_edge(i)))
        here = merge(edge, here - edge, here == shorter + edge)
      end associate
    end do
    call shift_separator(member, around, pack(at_edge(:n), side(at_edge(:n)) == edge), nodes, side)
  end subroutine find_separator

  !> Let nodes of the separator go to a half: if they have no neighbours in the other, or only one, which takes their place, and
  !! the halves become more alike. (Liu, ACM Trans. Math. Softw. 15 (1989) 198, moves several at once.)
  pure subroutine shift_separator(member, around, separator, nodes, side)
    integer, contiguous, intent(in) :: member(:, :)
    type(incidence), intent(in) :: around
    integer, intent(in) :: separator(:)
    integer, intent(inout) :: nodes(left:right)      !! in each half
    integer, contiguous, intent(inout) :: side(0:)
    integer :: beside(left:right), half, i, length, other
    integer :: list(sum(nodes) + 2*size(separator))

    length = size(separator)
    list(:length) = separator
    i = 0
    do while (i < length)
      i = i + 1
      beside = neighbours(member, around, list(i), side)
      half = merge(left, right, nodes(left) < nodes(right))
      other = both - half
      if (beside(other) /= none .and. beside(half) == none .and. nodes(other) < largest_half*sum(nodes)) then
        half = other
        other = both - half
      end if
      if (beside(other) == several) cycle
      if (beside(other) /= none) then
        if (nodes(half) + 1 >= nodes(other)) cycle
        length = length + 1
        list(length) = beside(other)
        side(beside(other)) = edge
        nodes(other) = nodes(other) - 1
      end if
      side(list(i)) = half
      nodes(half) = nodes(half) + 1
    end do
  end subroutine shift_separator

  !> The neighbour of a node in each half; or none, or several.
  pure function neighbours(member, around, node, side) result(beside)
    integer, contiguous, intent(in) :: member(:, :)
    type(incidence), intent(in) :: around
    integer, intent(in) :: node
    integer, contiguous, intent(in) :: side(0:)
    integer :: beside(left:right)
    integer :: i, j

    beside = none
    do j = around%start(node), around%start(node + 1) - 1
      do i = 1, size(member, 1)
        associate (other => member(i, around%group(j)))
          if (other == 0) exit
          if (side(other) /= left .and. side(other) /= right) cycle
          associate (known => beside(side(other)))
            if (known == none) then
              known = other
            else if (known /= other) then
              known = several
            end if
          end associate
        end associate
      end do
    end do
  end function neighbours

  !> Where an element has nodes, all bits that say so.
  pure integer function sides_of(member, element, side) result(sides)
    integer, contiguous, intent(in) :: member(:, :)
    integer, intent(in) :: element
    integer, contiguous, intent(in) :: side(0:)
    integer :: i

    sides = ior(ior(side(member(1, element)), side(member(2, element))), side(member(3, element)))
    do i = 4, size(member, 1)
      sides = ior(sides, side(member(i, element)))
    end do
  end function sides_of

  !> Put the elements of the left half before those of the right. What has nodes of the separator alone is done with.
  pure subroutine part_elements(member, first, last, middle, end_of_right, work)
    integer, contiguous, intent(in) :: member(:, :)
    integer, intent(in) :: first, last               !! in the list of elements
    integer, intent(out) :: middle, end_of_right     !! the last of the left half, and of the right
    type(workspace), intent(inout) :: work
    integer :: of_right(last - first + 2)
    integer :: e, n, sides

    middle = first - 1
    n = 0
    do e = first, last
      sides = iand(sides_of(member, work%element(e), work%side), both)
      of_right(n + 1) = work%element(e)
      work%element(middle + 1) = work%element(e)
      middle = middle + merge(1, 0, sides == left)
      n = n + merge(1, 0, sides == right)
    end do
    end_of_right = middle + n
    work%element(middle + 1:end_of_right) = of_right(:n)
  end subroutine part_elements

  !> Put the nodes of the left half before those of the right, and these before the separator.
  pure subroutine part_nodes(first, last, middle, separator, work)
    integer, intent(in) :: first, last
    integer, intent(out) :: middle                      !! the last of the left half
    integer, allocatable, intent(out) :: separator(:)
    type(workspace), intent(inout) :: work
    integer :: list(last - first + 2, right:edge)
    integer :: length(left:edge), i

    length = 0
    do i = first, last
      associate (node => work%node(i), side => work%side(work%node(i)))
        list(length(right) + 1, right) = node
        list(length(edge) + 1, edge) = node
        work%node(first + length(left)) = node
        length(side) = length(side) + 1
        side = outside
      end associate
    end do
    middle = first - 1 + length(left)
    work%node(middle + 1:last) = [list(:length(right), right), list(:length(edge), edge)]
    separator = list(:length(edge), edge)
  end subroutine part_nodes

  !> How far nodes are spread: the variance of a coordinate.
  pure real(wp) function spread_along(coordinate, node) result(variance)
    real(wp), intent(in) :: coordinate(:)   !! of all nodes
    integer, intent(in) :: node(:)
    real(wp) :: mean

    mean = sum(coordinate(node))/size(node)
    variance = sum((coordinate(node) - mean)**2)/size(node)
  end function spread_along

  pure subroutine add_front(nodes, work)
    integer, intent(in) :: nodes(:)
    type(workspace), intent(inout) :: work

    if (size(nodes) == 0) return
    work%fronts = work%fronts + 1
    work%first(work%fronts) = work%ordered + 1
    work%order(work%ordered + 1:work%ordered + size(nodes)) = nodes
    work%ordered = work%ordered + size(nodes)
  end subroutine add_front
end module epcont_plan_dissection
