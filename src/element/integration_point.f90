!> Strains of an element at its integration points, and the volumes of these points.
!>
!> A strain is xx, yy, zz, xy (engineering). In an axisymmetric element x is the radius and zz the hoop strain
!> u_x/x. Some types average the change of volume over the element (B-bar), so that they do not lock in nearly
!> incompressible materials. Plane stress does not need this, since the thickness can change.
module epcont_element_integration_point
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: element_kind, most_nodes
  use epcont_element_kinematics, only: axisymmetric, components, directions, plane_stress
  implicit none
  private
  public :: integration_point, evaluate_points

  real(wp), parameter :: full_turn = 2.0_wp*acos(-1.0_wp)

  type :: integration_point
    !> strain = b u with u = (ux, uy) of each node in turn; set for the nodes of the element [1/length]
    real(wp) :: b(components, directions*most_nodes)
    real(wp) :: volume              !! [length**3]
  end type integration_point

contains

  !> Evaluate all integration points of an element.
  pure subroutine evaluate_points(kind, x, kinematics, thickness, point)
    type(element_kind), intent(in) :: kind   !! of the element
    real(wp), intent(in) :: x(:, :)          !! of its nodes [length] [directions, nodes]
    integer, intent(in) :: kinematics        !! plane_strain, plane_stress or axisymmetric
    real(wp), intent(in) :: thickness        !! of plane elements [length]
    type(integration_point), intent(out) :: point(:)   !! [kind%points]
    real(wp) :: jacobian(directions, directions), determinant, radius, from_first(directions, most_nodes)
    integer :: i, n, p

    n = kind%nodes
    do i = 1, n
      from_first(:, i) = x(:, i) - x(:, 1)   ! far from the origin, sums of x would lose digits
    end do
    do p = 1, kind%points
      associate (slope => kind%slopes(:, :n, p), values => kind%values(:n, p), b => point(p)%b)
        jacobian = 0.0_wp   ! d x_j/d local_i
        do i = 1, n
          jacobian(:, 1) = jacobian(:, 1) + slope(:, i)*from_first(1, i)
          jacobian(:, 2) = jacobian(:, 2) + slope(:, i)*from_first(2, i)
        end do
        determinant = jacobian(1, 1)*jacobian(2, 2) - jacobian(1, 2)*jacobian(2, 1)
        point(p)%volume = kind%weight(p)*determinant*thickness
        b(:, :directions*n) = 0.0_wp
        do i = 1, n
          associate (dx => (jacobian(2, 2)*slope(1, i) - jacobian(1, 2)*slope(2, i))/determinant, &
                     dy => (jacobian(1, 1)*slope(2, i) - jacobian(2, 1)*slope(1, i))/determinant)
            b(1, 2*i - 1) = dx
            b(2, 2*i) = dy
            b(4, 2*i - 1) = dy
            b(4, 2*i) = dx
          end associate
        end do
        if (kinematics /= axisymmetric) cycle
        radius = dot_product(values, x(1, :))
        b(3, 1:2*n:2) = values/radius
        point(p)%volume = kind%weight(p)*determinant*full_turn*radius
      end associate
    end do
    if (kind%mean_dilatation .and. kinematics /= plane_stress) call average_dilatation(point, directions*n)
  end subroutine evaluate_points

  !> Replace the change of volume at each point by its mean over the element (B-bar).
  pure subroutine average_dilatation(point, freedoms)
    type(integration_point), intent(inout) :: point(:)
    integer, intent(in) :: freedoms
    real(wp) :: mean(freedoms), own(freedoms)
    integer :: i, p

    mean = 0.0_wp
    do p = 1, size(point)
      mean = mean + point(p)%volume*sum(point(p)%b(:3, :freedoms), dim=1)
    end do
    mean = mean/sum(point%volume)
    do p = 1, size(point)
      own = sum(point(p)%b(:3, :freedoms), dim=1)
      do i = 1, 3
        point(p)%b(i, :freedoms) = point(p)%b(i, :freedoms) + (mean - own)/3.0_wp
      end do
    end do
  end subroutine average_dilatation
end module epcont_element_integration_point
