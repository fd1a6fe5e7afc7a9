!> Boundaries defined by points, without elements.
module outlines
  use epcont_base_kinds, only: wp
  use epcont_geometry_boundary_line, only: boundary_line, facing_type
  use epcont_geometry_corners, only: find_normals
  use epcont_geometry_facing, only: find_facing, looking_point
  implicit none
  private
  public :: drawn, chain, degree, find_nearest

  real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp

contains

  !> Edges through points, straight unless they have mid-side nodes, listed with the body to the left.
  function drawn(x, closed, angle, held, middle) result(line)
    real(wp), intent(in) :: x(:, :)                 !! [2, points]
    logical, intent(in), optional :: closed         !! the last point is followed by the first
    real(wp), intent(in), optional :: angle         !! of PARAM CORNER [degree]
    integer, intent(in), optional :: held(:, :)     !! directions in which ends of edges are fixed [2, sides]
    real(wp), intent(in), optional :: middle(:, :)  !! of curved edges [2, sides]
    type(boundary_line) :: line
    real(wp) :: corner
    logical :: ring
    integer, allocatable :: none(:, :)
    integer :: i, n, points

    ring = .false.
    if (present(closed)) ring = closed
    corner = 0.0_wp
    if (present(angle)) corner = angle
    points = size(x, 2)
    n = merge(points, points - 1, ring)
    allocate (line%segment(3, n), none(2, n), source=0)
    allocate (line%x(2, 3, n), source=0.0_wp)
    allocate (line%neighbour(2, n))
    line%element = [(i, i=1, n)]
    do i = 1, n
      line%segment(:2, i) = [i, mod(i, points) + 1]
      line%x(:, :2, i) = x(:, line%segment(:2, i))
      line%neighbour(:, i) = [i - 1, mod(i + 1, n + 1)]
    end do
    if (present(middle)) then
      line%segment(3, :) = 100 + line%element
      line%x(:, 3, :) = middle
    end if
    if (ring) then
      line%neighbour(1, 1) = n
      line%neighbour(2, n) = 1
    end if
    if (present(held)) then
      call find_normals(line, held, corner)
    else
      call find_normals(line, none, corner)
    end if
  end function drawn

  !> Points of a boundary with some angles, counter-clockwise, between edges of some lengths; the first edge points left.
  pure function chain(turn, length) result(x)
    real(wp), intent(in) :: turn(:)      !! [degree]
    real(wp), intent(in) :: length(:)    !! one more than angles
    real(wp) :: x(2, size(length) + 1)
    real(wp) :: along
    integer :: i

    x(:, 1) = 0.0_wp
    along = 180.0_wp*degree
    do i = 1, size(length)
      x(:, i + 1) = x(:, i) + length(i)*[cos(along), sin(along)]
      if (i <= size(turn)) along = along + turn(i)*degree
    end do
  end function chain

  !> The nearest edge that a point projects onto.
  pure type(facing_type) function find_nearest(line, obstacles, from, search) result(nearest)
    type(boundary_line), intent(in) :: line, obstacles
    type(looking_point), intent(in) :: from
    real(wp), intent(in) :: search   !! [length]
    type(facing_type) :: face(2)

    face = find_facing(line, obstacles, from, search)
    nearest = face(1)
  end function find_nearest
end module outlines
