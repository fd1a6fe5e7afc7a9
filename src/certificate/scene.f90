!> Looks through the displaced outlines of all bodies for places where one lies inside another, or inside itself, and for
!> forces that press across a gap. Pairs and lines have no say in where it looks.
!>
!> Each side of the outlines that meets the box of another body is sampled: where it begins, at its quarter points, and
!> between two places where it crosses the other outline. The depth of a point is its distance from the other outline.
module epcont_certificate_scene
  use epcont_base_kinds, only: wp
  use epcont_certificate_allowance, only: meeting_type
  use epcont_certificate_beyond, only: farthest_beyond_axis, farthest_beyond_mirror
  use epcont_certificate_findings, only: beyond_place, is_worse, more, overlap_place, scene_type, take_deeper, take_worse
  use epcont_certificate_meeting, only: along_side, is_joined, is_paired, meeting_of, middle_of, new_search, note_crossing, &
                                       place_allowance, search_type, take_told, widen_allowance
  use epcont_certificate_pressed, only: look_at_pairs
  use epcont_certificate_way, only: look_at_ways
  use epcont_geometry_outline_shape, only: near_place, new_outline_shape
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: beyond_place, overlap_place, scene_type, look_through

  !> Sides turned [rad] or stretched by more than this are warned of.
  real(wp), parameter, public :: largest_change = 0.2_wp
  !> Below this part of what is allowed, rounding chooses the place.
  real(wp), parameter, public :: little = 0.01_wp
  !> Points of each side: its beginning and its quarter points.
  integer, parameter :: quarters = 4

  !> A point of a body.
  type :: point_type
    integer :: side = 0                !! of the outlines
    real(wp) :: s = 0.5_wp             !! along it, from 0 to 1
    logical :: in_element = .false.    !! it is the middle of that side's element
  end type point_type

contains

  !> Look through the whole scene.
  pure function look_through(model, displacement, force) result(scene)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp), intent(in) :: force(:)             !! contact forces [pairs]
    type(scene_type) :: scene
    type(search_type) :: search
    integer :: part, side

    scene%looked_through = .true.
    if (model%body_outline%sides == 0) return
    search = new_search(model, displacement)
    scene%moved = search%moved
    do side = 1, model%body_outline%sides
      call look_at_side(model, search, side, scene)
    end do
    do part = 1, model%body_outline%parts
      call look_at_middle(model, search, part, scene)
    end do
    call look_at_pairs(model, search, force, scene)
    call look_at_ways(model, search, scene)
    scene%axis = farthest_beyond_axis(model, displacement, search%allowance%least)
    scene%mirror = farthest_beyond_mirror(model, displacement, search%allowance%least)
    associate (allowance => search%allowance)
      scene%changed_side = maxloc(max(abs(allowance%turn), allowance%stretch), dim=1)
      scene%change = max(abs(allowance%turn(scene%changed_side)), allowance%stretch(scene%changed_side))
    end associate
  end function look_through

  !> The points of a side, in the bodies whose boxes it meets.
  pure subroutine look_at_side(model, search, side, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    integer, intent(in) :: side
    type(scene_type), intent(inout) :: scene
    integer :: b, crossings, k, other, parts
    real(wp) :: h

    h = 0.5_wp*norm2(search%now%chord(side))
    associate (now => search%now, low => search%now%low(:, side), high => search%now%high(:, side), &
               part => model%body_outline%part(side))
      call now%part_tree%meeting(low, high, search%near, parts)
      do b = 1, parts
        other = search%near(b)
        if (other == part) cycle
        do k = 0, quarters - 1
          call look_at_point(model, search, point_type(side, real(k, wp)/quarters), other, scene)
        end do
        call find_crossings(search, side, other, crossings)
        do k = 2, crossings
          call look_at_point(model, search, point_type(side, 0.5_wp*(search%crossing(k - 1) + search%crossing(k))), other, scene)
        end do
      end do
      call now%side_tree(part)%meeting(low - h, high + h, search%near, parts)
      do b = 1, parts
        call look_at_itself(model, search, side, model%body_outline%first(part) + search%near(b) - 1, scene)
      end do
    end associate
  end subroutine look_at_side

  !> A point within a part, in the others whose boxes it meets: of bodies with one outline no point of that lies inside.
  pure subroutine look_at_middle(model, search, part, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    integer, intent(in) :: part
    type(scene_type), intent(inout) :: scene
    type(point_type) :: point
    real(wp) :: x(2)
    integer :: b, parts

    point = point_type(model%body_outline%first(part), in_element=.true.)
    x = now_at(model, search, point)
    call search%now%part_tree%meeting(x, x, search%near, parts)
    do b = 1, parts
      if (search%near(b) /= part) call look_at_point(model, search, point, search%near(b), scene)
    end do
  end subroutine look_at_middle

  !> One point of a body, in another.
  pure subroutine look_at_point(model, search, point, part, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    type(point_type), intent(in) :: point
    integer, intent(in) :: part
    type(scene_type), intent(inout) :: scene
    type(near_place) :: place
    type(meeting_type) :: meeting
    type(overlap_place) :: deep, inside
    real(wp) :: x(2)

    x = now_at(model, search, point)
    if (search%now%side_tree(part)%away(1, x) > 0.0_wp) return
    place = search%now%nearest_place(part, x, search%last)
    search%last = place%side
    if (.not. place%inside) return
    meeting = meeting_of(model, search, point%side, point%s, place, is_joined(model, search, point%side, place%side))
    inside = overlap_place(0.0_wp, place%distance, place_allowance(model, search, point%side, point%s, place, meeting), x, &
                           point%side, place%side)
    deep = inside
    call take_told(search, meeting, deep)
    if (.not. (is_worse(inside, scene%inside) .or. inside%depth > more*scene%deepest%depth .or. &
               deep%depth > deep%allowed .and. is_worse(deep, scene%deep))) return
    call widen_allowance(search, inside, place%distance, meeting)
    if (place%distance > min(inside%allowed, deep%allowed)) then
      call take_drawn(model, search, point, inside, scene%drawn)
      deep%depth = inside%depth
    end if
    call take_worse(inside, scene%inside)
    call take_deeper(inside, scene%deepest)
    if (deep%depth > deep%allowed) call take_worse(deep, scene%deep)
  end subroutine look_at_point

  !> Where a point is, displaced.
  pure function now_at(model, search, point) result(x)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    type(point_type), intent(in) :: point
    real(wp) :: x(2)

    if (point%in_element) then
      x = middle_of(model, point%side, model%x) + middle_of(model, point%side, search%displacement)
    else
      x = search%now%at(point%side, point%s)
    end if
  end function now_at

  !> Take off the depth at a place what the bodies overlapped as drawn, if no pair is to close that.
  pure subroutine take_drawn(model, search, point, inside, drawn)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    type(point_type), intent(in) :: point
    type(overlap_place), intent(inout) :: inside
    type(overlap_place), intent(inout) :: drawn     !! the deepest such overlap
    type(near_place) :: before
    real(wp) :: x(2)

    if (is_paired(model, search, inside%side, inside%other)) return
    if (.not. allocated(search%drawn%x)) search%drawn = new_outline_shape(model%body_outline, model%x)
    if (point%in_element) then
      x = middle_of(model, point%side, model%x)
    else
      x = search%drawn%at(point%side, point%s)
    end if
    before = search%drawn%nearest_place(model%body_outline%part(inside%other), x)
    if (.not. before%inside) return
    if (before%distance > inside%allowed .and. before%distance > more*drawn%depth) &
      drawn = overlap_place(before%distance/inside%allowed, before%distance, inside%allowed, x, inside%side, before%side)
    inside%depth = inside%depth - before%distance
  end subroutine take_drawn

  !> Where the chord of a side crosses those of another part, ascending.
  pure subroutine find_crossings(search, side, part, crossings)
    type(search_type), intent(inout) :: search
    integer, intent(in) :: side, part
    integer, intent(out) :: crossings
    real(wp) :: across, along(2), from(2), other(2), s, t
    integer :: k, n

    crossings = 0
    associate (now => search%now)
      call now%side_tree(part)%meeting(now%low(:, side), now%high(:, side), search%nearer, n)
      if (n < 2) return
      along = now%chord(side)
      do k = 1, n
        associate (j => now%outline%first(part) + search%nearer(k) - 1)
          other = now%chord(j)
          across = cross_product(along, other)
          if (across == 0.0_wp) cycle
          from = now%x(:, 1, j) - now%x(:, 1, side)
          s = cross_product(from, other)/across
          t = cross_product(from, along)/across
          if (s < 0.0_wp .or. s > 1.0_wp .or. t < 0.0_wp .or. t > 1.0_wp) cycle
        end associate
        call note_crossing(search, s, crossings)
      end do
    end associate
  end subroutine find_crossings

  !> The points of a side, behind another side of its own body, before which they were drawn.
  pure subroutine look_at_itself(model, search, side, other, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side, other
    type(scene_type), intent(inout) :: scene
    type(near_place) :: place
    type(meeting_type) :: meeting
    real(wp) :: allowed, drawn, s, x(2)
    integer :: k

    associate (node => model%body_outline%node, now => search%now)
      if (any(node(1, side) == node(:2, other)) .or. any(node(2, side) == node(:2, other))) return
      do k = 0, quarters - 1
        s = real(k, wp)/quarters
        x = now%at(side, s)
        place = now%near_side(other, x)
        if (place%s <= 0.0_wp .or. place%s >= 1.0_wp .or. 2.0_wp*place%distance > norm2(now%chord(side))) cycle
        if (.not. now%is_inside(place, x)) cycle
        meeting = meeting_of(model, search, side, s, place, joined=.true.)
        allowed = place_allowance(model, search, side, s, place, meeting)
        if (place%distance <= more*allowed*scene%itself%ratio) cycle
        ! How far it was drawn behind that side: where the body lies between the two, all of its thickness.
        associate (a => model%x(:, node(1, other)), b => model%x(:, node(2, other)))
          drawn = cross_product(b - a, along_side(model, side, s, model%x) - a)/norm2(b - a)
        end associate
        if (drawn > allowed) cycle
        scene%itself = overlap_place(place%distance/allowed, place%distance, allowed, x, side, other)
      end do
    end associate
  end subroutine look_at_itself
end module epcont_certificate_scene
