!> Strains of an element from its displacements, without the element layer: what a displacement is between the nodes is
!> written down here afresh, and derived by differences, which are exact for the polynomials met.
module epcont_certificate_unit_strains
  use epcont_base_kinds, only: wp
  use epcont_element_element, only: most_nodes
  use epcont_element_kinematics, only: axisymmetric, plane_stress
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: kind_type, kind_of, unit_strains

  !> Integration places of an element, at most.
  integer, parameter, public :: most_places = 4

  !> Half the step of the differences, which is one: exact for quadratics whatever its size.
  real(wp), parameter :: half_step = 0.5_wp

  !> What is the same in all elements of so many nodes.
  type :: kind_type
    integer :: places = 0                                           !! integration places
    real(wp) :: weight(most_places) = 0.0_wp                        !! their parts of the reference area
    real(wp) :: share(most_nodes, most_places) = 0.0_wp             !! of each node in what is there
    real(wp) :: change(2, most_nodes, most_places) = 0.0_wp         !! its derivatives by the two local coordinates
  end type kind_type

contains

  pure type(kind_type) function kind_of(nodes) result(kind)
    integer, intent(in) :: nodes
    real(wp) :: place(2, most_places)
    integer :: p

    call places_of(nodes, kind%places, place, kind%weight)
    do p = 1, kind%places
      kind%share(:, p) = shares(nodes, place(:, p))
      kind%change(:, :, p) = differences(nodes, place(:, p))
    end do
  end function kind_of

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

  !> Strains xx, yy, zz, xy (engineering) that a unit displacement of each freedom gives at the integration places of an
  !! element, and the volumes that belong to them.
  pure subroutine unit_strains(model, element, kind, strain, volume)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element
    type(kind_type), intent(in) :: kind
    real(wp), intent(out) :: strain(4, 2, most_nodes, most_places)   !! [-, directions, nodes, places] [1/length]
    real(wp), intent(out) :: volume(most_places)                     !! [length**3]
    real(wp) :: x(2, most_nodes), side(2, 2), away(2), gradient(2), determinant, radius
    integer :: k, n, p

    n = model%order(element)
    do k = 1, n
      x(:, k) = model%x(:, model%connectivity(k, element))
    end do
    associate (s => model%section(element), change => kind%change, at => kind%share)
      do p = 1, kind%places
        ! d x/d local, one column each; from the first node, so that a place far from the origin takes no digits.
        side = 0.0_wp
        do k = 2, n
          away = x(:, k) - x(:, 1)
          side(:, 1) = side(:, 1) + away*change(1, k, p)
          side(:, 2) = side(:, 2) + away*change(2, k, p)
        end do
        determinant = side(1, 1)*side(2, 2) - side(1, 2)*side(2, 1)
        volume(p) = kind%weight(p)*determinant*model%thickness(s)
        strain(:, :, :n, p) = 0.0_wp
        do k = 1, n
          gradient(1) = (change(1, k, p)*side(2, 2) - change(2, k, p)*side(2, 1))/determinant
          gradient(2) = (change(2, k, p)*side(1, 1) - change(1, k, p)*side(1, 2))/determinant
          strain(1, 1, k, p) = gradient(1)
          strain(2, 2, k, p) = gradient(2)
          strain(4, :, k, p) = gradient([2, 1])
        end do
        if (model%kinematics(s) /= axisymmetric) cycle
        radius = dot_product(at(:n, p), x(1, :n))
        strain(3, 1, :n, p) = at(:n, p)/radius
        volume(p) = kind%weight(p)*determinant*2.0_wp*acos(-1.0_wp)*radius
      end do
      if (n == 4 .and. model%kinematics(s) /= plane_stress) call average_dilatation(strain, volume)
    end associate
  end subroutine unit_strains

  !> CQUAD4 has the mean change of volume everywhere.
  pure subroutine average_dilatation(strain, volume)
    real(wp), intent(inout) :: strain(4, 2, most_nodes, most_places)
    real(wp), intent(in) :: volume(most_places)
    real(wp) :: dilatation
    integer :: c, k, p

    do k = 1, 4
      do c = 1, 2
        dilatation = dot_product(sum(strain(:3, c, k, :), dim=1), volume)/sum(volume)
        do p = 1, most_places
          strain(:3, c, k, p) = strain(:3, c, k, p) + (dilatation - sum(strain(:3, c, k, p)))/3.0_wp
        end do
      end do
    end do
  end subroutine average_dilatation

  !> Derivatives of the nodes' shares by the two local coordinates [2, most_nodes].
  pure function differences(nodes, place) result(slope)
    integer, intent(in) :: nodes
    real(wp), intent(in) :: place(2)
    real(wp) :: slope(2, most_nodes)

    slope(1, :) = shares(nodes, place + [half_step, 0.0_wp]) - shares(nodes, place - [half_step, 0.0_wp])
    slope(2, :) = shares(nodes, place + [0.0_wp, half_step]) - shares(nodes, place - [0.0_wp, half_step])
  end function differences

  !> The nodes' shares in what is at a local place: linear, quadratic or bilinear between the nodes.
  pure function shares(nodes, place) result(share)
    integer, intent(in) :: nodes
    real(wp), intent(in) :: place(2)
    real(wp) :: share(most_nodes)

    share = 0.0_wp
    associate (a => place(1), b => place(2), c => 1.0_wp - place(1) - place(2))
      select case (nodes)
      case (3)
        share(:3) = [c, a, b]
      case (6)
        share = [c*(2*c - 1), a*(2*a - 1), b*(2*b - 1), 4*c*a, 4*a*b, 4*b*c]
      case default
        share(:4) = [(1 - a)*(1 - b), (1 + a)*(1 - b), (1 + a)*(1 + b), (1 - a)*(1 + b)]/4
      end select
    end associate
  end function shares
end module epcont_certificate_unit_strains
