!> THE table of element types: a new type is one function of this file.
module epcont_element_element_kinds
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: by_quadratics, by_quadrilaterals, element_kind, new_kind
  use epcont_element_kinematics, only: directions
  implicit none
  private
  public :: element_kinds

  real(wp), parameter :: &
    !> Local coordinates of the corners of triangles and quadrilaterals, in turn.
    triangle(directions, 3) = reshape([real(wp) :: 0, 0, 1, 0, 0, 1], [directions, 3]), &
    square(directions, 4) = reshape([real(wp) :: -1, -1, 1, -1, 1, 1, -1, 1], [directions, 4]), &
    !> Gauss points on a line, and weights of three.
    two(2) = [-1, 1]/sqrt(3.0_wp), &
    three(3) = [-sqrt(0.6_wp), 0.0_wp, sqrt(0.6_wp)], &
    part(3) = [5, 8, 5]/9.0_wp

contains

  !> List all element types.
  pure function element_kinds() result(kind)
    type(element_kind), allocatable :: kind(:)

    kind = [tria3(), tria6(), quad4(), quad8()]
  end function element_kinds

  !> Three-node triangle, linear. Its point is exact for constant strain.
  pure function tria3() result(kind)
    type(element_kind) :: kind
    !> Strains are compared at the centres of the edges: exact for quadratic polynomials.
    real(wp), parameter :: middle(directions, 3) = reshape([1, 1, 0, 1, 1, 0]/2.0_wp, [directions, 3])

    kind = new_kind(triangle, [1, 0, 0, &
                               -1, 1, 0, &
                               -1, 0, 1]*1.0_wp, spread([1.0_wp, 1.0_wp]/3.0_wp, 2, 1), [0.5_wp])
    kind%plane_card = 'CTRIA3'
    kind%ring_card = 'CTRAX3'
    kind%vtk = 5
    kind%locks = .true.
    call kind%compare_at(middle, spread([1.0_wp], 2, 3), spread([1.0_wp/3.0_wp], 2, 3))
  end function tria3

  !> Six-node triangle, quadratic. Its points are exact for quadratic polynomials, that is, for the stiffness
  !! of a straight-sided element.
  pure function tria6() result(kind)
    type(element_kind) :: kind
    real(wp), parameter :: &
      point(directions, 3) = reshape([1, 1, 4, 1, 1, 4]/6.0_wp, [directions, 3]), &
      !> Points at which strains are compared, and their parts of the volume. At the integration points the
      !! error is least and would be underestimated; these points are exact for polynomials of degree four
      !! (Dunavant 1985).
      near = 0.091576213509771_wp, far = 0.445948490915965_wp, &
      place(directions, 6) = &
        reshape([near, near, 1 - 2*near, near, near, 1 - 2*near, &
                 far, far, 1 - 2*far, far, far, 1 - 2*far], [directions, 6]), &
      volume(6) = [spread(0.109951743655322_wp, 1, 3), spread(0.223381589678011_wp, 1, 3)]
    real(wp) :: from_points(3, 6)
    integer :: k

    kind = new_kind(triangle, [1, 0, 0, 0, 0, 0, &
                               -3, -1, 0, 4, 0, 0, &
                               -3, 0, -1, 0, 0, 4, &
                               4, 0, 0, -4, 4, -4, &
                               2, 2, 0, -4, 0, 0, &
                               2, 0, 2, 0, 0, -4]*1.0_wp, point, spread(1.0_wp/6.0_wp, 1, 3))
    kind%plane_card = 'CTRIA6'
    kind%ring_card = 'CTRAX6'
    kind%vtk = 22
    kind%estimated_as = by_quadratics
    do k = 1, size(volume)
      ! Linear between the points
      from_points(:, k) = 2.0_wp*[1.0_wp - sum(place(:, k)), place(:, k)] - 1.0_wp/3.0_wp
    end do
    call kind%compare_at(place, from_points, spread(volume, 1, 3))
  end function tria6

  !> Four-node quadrilateral, bilinear, with two by two Gauss points.
  pure function quad4() result(kind)
    type(element_kind) :: kind

    kind = new_kind(square, [1, 1, 1, 1, &
                             -1, 1, 1, -1, &
                             -1, -1, 1, 1, &
                             1, -1, 1, -1]/4.0_wp, square/sqrt(3.0_wp), spread(1.0_wp, 1, 4))
    kind%plane_card = 'CQUAD4'
    kind%vtk = 9
    kind%mean_dilatation = .true.
    kind%estimated_as = by_quadrilaterals
  end function quad4

  !> Eight-node quadrilateral, serendipity. Three by three Gauss points integrate the stiffness. Two by two
  !! would leave a zero-energy mode, but strains are best there (Barlow 1976) and are sampled there.
  pure function quad8() result(kind)
    type(element_kind) :: kind
    real(wp) :: sample_of(9, 4)
    integer :: i, j

    kind = new_kind(square, [-1, -1, -1, -1, 2, 2, 2, 2, &
                             0, 0, 0, 0, 0, 2, 0, -2, &
                             0, 0, 0, 0, -2, 0, 2, 0, &
                             1, -1, 1, -1, 0, 0, 0, 0, &
                             1, 1, 1, 1, -2, 0, -2, 0, &
                             1, 1, 1, 1, 0, -2, 0, -2, &
                             -1, -1, 1, 1, 2, 0, -2, 0, &
                             -1, 1, 1, -1, 0, -2, 0, 2]/4.0_wp, grid(three), &
                    reshape(spread(part, 1, 3)*spread(part, 2, 3), [9]))
    kind%plane_card = 'CQUAD8'
    kind%vtk = 23
    kind%estimated_as = by_quadratics
    do j = 1, 2
      do i = 1, 2
        sample_of(:, i + 2*j - 2) = reshape(spread(between(two(i)), 2, 3)*spread(between(two(j)), 1, 3), [9])
      end do
    end do
    call kind%sample_at(grid(two), sample_of)
  end function quad8

  !> List all points whose coordinates are among these, the first coordinate running first [directions,
  !! size**2].
  pure function grid(along) result(place)
    real(wp), intent(in) :: along(:)
    real(wp) :: place(directions, size(along)**2)

    place(1, :) = reshape(spread(along, 2, size(along)), [size(along)**2])
    place(2, :) = reshape(spread(along, 1, size(along)), [size(along)**2])
  end function grid

  !> Weights of the three Gauss points in a parabola through them, at another point of the line.
  pure function between(at) result(n)
    real(wp), intent(in) :: at
    real(wp) :: n(3)

    n = [0.5_wp*at*(at - three(3)), 0.6_wp - at**2, 0.5_wp*at*(at + three(3))]/0.6_wp
  end function between
end module epcont_element_element_kinds
