!> Bodies that pass through each other on their way, though they are apart where they come to: nodes go
!> straight from where they were drawn to where they are, as those of the other outline do, and may enter it
!> and come out again.
!>
!> A path is looked at in a frame that moves with the other body as a whole. There that body's sides are about
!> where they are displaced, so its tree of boxes tells which of them the path meets, and nothing is built
!> anew.
module epcont_certificate_way
  use epcont_base_kinds, only: wp
  use epcont_certificate_findings, only: is_worse, overlap_place, scene_type, take_if
  use epcont_certificate_meeting, only: boxes_meeting, insert, meet, point_on, point_type, search_type, &
                                       sides_meeting
  use epcont_geometry_box_tree, only: box_tree, new_box_tree
  use epcont_geometry_outline_shape, only: near_place, outline_shape
  use epcont_geometry_plane, only: cross_product
  implicit none
  private
  public :: look_at_ways

  !> Faces by which a node enters and leaves look against each other, within 26 degrees (cosine): it passes
  !! through what is between them. Else it cuts a corner, and only by more than a side is that told from what
  !! a path does that is not straight.
  real(wp), parameter :: opposite = -0.9_wp

  !> A body of which a side turns [rad] or is stretched by more than this has no way that is straight, and no
  !! shape on it.
  real(wp), parameter :: shapeless = 1.0_wp

  !> How each part moves as a whole, and the outlines on the way.
  type :: ways_type
    real(wp), allocatable :: mean(:, :)    !! displacement of each part [length] [2, parts]
    real(wp), allocatable :: spread(:)     !! what its nodes' differ by from that [length] [parts]
    logical, allocatable :: straight(:)    !! it keeps a shape on its way [parts]
    type(box_tree) :: part_tree            !! where each part is on its way
    type(outline_shape) :: between         !! some sides, as far on their way as was asked last
  end type ways_type

  !> A node, or the middle of an element, on its way past a part.
  type :: walk_type
    type(point_type) :: point
    integer :: part = 0
    real(wp) :: length = 0.0_wp            !! at most so far goes it along the other outline [length]
  end type walk_type

contains

  !> The paths of all nodes of the outlines, and of a point within each part: of two bodies with one outline
  !! no node goes inside.
  pure subroutine look_at_ways(search, scene)
    type(search_type), intent(in) :: search    !! the outlines
    type(scene_type), intent(inout) :: scene   !! what is found is added
    type(ways_type) :: ways
    integer :: part, side

    associate (outline => search%now%outline)
      if (outline%parts < 2) return
      ways = new_ways(search)
      do part = 1, outline%parts
        if (.not. ways%straight(part)) cycle
        do side = outline%first(part), outline%first(part + 1) - 1
          call walk(search, ways, point_on(search, side, 0.0_wp), scene)
          if (outline%node(3, side) > 0) call walk(search, ways, point_on(search, side, 0.5_wp), scene)
        end do
        call walk(search, ways, search%middle(part), scene)
      end do
    end associate
  end subroutine look_at_ways

  !> How the parts move.
  pure function new_ways(search) result(ways)
    type(search_type), intent(in) :: search
    type(ways_type) :: ways
    real(wp), allocatable :: high(:, :), low(:, :), u(:, :)
    integer :: p

    associate (outline => search%now%outline)
      allocate (ways%mean(2, outline%parts), ways%spread(outline%parts), ways%straight(outline%parts))
      allocate (low(2, outline%parts), high(2, outline%parts))
      do p = 1, outline%parts
        associate (first => outline%first(p), last => outline%first(p + 1) - 1, &
                   tree => search%now%side_tree(p))
          ways%straight(p) = all(search%allowance%change(first:last) <= shapeless)
          u = search%motion(:, 1, first:last)   ! what middles bulge besides is allowed three times over
          ways%mean(:, p) = 0.5_wp*(minval(u, dim=2) + maxval(u, dim=2))
          ways%spread(p) = maxval(norm2(u - spread(ways%mean(:, p), 2, size(u, 2)), dim=1))
          ! From where it was drawn to where it is.
          low(:, p) = tree%low(:, 1) - max(0.0_wp, maxval(u, dim=2))
          high(:, p) = tree%high(:, 1) - min(0.0_wp, minval(u, dim=2))
        end associate
      end do
      ways%part_tree = new_box_tree(low, high)
      ways%between%outline = outline
      allocate (ways%between%x, mold=search%now%x)
    end associate
  end function new_ways

  !> The path of one point, past all parts that it comes near to.
  pure subroutine walk(search, ways, point, scene)
    type(search_type), intent(in) :: search
    type(ways_type), intent(inout) :: ways
    type(point_type), intent(in) :: point
    type(scene_type), intent(inout) :: scene
    integer, allocatable :: parts(:)
    integer :: b

    parts = boxes_meeting(ways%part_tree, min(point%drawn, point%x), max(point%drawn, point%x))
    do b = 1, size(parts)
      if (parts(b) /= search%now%outline%part(point%side) .and. ways%straight(parts(b))) &
        call look_at_way(search, ways, point, parts(b), scene)
    end do
  end subroutine walk

  !> The path of one point past another part: between two crossings of its outline it may be inside.
  pure subroutine look_at_way(search, ways, point, part, scene)
    type(search_type), intent(in) :: search
    type(ways_type), intent(inout) :: ways
    type(point_type), intent(in) :: point
    integer, intent(in) :: part
    type(scene_type), intent(inout) :: scene
    type(walk_type) :: walk
    real(wp), allocatable :: time(:)
    integer, allocatable :: sides(:)
    integer :: k

    associate (start => point%drawn + ways%mean(:, part), stop => point%x, wide => ways%spread(part))
      walk = walk_type(point, part, norm2(stop - start) + wide)
      if (walk%length <= search%least) return
      sides = sides_meeting(search%now, part, min(start, stop) - wide, max(start, stop) + wide)
    end associate
    allocate (time(0))
    do k = 1, size(sides)
      call cross_side(search, point, sides(k), time)
    end do
    if (size(time) == 0) return
    time = [0.0_wp, time, 1.0_wp]
    do k = 2, size(time)
      if ((time(k) - time(k - 1))*walk%length > search%least) &
        call look_between(search, ways, walk, time(k - 1:k), scene)
    end do
  end subroutine look_at_way

  !> When a point passes between the ends of a side that moves too. Curved sides are two chords. The area
  !! between the point and a chord is a square function of time; on the chord it vanishes.
  pure subroutine cross_side(search, point, side, time)
    type(search_type), intent(in) :: search
    type(point_type), intent(in) :: point
    integer, intent(in) :: side
    real(wp), allocatable, intent(inout) :: time(:)   !! ascending
    real(wp) :: a(2), b(2), da(2), db(2), root(2)
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

  !> The real roots of a + b t + c t**2 between -1 and 1; 2 stands for one that is not there.
  pure function roots_of_square(a, b, c) result(root)
    real(wp), intent(in) :: a, b, c
    real(wp) :: root(2)
    real(wp) :: discriminant, q

    root = 2.0_wp
    discriminant = b**2 - 4.0_wp*a*c
    if (discriminant < 0.0_wp) return
    q = -0.5_wp*(b + sign(sqrt(discriminant), b))   ! no difference of near numbers
    if (abs(a) <= abs(q) .and. q /= 0.0_wp) root(1) = a/q
    if (abs(q) <= abs(c) .and. c /= 0.0_wp) root(2) = q/c
  end function roots_of_square

  !> Is a point inside between two times, deeper than at these, and than is allowed?
  pure subroutine look_between(search, ways, walk, time, scene)
    type(search_type), intent(in) :: search
    type(ways_type), intent(inout) :: ways
    type(walk_type), intent(in) :: walk
    real(wp), intent(in) :: time(2)
    type(scene_type), intent(inout) :: scene
    type(near_place) :: ends(2), place
    type(overlap_place) :: found
    real(wp) :: along(2, 2), middle, within
    integer :: i

    middle = 0.5_wp*(time(1) + time(2))
    within = (time(2) - time(1))*walk%length
    call find_nearest(search, ways, walk, middle, 0.5_wp*within, place)   ! no farther is the crossing
    if (place%side == 0 .or. .not. place%inside) return
    found = meet(search, walk%point, place)
    if (found%depth <= found%allowed) return
    do i = 1, 2
      call find_nearest(search, ways, walk, time(i), within + place%distance, ends(i))
      if (ends(i)%inside) found%depth = min(found%depth, place%distance - ends(i)%distance)
      along(:, i) = search%now%tangent(ends(i)%side, ends(i)%s)   ! of the side where it enters, or leaves
    end do
    if (found%depth <= found%allowed) return
    if (dot_product(along(:, 1), along(:, 2)) > opposite*norm2(along(:, 1))*norm2(along(:, 2)) .and. &
        within <= maxval(search%allowance%length([found%side, found%other]))) return
    found%x = walk%point%drawn + middle*walk%point%motion
    if (.not. walk%point%in_element) &
      found%node = search%now%outline%node(merge(3, 1, walk%point%s > 0.0_wp), found%side)
    call take_if(is_worse(found, scene%passed), found, scene%passed)
  end subroutine look_between

  !> The place of a part that is nearest to a point at a time, of those within reach; side 0: none.
  pure subroutine find_nearest(search, ways, walk, time, reach, best)
    type(search_type), intent(in) :: search
    type(ways_type), intent(inout) :: ways
    type(walk_type), intent(in) :: walk
    real(wp), intent(in) :: time
    real(wp), intent(in) :: reach           !! [length]
    type(near_place), intent(out) :: best
    type(near_place) :: place
    integer, allocatable :: near(:), sides(:)
    real(wp) :: wide, x(2), x_now(2)
    integer :: k

    x = walk%point%drawn + time*walk%point%motion
    x_now = x + (1.0_wp - time)*ways%mean(:, walk%part)
    wide = reach + (1.0_wp - time)*ways%spread(walk%part)
    near = sides_meeting(search%now, walk%part, x_now - wide, x_now + wide)
    associate (outline => search%now%outline)
      sides = [near, outline%before(near), outline%after(near)]   ! at a node both say what is inside
    end associate
    ways%between%x(:, :, sides) = search%drawn%x(:, :, sides) + time*search%motion(:, :, sides)
    do k = 1, size(near)
      place = ways%between%near_side(near(k), x)
      if (place%distance < best%distance) best = place
    end do
    if (best%side > 0) best%inside = ways%between%is_inside(best, x)
  end subroutine find_nearest
end module epcont_certificate_way
