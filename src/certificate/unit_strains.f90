!> Strains of an element from its displacements. From the table of elements only shape functions and
!> integration points are used; derivatives are differences, which are exact for these polynomials.
module epcont_certificate_unit_strains
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: element_kind, most_nodes, most_points
  use epcont_element_kinematics, only: axisymmetric, components, directions, plane_stress
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_slopes, largest_face, slopes_at, strain_by, unit_strains

  !> Half the step of the differences: exact for quadratic polynomials whatever its size.
  real(wp), parameter :: half_step = 0.5_wp

contains

  !> Derivatives of the shape functions at each integration point of an element type.
  pure subroutine find_slopes(kind, slope)
    type(element_kind), intent(in) :: kind                       !! element type
    real(wp), intent(out) :: slope(directions, most_nodes, most_points)   !! [local directions, nodes, points]
    integer :: p

    do p = 1, kind%points
      slope(:, :, p) = slopes_at(kind, kind%point(:, p))
    end do
  end subroutine find_slopes

  !> Derivatives of the shape functions at a point, by differences.
  pure function slopes_at(kind, point) result(slope)
    type(element_kind), intent(in) :: kind        !! element type
    real(wp), intent(in) :: point(directions)     !! local coordinates
    real(wp) :: slope(directions, most_nodes)     !! [local directions, nodes]
    real(wp) :: after(most_nodes), before(most_nodes), step(directions), unused(directions, most_nodes)
    integer :: c

    do c = 1, directions
      step = 0.0_wp
      step(c) = half_step
      call kind%shape(point + step, after, unused)
      call kind%shape(point - step, before, unused)
      slope(c, :) = after - before
    end do
  end function slopes_at

  !> Find the strains xx, yy, zz, xy (engineering) at the integration points of an element by a unit
  !! displacement of each DOF, and the volumes of these points.
  pure subroutine unit_strains(model, element, slope, strain, volume)
    type(model_type), intent(in) :: model        !! model
    integer, intent(in) :: element               !! number of the element
    real(wp), intent(in) :: slope(directions, most_nodes, most_points)   !! of its type, from `find_slopes`
    !> [1/length] [components, directions, nodes, points]
    real(wp), intent(out) :: strain(components, directions, most_nodes, most_points)
    real(wp), intent(out) :: volume(most_points)                     !! [length**3]
    real(wp) :: x(directions, most_nodes), side(directions, directions), gradient(directions)
    real(wp) :: determinant, radius
    integer :: k, n, p

    n = model%mesh%node_count(element)
    do k = 1, n
      x(:, k) = model%mesh%x(:, model%mesh%connectivity(k, element))
    end do
    associate (s => model%mesh%section(element), kind => model%mesh%kinds(model%mesh%kind(element)))
      do p = 1, kind%points
        ! d x/d local, one column each; relative to the first node, so that a distance from the origin takes
        ! no digits.
        side = 0.0_wp
        do k = 2, n
          side(:, 1) = side(:, 1) + (x(:, k) - x(:, 1))*slope(1, k, p)
          side(:, 2) = side(:, 2) + (x(:, k) - x(:, 1))*slope(2, k, p)
        end do
        determinant = side(1, 1)*side(2, 2) - side(1, 2)*side(2, 1)
        volume(p) = kind%weight(p)*determinant*model%sections%thickness(s)
        strain(:, :, :n, p) = 0.0_wp
        do k = 1, n
          gradient(1) = (slope(1, k, p)*side(2, 2) - slope(2, k, p)*side(2, 1))/determinant
          gradient(2) = (slope(2, k, p)*side(1, 1) - slope(1, k, p)*side(1, 2))/determinant
          strain(1, 1, k, p) = gradient(1)
          strain(2, 2, k, p) = gradient(2)
          strain(4, 1, k, p) = gradient(2)
          strain(4, 2, k, p) = gradient(1)
        end do
        if (model%sections%kinematics(s) /= axisymmetric) cycle
        radius = dot_product(kind%values(:n, p), x(1, :n))
        strain(3, 1, :n, p) = kind%values(:n, p)/radius
        volume(p) = kind%weight(p)*determinant*2.0_wp*acos(-1.0_wp)*radius
      end do
      if (kind%mean_dilatation .and. model%sections%kinematics(s) /= plane_stress) &
        call average_dilatation(strain(:, :, :n, :kind%points), volume(:kind%points))
    end associate
  end subroutine unit_strains

  !> Use the mean change of volume at all points, for element types that would lock.
  pure subroutine average_dilatation(strain, volume)
    real(wp), intent(inout) :: strain(:, :, :, :)
    real(wp), intent(in) :: volume(:)
    real(wp) :: dilatation
    integer :: c, k, p

    do k = 1, size(strain, 3)
      do c = 1, directions
        dilatation = dot_product(sum(strain(:3, c, k, :), dim=1), volume)/sum(volume)
        do p = 1, size(volume)
          strain(:3, c, k, p) = strain(:3, c, k, p) + (dilatation - sum(strain(:3, c, k, p)))/3.0_wp
        end do
      end do
    end do
  end subroutine average_dilatation

  !> Find the largest product of an element's diameter and depth [length**2].
  pure real(wp) function largest_face(model) result(face)
    type(model_type), intent(in) :: model   !! the model
    real(wp), dimension(directions) :: least, most
    integer :: e, k

    face = 0.0_wp
    do e = 1, model%mesh%elements
      least = model%mesh%x(:, model%mesh%connectivity(1, e))
      most = least
      do k = 2, model%mesh%node_count(e)
        least = min(least, model%mesh%x(:, model%mesh%connectivity(k, e)))
        most = max(most, model%mesh%x(:, model%mesh%connectivity(k, e)))
      end do
      face = max(face, maxval(most - least)*model%depth(e, most(1)))
    end do
  end function largest_face

  !> Find the strain at one point of an element. A translation (along y, and in plane models along x) is
  !! subtracted first, so that it leaves no rounding error.
  pure function strain_by(nodes, displacement, unit, ring) result(strain)
    integer, intent(in) :: nodes
    real(wp), intent(in) :: displacement(directions, nodes)         !! of its nodes
    real(wp), intent(in) :: unit(components, directions, nodes)     !! by a unit displacement of each
    logical, intent(in) :: ring
    real(wp) :: strain(components), apart(directions)
    integer :: k

    strain = 0.0_wp
    do k = 1, nodes
      apart = displacement(:, k) - displacement(:, 1)
      if (ring) apart(1) = displacement(1, k)
      strain = strain + apart(1)*unit(:, 1, k) + apart(2)*unit(:, 2, k)
    end do
  end function strain_by
end module epcont_certificate_unit_strains
