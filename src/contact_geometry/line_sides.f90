!> Boundary lines: from the nodes that are given to sides of the bodies' outlines, end to end.
module epcont_contact_geometry_line_sides
  use epcont_base_text, only: text_of
  use epcont_contact_geometry_boundary, only: find_boundary
  use epcont_model_finding, only: findings, of_element, of_line, of_node
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_line_sides

  !> What elements have between two nodes.
  type :: between_type
    integer :: elements = 0       !! that have a side there
    integer :: element(2) = 0     !! the first and the last of them
    integer :: node(3) = 0        !! of the first one's side, as the element turns
  end type between_type

contains

  !> The sides of all lines; one that is not sound has none. Where the elements are not `sound` there are no
  !! outlines, and nodes alone are looked at.
  pure subroutine find_line_sides(model, sound, found)
    type(model_type), intent(inout) :: model   !! the scene
    logical, intent(in) :: sound              !! the elements are, and the outlines known
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    type(between_type), allocatable :: way(:)
    integer, allocatable :: starting(:)       ! the last side of the outline that starts at each node
    integer :: i, passed

    if (size(model%line) == 0) return
    if (sound) then
      model%boundary = find_boundary(model)
      allocate (starting(model%nodes), source=0)
      starting(model%boundary%segment(1, :)) = [(i, i=1, size(model%boundary%element))]
    end if
    do i = 1, size(model%line)
      allocate (model%line(i)%side(0))
      if (size(model%line(i)%node) == 1) &
        call found%add_error(of_line, i, 0, ': one node is no line', 'two nodes or more')
      passed = first_passed_twice(model%line(i)%node, model%nodes)
      if (passed > 0) then
        call found%add_error(of_line, i, -passed, ': '//model%name_of(of_node, model%line(i)%node(passed))// &
                             ' stands in it before', 'each node once; a closed line ends with its first node')
      else
        call walk(model, i, way, found)
        if (sound .and. size(way) > 0) call set_sides(model, i, way, starting)
      end if
    end do
  end subroutine find_line_sides

  !> Where a line comes to a node that it has passed; 0: nowhere. But a closed line ends with its first node.
  pure integer function first_passed_twice(node, nodes) result(k)
    integer, intent(in) :: node(:)
    integer, intent(in) :: nodes      !! how many there are in all
    logical :: met(nodes)

    met = .false.
    do k = 1, size(node)
      if (met(node(k)) .and. .not. (k == size(node) .and. node(k) == node(1) .and. k > 3)) return
      met(node(k)) = .true.
    end do
    k = 0
  end function first_passed_twice

  !> The sides between consecutive nodes; a middle node between two corners may be listed or left out.
  pure subroutine walk(model, i, way, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: i
    type(between_type), allocatable, intent(out) :: way(:)   !! none where one is missing [sides]
    type(findings), intent(inout) :: found
    type(between_type) :: next, over
    integer :: k, sides

    associate (node => model%line(i)%node)
      allocate (way(size(node)))
      sides = 0
      k = 1
      do while (k < size(node))
        next = between(model, node(k), node(k + 1))
        if (next%elements == 0 .and. k + 2 <= size(node)) then
          over = between(model, node(k), node(k + 2))
          if (over%elements > 0 .and. over%node(3) == node(k + 1)) then
            k = k + 1
            next = over
          end if
        end if
        if (next%elements /= 1) then
          call add_no_side(model, i, k, next, found)
          sides = 0
          exit
        end if
        sides = sides + 1
        way(sides) = next
        k = k + 1
      end do
    end associate
    way = way(:sides)
  end subroutine walk

  !> No side, or no free one, between the nodes k and k + 1 of a line.
  pure subroutine add_no_side(model, i, k, there, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: i, k
    type(between_type), intent(in) :: there
    type(findings), intent(inout) :: found
    character(len=:), allocatable :: ends

    associate (node => model%line(i)%node)
      ends = model%name_of(of_node, node(k))//' and '//text_of(model%node_id(node(k + 1)))
    end associate
    if (there%elements == 0) then
      call found%add_error(of_line, i, -k - 1, ': '//ends//' are not the ends of a side of an element', &
                           'nodes in the order of the boundary')
    else
      call found%add_error(of_line, i, -k - 1, ': the side between '//ends// &
                           ' lies inside a body, between '// &
                           model%name_of(of_element, there%element(1))//' and '// &
                           model%name_of(of_element, there%element(2)), 'sides that one element has')
    end if
  end subroutine add_no_side

  !> The side that ends at two corners, and how many elements have it.
  pure type(between_type) function between(model, a, b)
    type(model_type), intent(in) :: model
    integer, intent(in) :: a, b
    integer :: i, side

    do i = model%around%start(a), model%around%start(a + 1) - 1
      associate (element => model%around%group(i))
        side = model%side_between(element, a, b)
        if (side == 0) cycle
        between%elements = between%elements + 1
        if (between%elements == 1) then
          between%element = element
          between%node = model%edge(element, side)
        else
          between%element(2) = element
        end if
      end associate
    end do
  end function between

  !> Its sides of the outline, walked with the body to the left.
  pure subroutine set_sides(model, i, way, starting)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: i
    type(between_type), intent(in) :: way(:)
    integer, intent(in) :: starting(:)       !! the last side of the outline that starts at each node
    integer :: k, s, side(size(way))

    do s = 1, size(way)
      k = starting(way(s)%node(1))
      do while (model%boundary%element(k) /= way(s)%element(1) .or. &
                any(model%boundary%segment(:, k) /= way(s)%node))
        k = k - 1   ! the only one, but where boundaries meet in a node
      end do
      side(s) = k
    end do
    associate (line => model%line(i))
      if (way(1)%node(1) /= line%node(1)) side = side(size(side):1:-1)
      line%side = side
      line%box = reshape([minval(model%x(:, line%node), dim=2), maxval(model%x(:, line%node), dim=2)], [2, 2])
    end associate
  end subroutine set_sides
end module epcont_contact_geometry_line_sides
