!> Boundary lines: from the nodes that are given to sides of the bodies' outlines, end to end; and the
!> boundary of all bodies as contact takes it, those sides with normals and corners.
module epcont_contact_geometry_line_sides
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_corners, only: find_normals
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

  !> The sides of all lines; one that is not sound has none. Where there were errors before there are no
  !! outlines, and nodes alone are looked at.
  subroutine find_line_sides(model, found)
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer, allocatable :: starting(:)       ! the last side of the outline that starts at each node
    integer :: i, passed
    logical :: sound                          ! the elements are, and the outlines known

    if (size(model%line) == 0) return
    sound = found%errors == 0
    if (sound) then
      model%boundary = find_boundary(model)
      allocate (starting(model%nodes), source=0)
      starting(model%boundary%segment(1, :)) = [(i, i=1, size(model%boundary%element))]
    end if
    do i = 1, size(model%line)
      associate (line => model%line(i))
        allocate (line%side(0))
        if (size(line%node) == 1) &
          call found%add_error(of_line, i, 0, ': one node is no line', 'two nodes or more')
        passed = first_passed_twice(line%node, model%nodes)
        if (passed > 0) then
          call found%add_error(of_line, i, -passed, ': '//model%name_of(of_node, line%node(passed))// &
                               ' stands in it before', &
                               'each node once; a closed line ends with its first node')
        else
          call walk(line%node)
        end if
      end associate
    end do

  contains

    !> The sides between consecutive nodes, none where one is missing; a middle node between two corners may
    !! be listed or left out.
    subroutine walk(node)
      integer, intent(in) :: node(:)
      type(between_type) :: next, over
      integer :: k, side(size(node)), sides

      sides = 0
      k = 1
      do while (k < size(node))
        next = between(node(k), node(k + 1))
        if (next%elements == 0 .and. k + 2 <= size(node)) then
          over = between(node(k), node(k + 2))
          if (over%elements > 0 .and. over%node(3) == node(k + 1)) then
            k = k + 1
            next = over
          end if
        end if
        if (next%elements /= 1) then
          call add_no_side(next, k, node(k:k + 1))
          return
        end if
        sides = sides + 1
        if (sound) side(sides) = side_of_outline(next)
        k = k + 1
      end do
      if (.not. sound .or. sides == 0) return
      if (model%boundary%segment(1, side(1)) /= node(1)) side(:sides) = side(sides:1:-1)
      model%line(i)%side = side(:sides)
      model%line(i)%box = reshape([minval(model%x(:, node), dim=2), maxval(model%x(:, node), dim=2)], [2, 2])
    end subroutine walk

    !> The side that ends at two corners, and how many elements have it.
    pure type(between_type) function between(a, b)
      integer, intent(in) :: a, b
      integer :: k, side

      do k = model%around%start(a), model%around%start(a + 1) - 1
        associate (element => model%around%group(k))
          side = model%side_between(element, a, b)
          if (side == 0) cycle
          between%elements = between%elements + 1
          between%element(min(between%elements, 2)) = element
          if (between%elements == 1) between%node = model%edge(element, side)
        end associate
      end do
    end function between

    !> No side, or no free one, between the k-th and the next node of a line.
    subroutine add_no_side(there, k, node)
      type(between_type), intent(in) :: there
      integer, intent(in) :: k, node(2)
      character(len=:), allocatable :: ends

      ends = model%name_of(of_node, node(1))//' and '//text_of(model%node_id(node(2)))
      if (there%elements == 0) then
        call found%add_error(of_line, i, -k - 1, ': '//ends//' are not the ends of a side of an element', &
                             'nodes in the order of the boundary')
      else
        call found%add_error(of_line, i, -k - 1, ': the side between '//ends// &
                             ' lies inside a body, between '//model%name_of(of_element, there%element(1))// &
                             ' and '//model%name_of(of_element, there%element(2)), &
                             'sides that one element has')
      end if
    end subroutine add_no_side

    !> The side of the outline that an element has, walked with the body to the left.
    pure integer function side_of_outline(own) result(k)
      type(between_type), intent(in) :: own

      k = starting(own%node(1))
      associate (line => model%boundary)
        do while (line%element(k) /= own%element(1) .or. any(line%segment(:, k) /= own%node))
          k = k - 1   ! the only one, but where boundaries meet in a node
        end do
      end associate
    end function side_of_outline
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

  !> All sides of the bodies, numbered as those of the outlines.
  type(boundary_line) function find_boundary(model) result(line)
    type(model_type), intent(in) :: model
    integer :: held(2, model%body_outline%sides), i, k

    associate (outline => model%body_outline, sides => model%body_outline%sides)
      line%segment = outline%node
      line%element = outline%element
      line%neighbour = transpose(reshape([outline%before, outline%after], [sides, 2]))
      allocate (line%x(2, 3, sides), source=0.0_wp)
      do i = 1, sides
        associate (node => outline%node(:, i))
          line%x(:, :merge(3, 2, node(3) > 0), i) = model%edge_coordinates(node)
        end associate
      end do
      held = reshape([((held_direction(outline%node(k, i)), k=1, 2), i=1, sides)], [2, sides])
    end associate
    call find_normals(line, held, model%controls%corner)

  contains

    !> The direction in which a node, or what it is tied to, is held: 0 none, 3 both.
    pure integer function held_direction(node)
      integer, intent(in) :: node
      integer :: c

      held_direction = sum([(merge(c, 0, model%held(c, model%leader(c, node))), c=1, 2)])
    end function held_direction
  end function find_boundary
end module epcont_contact_geometry_line_sides
