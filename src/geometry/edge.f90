!> Integration along edges of elements, straight or with a mid-side node.
module epcont_geometry_edge
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: edge_point, edge_points

  !> Gauss points along an edge: exact for a linear pressure on any edge, straight or curved. On a curved edge
  !! of an axisymmetric element, the product of pressure, radius, shape function and tangent has the degree
  !! 1 + 2 + 2 + 1 = 6.
  integer, parameter, public :: edge_point_count = 4
  real(wp), parameter :: inner = sqrt((3.0_wp - 2.0_wp*sqrt(1.2_wp))/7.0_wp), &
                         outer = sqrt((3.0_wp + 2.0_wp*sqrt(1.2_wp))/7.0_wp), &
                         place(4) = [-outer, -inner, inner, outer], &
                         weight(4) = 0.5_wp + [-1, 1, 1, -1]*sqrt(30.0_wp)/36.0_wp

  type :: edge_point
    real(wp) :: values(3) = 0.0_wp   !! shape functions of start, end and mid-side node
    real(wp) :: x(2) = 0.0_wp        !! [length]
    !> Tangent, with the length of the part of the edge that belongs to the point [length]
    real(wp) :: tangent(2) = 0.0_wp
    real(wp) :: along = 0.0_wp       !! from 0 at the start to 1 at the end
  end type edge_point

contains

  !> Integration points of an edge with given start, end and, if it has one, mid-side node.
  pure function edge_points(x) result(point)
    real(wp), intent(in) :: x(:, :)   !! [length] [2, 2 or 3]
    type(edge_point) :: point(edge_point_count)
    real(wp) :: s
    integer :: p

    do p = 1, edge_point_count
      s = place(p)
      point(p)%values = [0.5_wp*(1.0_wp - s), 0.5_wp*(1.0_wp + s), 0.0_wp]
      ! Differences leave no rounding across an edge along an axis. Such rounding would be a load on an
      ! unconstrained mode.
      point(p)%tangent = 0.5_wp*(x(:, 2) - x(:, 1))
      if (size(x, 2) == 3) then
        point(p)%values = [0.5_wp*s*(s - 1.0_wp), 0.5_wp*s*(s + 1.0_wp), 1.0_wp - s*s]
        point(p)%tangent = point(p)%tangent + s*((x(:, 1) - x(:, 3)) + (x(:, 2) - x(:, 3)))
      end if
      point(p)%x = matmul(x, point(p)%values(:size(x, 2)))
      point(p)%tangent = weight(p)*point(p)%tangent
      point(p)%along = 0.5_wp*(1.0_wp + s)
    end do
  end function edge_points
end module epcont_geometry_edge
