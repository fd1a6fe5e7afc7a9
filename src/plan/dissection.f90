!> Nested dissection: an order of a body's nodes in which elimination fills little, and the fronts it falls
!> into.
!>
!> A set of nodes is halved at the median of the coordinate across which the fewest elements lie. The nodes of
!> one half that elements join to the other are its separator: with them out of the way the halves know
!> nothing of each other, so each is eliminated by itself, and in the same manner, before the separator
!> (George, SIAM J. Numer. Anal. 10 (1973) 345).
module epcont_plan_dissection
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: halve
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: dissection, dissect

  type :: dissection
    integer, allocatable :: node(:)    !! in the order of elimination
    integer, allocatable :: first(:)   !! the first of each front in it, and one behind the last [fronts + 1]
  end type dissection

  !> Sets of so few nodes are not halved. From 12 to 24 it matters little: fewer operations against more and
  !! smaller matrices.
  integer, parameter :: few = 16
  !> Sets of more are halved where the fewest elements are cut, others along the coordinate of the plane that
  !! spreads most: which elements are cut takes longer to find, and is soon repaid only where separators are
  !! long.
  integer, parameter :: many = 100
  !> A half may not have more of its set than this.
  real(wp), parameter :: largest_half = 0.6_wp
  !> Coordinates along which sets may be halved, and nodes of a set whose median serves for that of all.
  integer, parameter :: axes = 3, sample = 128

  !> Where a node is, seen from the set that is being halved. At the edge of their half are nodes that have
  !! neighbours across; of these, those of the separator then belong to neither half.
  integer, parameter :: outside = 0, left = 1, right = 2, both = 3, edge = 4
  !> The neighbours that a node has in a half, where it is not one.
  integer, parameter :: none = 0, several = -1

  !> A set that is to be halved: its places in the lists of nodes and of elements, all that have a node in it.
  type :: node_set
    integer :: first, last, first_element, last_element
  end type node_set

  type :: workspace
    !> X, y and one more, along which nodes are parted [3, all nodes]
    real(wp), allocatable :: coordinate(:, :)
    integer, allocatable :: node(:), element(:)   !! those of a set stand together
    integer, allocatable :: side(:)               !! one of its kind above, and for none [0:all nodes]
    integer :: nodes(left:right) = 0              !! in each half of the set that is being halved
    integer, allocatable :: order(:), first(:)    !! what is found so far
    integer :: ordered = 0, fronts = 0
  end type workspace

contains

  !> Dissect a body along x, y and one more coordinate. The nodes that are wanted last are a front of their
  !! own, the last.
  pure function dissect(model, further, elements, nodes, wanted_last) result(found)
    type(model_type), intent(in) :: model      !! its nodes, connectivity, and elements around nodes are used
    real(wp), intent(in) :: further(:)         !! the one more coordinate [all nodes]
    integer, intent(in) :: elements(:)         !! of the body
    integer, intent(in) :: nodes(:)            !! of the body
    logical, intent(in) :: wanted_last(:)      !! [all nodes]
    type(dissection) :: found
    type(workspace) :: work

    allocate (work%coordinate(axes, size(further)))
    work%coordinate(:2, :) = model%x
    work%coordinate(3, :) = further
    work%node = pack(nodes, .not. wanted_last(nodes))
    work%element = elements
    allocate (work%side(0:size(wanted_last)), source=outside)
    allocate (work%order(size(nodes)), work%first(size(nodes) + 1))
    call dissect_set(model, work, node_set(1, size(work%node), 1, size(work%element)))
    call add_front(pack(nodes, wanted_last(nodes)), work)
    found%node = work%order
    found%first = [work%first(:work%fronts), size(nodes) + 1]
  end function dissect

  pure recursive subroutine dissect_set(model, work, set)
    type(model_type), intent(in) :: model
    type(workspace), intent(inout) :: work
    type(node_set), intent(in) :: set
    type(node_set) :: half(left:right)
    integer, allocatable :: separator(:)

    associate (count => set%last - set%first + 1)
      if (count <= few) then
        call add_front(work%node(set%first:set%last), work)
        return
      end if
      work%nodes = 0
      if (count > many) call cut_least(model, work, set)
      if (any(work%nodes == 0)) call cut_midway(work, set)
    end associate
    call find_separator(model, work, set)
    call part_elements(model, work, set, half)
    call part_nodes(work, set, half, separator)
    call dissect_set(model, work, half(left))
    call dissect_set(model, work, half(right))
    call add_front(separator, work)
  end subroutine dissect_set

  !> Halve a set where the fewest elements lie across: at the median of one of the coordinates. Where many
  !! nodes have the same coordinate, it may part the set too unevenly, and none is taken.
  pure subroutine cut_least(model, work, set)
    type(model_type), intent(in) :: model
    type(workspace), intent(inout) :: work         !! its sides have two bits for each coordinate on the way
    type(node_set), intent(in) :: set
    integer :: below(axes), cut(axes), axis, e, k, sides

    associate (count => set%last - set%first + 1, node => work%node(set%first:set%last))
      call mark_sides(work, set, below)
      cut = 0
      do e = set%first_element, set%last_element
        sides = sides_of(model, work%element(e), work%side)
        do k = 1, axes
          if (ibits(sides, 2*(k - 1), 2) == both) cut(k) = cut(k) + 1
        end do
      end do
      axis = minloc(cut, dim=1, mask=max(below, count - below) <= largest_half*count)
      if (axis == 0) return
      work%nodes = [below(axis), count - below(axis)]
      work%side(node) = ibits(work%side(node), 2*(axis - 1), 2)
    end associate
  end subroutine cut_least

  !> Mark on which side of the medians of all coordinates each node of a set is, two bits for each.
  pure subroutine mark_sides(work, set, below)
    type(workspace), intent(inout) :: work
    type(node_set), intent(in) :: set
    integer, intent(out) :: below(axes)            !! nodes not above the median
    integer, allocatable :: some(:)
    real(wp) :: median(axes)
    integer :: i, k, sides

    do k = 1, axes
      some = work%node(set%first:set%last:(set%last - set%first + 1)/sample + 1)
      call halve(work%coordinate(k, some), some)
      median(k) = maxval(work%coordinate(k, some(:size(some)/2)))
    end do
    below = 0
    do i = set%first, set%last
      sides = outside
      do k = 1, axes
        if (work%coordinate(k, work%node(i)) <= median(k)) then
          below(k) = below(k) + 1
          sides = ior(sides, shiftl(left, 2*(k - 1)))
        else
          sides = ior(sides, shiftl(right, 2*(k - 1)))
        end if
      end do
      work%side(work%node(i)) = sides
    end do
  end subroutine mark_sides

  !> Halve a set at the median of that coordinate of the plane along which it spreads most.
  pure subroutine cut_midway(work, set)
    type(workspace), intent(inout) :: work
    type(node_set), intent(in) :: set
    integer :: axis

    associate (node => work%node(set%first:set%last))
      axis = maxloc([spread_along(work%coordinate(1, node)), spread_along(work%coordinate(2, node))], dim=1)
      call halve(work%coordinate(axis, node), node)
      work%nodes(left) = size(node)/2
      work%nodes(right) = size(node) - work%nodes(left)
      work%side(node(:work%nodes(left))) = left
      work%side(node(work%nodes(left) + 1:)) = right
    end associate
  end subroutine cut_midway

  !> How far nodes are spread: the variance of a coordinate.
  pure real(wp) function spread_along(coordinate) result(variance)
    real(wp), intent(in) :: coordinate(:)

    variance = sum((coordinate - sum(coordinate)/size(coordinate))**2)/size(coordinate)
  end function spread_along

  !> Mark the separator: the shorter of the edges that the halves have where elements join them, moved to
  !! where it is shorter.
  pure subroutine find_separator(model, work, set)
    type(model_type), intent(in) :: model
    type(workspace), intent(inout) :: work
    type(node_set), intent(in) :: set
    integer :: at_edge(set%last - set%first + 1), edges(left:right)
    integer :: e, i, n, shorter

    n = 0
    edges = 0
    do e = set%first_element, set%last_element
      if (iand(sides_of(model, work%element(e), work%side), both) /= both) cycle
      do i = 1, size(model%connectivity, 1)
        associate (node => model%connectivity(i, work%element(e)))
          if (node == 0) exit
          associate (here => work%side(node))
            if (here /= left .and. here /= right) cycle
            edges(here) = edges(here) + 1
            here = here + edge
          end associate
          n = n + 1
          at_edge(n) = node
        end associate
      end do
    end do
    shorter = merge(left, right, edges(left) <= edges(right))
    work%nodes(shorter) = work%nodes(shorter) - edges(shorter)
    do i = 1, n
      associate (here => work%side(at_edge(i)))
        here = merge(edge, here - edge, here == shorter + edge)
      end associate
    end do
    call shift_separator(model, work, pack(at_edge(:n), work%side(at_edge(:n)) == edge))
  end subroutine find_separator

  !> Let nodes of the separator go to a half: if they have no neighbours in the other, or only one, which
  !! takes their place, and the halves become more alike. (Liu, ACM Trans. Math. Softw. 15 (1989) 198, moves
  !! several at once.)
  pure subroutine shift_separator(model, work, separator)
    type(model_type), intent(in) :: model
    type(workspace), intent(inout) :: work
    integer, intent(in) :: separator(:)
    integer :: beside(left:right), half, i, length, other
    integer :: list(sum(work%nodes) + 2*size(separator))

    length = size(separator)
    list(:length) = separator
    i = 0
    do while (i < length)
      i = i + 1
      beside = neighbours(model, list(i), work%side)
      half = merge(left, right, work%nodes(left) < work%nodes(right))
      other = both - half
      if (beside(other) /= none .and. beside(half) == none .and. &
          work%nodes(other) < largest_half*sum(work%nodes)) then
        half = other
        other = both - half
      end if
      if (beside(other) == several) cycle
      if (beside(other) /= none) then
        if (work%nodes(half) + 1 >= work%nodes(other)) cycle
        length = length + 1
        list(length) = beside(other)
        work%side(beside(other)) = edge
        work%nodes(other) = work%nodes(other) - 1
      end if
      work%side(list(i)) = half
      work%nodes(half) = work%nodes(half) + 1
    end do
  end subroutine shift_separator

  !> The neighbour of a node in each half; or none, or several.
  pure function neighbours(model, node, side) result(beside)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    integer, contiguous, intent(in) :: side(0:)
    integer :: beside(left:right)
    integer :: i, j

    beside = none
    do j = model%around%start(node), model%around%start(node + 1) - 1
      do i = 1, size(model%connectivity, 1)
        associate (other => model%connectivity(i, model%around%group(j)))
          if (other == 0) exit
          if (side(other) /= left .and. side(other) /= right) cycle
          associate (known => beside(side(other)))
            known = merge(other, several, known == none .or. known == other)
          end associate
        end associate
      end do
    end do
  end function neighbours

  !> Where an element has nodes, all bits that say so.
  pure integer function sides_of(model, element, side) result(sides)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element
    integer, contiguous, intent(in) :: side(0:)
    integer :: i

    associate (node => model%connectivity)
      sides = ior(ior(side(node(1, element)), side(node(2, element))), side(node(3, element)))
      do i = 4, size(node, 1)
        sides = ior(sides, side(node(i, element)))
      end do
    end associate
  end function sides_of

  !> Put the elements of the left half before those of the right. What has nodes of the separator alone is
  !! done with.
  pure subroutine part_elements(model, work, set, half)
    type(model_type), intent(in) :: model
    type(workspace), intent(inout) :: work
    type(node_set), intent(in) :: set
    type(node_set), intent(out) :: half(left:right)
    integer :: of_right(set%last_element - set%first_element + 2)
    integer :: e, middle, n, sides

    middle = set%first_element - 1
    n = 0
    do e = set%first_element, set%last_element
      sides = iand(sides_of(model, work%element(e), work%side), both)
      of_right(n + 1) = work%element(e)
      work%element(middle + 1) = work%element(e)
      middle = middle + merge(1, 0, sides == left)
      n = n + merge(1, 0, sides == right)
    end do
    work%element(middle + 1:middle + n) = of_right(:n)
    half%first_element = [set%first_element, middle + 1]
    half%last_element = [middle, middle + n]
  end subroutine part_elements

  !> Put the nodes of the left half before those of the right, and these before the separator.
  pure subroutine part_nodes(work, set, half, separator)
    type(workspace), intent(inout) :: work
    type(node_set), intent(in) :: set
    type(node_set), intent(inout) :: half(left:right)
    integer, allocatable, intent(out) :: separator(:)
    integer :: list(set%last - set%first + 2, right:edge)
    integer :: length(left:edge), i

    length = 0
    do i = set%first, set%last
      associate (node => work%node(i), side => work%side(work%node(i)))
        list(length(right) + 1, right) = node
        list(length(edge) + 1, edge) = node
        work%node(set%first + length(left)) = node
        length(side) = length(side) + 1
        side = outside
      end associate
    end do
    separator = list(:length(edge), edge)
    work%node(set%first + length(left):set%last) = [list(:length(right), right), separator]
    half%first = set%first + [0, length(left)]
    half%last = half%first + length(left:right) - 1
  end subroutine part_nodes

  !> Nodes that are eliminated next, together.
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
