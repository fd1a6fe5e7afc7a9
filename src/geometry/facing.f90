!> Projection of a point of one boundary on another.
!>
!> An edge is opposite a point if its normal leads to the point, both boundaries face each other, and no body
!> lies between. The nearest edge is used; in a concave corner, also a second edge at a similar distance.
module epcont_geometry_facing
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, least_difference
  use epcont_geometry_boundary_line, only: boundary_line, facing_type
  use epcont_geometry_plane, only: crossing
  implicit none
  private
  public :: find_facing, looking_point, node_of, rise_of

  !> Boundaries are opposite if the cosine of their normals is below this: a wall at a right angle to a floor
  !! is not opposite, whatever the rounding in a rotated model. (93 degrees: an angle that is not used in
  !! drawings.)
  real(wp), parameter :: against = -0.05_wp
  !> Normals with a larger cosine belong to the same face: 10 degrees.
  real(wp), parameter, public :: same_face = 0.985_wp
  !> Most points are close to the line: the first search is within this number of lengths of their own edge,
  !! and each further one is larger by this factor.
  real(wp), parameter :: nearby = 3.0_wp, widening = 8.0_wp
  real(wp), parameter :: &
    !> Bodies are not thinner than this part of their edges: nothing can lie in smaller gaps.
    thin = 1.0e-3_wp, &
    !> Curves rise above their chords by an eighth of chord times rotation. Points nearer to an edge than this
    !! part of the rise, and than this part of the distance, are on the edge itself.
    rise = 0.2_wp, at_end = 0.01_wp, &
    !> The search for bodies between starts at this part of the edge from a node towards the middle of its
    !! edge, so that flush faces are ignored.
    aside = 1.0e-3_wp

  !> Point to be projected.
  type :: looking_point
    real(wp) :: x(2) = 0.0_wp         !! [length]
    real(wp) :: outward(2) = 0.0_wp   !! normal of its own boundary
    real(wp) :: along(2) = 0.0_wp     !! vector to the middle of its own edge [length]
    real(wp) :: rise = 0.0_wp         !! possible height of its own curve above the edges there [length]
    integer :: node = 0               !! edges that end at this node are ignored; 0 if the point is not a node
    logical :: at_tip = .false.       !! convex corner of its own boundary
  end type looking_point

contains

  !> A node of a side: 1 its start, 2 its end, 3 its middle.
  pure function node_of(line, side, which) result(from)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side, which   !! edge; 1 start, 2 end, 3 middle
    type(looking_point) :: from

    from%x = line%x(:, which, side)
    from%outward = line%normal(:, which, side)
    from%along = 0.5_wp*(line%x(:, 1, side) + line%x(:, 2, side)) - from%x
    if (which == 3) from%along = 0.5_wp*(line%x(:, 2, side) - from%x)
    from%rise = rise_of(line, side)
    from%node = line%segment(which, side)
    if (which < 3) from%at_tip = line%tip(which, side)
  end function node_of

  !> Project a point on a line, within the distance `search`: first on the nearest edge, then on a second face
  !! that is farther by less than the length of the point's own edge.
  pure function find_facing(line, obstacles, from, search) result(face)
    type(boundary_line), intent(in) :: line        !! line to project on
    type(boundary_line), intent(in) :: obstacles   !! outlines of all bodies
    type(looking_point), intent(in) :: from        !! point to be projected
    real(wp), intent(in) :: search                 !! [length]
    type(facing_type) :: face(2)
    type(facing_type), allocatable :: met(:)
    integer, allocatable :: sides(:)
    real(wp) :: ahead(2), more, rounding, within
    integer :: k

    rounding = cancelled*maxval(abs(from%x))
    ahead = from%x + aside*from%along
    more = min(search, 2.0_wp*norm2(from%along))
    within = min(search, max(nearby*more, least_difference*search))
    do
      sides = line%in_box(from%x - within, from%x + within)
      met = [(look_at(sides(k)), k=1, size(sides))]
      face = best_two(pack(met, met%found))
      ! Edges that were left out are farther away than `within`.
      if (face(1)%found .and. abs(face(1)%gap) + more < within - 2.0_wp*least_difference*search) exit
      if (within >= search) exit
      within = min(search, widening*within)
    end do
    if (abs(face(2)%gap) > abs(face(1)%gap) + more) face(2) = facing_type()
    where (abs(face%gap) <= rounding) face%gap = 0.0_wp

  contains

    !> Project the point on an edge; `found` if the projection is valid.
    pure type(facing_type) function look_at(side) result(face)
      integer, intent(in) :: side
      real(wp) :: away(2)

      if (from%node > 0 .and. any(line%segment(:, side) == from%node)) return
      face = line%face(side, from%x)
      face%found = face%found .and. abs(face%gap) <= search*(1.0_wp + least_difference)
      if (.not. face%found) return
      face%found = dot_product(face%normal, from%outward) < against
      if (.not. face%found) return
      if (face%at_corner .and. .not. from%at_tip) then   ! in contact along the normal of the smooth boundary
        away = face%gap*face%normal
        face%normal = -from%outward
        face%gap = dot_product(face%normal, away)
      end if
      if (face%gap < -max(least_difference*search, rounding)) face%found = goes_on(line, search, ahead, side)
      if (face%found) face%found = .not. is_blocked(line, obstacles, from, ahead, face)
    end function look_at

    !> The best projection, and the nearest one with a different normal.
    pure function best_two(met) result(best)
      type(facing_type), intent(in) :: met(:)
      type(facing_type) :: best(2)
      logical :: taken(size(met))   ! has the same face as the best one
      real(wp) :: by
      integer :: i

      if (size(met) == 0) return
      best(1) = met(1)
      taken = [(i == 1, i=1, size(met))]
      do i = 2, size(met)
        by = advantage(met(i), best(1))
        ! Of equal ones, the one opposite the middle of the point's own edge is better.
        if (by == 0.0_wp .and. aside_of(met(i)) < aside_of(best(1))*(1.0_wp - least_difference)) by = 1.0_wp
        if (by > 0.0_wp) then
          best(1) = met(i)
          taken = .false.
        else if (by == 0.0_wp .and. from%at_tip) then
          call take_mean(met(i), best(1))
        else
          cycle
        end if
        taken(i) = .true.
      end do
      taken = taken .or. met%cosine(best(1)) > same_face
      i = minloc(abs(met%gap), mask=.not. taken, dim=1)
      if (i > 0) best(2) = met(i)
    end function best_two

    !> Advantage of one projection over another: it is nearer, or as near with a more opposite normal. 0 if
    !! both are equal.
    pure real(wp) function advantage(one, other) result(by)
      type(facing_type), intent(in) :: one, other

      by = abs(other%gap) - abs(one%gap)
      if (abs(by) > least_difference*search) return
      by = dot_product(other%normal, from%outward) - dot_product(one%normal, from%outward)
      if (abs(by) <= least_difference) by = 0.0_wp
    end function advantage

    !> Distance from the projected point on the opposite edge to the middle of the point's own edge [length].
    pure real(wp) function aside_of(face)
      type(facing_type), intent(in) :: face

      aside_of = norm2(matmul(line%x(:, :, face%segment), face%share) - from%x - from%along)
    end function aside_of
  end function find_facing

  !> Does a body lie between the point and its projection?
  pure logical function is_blocked(line, obstacles, from, ahead, face)
    type(boundary_line), intent(in) :: line, obstacles
    type(looking_point), intent(in) :: from
    real(wp), intent(in) :: ahead(2)
    type(facing_type), intent(in) :: face
    ! Parts at the ends of the line of sight that are ignored; parts of this line and of an edge at which they
    ! cross
    real(wp) :: near(2), part(2), place(2)
    integer, allocatable :: between(:)
    integer :: i

    is_blocked = .false.
    if (abs(face%gap) <= thin*min(line%chord_length(face%segment), 2.0_wp*norm2(from%along))) return
    near = max([from%rise, rise_of(line, face%segment) + aside*norm2(from%along)]/abs(face%gap), at_end)
    if (sum(near) >= 1.0_wp) return
    place = ahead - face%gap*face%normal
    between = obstacles%in_box(min(ahead, place), max(ahead, place))
    do i = 1, size(between)
      associate (side => obstacles%x(:, :2, between(i)))
        part = crossing(ahead, place - ahead, side(:, 1), side(:, 2) - side(:, 1))
      end associate
      is_blocked = part(1) > near(1) .and. part(1) < 1.0_wp - near(2) .and. &
                   part(2) >= 0.0_wp .and. part(2) <= 1.0_wp
      if (is_blocked) return
    end do
  end function is_blocked

  !> Does a penetration continue along the point's own edge? (The corner of a block on top of another does not
  !! penetrate the other's flank, however far it is from it.)
  pure logical function goes_on(line, search, ahead, side)
    type(boundary_line), intent(in) :: line
    real(wp), intent(in) :: search, ahead(2)
    integer, intent(in) :: side
    type(facing_type) :: place
    integer :: end

    place = line%face(side, ahead)
    goes_on = place%found
    do end = 1, 2
      if (goes_on .or. line%neighbour(end, side) == 0) cycle
      place = line%face(line%neighbour(end, side), ahead)
      goes_on = place%found .and. place%gap < search .and. &
                dot_product(place%normal, line%own_normal(side, 0.5_wp)) > same_face
    end do
  end function goes_on

  !> If a corner is equally far from two edges at their common corner, take the mean of their normals.
  pure subroutine take_mean(other, face)
    type(facing_type), intent(in) :: other
    type(facing_type), intent(inout) :: face
    real(wp) :: both(2)

    if (.not. (face%at_corner .and. other%at_corner)) return
    both = face%normal + other%normal
    face%normal = both/norm2(both)
    face%gap = (face%gap + other%gap)/norm2(both)
  end subroutine take_mean

  !> Largest height of the true curve above an edge [length].
  pure real(wp) function rise_of(line, side)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side   !! number of the edge

    rise_of = rise*line%chord_length(side)*norm2(line%normal(:, 2, side) - line%normal(:, 1, side))
  end function rise_of
end module epcont_geometry_facing
