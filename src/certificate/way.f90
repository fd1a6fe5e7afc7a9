!> Bodies that pass through each other on their way, though they are apart where they come to: nodes go straight from where they
!> were drawn to where they are, as those of the other outline do, and may enter it and come out again.
!>
!> A path is looked at in a frame that moves with the other body as a whole. There that body's sides are about where they are
!> displaced, so its tree of boxes tells which of them the path meets, and nothing is built anew.
module epcont_certificate_way
  use epcont_base_kinds, only: wp
  use epcont_certificate_allowance, only: meeting_type
  use epcont_certificate_findings, only: is_worse, overlap_place, scene_type, take_worse
  use epcont_certificate_meeting, only: is_joined, meeting_of, middle_of, note_crossing, place_allowance, search_type
  use epcont_geometry_box_tree, only: box_tree, new_box_tree
  use epcont_geometry_outline_shape, only: near_place, outline_shape
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: look_at_ways

  !> Faces by which a node enters and leaves look against each other, within 26 degrees (cosine): it passes through what is
  !! between them. Else it cuts a corner, and only by more than a side is that told from what a path does that is not straight.
  real(wp), parameter :: opposite = -0.9_wp

  !> A body of which a side turns [rad] or is stretched by more than this has no way that is straight, and no shape on it.
  real(wp), parameter :: shapeless = 1.0_wp

  !> How each part moves as a whole, and the outlines on the way.
  type :: ways_type
    real(wp), allocatable :: mean(:, :)    !! displacement of each part [length] [2, parts]
    real(wp), allocatable :: spread(:)     !! what its nodes' differ by from that [length] [parts]
    logical, allocatable :: straight(:)    !! it keeps a shape on its way [parts]
    type(box_tree) :: part_tree            !! where each part is on its way
    type(outline_shape) :: between         !! some sides, as far on their way as was asked last
  end type ways_type

  !> A node, and the side that begins at it or has it as its middle; 0: the middle of that side's element.
  type :: walker_type
    integer :: node = 0, side = 0
    real(wp) :: s = 0.0_wp
    real(wp) :: from(2) = 0.0_wp, motion(2) = 0.0_wp   !! where it was drawn, and its displacement [length]
  end type walker_type

contains

  !> The paths of all nodes of the outlines, and of a point within each part: of two bodies with one outline no node goes inside.
  pure subroutine look_at_ways(model, search, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    type(scene_type), intent(inout) :: scene
    type(ways_type) :: ways
    integer :: k, part, side

    if (model%body_outline%parts < 2) return
    ways = new_ways(model, search)
    do part = 1, model%body_outline%parts
      if (.not. ways%straight(part)) cycle
      do side = model%body_outline%first(part), model%body_outline%first(part + 1) - 1
        do k = 1, 3, 2
          associate (node => model%body_outline%node(k, side))
            if (node == 0) cycle
            call walk(model, search, ways, walker_type(node, side, merge(0.5_wp, 0.0_wp, k == 3), model%x(:, node), &
                                                       search%displacement(:, node)), scene)
          end associate
        end do
      end do
      side = model%body_outline%first(part)
      call walk(model, search, ways, walker_type(0, side, 0.5_wp, middle_of(model, side, model%x), &
                                                 middle_of(model, side, search%displacement)), scene)
    end do
  end subroutine look_at_ways

  !> The path of one node, past all parts that it comes near to.
  pure subroutine walk(model, search, ways, walker, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    type(ways_type), intent(inout) :: ways
    type(walker_type), intent(in) :: walker
    type(scene_type), intent(inout) :: scene
    integer :: b, n

    associate (from => walker%from, to => walker%from + walker%motion)
      call ways%part_tree%meeting(min(from, to), max(from, to), search%near, n)
    end associate
    do b = 1, n
      if (search%near(b) == model%body_outline%part(walker%side) .or. .not. ways%straight(search%near(b))) cycle
      call look_at_way(model, search, ways, walker, search%near(b), scene)
    end do
  end subroutine walk

  !> How the parts move.
  pure function new_ways(model, search) result(ways)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    type(ways_type) :: ways
    real(wp), allocatable :: high(:, :), low(:, :), u(:, :)
    integer :: p

    associate (outline => model%body_outline, allowance => search%allowance)
      allocate (ways%mean(2, outline%parts), ways%spread(outline%parts), ways%straight(outline%parts))
      allocate (low(2, outline%parts), high(2, outline%parts))
      do p = 1, outline%parts
        associate (first => outline%first(p), last => outline%first(p + 1) - 1, tree => search%now%side_tree(p))
          ways%straight(p) = all(max(abs(allowance%turn(first:last)), allowance%stretch(first:last)) <= shapeless)
          u = search%displacement(:, outline%node(1, first:last))   ! what middles bulge besides is allowed three times over
          ways%mean(:, p) = 0.5_wp*(minval(u, dim=2) + maxval(u, dim=2))
          ways%spread(p) = maxval(norm2(u - spread(ways%mean(:, p), 2, size(u, 2)), dim=1))
          low(:, p) = tree%low(:, 1) - max(0.0_wp, maxval(u, dim=2))   ! from where it was drawn to where it is
          high(:, p) = tree%high(:, 1) - min(0.0_wp, minval(u, dim=2))
        end associate
      end do
      ways%part_tree = new_box_tree(low, high)
      ways%between%outline = outline
      allocate (ways%between%x, mold=search%now%x)
    end associate
  end function new_ways

  !> The path of one node past another part: between two crossings of its outline it may be inside.
  pure subroutine look_at_way(model, search, ways, walker, part, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    type(ways_type), intent(inout) :: ways
    type(walker_type), intent(in) :: walker
    integer, intent(in) :: part
    type(scene_type), intent(inout) :: scene
    real(wp) :: from, length, low(2), high(2), to
    integer :: crossings, i, k, n

    associate (start => walker%from + ways%mean(:, part), stop => walker%from + walker%motion, wide => ways%spread(part))
      length = norm2(stop - start) + wide   ! at most so far goes it along the other outline
      if (length <= search%allowance%least) return
      low = min(start, stop) - wide
      high = max(start, stop) + wide
    end associate
    call search%now%side_tree(part)%meeting(low, high, search%nearer, n)
    crossings = 0
    do i = 1, n
      call cross_side(model, search, walker, model%body_outline%first(part) + search%nearer(i) - 1, crossings)
    end do
    if (crossings == 0) return
    from = 0.0_wp
    do k = 1, crossings + 1
      to = 1.0_wp
      if (k <= crossings) to = search%crossing(k)
      if ((to - from)*length > search%allowance%least) &
        call look_between(model, search, ways, walker, part, [from, to], length, scene)
      from = to
    end do
  end subroutine look_at_way

  !> When a node passes between the ends of a side that moves too. Curved sides are two chords.
  pure subroutine cross_side(model, search, walker, side, crossings)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    type(walker_type), intent(in) :: walker
    integer, intent(in) :: side
    integer, intent(inout) :: crossings

    associate (node => model%body_outline%node(:, side))
      if (node(3) == 0) then
        call cross_chord(model, search, walker, node(:2), crossings)
      else
        call cross_chord(model, search, walker, node([1, 3]), crossings)
        call cross_chord(model, search, walker, node([3, 2]), crossings)
      end if
    end associate
  end subroutine cross_side

  !> The area between the node and a chord is a square function of time; on the chord it vanishes.
  pure subroutine cross_chord(model, search, walker, node, crossings)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    type(walker_type), intent(in) :: walker
    integer, intent(in) :: node(2)
    integer, intent(inout) :: crossings
    real(wp) :: a(2), b(2), da(2), db(2), time(2)
    integer :: i

    a = model%x(:, node(1)) - walker%from
    b = model%x(:, node(2)) - walker%from
    da = search%displacement(:, node(1)) - walker%motion
    db = search%displacement(:, node(2)) - walker%motion
    time = roots_of_square(cross_product(a, b), cross_product(a, db) + cross_product(da, b), cross_product(da, db))
    do i = 1, 2
      if (time(i) < 0.0_wp .or. time(i) > 1.0_wp) cycle
      if (dot_product(a + time(i)*da, b + time(i)*db) <= 0.0_wp) call note_crossing(search, time(i), crossings)
    end do
  end subroutine cross_chord

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

  !> Is a node inside between two times, deeper than at these, and than is allowed?
  pure subroutine look_between(model, search, ways, walker, part, time, length, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    type(ways_type), intent(inout) :: ways
    type(walker_type), intent(in) :: walker
    integer, intent(in) :: part
    real(wp), intent(in) :: time(2), length
    type(scene_type), intent(inout) :: scene
    type(near_place) :: ends(2), place
    type(overlap_place) :: found
    type(meeting_type) :: meeting
    real(wp) :: middle, reach, within
    integer :: i

    middle = 0.5_wp*(time(1) + time(2))
    within = (time(2) - time(1))*length
    reach = 0.5_wp*within   ! from the crossing
    call find_nearest(model, search, ways, walker, part, [middle, reach], place)
    if (place%side == 0 .or. .not. place%inside) return
    meeting = meeting_of(model, search, walker%side, walker%s, place, is_joined(model, search, walker%side, place%side))
    found%allowed = place_allowance(model, search, walker%side, walker%s, place, meeting)
    found%depth = place%distance
    if (found%depth <= found%allowed) return
    do i = 1, 2
      call find_nearest(model, search, ways, walker, part, [time(i), 2.0_wp*reach + place%distance], ends(i))
      if (ends(i)%inside) found%depth = min(found%depth, place%distance - ends(i)%distance)
    end do
    if (found%depth <= found%allowed) return
    if (dot_product(along(ends(1)), along(ends(2))) > opposite .and. &
        within <= max(search%allowance%length(walker%side), search%allowance%length(place%side))) return
    found%x = walker%from + middle*walker%motion
    found%side = walker%side
    found%other = place%side
    if (is_worse(found, scene%passed)) scene%passing_node = walker%node
    call take_worse(found, scene%passed)

  contains

    !> Direction of the side where the node enters, or leaves.
    pure function along(place)
      type(near_place), intent(in) :: place
      real(wp) :: along(2)

      along = search%now%tangent(place%side, place%s)
      along = along/max(norm2(along), tiny(1.0_wp))
    end function along
  end subroutine look_between

  !> The place of a part that is nearest to a node at a time, of those within reach; side 0: none.
  pure subroutine find_nearest(model, search, ways, walker, part, moment, best)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    type(ways_type), intent(inout) :: ways
    type(walker_type), intent(in) :: walker
    integer, intent(in) :: part
    real(wp), intent(in) :: moment(2)       !! time, and reach [length]
    type(near_place), intent(out) :: best
    type(near_place) :: place
    real(wp) :: time, wide, x(2), x_now(2)
    integer :: i, n

    time = moment(1)
    x = walker%from + time*walker%motion
    x_now = x + (1.0_wp - time)*ways%mean(:, part)
    wide = moment(2) + (1.0_wp - time)*ways%spread(part)
    call search%now%side_tree(part)%meeting(x_now - wide, x_now + wide, search%nearer, n)
    associate (outline => model%body_outline)
      do i = 1, n
        associate (side => outline%first(part) + search%nearer(i) - 1)
          call put_side(model, search, side, time, ways%between%x(:, :, side))
          place = ways%between%near_side(side, x)
          if (place%distance < best%distance) best = place
        end associate
      end do
      if (best%side == 0) return
      associate (before => outline%before(best%side), after => outline%after(best%side))
        call put_side(model, search, before, time, ways%between%x(:, :, before))
        call put_side(model, search, after, time, ways%between%x(:, :, after))
      end associate
    end associate
    best%inside = ways%between%is_inside(best, x)
  end subroutine find_nearest

  !> Where a side is at a time.
  pure subroutine put_side(model, search, side, time, x)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side
    real(wp), intent(in) :: time
    real(wp), intent(inout) :: x(2, 3)   !! of where it begins and ends, and of its middle node if it has one [length]
    integer :: k

    associate (node => model%body_outline%node(:, side))
      do k = 1, merge(3, 2, node(3) > 0)
        x(:, k) = model%x(:, node(k)) + time*search%displacement(:, node(k))
      end do
    end associate
  end subroutine put_side
end module epcont_certificate_way
