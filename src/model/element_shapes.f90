!> Elements, given by their nodes: turned counter-clockwise, checked, and what follows from them.
module epcont_model_element_shapes
  use epcont_base_incidence, only: new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_base_tolerances, only: rounded_off
  use epcont_element_kinematics, only: axisymmetric
  use epcont_geometry_plane, only: cross_product, polygon_area
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
  pure subroutine complete_elements(model, found)
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: e

    model%order = model%kinds(model%kind)%nodes
    allocate (model%first_point(model%elements + 1))
    model%first_point(1) = 1
    do e = 1, model%elements
      model%first_point(e + 1) = model%first_point(e) + model%kinds(model%kind(e))%points
      if (all(model%connectivity(:model%order(e), e) > 0)) call check_shape(model, e, found)
    end do
    model%points = model%first_point(model%elements + 1) - 1
    allocate (model%point_element(model%points))
    do e = 1, model%elements
      model%point_element(model%first_point(e):model%first_point(e + 1) - 1) = e
    end do
    model%around = new_incidence(model%connectivity, model%nodes)
    call check_kinds(model, found)
  end subroutine complete_elements

  !> Turn the element counter-clockwise; a shape that is none is a fault.
  pure subroutine check_shape(model, e, found)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: e
    type(findings), intent(inout) :: found
    real(wp) :: area, extent, longest, side(2), x(2, model%corners(e))
    integer :: k, n

    n = model%corners(e)
    x = model%x(:, model%connectivity(:n, e))
    extent = 0.0_wp
    longest = 0.0_wp
    do k = 1, n
      side = x(:, k) - x(:, mod(k, n) + 1)
      extent = max(extent, abs(side(1)), abs(side(2)))
      longest = max(longest, side(1)**2 + side(2)**2)
    end do
    area = polygon_area(x)
    if (extent > 0.0_wp .and. extent < shortest_side) then
      call found%add_error(of_element, e, 3, ': its sides are shorter than '//short_real(shortest_side), &
                           'other units')
    else if (n == 3 .and. abs(area) <= rounded_off*longest) then
      call found%add_error(of_element, e, 4, ': its corners '//corner_ids(model, e)//' lie on one line', &
                           'corners that span an area')
    else if (n == 4 .and. .not. bends_one_way(x, sign(1.0_wp, area), rounded_off*longest)) then
      call found%add_error(of_element, e, 3, ': its corners '//corner_ids(model, e)// &
                           ' cross over, bend inwards or lie on one line', &
                           'four corners in turn, each bending the same way')
    else
      if (area < 0.0_wp) then
        call turn(model%connectivity(2:n, e))
        call turn(model%connectivity(n + 1:model%order(e), e))
      end if
      if (model%order(e) > n) call check_middles(e, n, model%coordinates(e), found)
    end if
  end subroutine check_shape

  !> Does a boundary bend by more than `least` at each corner, to the left where `way` is 1, else to the
  !! right?
  pure logical function bends_one_way(x, way, least)
    real(wp), intent(in) :: x(:, :)   !! corners [2, any]
    real(wp), intent(in) :: way       !! 1 or -1
    real(wp), intent(in) :: least     !! [length**2]
    integer :: k, n

    n = size(x, 2)
    bends_one_way = .false.
    do k = 1, n
      if (way*cross_product(x(:, k) - x(:, mod(k + n - 2, n) + 1), x(:, mod(k, n) + 1) - x(:, k)) <= least) &
        return
    end do
    bends_one_way = .true.
  end function bends_one_way

  !> The ids of an element's corners.
  pure function corner_ids(model, e) result(ids)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    character(len=:), allocatable :: ids
    integer :: k, n

    n = model%corners(e)
    ids = text_of(model%node_id(model%connectivity(1, e)))
    do k = 2, n
      ids = ids//trim(merge(' and', ',   ', k == n))//' '//text_of(model%node_id(model%connectivity(k, e)))
    end do
  end function corner_ids

  !> The same nodes the other way round.
  pure subroutine turn(node)
    integer, intent(inout) :: node(:)
    integer :: k, n

    n = size(node)
    do k = 1, n/2
      node([k, n + 1 - k]) = node([n + 1 - k, k])
    end do
  end subroutine turn

  !> A side's middle node may leave the middle as long as the element does not fold over at a corner; a side
  !! that bulges more than half a circle does is hardly meant.
  pure subroutine check_middles(e, corners, x, found)
    integer, intent(in) :: e, corners
    real(wp), intent(in) :: x(:, :)   !! [2, nodes]
    type(findings), intent(inout) :: found
    character(len=*), parameter :: remedy = 'nodes near the middles of the sides'
    logical :: bulges, folds
    integer :: after, before, k

    bulges = .false.
    folds = .false.
    do k = 1, corners
      after = mod(k, corners) + 1
      before = mod(k + corners - 2, corners) + 1
      ! Tangents of the two sides at the corner.
      folds = folds .or. .not. cross_product(4.0_wp*x(:, corners + k) - 3.0_wp*x(:, k) - x(:, after), &
                                             4.0_wp*x(:, corners + before) - 3.0_wp*x(:, k) - &
                                             x(:, before)) > 0.0_wp
      bulges = bulges .or. norm2(2.0_wp*x(:, corners + k) - x(:, k) - x(:, after)) > &
               norm2(x(:, after) - x(:, k))
    end do
    if (folds) then
      call found%add_error(of_element, e, 3, &
                           ': a middle node is so far from the middle of its side that '// &
                           'the element folds over', &
                           remedy)
    else if (bulges) then
      call found%add_warning(of_element, e, 3, &
                             ': a middle node is farther from the middle of its side than '// &
                             'half of that side is long', remedy)
    end if
  end subroutine check_middles

  !> A scene is plane, or it is of rings.
  pure subroutine check_kinds(model, found)
    type(model_type), intent(in) :: model
    type(findings), intent(inout) :: found
    integer :: e, first(2), kind   ! plane, of rings; 0: there is none

    first = 0
    do e = model%elements, 1, -1
      if (model%section(e) == 0) cycle
      kind = merge(2, 1, model%kinematics(model%section(e)) == axisymmetric)
      first(kind) = e
    end do
    if (all(first > 0)) call found%add_error(of_element, first(2), 0, &
                                             ': a ring in a deck of plane elements ('// &
                          model%name_of(of_element, first(1))//')', 'plane elements only, or rings only')
  end subroutine check_kinds

  !> Rings lie at x >= 0, and their nodes on the axis cannot leave it. Supports and ties are known.
  pure subroutine check_axis(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    logical :: in_ring(model%nodes), loose(model%nodes)
    integer :: e, i

    in_ring = .false.
    do e = 1, model%elements
      if (model%section(e) == 0 .or. any(model%connectivity(:model%order(e), e) == 0)) cycle
      if (model%kinematics(model%section(e)) == axisymmetric) &
        in_ring(model%connectivity(:model%order(e), e)) = .true.
    end do
    do i = 1, model%nodes
      if (in_ring(i) .and. model%x(1, i) < 0.0_wp) &
        call found%add_error(of_node, i, 3, ': belongs to a ring and lies at a negative radius', &
                             'X1 of at least 0.0: x is the radius')
      loose(i) = in_ring(i) .and. model%x(1, i) == 0.0_wp .and. .not. model%held(1, model%leader(1, i))
    end do
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
    integer :: e, first, like(model%elements), twice

    like = [(element_like(model, e), e=1, model%elements)]
    twice = count(like > 0)
    first = findloc(like > 0, .true., dim=1)
    if (twice > 0) call found%add_warning(of_element, first, 1, ' has the nodes of '// &
      model%name_of(of_element, like(first))//': both count, one upon the other'// &
      and_more(twice, '; so it is with ', trim(merge(' more elements', ' more element ', twice > 2))), &
      'one element, unless two laminae are meant')
  end subroutine warn_of_elements_twice

  !> The first element before one that has its corners; 0: none. Looked for where the fewest elements meet.
  pure integer function element_like(model, element) result(other)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element
    integer :: i, k, n, node

    n = model%corners(element)
    associate (corner => model%connectivity(:n, element), start => model%around%start)
      node = corner(1)
      do k = 2, n
        if (start(corner(k) + 1) - start(corner(k)) < start(node + 1) - start(node)) node = corner(k)
      end do
      do i = start(node), start(node + 1) - 1
        other = model%around%group(i)
        if (other == element) exit
        do k = 1, n
          if (.not. any(model%connectivity(:n, other) == corner(k))) exit
        end do
        if (k > n .and. model%corners(other) == n) return
      end do
    end associate
    other = 0
  end function element_like
end module epcont_model_element_shapes
