!> Bodies that pass through each other along the path of displacement, although they are apart at its end. All
!> nodes move along straight paths; a node may enter the other outline and come out again.
!>
!> A path is relative to the displacement of the other outline at its point that is nearest at the end. It is
!> checked against the displaced outline like an edge: between two crossings.
module epcont_certificate_way
  use epcont_base_kinds, only: wp
  use epcont_certificate_findings, only: is_worse, overlap_place, rated, overlaps_type
  use epcont_certificate_meeting, only: meet, point_on, point_type, search_type
  use epcont_element_kinematics, only: directions
  use epcont_geometry_box_tree, only: box_tree, new_box_tree
  use epcont_geometry_outline_shape, only: near_place
  implicit none
  private
  public :: look_at_ways

  !> A node passes through a body if the faces where it enters and leaves are opposite, within 26 degrees
  !! (cosine). Otherwise it cuts a corner; then only a path inside longer than an edge counts, since true
  !! paths are not straight.
  real(wp), parameter :: opposite = -0.9_wp

contains

  !> Follow the paths of all nodes of the outlines, and of a point inside each part, since no node enters a
  !! body with the same outline.
  subroutine look_at_ways(search, scene)
    type(search_type), intent(in) :: search    !! the outlines
    type(overlaps_type), intent(inout) :: scene   !! results are added
    type(box_tree) :: paths
    integer :: part, side

    paths = path_boxes(search)
    associate (outline => search%now%outline)
      do part = 1, outline%parts
        if (.not. search%straight(part)) cycle
        do side = outline%first(part), outline%first(part + 1) - 1
          call walk(search, scene, paths, point_on(search, side, 0.0_wp))
          if (outline%node(3, side) > 0) call walk(search, scene, paths, point_on(search, side, 0.5_wp))
        end do
        call walk(search, scene, paths, search%middle(part))
      end do
    end associate
  end subroutine look_at_ways

  !> Make a tree of boxes around the path of each part.
  pure type(box_tree) function path_boxes(search) result(paths)
    type(search_type), intent(in) :: search    !! the outlines
    real(wp), dimension(directions, search%now%outline%parts) :: high, low
    integer :: p

    do p = 1, size(low, 2)
      low(:, p) = min(search%drawn%side_tree(p)%low(:, 1), search%now%side_tree(p)%low(:, 1))
      high(:, p) = max(search%drawn%side_tree(p)%high(:, 1), search%now%side_tree(p)%high(:, 1))
    end do
    paths = new_box_tree(low, high)
  end function path_boxes

  !> Follow the path of one point past all nearby parts.
  subroutine walk(search, scene, paths, point)
    type(search_type), intent(in) :: search    !! the outlines
    type(overlaps_type), intent(inout) :: scene   !! results are added
    type(box_tree), intent(in) :: paths     !! of the parts
    type(point_type), intent(in) :: point   !! a node, or the centre of an element
    integer, allocatable :: parts(:)
    integer :: b

    parts = paths%meeting(min(point%drawn, point%x), max(point%drawn, point%x))
    do b = 1, size(parts)
      if (parts(b) /= search%now%outline%part(point%side) .and. search%straight(parts(b))) &
        call look_at_way(search, scene, point, parts(b))
    end do
  end subroutine walk

  !> Follow the path of one point past another part; between two crossings of its outline it may be inside.
  subroutine look_at_way(search, scene, point, part)
    type(search_type), intent(in) :: search    !! the outlines
    type(overlaps_type), intent(inout) :: scene   !! results are added
    type(point_type), intent(in) :: point
    integer, intent(in) :: part
    type(near_place) :: place
    real(wp), allocatable :: s(:)   ! along the path, from 0 to 1
    real(wp) :: path(directions)
    integer :: k

    place = search%now%nearest_place(part, point%x)
    path = point%motion - search%motion%at(place%side, place%s)
    s = search%now%crossings(part, point%x - path, path)
    if (size(s) == 0) return
    s = [0.0_wp, s, 1.0_wp]
    do k = 2, size(s)
      if ((s(k) - s(k - 1))*norm2(path) > search%least) &
        call look_between(search, scene, point, part, path, s(k - 1:k))
    end do
  end subroutine look_at_way

  !> Is a point inside a part between two points of its path, deeper than at these, and deeper than allowed?
  subroutine look_between(search, scene, point, part, path, s)
    type(search_type), intent(in) :: search    !! the outlines
    type(overlaps_type), intent(inout) :: scene   !! results are added
    type(point_type), intent(in) :: point
    integer, intent(in) :: part
    real(wp), intent(in) :: path(directions)   !! relative to the part [length]
    real(wp), intent(in) :: s(2)               !! along the path, from 0 to 1
    type(near_place) :: ends(2), place
    type(overlap_place) :: found
    type(point_type) :: middle
    real(wp) :: along(directions, 2), left   ! part of the path after the middle
    integer :: i

    left = 1.0_wp - 0.5_wp*(s(1) + s(2))
    middle = point
    middle%x = point%x - left*path
    place = search%now%nearest_place(part, middle%x)
    if (.not. place%inside) return
    found = meet(search, middle, place)
    if (found%depth <= found%allowed) return
    do i = 1, 2
      ends(i) = search%now%nearest_place(part, point%x - (1.0_wp - s(i))*path)
      if (ends(i)%inside) found%depth = min(found%depth, place%distance - ends(i)%distance)
      along(:, i) = search%now%tangent(ends(i)%side, ends(i)%s)   ! of the edges where it enters and leaves
    end do
    if (found%depth <= found%allowed) return
    if (dot_product(along(:, 1), along(:, 2)) > opposite*norm2(along(:, 1))*norm2(along(:, 2)) .and. &
        (s(2) - s(1))*norm2(path) <= maxval(search%allowance%length([found%side, found%other]))) return
    found%x = point%x - left*point%motion
    if (.not. point%in_element) &
      found%node = search%now%outline%node(merge(3, 1, point%s > 0.0_wp), found%side)
    if (is_worse(found, scene%passed)) scene%passed = rated(found)
  end subroutine look_between
end module epcont_certificate_way
