!> Four-node quadrilateral, bilinear: corners in turn at (-1, -1), (1, -1), (1, 1), (-1, 1).
module epcont_element_quad4
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: by_quadrilaterals, element_kind, most_nodes, new_kind
  use epcont_element_kinematics, only: directions
  implicit none
  private
  public :: quad4

  real(wp), parameter :: corner(directions, 4) = &
    reshape([real(wp) :: -1, -1, 1, -1, 1, 1, -1, 1], [directions, 4])
  !> Gauss points and weights, two by two.
  real(wp), parameter :: point(directions, 4) = corner/sqrt(3.0_wp), weight(4) = 1.0_wp

contains

  !> Create the type for the table.
  pure function quad4() result(kind)
    type(element_kind) :: kind

    kind = new_kind(corner, 4, shape, point, weight)
    kind%plane_card = 'CQUAD4'
    kind%vtk = 9
    kind%mean_dilatation = .true.
    kind%estimated_as = by_quadrilaterals
  end function quad4

  !> Find shape functions and their derivatives at a local point.
  pure subroutine shape(place, n, slope)
    real(wp), intent(in) :: place(directions)
    real(wp), intent(out) :: n(most_nodes), slope(directions, most_nodes)

    n = 0.0_wp
    slope = 0.0_wp
    associate (a => 1.0_wp + place(1)*corner(1, :), b => 1.0_wp + place(2)*corner(2, :))
      n(:4) = 0.25_wp*a*b
      slope(1, :4) = 0.25_wp*corner(1, :)*b
      slope(2, :4) = 0.25_wp*corner(2, :)*a
    end associate
  end subroutine shape
end module epcont_element_quad4
