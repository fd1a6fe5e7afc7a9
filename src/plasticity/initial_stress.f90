!> METHOD INISTR: the stiffness stays elastic and is factored once; what the elastic stress is off the curve goes to
!> the right-hand side. Accelerated as MODSEC is.
module epcont_plasticity_initial_stress
  use epcont_base_kinds, only: wp
  use epcont_material_curve, only: material_type
  use epcont_material_linear_law, only: linear_law
  use epcont_material_total_theory, only: respond, response_type
  use epcont_model_model, only: model_type
  use epcont_plasticity_anderson, only: anderson_mixer
  use epcont_plasticity_method, only: plastic_method
  use epcont_plasticity_state, only: scene_state
  implicit none
  private
  public :: initial_stress_method

  type, extends(plastic_method) :: initial_stress_method
    type(anderson_mixer) :: mixer
  contains
    procedure :: restart
    procedure :: linearise
    procedure :: advance
  end type initial_stress_method

contains

  pure subroutine restart(self)
    class(initial_stress_method), intent(inout) :: self

    call self%mixer%forget()
  end subroutine restart

  !> Initial stress: that of the curve less the elastic one.
  pure subroutine linearise(self, model, material, strain, law)
    class(initial_stress_method), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(material_type), intent(in) :: material(:)
    real(wp), intent(in) :: strain(:, :)
    type(linear_law), intent(inout) :: law
    type(response_type) :: response
    integer :: e

    do e = 1, model%elements
      associate (m => material(model%section(e)))
        if (.not. m%yields) cycle
        response = respond(m, strain(:, e))
        law%initial_stress(:, e) = 0.0_wp
        if (response%curve%yielded) &
          law%initial_stress(:, e) = response%stress([1, 2, 4]) - matmul(law%matrix(:, :, e), strain(:, e))
      end associate
    end do
  end subroutine linearise

  pure subroutine advance(self, model, material, part, found, about)
    class(initial_stress_method), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(material_type), intent(in) :: material(:)
    real(wp), intent(in) :: part
    type(scene_state), intent(in) :: found
    type(scene_state), intent(inout) :: about

    call self%mixer%mix(model, found, about)
  end subroutine advance
end module epcont_plasticity_initial_stress
