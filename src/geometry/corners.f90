!> Corners of a boundary, and its normals: what is a corner is decided by how the boundary turns around it.
!>
!> Where sides are chords of a curve, neighbouring nodes turn alike; at a chamfer one node turns and those
!> beside it do not.
!>
!>     turns  30 30 30 30   a circle of twelve sides: smooth      0 30 0   a chamfer: a corner
!>            0 15 30 15 0  an arc of two sides: smooth           0 30 30 0   one side across a corner: two
!> corners
module epcont_geometry_corners
  use epcont_base_kinds, only: wp
  use epcont_geometry_boundary_line, only: boundary_line, unit
  use epcont_geometry_plane, only: cross_product
  implicit none
  private
  public :: find_normals

  real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
  !> A turn below the first is smooth, one above the second a corner, whatever lies beside them. Neither is an
  !! angle that people draw: rounding must not decide.
  real(wp), parameter :: always_smooth = 4.7_wp*degree, always_corner = 35.3_wp*degree
  !> Turns that differ by less than this factor are those of one curve, its sides graded.
  real(wp), parameter :: alike = 1.0_wp/0.39_wp
  !> Turns that differ from PARAM CORNER by less are as large.
  real(wp), parameter :: rounding = 1.0e-6_wp*degree
  !> Held in x and y.
  integer, parameter :: both = 3

contains

  !> Normals at the ends of the sides, corners and lines of symmetry. A side's neighbours are known.
  pure subroutine find_normals(line, held, angle)
    type(boundary_line), intent(inout) :: line   !! its sides, whose normals are set
    !> The direction in which its start, its end is held: 0 none, 3 both [2, sides]
    integer, intent(in) :: held(:, :)
    !> Turns above it are corners, others are not [degree]; 0: decided here
    real(wp), intent(in) :: angle
    real(wp) :: turn(2, size(line%element))
    integer :: n

    n = size(line%element)
    allocate (line%normal(2, 2, n), line%end_normal(2, 2, n), source=0.0_wp)
    allocate (line%mirrored(2, n), source=.false.)
    allocate (line%corner(2, n), source=.true.)
    call find_turns(line, turn)
    call reflect(line, held, turn)
    if (angle > 0.0_wp) then
      line%corner = abs(turn) > angle*degree + rounding
    else
      line%corner = .not. (abs(turn) < always_smooth .or. is_on_curve(line, turn))
    end if
    where (ends_there(line)) line%corner = .true.
    line%tip = line%corner .and. (turn > 0.0_wp .or. ends_there(line)) .and. .not. line%mirrored
    call set_normals(line)
  end subroutine find_normals

  !> Sides without a neighbour, and without a mirrored one.
  pure function ends_there(line) result(ends)
    type(boundary_line), intent(in) :: line
    logical :: ends(2, size(line%element))

    ends = line%neighbour == 0 .and. .not. line%mirrored
  end function ends_there

  !> By how much the boundary turns at the start and end of each side, positive where it is convex.
  pure subroutine find_turns(line, turn)
    type(boundary_line), intent(in) :: line
    real(wp), intent(out) :: turn(:, :)   !! [2, sides]
    integer :: i, next

    turn = 0.0_wp
    do i = 1, size(line%element)
      next = line%neighbour(2, i)
      if (next == 0) cycle
      turn(2, i) = angle_between(line%own_normal(i, 1.0_wp), line%own_normal(next, 0.0_wp))
      turn(1, next) = turn(2, i)
    end do
  end subroutine find_turns

  !> Counter-clockwise from one vector to another.
  pure real(wp) function angle_between(a, b)
    real(wp), intent(in) :: a(2), b(2)

    angle_between = atan2(cross_product(a, b), dot_product(a, b))
  end function angle_between

  !> Where a side meets a line of symmetry, along which the body is cut, it goes on as it would be mirrored
  !! there.
  pure subroutine reflect(line, held, turn)
    type(boundary_line), intent(inout) :: line
    integer, intent(in) :: held(:, :)
    real(wp), intent(inout) :: turn(:, :)
    real(wp) :: mirrored(2), own(2)
    integer :: end, i

    do i = 1, size(line%element)
      do end = 1, 2
        associate (d => held(end, i))
          if (d == 0 .or. d == both .or. held(3 - end, i) == d) cycle
          ! A cut meets the side at a corner; on a curve the next side may look like one from 45 degrees on.
          if (line%neighbour(end, i) > 0 .and. abs(turn(end, i)) < always_corner) cycle
          own = line%own_normal(i, real(end - 1, wp))
          if (abs(own(3 - d)) < abs(own(d)) .or. .not. is_cut(line, held, i, end)) cycle
          line%mirrored(end, i) = .true.
          line%end_normal(3 - d, end, i) = sign(1.0_wp, own(3 - d))
          mirrored = own
          mirrored(d) = -own(d)
          turn(end, i) = angle_between(own, mirrored)
          if (end == 1) turn(end, i) = -turn(end, i)
        end associate
      end do
    end do
  end subroutine reflect

  !> Does the body end there along a line across the direction in which that end of a side is held? A node
  !! held by itself, to keep a body from drifting, is no cut. If nothing is known of what lies beyond, yes.
  pure logical function is_cut(line, held, side, end)
    type(boundary_line), intent(in) :: line
    integer, intent(in) :: held(:, :), side, end
    real(wp) :: other(2)

    is_cut = line%neighbour(end, side) == 0
    if (is_cut) return
    associate (d => held(end, side), next => line%neighbour(end, side))
      other = line%own_normal(next, real(2 - end, wp))
      is_cut = abs(other(3 - d)) < abs(other(d)) .and. any(held(end, next) == [d, both])
    end associate
  end function is_cut

  !> The turns beside that at one end of a side: along the side, and along the one that it meets there.
  pure function beside(line, turn, end, side) result(turns)
    type(boundary_line), intent(in) :: line
    real(wp), intent(in) :: turn(:, :)
    integer, intent(in) :: end, side
    real(wp) :: turns(2)

    turns(1) = turn(3 - end, side)
    turns(2) = 0.0_wp
    if (line%mirrored(end, side)) then
      turns(2) = turns(1)
    else if (line%neighbour(end, side) > 0) then
      turns(2) = turn(end, line%neighbour(end, side))
    end if
  end function beside

  !> Is the end of a side within a curve (those on both sides turn as it does, and are no corners), or the
  !! first or the last node of one (beside a node within it, and they turn like that)?
  pure function is_on_curve(line, turn) result(on)
    type(boundary_line), intent(in) :: line
    real(wp), intent(in) :: turn(:, :)
    logical :: on(2, size(line%element))
    logical :: inner(2, 0:size(line%element))
    real(wp) :: turns(2)
    integer :: end, i, next

    inner = .false.
    do i = 1, size(line%element)
      do end = 1, 2
        turns = beside(line, turn, end, i)*sign(1.0_wp, turn(end, i))
        inner(end, i) = all(alike*turns > abs(turn(end, i)) .and. turns < always_corner)
      end do
    end do
    inner(:, 1:) = inner(:, 1:) .and. abs(turn) < always_corner
    do i = 1, size(line%element)
      do end = 1, 2
        next = merge(0, line%neighbour(end, i), line%mirrored(end, i))
        turns = beside(line, turn, end, i)*sign(1.0_wp, turn(end, i))
        on(end, i) = inner(end, i) .or. any([inner(3 - end, i), inner(end, next)] .and. &
                                            alike*turns > abs(turn(end, i)))
      end do
    end do
    on = on .and. abs(turn) < always_corner
  end function is_on_curve

  !> Normals from the sides that meet, or from the other end of the side.
  pure subroutine set_normals(line)
    type(boundary_line), intent(inout) :: line
    real(wp) :: chord(2)
    integer :: end, i, next

    do i = 1, size(line%element)
      next = line%neighbour(2, i)
      if (.not. line%corner(2, i) .and. .not. line%mirrored(2, i)) then
        line%normal(:, 2, i) = unit(line%chord_length(next)*line%own_normal(i, 1.0_wp) + &
                                    line%chord_length(i)*line%own_normal(next, 0.0_wp))
        line%normal(:, 1, next) = line%normal(:, 2, i)
      end if
      do end = 1, 2
        if (line%mirrored(end, i) .and. .not. line%corner(end, i)) &
          line%normal(:, end, i) = line%end_normal(:, end, i)
      end do
    end do
    do i = 1, size(line%element)
      chord = line%own_normal(i, 0.5_wp)
      do end = 1, 2
        if (.not. line%corner(end, i)) cycle
        line%normal(:, end, i) = line%own_normal(i, real(end - 1, wp))
        if (line%segment(3, i) > 0 .or. line%corner(3 - end, i)) cycle
        ! Of a circle through both ends the one normal mirrors the other.
        associate (other => line%normal(:, 3 - end, i))
          line%normal(:, end, i) = 2.0_wp*dot_product(other, chord)*chord - other
        end associate
      end do
    end do
  end subroutine set_normals
end module epcont_geometry_corners
