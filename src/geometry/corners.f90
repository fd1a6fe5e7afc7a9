!> Corners and normals of a boundary. The rotations of the boundary at neighbouring nodes decide what is a
!> corner.
!>
!> Along chords of a curve, neighbouring nodes have similar rotations. At a chamfer one node has a rotation,
!> and its neighbours have none.
!>
!>     rotations  30 30 30 30   circle of twelve edges: smooth   0 30 0     chamfer: a corner
!>                0 15 30 15 0  arc of two edges: smooth         0 30 30 0  edge across a corner: two corners
module epcont_geometry_corners
  use epcont_base_kinds, only: wp
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_plane, only: angle_between, right_of, unit
  implicit none
  private
  public :: find_normals

  real(wp), parameter :: &
    degree = acos(-1.0_wp)/180.0_wp, &
    !> Rotations below the first are smooth, above the second corners, whatever the neighbours. Neither is an
    !! angle used in drawings, so that rounding does not decide.
    always_smooth = 4.7_wp*degree, always_corner = 35.3_wp*degree, &
    !> Rotations whose ratio is below this belong to one curve with graded edges.
    alike = 1.0_wp/0.39_wp, &
    !> Rotations that differ from PARAM CORNER by less are equal to it.
    rounding = 1.0e-6_wp*degree
  !> Fixed in x and y.
  integer, parameter :: both = 3

contains

  !> Compute normals at the ends of the edges, corners, lines of symmetry, and boxes of the edges. The
  !! neighbours of the edges are known.
  subroutine find_normals(line, held, angle)
    type(boundary_line), intent(inout) :: line   !! its edges; their normals are set
    !> Direction in which start and end are fixed: 0 not fixed, 3 both [2, sides]
    integer, intent(in) :: held(:, :)
    !> Rotations above this are corners, others are not [degree]; 0: decided here
    real(wp), intent(in) :: angle
    !> Normals of each edge itself at its ends; rotations of the boundary there, positive if convex, zero at
    !! the ends of the line
    real(wp) :: own(2, 2, size(line%element)), turn(2, 0:size(line%element))
    logical :: ends_there(2, size(line%element))
    integer :: end, i, n

    n = size(line%element)
    allocate (line%normal(2, 3, n), line%end_normal(2, 2, n), source=0.0_wp)
    own = reshape([((line%own_normal(i, real(end - 1, wp)), end=1, 2), i=1, n)], [2, 2, n])
    turn = 0.0_wp
    do i = 1, n
      associate (next => line%neighbour(2, i))
        if (next == 0) cycle
        turn(2, i) = angle_between(own(:, 2, i), own(:, 1, next))
        turn(1, next) = turn(2, i)
      end associate
    end do
    allocate (line%mirrored(2, n))
    do i = 1, n
      do end = 1, 2
        line%mirrored(end, i) = is_mirrored(end, i)
        if (line%mirrored(end, i)) call reflect()
      end do
    end do
    ends_there = line%neighbour == 0 .and. .not. line%mirrored
    if (angle > 0.0_wp) then
      line%corner = ends_there .or. abs(turn(:, 1:)) > angle*degree + rounding
    else
      line%corner = ends_there .or. .not. (abs(turn(:, 1:)) < always_smooth .or. is_on_curve(line, turn, n))
    end if
    line%tip = line%corner .and. (turn(:, 1:) > 0.0_wp .or. ends_there) .and. .not. line%mirrored
    call set_normals(own, n, line)
    call line%set_boxes()

  contains

    !> Does an edge end on a line of symmetry, along which the body is cut and across which this line is
    !! fixed? A single fixed node, which keeps a body from drifting, is not a cut.
    pure logical function is_mirrored(end, side)
      integer, intent(in) :: end, side

      associate (d => held(end, side), next => line%neighbour(end, side))
        is_mirrored = d /= 0 .and. d /= both .and. held(3 - end, side) /= d
        if (is_mirrored) is_mirrored = abs(own(3 - d, end, side)) >= abs(own(d, end, side))
        if (.not. is_mirrored .or. next == 0) return   ! the continuation is unknown
        ! A cut meets the edge at a corner. On a curve, the next edge looks like a cut above 45 degrees.
        is_mirrored = abs(turn(end, side)) >= always_corner .and. any(held(end, next) == [d, both]) .and. &
                      abs(own(3 - d, 3 - end, next)) < abs(own(d, 3 - end, next))
      end associate
    end function is_mirrored

    !> Set the normal along a line of symmetry at the end of an edge, and the rotation there: the edge
    !! continues with its mirror image.
    subroutine reflect()
      real(wp) :: mirrored(2)

      associate (across => held(end, i), normal => own(:, end, i))
        line%end_normal(3 - across, end, i) = sign(1.0_wp, normal(3 - across))
        mirrored = normal
        mirrored(across) = -normal(across)
        turn(end, i) = merge(-1.0_wp, 1.0_wp, end == 1)*angle_between(normal, mirrored)
      end associate
    end subroutine reflect
  end subroutine find_normals

  !> Is the end of an edge inside a curve (both neighbours have similar rotations and are not corners), or at
  !! the end of a curve (next to a node inside it with a similar rotation)?
  pure function is_on_curve(line, turn, n) result(on)
    type(boundary_line), intent(in) :: line
    real(wp), intent(in) :: turn(:, 0:)
    integer, intent(in) :: n
    logical :: alike_beside(2, 2, n), inner(2, 0:n), on(2, n)
    real(wp) :: beside(2)
    integer :: at(2), end, i

    inner = .false.
    do i = 1, n
      do end = 1, 2
        at = beyond(end, i)
        beside = sign(1.0_wp, turn(end, i))*[turn(3 - end, i), turn(at(1), at(2))]
        alike_beside(:, end, i) = alike*beside > abs(turn(end, i))
        inner(end, i) = abs(turn(end, i)) < always_corner .and. &
                        all(alike_beside(:, end, i) .and. beside < always_corner)
      end do
    end do
    do i = 1, n
      do end = 1, 2
        at = beyond(end, i)
        on(end, i) = abs(turn(end, i)) < always_corner .and. &
                     (inner(end, i) .or. &
                      any([inner(3 - end, i), inner(at(1), at(2))] .and. alike_beside(:, end, i)))
      end do
    end do

  contains

    !> Next end of the boundary beyond an end of an edge, and its edge; the same edge if it is mirrored.
    pure function beyond(end, side)
      integer, intent(in) :: end, side
      integer :: beyond(2)

      beyond = merge([3 - end, side], [end, line%neighbour(end, side)], line%mirrored(end, side))
    end function beyond
  end function is_on_curve

  !> Set normals from the edges that meet, or from the other end of the edge. Differences from the edge's own
  !! normals at its ends are interpolated along it.
  subroutine set_normals(own, n, line)
    real(wp), intent(in) :: own(:, :, :)
    integer, intent(in) :: n
    type(boundary_line), intent(inout) :: line
    real(wp) :: arc(2, 3, n), chord(2)
    integer :: end, i

    arc = reshape([(arc_normals(line, own, i), i=1, n)], [2, 3, n])
    line%normal(:, :2, :) = line%end_normal
    do i = 1, n
      if (line%corner(2, i) .or. line%mirrored(2, i)) cycle
      associate (next => line%neighbour(2, i))
        line%normal(:, 2, i) = unit(line%chord_length(next)*arc(:, 2, i) + &
                                    line%chord_length(i)*arc(:, 1, next))
        line%normal(:, 1, next) = line%normal(:, 2, i)
      end associate
    end do
    do i = 1, n
      chord = line%own_normal(i, 0.5_wp)
      do end = 1, 2
        if (.not. line%corner(end, i)) cycle
        line%normal(:, end, i) = arc(:, end, i)
        if (line%segment(3, i) > 0 .or. line%corner(3 - end, i)) cycle
        line%normal(:, end, i) = mirror_of(line%normal(:, 3 - end, i), chord)
      end do
      line%normal(:, 3, i) = unit(arc(:, 3, i) + 0.5_wp*sum(line%normal(:, :2, i) - arc(:, :2, i), dim=2))
    end do
  end subroutine set_normals

  !> Normals of the circle through start, end and middle of an edge at these nodes; for a chord, its own
  !! normal.
  pure function arc_normals(line, own, side) result(normal)
    type(boundary_line), intent(in) :: line
    real(wp), intent(in) :: own(:, :, :)
    integer, intent(in) :: side
    real(wp) :: half(2, 2), normal(2, 3)

    normal = spread(own(:, 1, side), 2, 3)
    if (line%segment(3, side) == 0) return
    half(:, 1) = line%x(:, 3, side) - line%x(:, 1, side)
    half(:, 2) = line%x(:, 2, side) - line%x(:, 3, side)
    normal(:, 3) = unit(right_of(half(:, 1)/sum(half(:, 1)**2) + half(:, 2)/sum(half(:, 2)**2)))
    normal(:, 1) = mirror_of(normal(:, 3), unit(right_of(half(:, 1))))
    normal(:, 2) = mirror_of(normal(:, 3), unit(right_of(half(:, 2))))
  end function arc_normals

  !> Mirror image of a normal of a circle at one end of a chord: the normal at the other end.
  pure function mirror_of(normal, chord)
    real(wp), intent(in) :: normal(2), chord(2)   !! normal at one end; the chord
    real(wp) :: mirror_of(2)

    mirror_of = 2.0_wp*dot_product(normal, chord)*chord - normal
  end function mirror_of
end module epcont_geometry_corners
