!> From nodes to integration points and back: strains of displacements, nodal forces of stresses.
module epcont_assembly_fields
  use epcont_base_kinds, only: wp
  use epcont_element_element, only: element_point, evaluate_points, most_points
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: points_of_element, strains, volumes, nodal_forces

contains

  !> The integration points of an element of the model.
  pure subroutine points_of_element(model, e, point, count)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    type(element_point), intent(out) :: point(most_points)
    integer, intent(out) :: count

    associate (s => model%section(e))
      count = model%first_point(e + 1) - model%first_point(e)
      call evaluate_points(model%coordinates(e), model%kinematics(s), model%thickness(s), point(:count))
    end associate
  end subroutine points_of_element

  !> Strains xx, yy, zz, xy (engineering) [4, points].
  pure function strains(model, displacement) result(strain)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp), allocatable :: strain(:, :)
    type(element_point) :: point(most_points)
    integer :: count, e, i, k, n

    allocate (strain(4, model%points))
    do e = 1, model%elements
      call points_of_element(model, e, point, count)
      n = model%order(e)
      do k = 1, count
        strain(:, model%first_point(e) + k - 1) = 0.0_wp
        do i = 1, n
          associate (u => displacement(:, model%connectivity(i, e)), now => strain(:, model%first_point(e) + k - 1))
            now = now + point(k)%b(:, 2*i - 1)*u(1) + point(k)%b(:, 2*i)*u(2)
          end associate
        end do
      end do
    end do
  end function strains

  !> The volume that belongs to each point [length**3] [points].
  pure function volumes(model) result(volume)
    type(model_type), intent(in) :: model
    real(wp), allocatable :: volume(:)
    type(element_point) :: point(most_points)
    integer :: count, e

    allocate (volume(model%points))
    do e = 1, model%elements
      call points_of_element(model, e, point, count)
      volume(model%first_point(e):model%first_point(e + 1) - 1) = point(:count)%volume
    end do
  end function volumes

  !> Forces that nodes must exert on the elements to hold their stresses [force] [2, nodes].
  pure function nodal_forces(model, stress) result(force)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: stress(:, :)         !! xx, yy, zz, xy [stress] [4, points]
    real(wp), allocatable :: force(:, :)
    type(element_point) :: point(most_points)
    integer :: count, e, i, k, n

    allocate (force(2, model%nodes), source=0.0_wp)
    do e = 1, model%elements
      call points_of_element(model, e, point, count)
      n = model%order(e)
      do k = 1, count
        do i = 1, n
          associate (node => model%connectivity(i, e), s => stress(:, model%first_point(e) + k - 1))
            force(:, node) = force(:, node) + point(k)%volume*[dot_product(s, point(k)%b(:, 2*i - 1)), &
                                                               dot_product(s, point(k)%b(:, 2*i))]
          end associate
        end do
      end do
    end do
  end function nodal_forces
end module epcont_assembly_fields
