!> Elements by their number of nodes: strains at the integration points, and the volume that belongs to each.
!>
!> A strain is xx, yy, zz, xy (engineering). In a ring x is the radius and zz the hoop: u_x/x. CQUAD4 has its volume
!> change averaged over the element (B-bar), so that it does not lock where the material cannot change its volume; in
!> plane stress, where the sheet gives way, there is no need.
module epcont_element_element
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: axisymmetric, plane_stress
  use epcont_element_quad4, only: quad4_point, quad4_slopes, quad4_values, quad4_weight
  use epcont_element_tria3, only: tria3_point, tria3_slopes, tria3_values, tria3_weight
  use epcont_element_tria6, only: tria6_point, tria6_slopes, tria6_values, tria6_weight
  implicit none
  private
  public :: element_point, point_count, evaluate_points, shape_values, local_points

  !> Nodes of an element, at most.
  integer, parameter, public :: most_nodes = 6
  !> Integration points of an element, at most.
  integer, parameter, public :: most_points = 4
  real(wp), parameter :: full_turn = 2.0_wp*acos(-1.0_wp)

  type :: element_point
    real(wp) :: b(4, 2*most_nodes)  !! strain = b u, u = (ux, uy) of each node in turn; set for its nodes [1/length]
    real(wp) :: volume              !! [length**3]
  end type element_point

contains

  !> Integration points of an element of so many nodes.
  pure integer function point_count(nodes)
    integer, intent(in) :: nodes

    select case (nodes)
    case (6)
      point_count = size(tria6_weight)
    case (4)
      point_count = size(quad4_weight)
    case default
      point_count = size(tria3_weight)
    end select
  end function point_count

  !> All integration points of an element.
  pure subroutine evaluate_points(x, kinematics, thickness, point)
    real(wp), intent(in) :: x(:, :)          !! of its nodes [length] [2, nodes]
    integer, intent(in) :: kinematics        !! plane_strain, plane_stress or axisymmetric
    real(wp), intent(in) :: thickness        !! of plane ones [length]
    type(element_point), intent(out) :: point(:)   !! [point_count(nodes)]
    real(wp) :: place(2, most_points), weight(most_points), jacobian(2, 2), determinant, radius, from_first(2, most_nodes)
    real(wp) :: slope(2, most_nodes), values(most_nodes)
    integer :: i, n, p

    n = size(x, 2)
    call local_points(n, place, weight)
    do i = 1, n
      from_first(:, i) = x(:, i) - x(:, 1)   ! far from the origin the sums below would lose the digits of the size
    end do
    do p = 1, point_count(n)
      slope(:, :n) = local_slopes(n, place(:, p))
      jacobian = matmul(slope(:, :n), transpose(from_first(:, :n)))   ! d x_j/d local_i
      determinant = jacobian(1, 1)*jacobian(2, 2) - jacobian(1, 2)*jacobian(2, 1)
      point(p)%volume = weight(p)*determinant*thickness
      point(p)%b(:, :2*n) = 0.0_wp
      do i = 1, n
        associate (dx => (jacobian(2, 2)*slope(1, i) - jacobian(1, 2)*slope(2, i))/determinant, &
                   dy => (jacobian(1, 1)*slope(2, i) - jacobian(2, 1)*slope(1, i))/determinant)
          point(p)%b(1, 2*i - 1) = dx
          point(p)%b(2, 2*i) = dy
          point(p)%b(4, 2*i - 1) = dy
          point(p)%b(4, 2*i) = dx
        end associate
      end do
      if (kinematics /= axisymmetric) cycle
      values(:n) = shape_values(n, place(:, p))
      radius = dot_product(values(:n), x(1, :))
      point(p)%b(3, 1:2*n - 1:2) = values(:n)/radius
      point(p)%volume = weight(p)*determinant*full_turn*radius
    end do
    if (n == 4 .and. kinematics /= plane_stress) call average_dilatation(point, 2*n)
  end subroutine evaluate_points

  !> B-bar: the volume change at each point is the mean over the element.
  pure subroutine average_dilatation(point, freedoms)
    type(element_point), intent(inout) :: point(:)
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

  !> Local places and weights of the integration points.
  pure subroutine local_points(nodes, place, weight)
    integer, intent(in) :: nodes
    real(wp), intent(out) :: place(:, :)   !! [2, most_points]
    real(wp), intent(out) :: weight(:)     !! [most_points]

    place = 0.0_wp
    weight = 0.0_wp
    select case (nodes)
    case (6)
      place(:, :3) = tria6_point
      weight(:3) = tria6_weight
    case (4)
      place = quad4_point
      weight = quad4_weight
    case default
      place(:, :1) = tria3_point
      weight(:1) = tria3_weight
    end select
  end subroutine local_points

  pure function local_slopes(nodes, place) result(slope)
    integer, intent(in) :: nodes
    real(wp), intent(in) :: place(2)
    real(wp) :: slope(2, nodes)

    select case (nodes)
    case (6)
      slope = tria6_slopes(place)
    case (4)
      slope = quad4_slopes(place)
    case default
      slope = tria3_slopes(place)
    end select
  end function local_slopes

  !> Shape functions at a local place.
  pure function shape_values(nodes, place) result(n)
    integer, intent(in) :: nodes
    real(wp), intent(in) :: place(2)
    real(wp) :: n(nodes)

    select case (nodes)
    case (6)
      n = tria6_values(place)
    case (4)
      n = quad4_values(place)
    case default
      n = tria3_values(place)
    end select
  end function shape_values
end module epcont_element_element
