!> Six-node triangle, quadratic: corners in turn at (0, 0), (1, 0), (0, 1), then the mid-side nodes after
!> each.
module epcont_element_tria6
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: by_quadratics, element_kind, most_nodes, new_kind
  use epcont_element_kinematics, only: directions
  implicit none
  private
  public :: tria6

  real(wp), parameter :: &
    !> Integration points and weights: exact for quadratic polynomials, that is, for the stiffness of a
    !! straight-sided element.
    point(directions, 3) = reshape([1, 1, 4, 1, 1, 4]/6.0_wp, [directions, 3]), &
    weight(3) = 1.0_wp/6.0_wp, &
    !> Points at which strains are compared, and their parts of the volume. At the integration points the
    !! error is least and would be underestimated; these points are exact for polynomials of degree four
    !! (Dunavant 1985).
    near = 0.091576213509771_wp, far = 0.445948490915965_wp, &
    place(directions, 6) = &
      reshape([near, near, 1 - 2*near, near, near, 1 - 2*near, &
               far, far, 1 - 2*far, far, far, 1 - 2*far], [directions, 6]), &
    part(6) = [spread(0.109951743655322_wp, 1, 3), spread(0.223381589678011_wp, 1, 3)]

contains

  !> Create the type for the table.
  pure function tria6() result(kind)
    type(element_kind) :: kind
    real(wp) :: from_points(3, 6)
    integer :: k

    kind = new_kind(reshape([real(wp) :: 0, 0, 1, 0, 0, 1], [directions, 3]), 6, shape, point, weight)
    kind%plane_card = 'CTRIA6'
    kind%ring_card = 'CTRAX6'
    kind%vtk = 22
    kind%estimated_as = by_quadratics
    do k = 1, size(part)
      ! Linear between the points
      from_points(:, k) = 2.0_wp*[1.0_wp - sum(place(:, k)), place(:, k)] - 1.0_wp/3.0_wp
    end do
    call kind%compare_at(place, from_points, spread(part, 1, 3))
  end function tria6

  !> Find shape functions and their derivatives at a local point.
  pure subroutine shape(place, n, slope)
    real(wp), intent(in) :: place(directions)
    real(wp), intent(out) :: n(most_nodes), slope(directions, most_nodes)
    integer, parameter :: next(3) = [2, 3, 1]
    real(wp), parameter :: l_slope(directions, 3) = &
      reshape([real(wp) :: -1, -1, 1, 0, 0, 1], [directions, 3])
    real(wp) :: l(3)
    integer :: i

    n = 0.0_wp
    slope = 0.0_wp
    l = [1.0_wp - place(1) - place(2), place]
    n(:6) = [l*(2.0_wp*l - 1.0_wp), 4.0_wp*l*cshift(l, 1)]
    do i = 1, 3
      slope(:, i) = (4.0_wp*l(i) - 1.0_wp)*l_slope(:, i)
      slope(:, 3 + i) = 4.0_wp*(l(next(i))*l_slope(:, i) + l(i)*l_slope(:, next(i)))
    end do
  end subroutine shape
end module epcont_element_tria6
