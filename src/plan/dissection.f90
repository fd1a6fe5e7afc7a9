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
  use epcont_element_kinematics, only: directions
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
  integer, parameter :: axes = directions + 1, sample = 128

  !> Where a node is, seen from the set that is being halved. At the edge of their half are nodes that have
  !! neighbours across; of these, those of the separator then belong to neither half.
  integer, parameter :: outside = 0, left = 1, right = 2, both = 3, edge = 4
  !> The neighbours that a node has in a half, where it is not one.
  integer, parameter :: none = 0, several = -1

contains

  !> Dissect a body along x, y and one more coordinate. The nodes that are wanted last are a front of their
  !! own, the last.
  function dissect(model, further, elements, nodes, wanted_last) result(found)
    type(model_type), intent(in) :: model      !! its nodes, connectivity, and elements around nodes are used
    real(wp), intent(in) :: further(:)         !! the one more coordinate [all nodes]
    integer, intent(in) :: elements(:)         !! of the body
    integer, intent(in) :: nodes(:)            !! of the body
    logical, intent(in) :: wanted_last(:)      !! [all nodes]
    type(dissection) :: found
    real(wp), allocatable :: coordinate(:, :)  ! along which nodes are parted [axes, all nodes]
    integer, allocatable :: side(:)            ! where nodes are, and for none [0:all nodes]
    integer :: in_half(left:right)             ! nodes of the set that is being halved
    integer :: fronts, ordered

    allocate (coordinate(axes, size(further)))
    coordinate(:directions, :) = model%x
    coordinate(axes, :) = further
    allocate (side(0:size(further)), source=outside)
    allocate (found%node(size(nodes)), found%first(size(nodes) + 1))
    fronts = 0
    ordered = 0
    call dissect_set(pack(nodes, .not. wanted_last(nodes)), elements)
    call add_front(pack(nodes, wanted_last(nodes)))
    found%first = [found%first(:fronts), size(nodes) + 1]

  contains

    !> Dissect a set, with all elements that have a node in it.
    recursive subroutine dissect_set(set, element)
      integer, intent(in) :: set(:), element(:)
      integer, allocatable :: node(:), place(:), sides(:)
      integer :: half

      if (size(set) <= few) then
        call add_front(set)
        return
      end if
      node = set
      in_half = 0
      if (size(node) > many) call cut_least(node, element, sides)
      if (any(in_half == 0)) then
        call cut_midway(node)
        sides = sides_of(element)
      end if
      call find_separator(members(element, sides, both))
      place = side(node)
      sides = iand(sides_of(element), both)
      side(node) = outside
      do half = left, right
        call dissect_set(members(node, place, half), members(element, sides, half))
      end do
      call add_front(members(node, place, edge))
    end subroutine dissect_set

    !> Nodes that are eliminated next, together.
    subroutine add_front(node)
      integer, intent(in) :: node(:)

      if (size(node) == 0) return
      fronts = fronts + 1
      found%first(fronts) = ordered + 1
      found%node(ordered + 1:ordered + size(node)) = node
      ordered = ordered + size(node)
    end subroutine add_front

    !> Halve a set where the fewest elements lie across: at the median of one of the coordinates. Where many
    !! nodes have the same coordinate, it may part the set too unevenly, and none is taken.
    subroutine cut_least(node, element, sides)
      integer, intent(in) :: node(:), element(:)
      integer, allocatable, intent(out) :: sides(:)   !! of the halves: where each element has nodes
      integer, parameter :: bit(axes) = [0, 2, 4]   ! of `side`: the first of two for each coordinate
      integer, allocatable :: some(:)
      real(wp) :: median(axes)
      logical :: is_below(axes)
      integer :: below(axes), cut(axes), i, k

      do k = 1, axes
        some = node(::size(node)/sample + 1)
        call halve(coordinate(k, some), some)
        median(k) = maxval(coordinate(k, some(:size(some)/2)))
      end do
      below = 0
      do i = 1, size(node)
        is_below = coordinate(:, node(i)) <= median
        below = below + merge(1, 0, is_below)
        side(node(i)) = sum(shiftl(merge(left, right, is_below), bit))
      end do
      sides = sides_of(element)
      cut = [(count(ibits(sides, bit(k), 2) == both), k=1, axes)]
      k = minloc(cut, dim=1, mask=max(below, size(node) - below) <= largest_half*size(node))
      if (k == 0) return
      in_half = [below(k), size(node) - below(k)]
      side(node) = ibits(side(node), bit(k), 2)
      sides = ibits(sides, bit(k), 2)
    end subroutine cut_least

    !> Halve a set at the median of that coordinate of the plane along which it spreads most.
    subroutine cut_midway(node)
      integer, intent(inout) :: node(:)
      integer :: axis, k

      axis = maxloc([(variance(coordinate(k, node)), k=1, directions)], dim=1)
      call halve(coordinate(axis, node), node)
      in_half = [size(node)/2, (size(node) + 1)/2]
      side(node) = right
      side(node(:in_half(left))) = left
    end subroutine cut_midway

    !> Mark the separator: the shorter of the edges that the halves have where elements join them, moved to
    !! where it is shorter.
    subroutine find_separator(joining)
      integer, intent(in) :: joining(:)   !! these elements
      integer, allocatable :: at_edge(:, :)
      integer :: e, edges(left:right), half, i, shorter

      allocate (at_edge(maxval(in_half), left:right))
      edges = 0
      do e = 1, size(joining)
        do i = 1, size(model%connectivity, 1)
          associate (node => model%connectivity(i, joining(e)))
            half = side(node)
            if (half /= left .and. half /= right) cycle
            edges(half) = edges(half) + 1
            at_edge(edges(half), half) = node
            side(node) = half + edge
          end associate
        end do
      end do
      shorter = merge(left, right, edges(left) <= edges(right))
      half = both - shorter
      side(at_edge(:edges(half), half)) = half
      side(at_edge(:edges(shorter), shorter)) = edge
      in_half(shorter) = in_half(shorter) - edges(shorter)
      call shift_separator(at_edge(:edges(shorter), shorter))
    end subroutine find_separator

    !> Let nodes of the separator go to a half: if they have no neighbours in the other, or only one, which
    !! takes their place, and the halves become more alike. (Liu, ACM Trans. Math. Softw. 15 (1989) 198, moves
    !! several at once.)
    subroutine shift_separator(separator)
      integer, intent(in) :: separator(:)
      integer :: beside(left:right), half, i, length, other
      integer :: list(sum(in_half) + 2*size(separator))

      length = size(separator)
      list(:length) = separator
      i = 0
      do while (i < length)
        i = i + 1
        beside = neighbours(list(i))
        half = merge(left, right, in_half(left) < in_half(right))
        other = both - half
        if (beside(other) /= none .and. beside(half) == none .and. &
            in_half(other) < largest_half*sum(in_half)) half = other
        other = both - half
        if (beside(other) == several) cycle
        if (beside(other) /= none) then
          if (in_half(half) + 1 >= in_half(other)) cycle
          length = length + 1
          list(length) = beside(other)
          side(beside(other)) = edge
          in_half(other) = in_half(other) - 1
        end if
        side(list(i)) = half
        in_half(half) = in_half(half) + 1
      end do
    end subroutine shift_separator

    !> The neighbour of a node in each half; or none, or several.
    pure function neighbours(node) result(beside)
      integer, intent(in) :: node
      integer :: beside(left:right)
      integer :: i, j

      beside = none
      do j = model%around%start(node), model%around%start(node + 1) - 1
        do i = 1, size(model%connectivity, 1)
          associate (other => model%connectivity(i, model%around%group(j)))
            if (side(other) /= left .and. side(other) /= right) cycle
            beside(side(other)) = merge(other, several, any(beside(side(other)) == [none, other]))
          end associate
        end do
      end do
    end function neighbours

    !> Where an element has nodes, all bits that say so.
    elemental integer function sides_of(element)
      integer, intent(in) :: element
      integer :: i

      sides_of = outside
      do i = 1, size(model%connectivity, 1)
        sides_of = ior(sides_of, side(model%connectivity(i, element)))
      end do
    end function sides_of
  end function dissect

  !> The items at a place; `pack` takes longer.
  pure function members(item, place, where)
    integer, intent(in) :: item(:), place(:), where
    integer, allocatable :: members(:)
    integer :: i, n

    allocate (members(count(place == where)))
    n = 0
    do i = 1, size(item)
      if (place(i) /= where) cycle
      n = n + 1
      members(n) = item(i)
    end do
  end function members

  !> How far values are spread.
  pure real(wp) function variance(value)
    real(wp), intent(in) :: value(:)

    variance = sum((value - sum(value)/size(value))**2)/size(value)
  end function variance
end module epcont_plan_dissection
