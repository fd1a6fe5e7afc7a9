!> Three-node triangle, linear: corners in turn at (0, 0), (1, 0), (0, 1).
module epcont_element_tria3
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: element_kind, most_nodes, new_kind
  use epcont_element_kinematics, only: directions
  implicit none
  private
  public :: tria3

  !> Integration point and weight: exact for constant strain.
  real(wp), parameter :: point(directions, 1) = 1.0_wp/3.0_wp, weight(1) = 0.5_wp
  !> Strains are compared at the centres of the edges: exact for quadratic polynomials.
  real(wp), parameter :: middle(directions, 3) = &
    reshape([1, 1, 0, 1, 1, 0]/2.0_wp, [directions, 3])

contains

  !> Create the type for the table.
  pure function tria3() result(kind)
    type(element_kind) :: kind

    kind = new_kind(reshape([real(wp) :: 0, 0, 1, 0, 0, 1], [directions, 3]), 3, shape, point, weight)
    kind%plane_card = 'CTRIA3'
    kind%ring_card = 'CTRAX3'
    kind%vtk = 5
    kind%locks = .true.
    call kind%compare_at(middle, spread([1.0_wp], 2, 3), spread([1.0_wp/3.0_wp], 2, 3))
  end function tria3

  !> Find shape functions and their derivatives at a local point.
  pure subroutine shape(place, n, slope)
    real(wp), intent(in) :: place(directions)
    real(wp), intent(out) :: n(most_nodes), slope(directions, most_nodes)

    n = 0.0_wp
    slope = 0.0_wp
    n(:3) = [1.0_wp - place(1) - place(2), place]
    slope(:, :3) = reshape([real(wp) :: -1, -1, 1, 0, 0, 1], [directions, 3])
  end subroutine shape
end module epcont_element_tria3
