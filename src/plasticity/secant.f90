!> METHOD SECANT, the paper's: all load each time, moduli from the last strains, until nothing changes.
module epcont_plasticity_secant
  use epcont_base_kinds, only: wp
  use epcont_material_curve, only: material_type
  use epcont_material_linear_law, only: linear_law
  use epcont_material_total_theory, only: respond, secant_matrix
  use epcont_model_model, only: model_type
  use epcont_plasticity_method, only: plastic_method
  use epcont_plasticity_scene_state, only: scene_state
  implicit none
  private
  public :: secant_method, set_secant_law

  type, extends(plastic_method) :: secant_method
  contains
    procedure :: linearise
    procedure :: advance
  end type secant_method

contains

  pure subroutine linearise(self, model, material, strain, law)
    class(secant_method), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(material_type), intent(in) :: material(:)
    real(wp), intent(in) :: strain(:, :)
    type(linear_law), intent(inout) :: law

    call set_secant_law(model, material, strain, law)
  end subroutine linearise

  !> Secant matrices (2-8).
  pure subroutine set_secant_law(model, material, strain, law)
    type(model_type), intent(in) :: model
    type(material_type), intent(in) :: material(:)
    real(wp), intent(in) :: strain(:, :)
    type(linear_law), intent(inout) :: law
    integer :: p

    do p = 1, model%points
      associate (m => material(model%section(model%point_element(p))))
        if (m%yields) law%matrix(:, :, law%matrix_of(p)) = secant_matrix(m, respond(m, strain(:, p)))
      end associate
    end do
  end subroutine set_secant_law

  !> What was found is taken as it is.
  pure subroutine advance(self, model, material, part, found, about)
    class(secant_method), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(material_type), intent(in) :: material(:)
    real(wp), intent(in) :: part
    type(scene_state), intent(in) :: found
    type(scene_state), intent(inout) :: about

    about%displacement = found%displacement
    about%strain = found%strain
  end subroutine advance
end module epcont_plasticity_secant
