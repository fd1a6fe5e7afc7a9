!> What a point of one boundary faces of another.
!>
!> A side is faced where its normal leads to the point, the two boundaries look against each other, and no
!> body stands between. The nearest counts; in a concave corner, where a second face is about as near, that
!> one too.
module epcont_geometry_facing
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: coordinate_rounding, least_difference
  use epcont_geometry_boundary_line, only: boundary_line, facing_place
  use epcont_geometry_boxed_line, only: boxed_line
  use epcont_geometry_plane, only: cross_product
  implicit none
  private
  public :: facing_type, looking_point, node_of, rise_of, find_nearest, find_facing

  !> Boundaries face each other whose normals' cosine is below this: a wall at a right angle to a floor does
  !! not face it,
  !> however rounding has turned the scene. (93 degrees: no angle that people draw.)
  real(wp), parameter :: against = -0.05_wp
  !> Normals that differ by less (cosine) are those of one face: 10 degrees.
  real(wp), parameter, public :: same_face = 0.985_wp
  !> Most points have the line before their eyes: it is looked for within search/widening**rounds first.
  real(wp), parameter :: widening = 8.0_wp
  integer, parameter :: rounds = 3
  !> Bodies are not thinner than this part of their sides: where the gap is smaller nothing stands between.
  real(wp), parameter :: thin = 1.0e-3_wp
  !> Curves rise above the chords of their sides by an eighth of chord times turn; nearer to a side than this
  !! much of it, and
  !> than this part of the way, is the side itself.
  real(wp), parameter :: rise = 0.2_wp, at_end = 0.01_wp
  !> What stands between is looked for this part of the side away from a node, towards the middle of its side:
  !! flush faces
  !> do not count.
  real(wp), parameter :: aside = 1.0e-3_wp

  !> Who looks.
  type :: looking_point
    real(wp) :: x(2) = 0.0_wp         !! [length]
    real(wp) :: outward(2) = 0.0_wp   !! normal of its own boundary
    real(wp) :: along(2) = 0.0_wp     !! from there to the middle of its own side [length]
    real(wp) :: rise = 0.0_wp         !! how far its own curve may be from the sides there [length]
    integer :: node = 0               !! sides that end at this node do not count; 0: it is none
    logical :: at_tip = .false.       !! a convex corner of its own boundary
    real(wp) :: search = 0.0_wp       !! how far it looks: what is asked of this module says so [length]
  end type looking_point

  type :: facing_type
    type(facing_place) :: place
    integer :: segment = 0        !! the side
    logical :: same_way = .false. !! there is none, but one near by that looks the same way
  end type facing_type

contains

  !> A node of a side: 1 its start, 2 its end, 3 its middle.
  pure function node_of(line, side, which) result(from)
    class(boundary_line), intent(in) :: line   !! its sides
    integer, intent(in) :: side, which   !! side; 1 its start, 2 its end, 3 its middle
    type(looking_point) :: from

    from%x = line%x(:, which, side)
    from%outward = line%outward(side, which)
    from%along = 0.5_wp*(line%x(:, 1, side) + line%x(:, 2, side)) - from%x
    if (which == 3) from%along = 0.5_wp*(line%x(:, 2, side) - from%x)
    from%rise = rise_of(line, side)
    from%node = line%segment(which, side)
    if (which < 3) from%at_tip = line%tip(which, side)
  end function node_of

  !> The side of a line that a point faces nearest by, not farther than `search`.
  pure function find_nearest(line, obstacles, from, search) result(best)
    type(boxed_line), intent(in) :: line   !! that is looked at
    type(boxed_line), intent(in) :: obstacles   !! the outlines of all bodies
    type(looking_point), intent(in) :: from   !! who looks
    real(wp), intent(in) :: search              !! [length]
    type(facing_type) :: best
    type(facing_type) :: second

    call find_facing(line, obstacles, from, search, best, second)
  end function find_nearest

  !> The same, and a second face that is farther by less than the point's own side is long.
  pure subroutine find_facing(line, obstacles, from, search, best, second)
    type(boxed_line), intent(in) :: line   !! that is looked at
    type(boxed_line), intent(in) :: obstacles   !! the outlines of all bodies
    type(looking_point), intent(in) :: from   !! who looks
    real(wp), intent(in) :: search              !! [length]
    type(facing_type), intent(out) :: best      !! the nearest
    type(facing_type), intent(out) :: second    !! the nearest of those that look another way
    type(looking_point) :: who
    real(wp) :: more, within
    integer :: round

    who = from
    who%search = search
    more = min(search, 2.0_wp*norm2(from%along))
    do round = rounds, 0, -1
      within = search/widening**round
      call look_at(line, line%in_box(from%x - within, from%x + within), obstacles, who, best, second)
      ! Sides that were left out are farther than `within`.
      if (best%place%found .and. abs(best%place%gap) + more < within - 2.0_wp*least_difference*search) exit
    end do
    if (second%place%found .and. abs(second%place%gap) > abs(best%place%gap) + more) second = facing_type()
    if (abs(best%place%gap) <= coordinate_rounding*maxval(abs(from%x))) best%place%gap = 0.0_wp
    if (abs(second%place%gap) <= coordinate_rounding*maxval(abs(from%x))) second%place%gap = 0.0_wp
    best%same_way = best%same_way .and. .not. best%place%found
  end subroutine find_facing

  !> The same among a few sides of the line.
  pure subroutine look_at(line, sides, obstacles, from, best, second)
    type(boxed_line), intent(in) :: line
    integer, intent(in) :: sides(:)
    type(boxed_line), intent(in) :: obstacles
    type(looking_point), intent(in) :: from
    type(facing_type), intent(out) :: best, second
    type(facing_type), allocatable :: faces(:)
    integer :: k, n
    logical :: same_way

    allocate (faces(4))
    n = 0
    same_way = .false.
    do k = 1, size(sides)
      if (any(line%segment(:, sides(k)) == from%node) .and. from%node > 0) cycle
      if (n == size(faces)) faces = [faces, faces]
      associate (found => faces(n + 1))
        found%segment = sides(k)
        found%place = line%face(sides(k), from%x)
        if (.not. found%place%found .or. abs(found%place%gap) > from%search*(1.0_wp + least_difference)) cycle
        if (dot_product(found%place%normal, from%outward) >= against) then
          same_way = same_way .or. dot_product(found%place%normal, from%outward) > -against
          cycle
        end if
        if (found%place%at_corner .and. .not. from%at_tip) call press_corner(from, found%place)
        if (found%place%gap < -max(least_difference*from%search, coordinate_rounding*maxval(abs(from%x)))) then
          if (.not. goes_on(line, sides(k), from)) cycle
        end if
        if (is_blocked(obstacles, from, found%place, line%chord_length(sides(k)), rise_of(line, sides(k)))) &
          cycle
      end associate
      n = n + 1
    end do
    call rank(line, from, faces(:n), best, second)
    best%same_way = same_way
  end subroutine look_at

  !> A corner is pressed along the normal of the smooth boundary that it touches.
  pure subroutine press_corner(from, place)
    type(looking_point), intent(in) :: from
    type(facing_place), intent(inout) :: place
    real(wp) :: away(2)

    away = place%gap*place%normal
    place%normal = -from%outward
    place%gap = dot_product(place%normal, away)
  end subroutine press_corner

  !> The best face, and the nearest of those that look another way.
  pure subroutine rank(line, from, faces, best, second)
    type(boxed_line), intent(in) :: line
    type(looking_point), intent(in) :: from
    type(facing_type), intent(in) :: faces(:)
    type(facing_type), intent(inout) :: best, second
    logical :: taken(size(faces))   ! in the best one
    integer :: k

    do k = 1, size(faces)
      if (.not. best%place%found) then
        taken = .false.
      else if (is_better(line, from, faces(k), best)) then
        taken = .false.
      else
        taken(k) = from%at_tip .and. are_equal(from, faces(k), best)
        if (taken(k)) call take_mean(faces(k)%place, best%place)
        cycle
      end if
      best = faces(k)
      taken(k) = .true.
    end do
    do k = 1, size(faces)
      if (taken(k)) cycle
      if (dot_product(faces(k)%place%normal, best%place%normal) > same_face) cycle
      if (second%place%found) then
        if (abs(second%place%gap) <= abs(faces(k)%place%gap)) cycle
      end if
      second = faces(k)
    end do
  end subroutine rank

  !> Is a face better than another? It is nearer; or as near, and looks more against the point's own boundary;
  !! or lies more before the middle of the point's own side.
  pure logical function is_better(line, from, one, other)
    type(boxed_line), intent(in) :: line
    type(looking_point), intent(in) :: from
    type(facing_type), intent(in) :: one, other
    real(wp) :: by

    by = abs(other%place%gap) - abs(one%place%gap)
    is_better = by > 0.0_wp
    if (abs(by) > least_difference*from%search) return
    by = dot_product(other%place%normal, from%outward) - dot_product(one%place%normal, from%outward)
    is_better = by > 0.0_wp
    if (abs(by) > least_difference) return
    is_better = away(one) < away(other)*(1.0_wp - least_difference)

  contains

    pure real(wp) function away(face)
      type(facing_type), intent(in) :: face

      away = norm2(matmul(line%x(:, :, face%segment), face%place%share) - from%x - from%along)
    end function away
  end function is_better

  !> Are two faces as near, and look as much against the point's own boundary?
  pure logical function are_equal(from, one, other)
    type(looking_point), intent(in) :: from
    type(facing_type), intent(in) :: one, other

    are_equal = abs(abs(one%place%gap) - abs(other%place%gap)) <= least_difference*from%search .and. &
                abs(dot_product(one%place%normal - other%place%normal, from%outward)) <= least_difference
  end function are_equal

  !> Of two sides that a corner faces equally well at their corner none is the better one: between their
  !! normals.
  pure subroutine take_mean(other, place)
    type(facing_place), intent(in) :: other
    type(facing_place), intent(inout) :: place
    real(wp) :: both(2)

    if (.not. (place%at_corner .and. other%at_corner)) return
    both = place%normal + other%normal
    place%normal = both/norm2(both)
    place%gap = (place%gap + other%gap)/norm2(both)
  end subroutine take_mean

  !> How far the curve that a side means may be from it [length].
  pure real(wp) function rise_of(line, side)
    class(boundary_line), intent(in) :: line   !! its sides
    integer, intent(in) :: side   !! which side

    rise_of = rise*line%chord_length(side)*norm2(line%normal(:, 2, side) - line%normal(:, 1, side))
  end function rise_of

  !> Does an overlap go on along the point's own side? (The corner of a block that stands on another is no
  !! overlap with the
  !> other's flank, however far it lies behind that.)
  pure logical function goes_on(line, side, from)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side
    type(looking_point), intent(in) :: from
    type(facing_place) :: place
    integer :: end

    place = line%face(side, from%x + aside*from%along)
    goes_on = place%found
    do end = 1, 2
      if (goes_on .or. line%neighbour(end, side) == 0) cycle
      place = line%face(line%neighbour(end, side), from%x + aside*from%along)
      goes_on = place%found .and. place%gap < from%search .and. &
                dot_product(place%normal, line%own_normal(side, 0.5_wp)) > same_face
    end do
  end function goes_on

  !> Does a body stand between a point and what it faces?
  pure logical function is_blocked(obstacles, from, place, side, side_rise)
    type(boxed_line), intent(in) :: obstacles
    type(looking_point), intent(in) :: from
    type(facing_place), intent(in) :: place
    !> Length of the side that is faced, how far its curve may be from it
    real(wp), intent(in) :: side, side_rise
    real(wp) :: a(2), b(2), near(2)
    integer, allocatable :: sides(:)
    integer :: k

    is_blocked = .false.
    if (abs(place%gap) <= thin*min(side, 2.0_wp*norm2(from%along))) return
    near = max([from%rise, side_rise + aside*norm2(from%along)]/abs(place%gap), at_end)
    if (sum(near) >= 1.0_wp) return
    a = from%x + aside*from%along
    b = a - place%gap*place%normal
    sides = obstacles%in_box(min(a, b), max(a, b))
    do k = 1, size(sides)
      is_blocked = crosses(a, b, near, obstacles%x(:, 1, sides(k)), obstacles%x(:, 2, sides(k)))
      if (is_blocked) return
    end do
  end function is_blocked

  !> Does the side from c to d cross the way from a to b, not near its ends?
  pure logical function crosses(a, b, near, c, d)
    real(wp), intent(in) :: a(2), b(2), c(2), d(2)
    real(wp), intent(in) :: near(2)   !! part of the way that does not count at a, at b
    real(wp) :: area, s, t

    area = cross_product(b - a, d - c)
    crosses = .false.
    if (area == 0.0_wp) return
    t = cross_product(c - a, d - c)/area
    s = cross_product(c - a, b - a)/area
    crosses = s >= 0.0_wp .and. s <= 1.0_wp .and. t > near(1) .and. t < 1.0_wp - near(2)
  end function crosses
end module epcont_geometry_facing
