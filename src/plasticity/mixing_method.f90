!> A method that goes on from a mixture of what it found last (Anderson's), not from the last alone.
module epcont_plasticity_mixing_method
  use epcont_base_kinds, only: wp
  use epcont_material_scene_materials, only: scene_materials
  use epcont_model_model, only: model_type
  use epcont_plasticity_anderson, only: anderson_mixer
  use epcont_plasticity_method, only: plastic_method
  use epcont_linear_scene_state, only: scene_state
  implicit none
  private
  public :: mixing_method

  type, abstract, extends(plastic_method) :: mixing_method
    type(anderson_mixer) :: mixer
  contains
    procedure :: restart
    procedure :: advance
  end type mixing_method

contains

  pure subroutine restart(self)
    class(mixing_method), intent(inout) :: self

    call self%mixer%forget()
  end subroutine restart

  pure subroutine advance(self, model, materials, part, found, about)
    class(mixing_method), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(scene_materials), intent(in) :: materials
    real(wp), intent(in) :: part
    type(scene_state), intent(in) :: found
    type(scene_state), intent(inout) :: about

    call self%mixer%mix(model, self%volume, found, about)
    about%point = materials%states(about%strain)
  end subroutine advance
end module epcont_plasticity_mixing_method
