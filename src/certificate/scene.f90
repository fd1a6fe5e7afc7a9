!> Looks through the displaced outlines of all bodies for places where one lies inside another, or inside itself, and for
!> forces that press across a gap. Pairs and lines have no say in where it looks.
!>
!> Each side of the outlines that meets the box of another body is sampled: where it begins, at its quarter points, and
!> between two places where it crosses the other outline. The depth of a point is its distance from the other outline.
module epcont_certificate_scene
  use epcont_base_geometry, only: cross_product
  use epcont_base_kinds, only: wp
  use epcont_certificate_allowance, only: meeting_type, new_allowance
  use epcont_certificate_meeting, only: allowance_about, is_joined, is_paired, meeting_of, own_allowance, search_type
  use epcont_model_mates, only: find_mates
  use epcont_model_model, only: model_type
  use epcont_model_outline_shape, only: near_place, new_outline_shape
  implicit none
  private
  public :: overlap_place, scene_type, look_through

  !> Sides turned [rad] or stretched by more than this are warned of.
  real(wp), parameter, public :: largest_change = 0.2_wp
  !> Below this part of what is allowed, rounding chooses the place.
  real(wp), parameter, public :: little = 0.01_wp
  !> Bodies deeper in each other, or farther apart where they press, than this part of the largest displacement: that is told,
  !! though it be allowed.
  real(wp), parameter :: told = 0.1_wp
  !> Near a corner the nearest side need not be the one to which a gap is measured: of those so many depths off the largest
  !! allowance counts.
  real(wp), parameter :: about = 1.5_wp
  !> A pair presses if its force is more than this part of the largest.
  real(wp), parameter :: pressing = 1.0e-6_wp
  !> Points of each side: its beginning and its quarter points.
  integer, parameter :: quarters = 4

  !> Of places that differ by less than this part the first counts: rounding decides nothing.
  real(wp), parameter :: more = 1.0_wp + 1.0e-9_wp

  !> Where a body lies in another, or in itself.
  type :: overlap_place
    real(wp) :: ratio = 0.0_wp     !! depth, of what is allowed
    real(wp) :: depth = 0.0_wp     !! [length]
    real(wp) :: allowed = 0.0_wp   !! [length]
    real(wp) :: x(2) = 0.0_wp      !! of the point that lies inside, displaced [length]
    integer :: side = 0            !! of the outlines, on which the point is; 0: there is no such place
    integer :: other = 0           !! the side of the other body that it is nearest to
    logical :: moving = .false.    !! it is for slides and turns that most of the depth is allowed
  end type overlap_place

  type :: scene_type
    logical :: looked_through = .false.
    type(overlap_place) :: inside          !! deepest in another body, by what is allowed
    type(overlap_place) :: itself          !! deepest in its own body
    type(overlap_place) :: apart           !! the depth is that of a gap across which `pair` presses
    integer :: pair = 0
    type(overlap_place) :: deep            !! deepest in another body, by what is told
    type(overlap_place) :: wide            !! the same of a gap across which a pair presses
    real(wp) :: moved = 0.0_wp             !! largest displacement [length]
    type(overlap_place) :: drawn           !! overlap as drawn, which no pair is to close: no fault, but told
    real(wp) :: change = 0.0_wp            !! largest turn [rad] or stretch of a side
    integer :: changed_side = 0            !! which one
  contains
    procedure :: sound
  end type scene_type

contains

  !> Does no body lie in another, and no force press across a gap?
  pure logical function sound(self)
    class(scene_type), intent(in) :: self

    sound = self%inside%ratio <= 1.0_wp .and. self%apart%ratio <= 1.0_wp
  end function sound

  !> Look through the whole scene.
  pure function look_through(model, displacement, force) result(scene)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp), intent(in) :: force(:)             !! contact forces [pairs]
    type(scene_type) :: scene
    type(search_type) :: search
    integer :: side

    scene%looked_through = .true.
    if (model%body_outline%sides == 0) return
    search%displacement = displacement
    search%now = new_outline_shape(model%body_outline, model%x + displacement)
    search%allowance = new_allowance(model, displacement)
    scene%moved = maxval(norm2(displacement, dim=1))
    search%told = search%allowance%least + told*scene%moved
    search%mate = find_mates(model)
    allocate (search%in_line(model%body_outline%sides), source=.false.)
    if (allocated(model%line)) then
      do side = 1, size(model%line)
        search%in_line(model%line(side)%side) = .true.
      end do
    end if
    allocate (search%near(16), search%nearer(16), search%crossing(16))
    do side = 1, model%body_outline%sides
      call look_at_side(model, search, side, scene)
    end do
    call look_at_pairs(model, search, force, scene)
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
          call look_at_point(model, search, side, real(k, wp)/quarters, other, scene)
        end do
        call find_crossings(search, side, other, crossings)
        do k = 2, crossings
          call look_at_point(model, search, side, 0.5_wp*(search%crossing(k - 1) + search%crossing(k)), other, scene)
        end do
      end do
      call now%side_tree(part)%meeting(low - h, high + h, search%near, parts)
      do b = 1, parts
        call look_at_itself(model, search, side, model%body_outline%first(part) + search%near(b) - 1, scene)
      end do
    end associate
  end subroutine look_at_side

  !> One point of a side, in another body.
  pure subroutine look_at_point(model, search, side, s, part, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    integer, intent(in) :: side
    real(wp), intent(in) :: s
    integer, intent(in) :: part
    type(scene_type), intent(inout) :: scene
    type(near_place) :: place
    type(meeting_type) :: meeting
    type(overlap_place) :: deep, inside
    real(wp) :: x(2)

    x = search%now%at(side, s)
    if (search%now%side_tree(part)%away(1, x) > 0.0_wp) return
    place = search%now%nearest(part, x, search%last)
    search%last = place%side
    if (.not. place%inside) return
    meeting = meeting_of(model, search, side, s, place, is_joined(model, search, side, place%side))
    inside = overlap_place(0.0_wp, place%distance, search%allowance%least + own_allowance(model, search, side, s, meeting) &
                           + own_allowance(model, search, place%side, place%s, meeting), x, side, place%side)
    deep = inside
    call take_told(search, meeting, deep)
    if (.not. (is_worse(inside, scene%inside) .or. deep%depth > deep%allowed .and. is_worse(deep, scene%deep))) return
    if (inside%depth > inside%allowed) &
      inside%allowed = search%allowance%least &
                       + allowance_about(search, model%body_outline%part(side), x, about*place%distance, side, meeting) &
                       + allowance_about(search, part, x, about*place%distance, place%side, meeting)
    if (place%distance > min(inside%allowed, deep%allowed)) then
      call take_drawn(model, search, s, inside, scene%drawn)
      deep%depth = inside%depth
    end if
    call take_worse(inside, scene%inside)
    if (deep%depth > deep%allowed) call take_worse(deep, scene%deep)
  end subroutine look_at_point

  !> Of a place where more or less is allowed: how much is not told.
  pure subroutine take_told(search, meeting, place)
    type(search_type), intent(in) :: search
    type(meeting_type), intent(in) :: meeting
    type(overlap_place), intent(inout) :: place

    associate (allowance => search%allowance)
      place%moving = 2.0_wp*(allowance%of_motion(place%side, meeting) + allowance%of_motion(place%other, meeting)) > place%allowed
      place%allowed = search%told + allowance%of_drawing(place%side, meeting) + allowance%of_drawing(place%other, meeting)
    end associate
  end subroutine take_told

  !> Is one place worse than another, by what is allowed there?
  pure logical function is_worse(one, other)
    type(overlap_place), intent(in) :: one, other

    is_worse = one%depth > more*one%allowed*other%ratio
  end function is_worse

  !> Keep the worse of two places.
  pure subroutine take_worse(found, worst)
    type(overlap_place), intent(in) :: found
    type(overlap_place), intent(inout) :: worst

    if (.not. is_worse(found, worst)) return
    worst = found
    worst%ratio = found%depth/found%allowed
  end subroutine take_worse

  !> Take off the depth at a place what the bodies overlapped as drawn, if no pair is to close that.
  pure subroutine take_drawn(model, search, s, inside, drawn)
    type(model_type), intent(in) :: model
    type(search_type), intent(inout) :: search
    real(wp), intent(in) :: s                       !! along the side
    type(overlap_place), intent(inout) :: inside
    type(overlap_place), intent(inout) :: drawn     !! the deepest such overlap
    type(near_place) :: before

    if (is_paired(model, search, inside%side, inside%other)) return
    if (.not. allocated(search%drawn%x)) search%drawn = new_outline_shape(model%body_outline, model%x)
    before = search%drawn%nearest(model%body_outline%part(inside%other), search%drawn%at(inside%side, s))
    if (.not. before%inside) return
    if (before%distance > inside%allowed .and. before%distance > more*drawn%depth) &
      drawn = overlap_place(before%distance/inside%allowed, before%distance, inside%allowed, search%drawn%at(inside%side, s), &
                            inside%side, before%side)
    inside%depth = inside%depth - before%distance
  end subroutine take_drawn

  !> Where the chord of a side crosses those of another part, ascending.
  pure subroutine find_crossings(search, side, part, crossings)
    type(search_type), intent(inout) :: search
    integer, intent(in) :: side, part
    integer, intent(out) :: crossings
    real(wp) :: across, along(2), from(2), other(2), s, t
    integer :: i, k, n

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
        if (crossings == size(search%crossing)) search%crossing = [search%crossing, search%crossing]
        i = crossings
        do while (i > 0)
          if (search%crossing(i) <= s) exit
          search%crossing(i + 1) = search%crossing(i)
          i = i - 1
        end do
        search%crossing(i + 1) = s
        crossings = crossings + 1
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
        allowed = search%allowance%least + own_allowance(model, search, side, s, meeting) &
                  + own_allowance(model, search, other, place%s, meeting)
        if (place%distance <= more*allowed*scene%itself%ratio) cycle
        ! How far it was drawn behind that side: where the body lies between the two, all of its thickness.
        associate (a => model%x(:, node(1, other)), b => model%x(:, node(2, other)))
          drawn = cross_product(b - a, x_drawn(model, search, side, s) - a)/norm2(b - a)
        end associate
        if (drawn > allowed) cycle
        scene%itself = overlap_place(place%distance/allowed, place%distance, allowed, x, side, other)
      end do
    end associate
  end subroutine look_at_itself

  !> A place of a side as drawn.
  pure function x_drawn(model, search, side, s) result(x)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side
    real(wp), intent(in) :: s
    real(wp) :: x(2)

    associate (node => model%body_outline%node(:, side))
      x = (1.0_wp - s)*model%x(:, node(1)) + s*model%x(:, node(2))
      if (node(3) > 0) x = x + 4.0_wp*s*(1.0_wp - s)*(model%x(:, node(3)) - 0.5_wp*(model%x(:, node(1)) + model%x(:, node(2))))
    end associate
  end function x_drawn

  !> Pressed pairs: the distance between the outlines along the normal.
  pure subroutine look_at_pairs(model, search, force, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    real(wp), intent(in) :: force(:)
    type(scene_type), intent(inout) :: scene
    type(near_place) :: place
    type(meeting_type) :: meeting
    type(overlap_place) :: apart, wide
    real(wp) :: gap, least, s, x(2)
    integer :: i, k, side_of(model%nodes)

    if (model%pairs == 0) return
    least = pressing*maxval(force)
    side_of = 0
    do i = 1, model%body_outline%sides
      if (model%body_outline%node(3, i) > 0) side_of(model%body_outline%node(3, i)) = i
      side_of(model%body_outline%node(1, i)) = i
    end do
    do k = 1, model%pairs
      associate (a => model%pair_node(1, k), b => model%pair_node(2, k), part => model%body_outline%part_of)
        if (force(k) <= least .or. side_of(b) == 0 .or. part(a) == 0 .or. part(a) == part(b)) cycle
        x = model%x(:, b) + search%displacement(:, b)
        place = search%now%nearest(part(a), x)
        if (place%inside) cycle
        gap = abs(dot_product(x - place%x, model%normal(:, k)))
        ! What has slid off the other body's end has nothing before it along the normal.
        if (abs(cross_product(x - place%x, model%normal(:, k))) > gap) cycle
        s = merge(0.5_wp, 0.0_wp, model%body_outline%node(3, side_of(b)) == b)
        meeting = meeting_of(model, search, side_of(b), s, place, joined=.true.)
        apart = overlap_place(0.0_wp, gap, search%allowance%least + own_allowance(model, search, side_of(b), s, meeting) &
                              + own_allowance(model, search, place%side, place%s, meeting), x, side_of(b), place%side)
        wide = apart
        call take_told(search, meeting, wide)
        if (gap > wide%allowed) call take_worse(wide, scene%wide)
        if (.not. is_worse(apart, scene%apart)) cycle
        if (gap > apart%allowed) apart%allowed = search%allowance%least &
                                 + allowance_about(search, part(b), x, about*place%distance, side_of(b), meeting) &
                                 + allowance_about(search, part(a), x, about*place%distance, place%side, meeting)
        if (is_worse(apart, scene%apart)) scene%pair = k
        call take_worse(apart, scene%apart)
      end associate
    end do
  end subroutine look_at_pairs
end module epcont_certificate_scene
