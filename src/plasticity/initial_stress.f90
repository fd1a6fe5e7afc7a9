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
    integer :: p

    do p = 1, model%points
      associate (m => material(model%section(model%point_element(p))))
        if (.not. m%yields) cycle
        response = respond(m, strain(:, p))
        law%initial_stress(:, p) = 0.0_wp
        if (response%curve%yielded) &
          law%initial_stress(:, p) = response%stress - matmul(law%matrix(:, :, law%matrix_of(p)), strain(:, p))
      end associate
    end do
  end subroutine linearise
end module epcont_plasticity_initial_stress
