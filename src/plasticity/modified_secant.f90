!> METHOD MODSEC: SECANT, accelerated. The moduli come from a mixture of the last strains (Anderson), not from
!> the last.
module epcont_plasticity_modified_secant
  use epcont_base_kinds, only: wp
  use epcont_material_linear_law, only: linear_law
  use epcont_material_scene_materials, only: scene_materials
  use epcont_plasticity_mixing_method, only: mixing_method
  use epcont_linear_scene_state, only: scene_state
  use epcont_plasticity_secant, only: set_secant_law
  implicit none
  private
  public :: modified_secant_method

  type, extends(mixing_method) :: modified_secant_method
  contains
    procedure :: linearise
  end type modified_secant_method

contains

  pure subroutine linearise(self, materials, about, law)
    class(modified_secant_method), intent(inout) :: self
    type(scene_materials), intent(in) :: materials
    type(scene_state), intent(in) :: about
    type(linear_law), intent(inout) :: law

    call set_secant_law(materials, about, law)
  end subroutine linearise
end module epcont_plasticity_modified_secant
