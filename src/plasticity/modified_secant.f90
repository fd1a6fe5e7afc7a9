!> METHOD MODSEC: SECANT, accelerated. The moduli come from a mixture of the last strains (Anderson), not from the last.
module epcont_plasticity_modified_secant
  use epcont_base_kinds, only: wp
  use epcont_material_curve, only: material_type
  use epcont_material_linear_law, only: linear_law
  use epcont_model_model, only: model_type
  use epcont_plasticity_mixing_method, only: mixing_method
  use epcont_plasticity_secant, only: set_secant_law
  implicit none
  private
  public :: modified_secant_method

  type, extends(mixing_method) :: modified_secant_method
  contains
    procedure :: linearise
  end type modified_secant_method

contains

  pure subroutine linearise(self, model, material, strain, law)
    class(modified_secant_method), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(material_type), intent(in) :: material(:)
    real(wp), intent(in) :: strain(:, :)
    type(linear_law), intent(inout) :: law

    call set_secant_law(model, material, strain, law)
  end subroutine linearise
end module epcont_plasticity_modified_secant
