!> Strains of an element from its displacements, without the element layer: what a displacement is between the nodes is
!> written down here afresh, and derived by differences, which are exact for the polynomials met.
module epcont_certificate_gradient
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: axisymmetric, model_type, plane_stress
  implicit none
  private
  public :: strains_of

  !> Integration places of an element, at most.
  integer, parameter, public :: most_places = 4

  !> Half the step of the differences: exact for quadratics whatever its size.
  real(wp), parameter :: half_step = 0.5_wp

contains

  !> Integration places of an element of so many nodes, in barycentric coordinates (3 and 6 nodes) or from -1 to 1
  !! (4), and their parts of the reference area.
  pure subroutine places_of(nodes, places, place, weight)
    integer, intent(in) :: nodes
    integer, intent(out) :: places
    real(wp), intent(out) :: place(2, most_places)
    real(wp), intent(out) :: weight(most_places)
    real(wp), parameter :: third = 1.0_wp/3.0_wp, sixth = third/2.0_wp, gauss = 0.57735026918962576_wp

    select case (nodes)
    case (3)
      places = 1
      place(:, 1) = third
      weight(1) = 0.5_wp
    case (6)
      places = 3
      place(:, :3) = reshape([sixth, sixth, 1.0_wp - third, sixth, sixth, 1.0_wp - third], [2, 3])
      weight(:3) = sixth
    case default
      places = 4
      place = reshape([-gauss, -gauss, gauss, -gauss, gauss, gauss, -gauss, gauss], [2, 4])
      weight = 1.0_wp
    end select
  end subroutine places_of

  !> Strains xx, yy, zz, xy (engineering) at the integration places of an element, and the volumes that belong to them.
  pure subroutine strains_of(model, element, u, places, strain, volume)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element
    real(wp), intent(in) :: u(:, :)                          !! displacements of its nodes [length] [2, order]
    integer, intent(out) :: places
    real(wp), intent(out) :: strain(4, most_places), volume(most_places)   !! of its places [-, length**3]
    real(wp) :: place(2, most_places), weight(most_places)
    real(wp) :: x(2, model%order(element)), moved(2, model%order(element))
    real(wp) :: side(2, 2), gradient(2, 2), change(2, 2), at(2), determinant, dilatation
    integer :: p

    x = model%coordinates(element)
    moved = u - spread(u(:, 1), 2, size(u, 2))   ! a shift does not spoil the differences
    call places_of(model%order(element), places, place, weight)
    associate (s => model%section(element))
      do p = 1, places
        side = difference(x, place(:, p))
        change = difference(moved, place(:, p))
        determinant = side(1, 1)*side(2, 2) - side(1, 2)*side(2, 1)
        gradient(:, 1) = (change(:, 1)*side(2, 2) - change(:, 2)*side(2, 1))/determinant
        gradient(:, 2) = (change(:, 2)*side(1, 1) - change(:, 1)*side(1, 2))/determinant
        strain(:, p) = [gradient(1, 1), gradient(2, 2), 0.0_wp, gradient(1, 2) + gradient(2, 1)]
        volume(p) = weight(p)*determinant*model%thickness(s)
        if (model%kinematics(s) /= axisymmetric) cycle
        at = between(x, place(:, p))
        strain(3, p) = (u(1, 1) + dot_product([1.0_wp, 0.0_wp], between(moved, place(:, p))))/at(1)
        volume(p) = weight(p)*determinant*2.0_wp*acos(-1.0_wp)*at(1)
      end do
      if (model%order(element) /= 4 .or. model%kinematics(s) == plane_stress) return
    end associate
    ! CQUAD4 has the mean change of volume everywhere.
    dilatation = sum(sum(strain(:3, :places), dim=1)*volume(:places))/sum(volume(:places))
    do p = 1, places
      strain(:3, p) = strain(:3, p) + (dilatation - sum(strain(:3, p)))/3.0_wp
    end do
  end subroutine strains_of

  !> Derivatives of what is between the nodes by the two local coordinates [2, 2].
  pure function difference(values, place) result(slope)
    real(wp), intent(in) :: values(:, :), place(2)
    real(wp) :: slope(2, 2)
    real(wp) :: step(2)
    integer :: c

    do c = 1, 2
      step = 0.0_wp
      step(c) = half_step
      slope(:, c) = (between(values, place + step) - between(values, place - step))/(2.0_wp*half_step)
    end do
  end function difference

  !> What nodal values are at a local place: linear, quadratic or bilinear between the nodes.
  pure function between(values, place) result(value)
    real(wp), intent(in) :: values(:, :)   !! [2, nodes]
    real(wp), intent(in) :: place(2)
    real(wp) :: value(2)

    associate (a => place(1), b => place(2), c => 1.0_wp - place(1) - place(2))
      select case (size(values, 2))
      case (3)
        value = values(:, 1) + a*(values(:, 2) - values(:, 1)) + b*(values(:, 3) - values(:, 1))
      case (6)
        value = c*(2*c - 1)*values(:, 1) + a*(2*a - 1)*values(:, 2) + b*(2*b - 1)*values(:, 3) &
                + 4*(c*a*values(:, 4) + a*b*values(:, 5) + b*c*values(:, 6))
      case default
        value = ((1 - a)*((1 - b)*values(:, 1) + (1 + b)*values(:, 4)) &
                 + (1 + a)*((1 - b)*values(:, 2) + (1 + b)*values(:, 3)))/4
      end select
    end associate
  end function between
end module epcont_certificate_gradient
