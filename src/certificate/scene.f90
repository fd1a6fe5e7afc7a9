!> Searches the displaced outlines of all bodies for points of one body inside another, or inside itself, and
!> for contact forces across a gap. The search does not depend on pairs or lines.
!>
!> Each edge of the outlines that meets the box of another body is sampled: at its start, at its quarter
!> points, and between two crossings with the other outline. The depth of a point is its distance from the
!> other outline.
!>
!> Pairs with a contact force have three values: the gap between the displaced outlines along the normal, the
!> distance of the node beside the end of the other body, and the relative tangential displacement. Last,
!> nodes may be displaced beyond a line at which their body ends: the axis of axisymmetric bodies, or a line
!> of symmetry.
module epcont_certificate_scene
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_effect
  use epcont_certificate_findings, only: beyond_place, is_worse, overlap_place, rated, overlaps_type
  use epcont_certificate_meeting, only: keep, meet, new_search, part_along, point_on, point_type, &
      search_type
  use epcont_certificate_way, only: look_at_ways
  use epcont_element_kinematics, only: directions
  use epcont_geometry_outline_shape, only: near_place
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: beyond_place, overlap_place, overlaps_type, look_through

  !> Rotation [rad] or stretch of an edge that gives a warning.
  real(wp), parameter, public :: largest_change = 0.2_wp
  !> Fraction of the allowed depth below which rounding chooses the point.
  real(wp), parameter, public :: little = 0.01_wp
  !> Points of each edge: start and quarter points.
  real(wp), parameter :: quarters(4) = [0.0_wp, 0.25_wp, 0.5_wp, 0.75_wp]

  !> Allowed relative tangential displacement, as fractions of the longer edge and of the smaller body. A node
  !! may be as far beside the end of the other body.
  real(wp), parameter :: part_of_side = 0.25_wp, part_of_body = 0.05_wp

contains

  !> Search the whole model.
  function look_through(model, displacement, force) result(scene)
    type(model_type), intent(in) :: model        !! the model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [directions, nodes]
    real(wp), intent(in) :: force(:)             !! contact forces [pairs]
    type(overlaps_type) :: scene
    type(search_type) :: search
    integer, allocatable :: others(:)
    integer :: b, part, side

    scene%looked_through = .true.
    if (model%mesh%body_outline%sides == 0) return
    search = new_search(model, displacement)
    scene%moved = search%moved
    do side = 1, model%mesh%body_outline%sides
      call look_at_side(search, scene, side)
    end do
    ! if two bodies have the same outline, no point of it is inside
    do part = 1, model%mesh%body_outline%parts
      others = search%now%part_tree%meeting(search%middle(part)%x, search%middle(part)%x)
      do b = 1, size(others)
        if (others(b) /= part) call look_at_point(search, scene, search%middle(part), others(b))
      end do
    end do
    call look_at_pairs(model, force, search, scene)
    call look_at_ways(search, scene)
    call look_beyond(model, displacement, search, scene)
    scene%changed_side = maxloc(search%allowance%change, dim=1)
    scene%change = search%allowance%change(scene%changed_side)
  end function look_through

  !> Check the points of an edge against the bodies whose boxes it meets.
  subroutine look_at_side(search, scene, side)
    type(search_type), intent(in) :: search      !! outlines
    type(overlaps_type), intent(inout) :: scene     !! results are added
    integer, intent(in) :: side
    real(wp), allocatable :: crossing(:), s(:)
    integer, allocatable :: others(:), parts(:)
    integer :: b, k
    real(wp) :: h, high(directions), low(directions)

    low = search%now%low(:, side)
    high = search%now%high(:, side)
    parts = search%now%part_tree%meeting(low, high)
    do b = 1, size(parts)
      if (parts(b) == search%now%outline%part(side)) cycle
      crossing = search%now%crossings(parts(b), search%now%x(:, 1, side), search%now%chord(side))
      s = [quarters, 0.5_wp*(crossing(:size(crossing) - 1) + crossing(2:))]
      do k = 1, size(s)
        call look_at_point(search, scene, point_on(search, side, s(k)), parts(b))
      end do
    end do
    h = 0.5_wp*norm2(search%now%chord(side))
    others = search%now%sides_meeting(search%now%outline%part(side), low - h, high + h)
    do b = 1, size(others)
      call look_at_itself(search, scene, side, others(b))
    end do
  end subroutine look_at_side

  !> Check a point of a body against another body.
  subroutine look_at_point(search, scene, point, part)
    type(search_type), intent(in) :: search      !! outlines
    type(overlaps_type), intent(inout) :: scene     !! results are added
    type(point_type), intent(in) :: point
    integer, intent(in) :: part
    type(near_place) :: place

    if (search%now%side_tree(part)%away(1, point%x) > 0.0_wp) return
    place = search%now%nearest_place(part, point%x)
    if (place%inside) call keep(search, meet(search, point, place), scene%inside, scene%deep)
  end subroutine look_at_point

  !> Check the points of an edge against another edge of its own body that they were in front of.
  subroutine look_at_itself(search, scene, side, other)
    type(search_type), intent(in) :: search      !! outlines
    type(overlaps_type), intent(inout) :: scene     !! results are added
    integer, intent(in) :: side, other
    type(near_place) :: place
    type(point_type) :: point
    type(overlap_place) :: found
    real(wp) :: drawn
    integer :: k

    associate (node => search%now%outline%node, was => search%drawn)
      if (any(node(1, side) == node(:2, other)) .or. any(node(2, side) == node(:2, other))) return
      do k = 1, size(quarters)
        point = point_on(search, side, quarters(k))
        place = search%now%near_side(other, point%x)
        if (place%s <= 0.0_wp .or. place%s >= 1.0_wp .or. .not. search%now%is_inside(place, point%x)) cycle
        if (2.0_wp*place%distance > norm2(search%now%chord(side))) cycle
        found = meet(search, point, place)
        ! Undeformed depth behind this edge: if the body is between the two, its whole thickness.
        drawn = cross_product(was%chord(other), point%drawn - was%x(:, 1, other))/norm2(was%chord(other))
        if (drawn <= found%allowed .and. is_worse(found, scene%itself)) scene%itself = rated(found)
      end do
    end associate
  end subroutine look_at_itself

  !> Check all pairs with a contact force between two bodies.
  subroutine look_at_pairs(model, force, search, scene)
    type(model_type), intent(in) :: model        !! the model
    real(wp), intent(in) :: force(:)             !! contact forces [pairs]
    type(search_type), intent(in) :: search      !! outlines
    type(overlaps_type), intent(inout) :: scene     !! results are added
    real(wp) :: least
    integer :: k, side, side_of(model%mesh%nodes)

    least = no_effect*maxval(force)
    associate (node => model%mesh%body_outline%node, part_of => model%mesh%body_outline%part_of)
      side_of = 0
      do side = 1, size(node, 2)
        if (node(3, side) > 0) side_of(node(3, side)) = side
        side_of(node(1, side)) = side
      end do
      do k = 1, model%contact%pairs
        associate (part => part_of(model%contact%pair_node(1, k)), b => model%contact%pair_node(2, k))
          if (force(k) <= least .or. side_of(b) == 0 .or. part == 0 .or. part == part_of(b)) cycle
          side = side_of(b)
          call look_at_pair(model, search, scene, k, point_on(search, side, merge(0.0_wp, 0.5_wp, node(1, &
              side) == b)), part)
        end associate
      end do
    end associate
  end subroutine look_at_pairs

  !> Check node B of a pair against the outline of node A.
  subroutine look_at_pair(model, search, scene, pair, point, part)
    type(model_type), intent(in) :: model        !! the model
    type(search_type), intent(in) :: search      !! outlines
    type(overlaps_type), intent(inout) :: scene     !! results are added
    integer, intent(in) :: pair, part
    type(point_type), intent(in) :: point
    type(near_place) :: place
    type(overlap_place) :: found, slid
    real(wp) :: apart(directions), off

    place = search%now%nearest_place(part, point%x)
    found = meet(search, point, place)
    found%pair = pair
    slid = found
    apart = point%motion - search%motion%at(place%side, place%s)
    ! At a corner the nearest edge may not be in contact: closing of a gap is not tangential.
    slid%depth = min(part_along(search%now, place%side, place%s, apart), &
                     abs(cross_product(model%contact%normal(:, pair), apart)))
    slid%allowed = max(part_of_side*maxval(search%allowance%length([found%side, found%other])), &
                       part_of_body*minval(search%width([part, search%now%outline%part(found%side)])))
    if (is_worse(slid, scene%slid)) scene%slid = rated(slid)
    if (place%inside) return
    found%depth = abs(dot_product(point%x - place%x, model%contact%normal(:, pair)))
    off = abs(cross_product(point%x - place%x, model%contact%normal(:, pair)))
    if (off <= found%depth) then
      call keep(search, found, scene%apart, scene%wide)
    else   ! the other body ends before the node
      found%depth = off
      found%allowed = found%allowed + slid%allowed
      if (is_worse(found, scene%beside)) scene%beside = rated(found)
    end if
  end subroutine look_at_pair

  !> Find nodes beyond a line. In axisymmetric models: the node with the least radius, if negative. In all
  !! models: the node farthest beyond a line of symmetry at an end of its body.
  subroutine look_beyond(model, displacement, search, scene)
    type(model_type), intent(in) :: model        !! the model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [directions, nodes]
    type(search_type), intent(in) :: search      !! outlines
    type(overlaps_type), intent(inout) :: scene     !! results are added
    type(beyond_place) :: found
    integer :: c, node, part, way

    if (model%has_rings()) then
      node = minloc(model%mesh%x(1, :) + displacement(1, :), dim=1, mask=model%mesh%body_outline%part_of > 0)
      found = beyond_place(-(model%mesh%x(1, node) + displacement(1, node)), 0.0_wp, 1, node)
      if (found%depth > search%least) scene%axis = found
    end if
    do c = 1, directions
      do way = -1, 1, 2
        do part = 1, model%mesh%body_outline%parts
          found = beyond_end(model, displacement, search, part, c, way)
          if (found%depth > max(search%least, scene%mirror%depth)) scene%mirror = found
        end do
      end do
    end do
  end subroutine look_beyond

  !> Find the node farthest beyond the end of a part towards lower (`way` 1) or higher coordinates (-1). All
  !! undeformed nodes on this line must be fixed normal to it, and one or more free along it; otherwise the
  !! depth is 0.
  pure type(beyond_place) function beyond_end(model, displacement, search, part, c, way) result(place)
    type(model_type), intent(in) :: model        !! the model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [directions, nodes]
    type(search_type), intent(in) :: search      !! outlines
    integer, intent(in) :: part, c, way
    real(wp), allocatable :: u(:), x(:)
    real(wp) :: edge
    integer :: farthest

    associate (first => model%mesh%body_outline%first(part), &
               last => model%mesh%body_outline%first(part + 1) - 1)
      associate (node => model%mesh%body_outline%node(1, first:last), &
                 next => model%mesh%body_outline%node(2, first:last))
        x = way*model%mesh%x(c, node)
        u = way*displacement(c, node)
        edge = minval(x) + search%least
        if (.not. all(x > edge .or. model%constraints%is_held(c, node) .and. abs(u) <= search%least)) return
        if (all(x > edge .or. way*model%mesh%x(c, next) > edge &
                .or. model%constraints%is_held(3 - c, node) .and. &
                  model%constraints%is_held(3 - c, next))) return
        farthest = minloc(x + u, dim=1)
        place = beyond_place(minval(x) - (x(farthest) + u(farthest)), way*minval(x), c, node(farthest))
      end associate
    end associate
  end function beyond_end
end module epcont_certificate_scene
