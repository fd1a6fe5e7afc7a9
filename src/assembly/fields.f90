!> From nodes to elements and back: strains of displacements, nodal forces of stresses.
module epcont_assembly_fields
  use epcont_base_kinds, only: wp
  use epcont_element_tria3, only: tria3_strain_matrix
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: element_strains, element_volumes, nodal_forces

contains

  !> Strains xx, yy, xy (engineering) of all elements [3, elements].
  pure function element_strains(model, displacement) result(strain)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp), allocatable :: strain(:, :)
    integer :: e

    allocate (strain(3, model%elements))
    do e = 1, model%elements
      strain(:, e) = matmul(tria3_strain_matrix(model%corners(e)), reshape(displacement(:, model%corner(:, e)), [6]))
    end do
  end function element_strains

  !> Area times thickness of all elements [length**3] [elements].
  pure function element_volumes(model) result(volume)
    type(model_type), intent(in) :: model
    real(wp), allocatable :: volume(:)
    integer :: e

    allocate (volume(model%elements))
    do e = 1, model%elements
      volume(e) = model%thickness(model%section(e))*model%area(e)
    end do
  end function element_volumes

  !> Forces that nodes must exert on the elements to hold their stresses [force] [2, nodes].
  pure function nodal_forces(model, stress) result(force)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: stress(:, :)         !! xx, yy, xy [stress] [3, elements]
    real(wp), allocatable :: force(:, :)
    real(wp), allocatable :: volume(:)
    real(wp) :: part(2, 3)
    integer :: e, k

    volume = element_volumes(model)
    allocate (force(2, model%nodes), source=0.0_wp)
    do e = 1, model%elements
      part = reshape(volume(e)*matmul(stress(:, e), tria3_strain_matrix(model%corners(e))), [2, 3])
      do k = 1, 3
        force(:, model%corner(k, e)) = force(:, model%corner(k, e)) + part(:, k)
      end do
    end do
  end function nodal_forces
end module epcont_assembly_fields
