!> Nested dissection: an order of a body's nodes in which elimination fills little, and the fronts it falls into.
!>
!> A set of nodes is halved at the median of the coordinate along which it spreads most. The nodes of one half that elements
!> join to the other are its separator: with them out of the way the halves know nothing of each other, so each is
!> eliminated by itself, and in the same manner, before the separator (George, SIAM J. Numer. Anal. 10 (1973) 345).
module epcont_plan_dissection
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: halve
  implicit none
  private
  public :: dissection, dissect

  type :: dissection
    integer, allocatable :: node(:)    !! in the order of elimination
    integer, allocatable :: first(:)   !! the first of each front in it, and one behind the last [fronts + 1]
  end type dissection

  !> Sets of so few nodes are not halved. From 16 to 32 it matters little: fewer operations against larger matrices.
  integer, parameter :: few = 24

  !> Where a node is, seen from the set that is being halved. Nodes that have neighbours across are at the edge of their half.
  integer, parameter :: outside = 0, left = 1, right = 2, both = 3, edge = 4

  type :: workspace
    integer, allocatable :: node(:), element(:)   !! those of a set stand together
    integer, allocatable :: where(:)              !! one of its kind above [all nodes]
    integer, allocatable :: order(:), first(:)    !! what is found so far
    integer :: ordered = 0, fronts = 0
  end type workspace

contains

  !> Dissect a body. The nodes that are wanted last are a front of their own, the last.
  pure function dissect(point, member, nodes, wanted_last) result(found)
    real(wp), intent(in) :: point(:, :)        !! of all nodes [2, all nodes]
    integer, intent(in) :: member(:, :)        !! nodes of each of the body's elements, zeros behind [any, elements]
    integer, intent(in) :: nodes(:)            !! of the body
    logical, intent(in) :: wanted_last(:)      !! [all nodes]
    type(dissection) :: found
    type(workspace) :: work
    integer :: e

    work%node = pack(nodes, .not. wanted_last(nodes))
    work%element = [(e, e=1, size(member, 2))]
    allocate (work%where(size(point, 2)), source=outside)
    allocate (work%order(size(nodes)), work%first(size(nodes) + 1))
    call dissect_set(point, member, 1, size(work%node), 1, size(work%element), work)
    call add_front(pack(nodes, wanted_last(nodes)), work)
    found%node = work%order
    found%first = [work%first(:work%fronts), size(nodes) + 1]
  end function dissect

  pure recursive subroutine dissect_set(point, member, first, last, first_element, last_element, work)
    real(wp), intent(in) :: point(:, :)
    integer, intent(in) :: member(:, :)
    integer, intent(in) :: first, last                   !! the set in the list of nodes
    integer, intent(in) :: first_element, last_element   !! and its elements, all that have a node in it
    type(workspace), intent(inout) :: work
    integer, allocatable :: separator(:)
    integer :: middle, middle_element, end_element

    if (last - first + 1 <= few) then
      call add_front(work%node(first:last), work)
      return
    end if
    call halve_set(point, first, last, work)
    call find_separator(member, first, last, work%element(first_element:last_element), work)
    call part_elements(member, first_element, last_element, middle_element, end_element, work)
    call part_nodes(first, last, middle, separator, work)
    call dissect_set(point, member, first, middle, first_element, middle_element, work)
    call dissect_set(point, member, middle + 1, last - size(separator), middle_element + 1, end_element, work)
    call add_front(separator, work)
  end subroutine dissect_set

  !> Halve a set at the median of the coordinate along which it is spread most.
  pure subroutine halve_set(point, first, last, work)
    real(wp), intent(in) :: point(:, :)
    integer, intent(in) :: first, last
    type(workspace), intent(inout) :: work
    integer :: axis, middle

    axis = maxloc([spread_along(point(1, :), work%node(first:last)), spread_along(point(2, :), work%node(first:last))], dim=1)
    call halve(point(axis, work%node(first:last)), work%node(first:last))
    middle = first - 1 + (last - first + 1)/2
    work%where(work%node(first:middle)) = left
    work%where(work%node(middle + 1:last)) = right
  end subroutine halve_set

  !> Mark the separator: the shorter of the edges that the halves have where elements join them.
  pure subroutine find_separator(member, first, last, element, work)
    integer, intent(in) :: member(:, :)
    integer, intent(in) :: first, last
    integer, intent(in) :: element(:)
    type(workspace), intent(inout) :: work
    integer :: at_edge(left:right), e, i, longer

    at_edge = 0
    do e = 1, size(element)
      if (halves_of(member(:, element(e)), work%where) /= both) cycle
      do i = 1, size(member, 1)
        if (member(i, element(e)) == 0) exit
        associate (where => work%where(member(i, element(e))))
          if (where /= left .and. where /= right) cycle
          at_edge(where) = at_edge(where) + 1
          where = where + edge
        end associate
      end do
    end do
    longer = merge(right, left, at_edge(left) <= at_edge(right))
    do i = first, last
      associate (where => work%where(work%node(i)))
        if (where == longer + edge) where = longer
      end associate
    end do
  end subroutine find_separator

  !> Which of the halves an element has nodes in.
  pure integer function halves_of(node, where) result(halves)
    integer, intent(in) :: node(:), where(:)
    integer :: i

    halves = outside
    do i = 1, size(node)
      if (node(i) == 0) exit
      halves = ior(halves, where(node(i)))
    end do
    halves = iand(halves, both)
  end function halves_of

  !> Put the elements of the left half before those of the right. Those with nodes of both halves have those of one at its edge,
  !! the separator: they belong to the other.
  pure subroutine part_elements(member, first, last, middle, end_of_right, work)
    integer, intent(in) :: member(:, :)
    integer, intent(in) :: first, last               !! in the list of elements
    integer, intent(out) :: middle, end_of_right     !! the last of the left half, and of the right
    type(workspace), intent(inout) :: work
    integer :: of_right(last - first + 1)
    integer :: e, i, inside, n

    middle = first - 1
    n = 0
    do e = first, last
      associate (node => member(:, work%element(e)))
        inside = outside
        do i = 1, size(node)
          if (node(i) == 0) exit
          if (work%where(node(i)) < edge) inside = ior(inside, work%where(node(i)))
        end do
      end associate
      if (inside == left) then
        middle = middle + 1
        work%element(middle) = work%element(e)
      else if (inside == right) then
        n = n + 1
        of_right(n) = work%element(e)
      end if
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
    integer, allocatable :: of_right(:)

    associate (node => work%node(first:last))
      separator = pack(node, work%where(node) > edge)
      of_right = pack(node, work%where(node) == right)
      middle = last - size(separator) - size(of_right)
      node(:middle - first + 1) = pack(node, work%where(node) == left)
      node(middle - first + 2:) = [of_right, separator]
      work%where(node) = outside
    end associate
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
