!> Bodies that pass through each other along the path of displacement, although they are apart at its end. All
!> nodes move along straight paths; a node may enter the other outline and come out again.
!>
!> A tree of the displaced edges stores how far each has moved, and so finds the edges on the path of a point.
module epcont_certificate_way
  use epcont_base_kinds, only: wp
  use epcont_certificate_findings, only: is_worse, overlap_place, rated, overlaps_type
  use epcont_certificate_meeting, only: insert, meet, point_on, point_type, search_type, &
      sides_meeting
  use epcont_element_kinematics, only: directions
  use epcont_geometry_box_tree, only: box_query, box_tree, motion_query, new_box_tree
  use epcont_geometry_outline_shape, only: near_place, outline_shape
  use epcont_geometry_plane, only: cross_product
  implicit none
  private
  public :: look_at_ways

  !> A node passes through a body if the faces where it enters and leaves are opposite, within 26 degrees
  !! (cosine). Otherwise it cuts a corner; then only a path inside longer than an edge counts, since true
  !! paths are not straight.
  real(wp), parameter :: opposite = -0.9_wp

  !> If an edge rotates [rad] or stretches by more than this, the path of its body is not straight and is not
  !! checked.
  real(wp), parameter :: shapeless = 1.0_wp

  !> Growth of the search radius for the nearest point in each round.
  real(wp), parameter :: widening = 8.0_wp

  !> Displacements of the parts.
  type :: ways_type
    real(wp), allocatable :: mean(:, :)      !! displacement of each part [length] [directions, parts]
    real(wp), allocatable :: spread_of(:)    !! largest difference of its nodes from this displacement
                                             !! [length] [parts]
    logical, allocatable :: straight(:)      !! its path is checked [parts]
    type(box_tree) :: part_tree              !! boxes around the path of each part
    type(outline_shape) :: between           !! some edges at the last requested time
  end type ways_type

contains

  !> Follow the paths of all nodes of the outlines, and of a point inside each part, since no node enters a
  !! body with the same outline.
  subroutine look_at_ways(search, scene)
    type(search_type), intent(in) :: search    !! the outlines
    type(overlaps_type), intent(inout) :: scene   !! results are added
    type(ways_type) :: ways
    integer :: part, side

    associate (outline => search%now%outline)
      if (outline%parts < 2) return
      call find_ways(search, ways)
      do part = 1, outline%parts
        if (.not. ways%straight(part)) cycle
        do side = outline%first(part), outline%first(part + 1) - 1
          call walk(search, scene, ways, point_on(search, side, 0.0_wp))
          if (outline%node(3, side) > 0) call walk(search, scene, ways, point_on(search, side, 0.5_wp))
        end do
        call walk(search, scene, ways, search%middle(part))
      end do
    end associate
  end subroutine look_at_ways

  !> Find the displacements of the parts.
  subroutine find_ways(search, ways)
    type(search_type), intent(in) :: search    !! the outlines
    type(ways_type), intent(inout) :: ways    !! of the parts
    real(wp), dimension(directions, search%now%outline%parts) :: high, low
    real(wp), allocatable :: u(:, :)
    integer :: p

    associate (parts => search%now%outline%parts)
      allocate (ways%mean(directions, parts), ways%spread_of(parts), ways%straight(parts))
    end associate
    do p = 1, size(ways%straight)
      associate (first => search%now%outline%first(p), last => search%now%outline%first(p + 1) - 1, &
                 tree => search%now%side_tree(p))
        ways%straight(p) = all(search%allowance%change(first:last) <= shapeless)
        u = search%motion(:, 1, first:last)   ! mid-side nodes: covered by three times the allowance
        ways%mean(:, p) = 0.5_wp*(minval(u, dim=2) + maxval(u, dim=2))
        ways%spread_of(p) = maxval(norm2(u - spread(ways%mean(:, p), 2, size(u, 2)), dim=1))
        ! From the undeformed to the displaced position.
        low(:, p) = tree%low(:, 1) - max(0.0_wp, maxval(u, dim=2))
        high(:, p) = tree%high(:, 1) - min(0.0_wp, minval(u, dim=2))
      end associate
    end do
    ways%part_tree = new_box_tree(low, high)
    ways%between%outline = search%now%outline
    allocate (ways%between%x, mold=search%now%x)
  end subroutine find_ways

  !> Follow the path of one point past all nearby parts.
  subroutine walk(search, scene, ways, point)
    type(search_type), intent(in) :: search    !! the outlines
    type(overlaps_type), intent(inout) :: scene   !! results are added
    type(ways_type), intent(inout) :: ways    !! of the parts
    type(point_type), intent(in) :: point   !! a node, or the centre of an element
    integer, allocatable :: parts(:)
    integer :: b

    parts = ways%part_tree%meeting(box_query(min(point%drawn, point%x), max(point%drawn, point%x)))
    do b = 1, size(parts)
      if (parts(b) /= search%now%outline%part(point%side) .and. ways%straight(parts(b))) &
        call look_at_way(search, scene, ways, point, parts(b))
    end do
  end subroutine walk

  !> Follow the path of one point past another part; between two crossings of its outline it may be inside.
  subroutine look_at_way(search, scene, ways, point, part)
    type(search_type), intent(in) :: search    !! the outlines
    type(overlaps_type), intent(inout) :: scene   !! results are added
    type(ways_type), intent(inout) :: ways    !! of the parts
    type(point_type), intent(in) :: point
    integer, intent(in) :: part
    real(wp), allocatable :: time(:)
    integer, allocatable :: sides(:)
    real(wp) :: length   ! largest length of its path along the other outline
    integer :: k

    associate (start => point%drawn + ways%mean(:, part), stop => point%x, wide => ways%spread_of(part))
      length = norm2(stop - start) + wide
      if (length <= search%least) return
    end associate
    sides = sides_meeting(search%now, part, motion_query(point%x - search%least, point%x + search%least, &
                                                         point%motion))
    allocate (time(0))
    do k = 1, size(sides)
      call cross_side(search, point, sides(k), time)
    end do
    if (size(time) == 0) return
    time = [0.0_wp, time, 1.0_wp]
    do k = 2, size(time)
      if ((time(k) - time(k - 1))*length > search%least) &
        call look_between(search, scene, ways, point, part, time(k - 1:k), length)
    end do
  end subroutine look_at_way

  !> Find the times at which a point crosses a moving edge. Curved edges are two chords. The area between the
  !! point and a chord is a quadratic function of time; it is zero on the chord.
  pure subroutine cross_side(search, point, side, time)
    type(search_type), intent(in) :: search    !! the outlines
    type(point_type), intent(in) :: point
    integer, intent(in) :: side
    real(wp), allocatable, intent(inout) :: time(:)   !! ascending
    real(wp), dimension(directions) :: a, b, da, db
    real(wp) :: root(2)
    integer :: chord, ends(3), i

    ends = [1, 2, 0]
    if (search%now%outline%node(3, side) > 0) ends = [1, 3, 2]
    do chord = 1, count(ends > 0) - 1
      a = search%drawn%x(:, ends(chord), side) - point%drawn
      b = search%drawn%x(:, ends(chord + 1), side) - point%drawn
      da = search%motion(:, ends(chord), side) - point%motion
      db = search%motion(:, ends(chord + 1), side) - point%motion
      root = roots_of_square(cross_product(a, b), cross_product(a, db) + cross_product(da, b), &
                             cross_product(da, db))
      do i = 1, 2
        if (root(i) < 0.0_wp .or. root(i) > 1.0_wp) cycle
        if (dot_product(a + root(i)*da, b + root(i)*db) <= 0.0_wp) call insert(root(i), time)
      end do
    end do
  end subroutine cross_side

  !> Is a point inside a part between two times, deeper than at these times, and deeper than allowed?
  subroutine look_between(search, scene, ways, point, part, time, length)
    type(search_type), intent(in) :: search    !! the outlines
    type(overlaps_type), intent(inout) :: scene   !! results are added
    type(ways_type), intent(inout) :: ways    !! of the parts
    type(point_type), intent(in) :: point
    integer, intent(in) :: part
    real(wp), intent(in) :: time(2), length
    type(near_place) :: ends(2), place
    type(overlap_place) :: found
    real(wp) :: along(directions, 2), middle, within
    integer :: i

    middle = 0.5_wp*(time(1) + time(2))
    within = (time(2) - time(1))*length
    place = nearest_place(search, ways, point, part, middle, 0.5_wp*within)   ! the crossing is not farther
    if (place%side == 0 .or. .not. place%inside) return
    found = meet(search, point, place)
    if (found%depth <= found%allowed) return
    do i = 1, 2
      ends(i) = nearest_place(search, ways, point, part, time(i), within + place%distance)
      if (ends(i)%inside) found%depth = min(found%depth, place%distance - ends(i)%distance)
      along(:, i) = search%now%tangent(ends(i)%side, ends(i)%s)   ! of the edges where it enters and leaves
    end do
    if (found%depth <= found%allowed) return
    if (dot_product(along(:, 1), along(:, 2)) > opposite*norm2(along(:, 1))*norm2(along(:, 2)) .and. &
        within <= maxval(search%allowance%length([found%side, found%other]))) return
    found%x = point%drawn + middle*point%motion
    if (.not. point%in_element) &
      found%node = search%now%outline%node(merge(3, 1, point%s > 0.0_wp), found%side)
    if (is_worse(found, scene%passed)) scene%passed = rated(found)
  end subroutine look_between

  !> Find the point of a part nearest to a point at a time, within reach; side 0 if there is no such point.
  !! The search starts with the length of its own edge.
  type(near_place) function nearest_place(search, ways, point, part, time, reach) result(best)
    type(search_type), intent(in) :: search    !! the outlines
    type(ways_type), intent(inout) :: ways    !! of the parts
    type(point_type), intent(in) :: point
    integer, intent(in) :: part
    real(wp), intent(in) :: time, reach     !! from 0 to 1; [length]
    type(near_place) :: place
    integer, allocatable :: near(:), sides(:)
    real(wp) :: within, x(directions)
    integer :: k

    x = point%drawn + time*point%motion
    within = min(reach, search%allowance%length(point%side))
    do
      near = sides_meeting(search%now, part, motion_query(point%x - within, point%x + within, &
                                                          point%motion, [time, time]))
      ! At a node both edges decide whether the point is inside.
      sides = [near, search%now%outline%before(near), search%now%outline%after(near)]
      ways%between%x(:, :, sides) = search%drawn%x(:, :, sides) + time*search%motion(:, :, sides)
      do k = 1, size(near)
        place = ways%between%near_side(near(k), x)
        if (place%distance < best%distance) best = place
      end do
      if (best%distance <= within .or. within >= reach) exit
      within = min(reach, widening*within)
    end do
    if (best%side > 0) best%inside = ways%between%is_inside(best, x)
  end function nearest_place

  !> Real roots of a + b t + c t**2 between -1 and 1; 2 stands for a root outside.
  pure function roots_of_square(a, b, c) result(root)
    real(wp), intent(in) :: a, b, c
    real(wp) :: root(2), discriminant, q

    root = 2.0_wp
    discriminant = b**2 - 4.0_wp*a*c
    if (discriminant < 0.0_wp) return
    q = -0.5_wp*(b + sign(sqrt(discriminant), b))   ! no difference of nearly equal numbers
    if (abs(a) <= abs(q) .and. q /= 0.0_wp) root(1) = a/q
    if (abs(q) <= abs(c) .and. c /= 0.0_wp) root(2) = q/c
  end function roots_of_square
end module epcont_certificate_way
