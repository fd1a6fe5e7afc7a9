!> METHOD INISTR: the stiffness stays elastic and is factored once; what the elastic stress is off the curve goes to
!> the right-hand side. Accelerated as MODSEC is.
module epcont_plasticity_initial_stress
  use epcont_base_kinds, only: wp
  use epcont_material_curve, only: material_type
  use epcont_material_linear_law, only: linear_law
  use epcont_material_total_theory, only: respond, response_type
  use epcont_model_model, only: model_type
  use epcont_plasticity_mixing_method, only: mixing_method
  implicit none
  private
  public :: initial_stress_method

  type, extends(mixing_method) :: initial_stress_method
  contains
    procedure :: linearise
  end type initial_stress_method

contains

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
end module epcont_plasticity_initial_stress
