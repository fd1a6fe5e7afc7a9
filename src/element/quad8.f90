!> Eight-node quadrilateral, serendipity: corners in turn at (-1, -1), (1, -1), (1, 1), (-1, 1), then the
!> mid-side nodes after each.
module epcont_element_quad8
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: by_quadratics, element_kind, most_nodes, new_kind
  use epcont_element_kinematics, only: directions
  implicit none
  private
  public :: quad8

  real(wp), parameter :: &
    node(directions, 8) = &
      reshape([real(wp) :: -1, -1, 1, -1, 1, 1, -1, 1, 0, -1, 1, 0, 0, 1, -1, 0], [directions, 8]), &
    !> Gauss points and weights on a line. Three by three points integrate the stiffness. Two by two would
    !! leave a zero-energy mode, but strains are best there (Barlow 1976) and are sampled there.
    three(3) = [-sqrt(0.6_wp), 0.0_wp, sqrt(0.6_wp)], &
    part(3) = [5, 8, 5]/9.0_wp, &
    two(2) = [-1, 1]/sqrt(3.0_wp)

contains

  !> Create the type for the table.
  pure function quad8() result(kind)
    type(element_kind) :: kind
    real(wp) :: sample_of(9, 4)
    integer :: i, j

    kind = new_kind(node(:, :4), 8, shape, grid(three), &
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

  !> Find shape functions and their derivatives at a local point.
  pure subroutine shape(place, n, slope)
    real(wp), intent(in) :: place(directions)
    real(wp), intent(out) :: n(most_nodes), slope(directions, most_nodes)
    real(wp) :: across   !! local coordinate that is 0 at a mid-side node
    integer :: i

    n = 0.0_wp
    slope = 0.0_wp
    do i = 1, 8
      associate (a => node(1, i)*place(1), b => node(2, i)*place(2), in_middle => node(:, i) == 0.0_wp)
        if (i <= 4) then
          n(i) = 0.25_wp*(1.0_wp + a)*(1.0_wp + b)*(a + b - 1.0_wp)
          slope(:, i) = 0.25_wp*node(:, i)*[(1.0_wp + b)*(2.0_wp*a + b), (1.0_wp + a)*(2.0_wp*b + a)]
        else
          across = place(merge(1, 2, in_middle(1)))
          n(i) = 0.5_wp*(1.0_wp + a + b)*(1.0_wp - across**2)
          slope(:, i) = merge(-(1.0_wp + a + b)*across, 0.5_wp*node(:, i)*(1.0_wp - across**2), in_middle)
        end if
      end associate
    end do
  end subroutine shape
end module epcont_element_quad8
