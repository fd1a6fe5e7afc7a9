!> METHOD SECANT, the paper's: all load each time, moduli from the last strains, until nothing changes.
module epcont_plasticity_secant
  use epcont_base_kinds, only: wp
  use epcont_material_linear_law, only: linear_law
  use epcont_material_scene_materials, only: scene_materials
  use epcont_model_model, only: model_type
  use epcont_plasticity_method, only: plastic_method
  use epcont_linear_scene_state, only: scene_state
  implicit none
  private
  public :: secant_method, set_secant_law

  type, extends(plastic_method) :: secant_method
  contains
    procedure :: linearise
    procedure :: advance
  end type secant_method

contains

  pure subroutine linearise(self, materials, about, law)
    class(secant_method), intent(inout) :: self
    type(scene_materials), intent(in) :: materials
    type(scene_state), intent(in) :: about
    type(linear_law), intent(inout) :: law

    call set_secant_law(materials, about, law)
  end subroutine linearise

  !> Secant matrices (2-8).
  pure subroutine set_secant_law(materials, about, law)
    type(scene_materials), intent(in) :: materials
    type(scene_state), intent(in) :: about
    type(linear_law), intent(inout) :: law
    integer :: p

    do p = 1, size(about%point)
      associate (m => materials%section(materials%of_point(p))%law)
        if (m%yields) call law%set_matrix(p, m%secant_matrix(about%point(p)))
      end associate
    end do
  end subroutine set_secant_law

  !> What was found is taken as it is.
  pure subroutine advance(self, model, materials, part, found, about)
    class(secant_method), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(scene_materials), intent(in) :: materials
    real(wp), intent(in) :: part
    type(scene_state), intent(in) :: found
    type(scene_state), intent(inout) :: about

    about%displacement = found%displacement
    about%strain = found%strain
    about%point = found%point
  end subroutine advance
end module epcont_plasticity_secant
