!> Boundary lines: edges of the outlines from the nodes of a line, end to end; and the
!> boundary of all bodies for contact: these edges with normals and corners.
module epcont_contact_geometry_line_sides
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: is_first
  use epcont_base_text, only: text_of
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_corners, only: find_normals
  use epcont_model_finding, only: findings, of_element, of_line, of_node
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_line_sides

contains

  !> Find the edges of all lines; a line with errors has none. If there have been errors, there are no
  !! outlines, and only nodes are checked.
  subroutine find_line_sides(model, found)
    type(model_type), intent(inout) :: model   !! the model
    type(findings), intent(inout) :: found   !! errors are added
    integer, allocatable :: starting(:)       ! last edge of the outline that starts at each node
    integer :: i, passed
    logical :: sound                          ! elements are correct, and outlines known

    if (size(model%contact%line) == 0) return
    sound = found%errors == 0
    if (sound) then
      model%contact%boundary = find_boundary(model)
      allocate (starting(model%mesh%nodes), source=0)
      starting(model%contact%boundary%segment(1, :)) = [(i, i=1, size(model%contact%boundary%element))]
    end if
    do i = 1, size(model%contact%line)
      associate (line => model%contact%line(i))
        allocate (line%side(0))
        if (size(line%node) == 1) &
          call found%add_error(of_line, i, 0, ': one node is no line', 'give two nodes or more')
        passed = first_passed_twice(line%node)
        if (passed > 0) then
          call found%add_error(of_line, i, -passed, ': '//model%name_of(of_node, line%node(passed))// &
                               ' is already in it', &
                               'name each node once; end a closed line with its first node')
        else
          call walk(line%node)
        end if
      end associate
    end do

  contains

    !> Find the edges between consecutive nodes; zero if one is missing. Mid-side nodes may be listed or left
    !! out.
    subroutine walk(node)
      integer, intent(in) :: node(:)
      integer, allocatable :: element(:), over(:)
      integer :: edge(3), k, side(size(node)), sides

      sides = 0
      k = 1
      do while (k < size(node))
        call find_between(node(k), node(k + 1), element, edge)
        if (size(element) == 0 .and. k + 2 <= size(node)) then
          call find_between(node(k), node(k + 2), over, edge)
          if (edge(3) == node(k + 1)) then
            k = k + 1
            element = over
          end if
        end if
        if (size(element) /= 1) then
          call add_no_side(model, i, element, k, node(k:k + 1), found)
          return
        end if
        sides = sides + 1
        if (sound) side(sides) = side_of_outline(element(1), edge)
        k = k + 1
      end do
      if (.not. sound .or. sides == 0) return
      if (model%contact%boundary%segment(1, side(1)) /= node(1)) side(:sides) = side(sides:1:-1)
      model%contact%line(i)%side = side(:sides)
      model%contact%line(i)%box = reshape([minval(model%mesh%x(:, node), dim=2), &
                                           maxval(model%mesh%x(:, node), dim=2)], [2, 2])
    end subroutine walk

    !> Elements that have an edge between two corners, and its nodes in the order of the first element; 0 if
    !! there is no such edge.
    subroutine find_between(a, b, element, edge)
      integer, intent(in) :: a, b
      integer, allocatable, intent(out) :: element(:)
      integer, intent(out) :: edge(3)

      element = model%mesh%with_side(a, b)
      edge = 0
      if (size(element) > 0) edge = model%mesh%edge_between(element(1), a, b)
    end subroutine find_between

    !> Edge of the outline that an element has, with the body to the left.
    pure integer function side_of_outline(element, edge) result(k)
      integer, intent(in) :: element, edge(3)

      k = starting(edge(1))
      associate (line => model%contact%boundary)
        do while (line%element(k) /= element .or. any(line%segment(:, k) /= edge))
          k = k - 1   ! usually the only one, except if boundaries meet in a node
        end do
      end associate
    end function side_of_outline
  end subroutine find_line_sides

  !> First position at which a line repeats a node; 0 if absent. A closed line may end with its first
  !! node.
  pure integer function first_passed_twice(node) result(k)
    integer, intent(in) :: node(:)

    k = findloc(is_first(node), .false., dim=1)
    if (k == size(node) .and. k > 3) k = merge(0, k, node(k) == node(1))
  end function first_passed_twice

  !> Report that there is no edge, or no free edge, between the k-th and the next node of a line.
  subroutine add_no_side(model, i, element, k, node, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: i, k, node(2)
    integer, intent(in) :: element(:)    !! elements that have this edge
    type(findings), intent(inout) :: found
    character(len=:), allocatable :: ends

    ends = model%name_of(of_node, node(1))//' and '//text_of(model%mesh%node_id(node(2)))
    if (size(element) == 0) then
      call found%add_error(of_line, i, -k - 1, ': '//ends//' are not the ends of an edge of an element', &
                           'give the nodes in the order of the boundary, from corner to corner')
    else
      call found%add_error(of_line, i, -k - 1, ': the edge between '//ends// &
                           ' lies inside a body, between '//model%name_of(of_element, element(1))// &
                           ' and '//model%name_of(of_element, element(size(element))), &
                           'give edges that belong to one element only')
    end if
  end subroutine add_no_side

  !> Find all edges of the bodies, numbered as those of the outlines.
  type(boundary_line) function find_boundary(model) result(line)
    type(model_type), intent(in) :: model
    integer :: held(2, model%mesh%body_outline%sides)   ! fixed direction: 0 if no direction, 3 if both
    integer :: i

    associate (outline => model%mesh%body_outline, sides => model%mesh%body_outline%sides)
      line%segment = outline%node
      line%element = outline%element
      line%neighbour = transpose(reshape([outline%before, outline%after], [sides, 2]))
      allocate (line%x(2, 3, sides), source=0.0_wp)
      do i = 1, sides
        associate (node => outline%node(:, i))
          line%x(:, :merge(3, 2, node(3) > 0), i) = model%mesh%edge_coordinates(node)
        end associate
      end do
      held = merge(1, 0, model%constraints%is_held(1, outline%node(:2, :))) + &
             merge(2, 0, model%constraints%is_held(2, outline%node(:2, :)))
    end associate
    call find_normals(line, held, model%controls%corner)
  end function find_boundary
end module epcont_contact_geometry_line_sides
