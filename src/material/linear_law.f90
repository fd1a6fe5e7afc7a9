!> Stress as a linear function of strain, one for each element: what a stiffness matrix can be made of.
module epcont_material_linear_law
  use epcont_base_kinds, only: wp
  use epcont_material_curve, only: material_type
  use epcont_material_elasticity, only: isotropic_matrix
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: linear_law, elastic_law

  !> stress = matrix strain + initial_stress; components xx, yy, xy (engineering shear strain).
  type :: linear_law
    real(wp), allocatable :: matrix(:, :, :)        !! [stress] [3, 3, elements]
    real(wp), allocatable :: initial_stress(:, :)   !! [stress] [3, elements]
  contains
    procedure :: stress
  end type linear_law

contains

  !> The law of bodies that do not yield.
  pure function elastic_law(model, material) result(law)
    type(model_type), intent(in) :: model
    type(material_type), intent(in) :: material(:)   !! of each section
    type(linear_law) :: law
    integer :: e

    allocate (law%matrix(3, 3, model%elements))
    allocate (law%initial_stress(3, model%elements), source=0.0_wp)
    do e = 1, model%elements
      associate (m => material(model%section(e)))
        law%matrix(:, :, e) = isotropic_matrix(m%bulk, m%shear, m%plane_strain)
      end associate
    end do
  end function elastic_law

  !> Stress of each element [3, elements].
  pure function stress(self, strain)
    class(linear_law), intent(in) :: self
    real(wp), intent(in) :: strain(:, :)   !! [3, elements]
    real(wp), allocatable :: stress(:, :)
    integer :: e

    allocate (stress, mold=strain)
    do e = 1, size(strain, 2)
      stress(:, e) = matmul(self%matrix(:, :, e), strain(:, e)) + self%initial_stress(:, e)
    end do
  end function stress
end module epcont_material_linear_law
