!> METHOD INISTR: the stiffness stays elastic and is factored once; what the elastic stress is off the curve
!> goes to the right-hand side. Accelerated as MODSEC is.
module epcont_plasticity_initial_stress
  use epcont_base_kinds, only: wp
  use epcont_material_linear_law, only: linear_law
  use epcont_material_scene_materials, only: scene_materials
  use epcont_plasticity_mixing_method, only: mixing_method
  use epcont_linear_scene_state, only: scene_state
  implicit none
  private
  public :: initial_stress_method

  type, extends(mixing_method) :: initial_stress_method
  contains
    procedure :: linearise
  end type initial_stress_method

contains

  !> Initial stress: that of the curve less the elastic one.
  pure subroutine linearise(self, materials, about, law)
    class(initial_stress_method), intent(inout) :: self
    type(scene_materials), intent(in) :: materials
    type(scene_state), intent(in) :: about
    type(linear_law), intent(inout) :: law
    integer :: p

    do p = 1, size(about%point)
      if (.not. materials%section(materials%of_point(p))%law%yields) cycle
      law%initial_stress(:, p) = 0.0_wp
      if (about%point(p)%yielded) law%initial_stress(:, p) = &
        about%point(p)%stress - matmul(law%matrix(:, :, law%matrix_of(p)), about%strain(:, p))
    end do
  end subroutine linearise
end module epcont_plasticity_initial_stress
