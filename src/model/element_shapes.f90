!> Elements, given by their nodes: turned counter-clockwise, checked, and what follows from them.
module epcont_model_element_shapes
  use epcont_base_incidence, only: new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_base_tolerances, only: rounded_off
  use epcont_element_element_kind, only: most_nodes
  use epcont_element_kinematics, only: axisymmetric
  use epcont_geometry_plane, only: polygon_area
  use epcont_model_finding, only: and_more, findings, of_element, of_node
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: complete_elements, check_axis, warn_of_elements_twice

  !> Shorter sides have areas and stiffnesses that are hardly numbers.
  real(wp), parameter :: shortest_side = 1.0e-30_wp

contains

  !> From kind, nodes and section of each element. Node 0 is one that could not be found, and section 0 one of
  !! these.
  subroutine complete_elements(model, found)
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: e, next, plane, ring

    model%node_count = model%kinds(model%kind)%nodes
    model%points = sum(model%kinds(model%kind)%points)
    allocate (model%first_point(model%elements + 1), model%point_element(model%points))
    next = 1
    do e = 1, model%elements
      model%first_point(e) = next
      next = next + model%kinds(model%kind(e))%points
      model%point_element(model%first_point(e):next - 1) = e
      if (all(model%connectivity(:model%node_count(e), e) > 0)) call check_shape(e, model%corners(e))
    end do
    model%first_point(e) = next
    model%around = new_incidence(model%connectivity, model%nodes)
    if (all(model%kinematics == axisymmetric) .or. all(model%kinematics /= axisymmetric)) return
    ring = findloc([(model%is_ring(e), e=1, model%elements)], .true., dim=1)
    plane = findloc([(model%section(e) > 0 .and. .not. model%is_ring(e), e=1, model%elements)], .true., dim=1)
    if (ring > 0 .and. plane > 0) call found%add_error(of_element, ring, 0, &
      ': a ring in a deck of plane elements ('//model%name_of(of_element, plane)//')', &
      'plane elements only, or rings only')

  contains

    !> Turn the element counter-clockwise; a shape that is none is a fault.
    subroutine check_shape(e, n)
      integer, intent(in) :: e, n                           !! which, and its corners
      real(wp), dimension(2, most_nodes + 1) :: side, x     ! behind the last the first one again
      real(wp) :: area, least
      integer :: k
      logical :: bends_wrong

      associate (node => model%connectivity(:model%node_count(e), e))
        do k = 1, n
          x(:, k) = model%x(:, node(k))
        end do
        x(:, n + 1) = x(:, 1)
        side(:, :n) = x(:, 2:n + 1) - x(:, :n)
        side(:, n + 1) = side(:, 1)
        area = polygon_area(x(:, :n))
        least = rounded_off*maxval(side(1, :n)**2 + side(2, :n)**2)
        bends_wrong = any(sign(1.0_wp, area)*(side(1, :n)*side(2, 2:n + 1) - side(2, :n)*side(1, 2:n + 1)) &
                          <= least)
        if (any(side(:, :n) /= 0.0_wp) .and. all(abs(side(:, :n)) < shortest_side)) then
          call found%add_error(of_element, e, 3, ': its sides are shorter than '//short_real(shortest_side), &
                               'other units')
        else if (n == 3 .and. abs(area) <= least) then
          call found%add_error(of_element, e, 4, ': its corners '//ids(node(:3))//' lie on one line', &
                               'corners that span an area')
        else if (n == 4 .and. bends_wrong) then
          call found%add_error(of_element, e, 3, ': its corners '//ids(node(:4))// &
                               ' cross over, bend inwards or lie on one line', &
                               'four corners in turn, each bending the same way')
        else
          if (area < 0.0_wp) then
            node(2:n) = node(n:2:-1)
            node(n + 1:) = node(size(node):n + 1:-1)
          end if
          if (size(node) > n) call check_middles(e, n, model%x(:, node([(k, k=1, n), 1])), &
                                                 model%x(:, node(n + 1:)))
        end if
      end associate
    end subroutine check_shape

    !> `1, 2 and 3` of nodes.
    pure function ids(node) result(text)
      integer, intent(in) :: node(:)
      character(len=:), allocatable :: text
      integer :: k

      text = text_of(model%node_id(node(1)))
      do k = 2, size(node)
        text = text//trim(merge(' and', ',   ', k == size(node)))//' '//text_of(model%node_id(node(k)))
      end do
    end function ids

    !> A side's middle node may leave the middle as long as the element does not fold over at a corner; a side
    !! that bulges more than half a circle does is hardly meant.
    subroutine check_middles(e, n, x, middle)
      integer, intent(in) :: e, n
      real(wp), intent(in) :: x(:, :)        !! corners, behind the last the first one again [2, n + 1]
      real(wp), intent(in) :: middle(:, :)   !! of the sides [2, n]
      character(len=*), parameter :: remedy = 'nodes near the middles of the sides'
      real(wp) :: at_start(2, n + 1), at_end(2, n)   ! tangents of the sides, into them
      integer :: k

      at_start(:, :n) = 4.0_wp*middle - 3.0_wp*x(:, :n) - x(:, 2:)
      at_start(:, n + 1) = at_start(:, 1)
      at_end = 4.0_wp*middle - 3.0_wp*x(:, 2:) - x(:, :n)
      if (.not. all(at_start(1, 2:)*at_end(2, :) - at_start(2, 2:)*at_end(1, :) > 0.0_wp)) then
        call found%add_error(of_element, e, 3, ': a middle node is so far from the middle of its side '// &
                             'that the element folds over', remedy)
      else if (any([(norm2(2.0_wp*middle(:, k) - x(:, k) - x(:, k + 1)) > norm2(x(:, k + 1) - x(:, k)), &
                     k=1, n)])) then
        call found%add_warning(of_element, e, 3, ': a middle node is farther from the middle of its side '// &
                               'than half of that side is long', remedy)
      end if
    end subroutine check_middles
  end subroutine complete_elements

  !> Rings lie at x >= 0, and their nodes on the axis cannot leave it. Supports and ties are known.
  subroutine check_axis(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    logical :: in_ring(model%nodes), loose(model%nodes)
    integer :: e, i

    in_ring = .false.
    do e = 1, model%elements
      associate (node => model%connectivity(:model%node_count(e), e))
        if (model%is_ring(e) .and. all(node > 0)) in_ring(node) = .true.
      end associate
    end do
    do i = 1, model%nodes
      if (in_ring(i) .and. model%x(1, i) < 0.0_wp) &
        call found%add_error(of_node, i, 3, ': belongs to a ring and lies at a negative radius', &
                             'X1 of at least 0.0: x is the radius')
    end do
    loose = in_ring .and. model%x(1, :) == 0.0_wp .and. .not. model%held(1, model%leader(1, :))
    if (.not. any(loose)) return
    call found%add_error(of_node, findloc(loose, .true., dim=1), 3, &
                         ': lies on the axis of rings and could leave it'// &
                         and_more(count(loose), '; so could ', ' more'), 'direction 1 held')
    found%list(found%count)%node = pack([(i, i=1, model%nodes)], loose)
  end subroutine check_axis

  !> Two elements on the same corners are as stiff as both: meant for laminae, and else a mesh read twice.
  pure subroutine warn_of_elements_twice(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: e, like(model%elements), twice

    like = [(element_like(e, model%corners(e)), e=1, model%elements)]
    twice = count(like > 0)
    if (twice == 0) return
    e = findloc(like > 0, .true., dim=1)
    call found%add_warning(of_element, e, 1, ' has the nodes of '//model%name_of(of_element, like(e))// &
      ': both count, one upon the other'// &
      and_more(twice, '; so it is with ', trim(merge(' more elements', ' more element ', twice > 2))), &
      'one element, unless two laminae are meant')

  contains

    !> The first element before one that has its corners; 0: none. Looked for where the fewest elements meet.
    pure integer function element_like(element, corners) result(other)
      integer, intent(in) :: element, corners
      integer :: i, k, least

      associate (corner => model%connectivity(:corners, element), start => model%around%start)
        least = corner(1)
        do k = 2, corners
          if (start(corner(k) + 1) - start(corner(k)) < start(least + 1) - start(least)) least = corner(k)
        end do
        do i = start(least), start(least + 1) - 1
          other = model%around%group(i)
          if (other == element) exit
          do k = 1, corners
            if (.not. any(model%connectivity(:corners, other) == corner(k))) exit
          end do
          if (k > corners .and. model%corners(other) == corners) return
        end do
      end associate
      other = 0
    end function element_like
  end subroutine warn_of_elements_twice
end module epcont_model_element_shapes
