!> METHOD INISTR: the stiffness stays elastic and is factored once; the difference of the elastic stress from
!> the curve goes to the right-hand side. Accelerated like MODSEC.
module epcont_plasticity_initial_stress
  use epcont_base_kinds, only: wp
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_solved_state, only: solved_state
  use epcont_plasticity_secant, only: secant_method
  implicit none
  private
  public :: initial_stress_method

  type, extends(secant_method) :: initial_stress_method
  contains
    procedure :: linearise
  end type initial_stress_method

contains

  !> Find the initial stress: stress on the curve minus elastic stress.
  pure subroutine linearise(self, p, about, linear)
    class(initial_stress_method), intent(inout) :: self
    integer, intent(in) :: p                         !! number of the point
    type(solved_state), intent(in) :: about           !! with strains and points
    type(linear_problem), intent(inout) :: linear    !! its law is set

    associate (law => linear%law, state => about%point(p))
      law%initial_stress(:, p) = 0.0_wp
      if (state%plastic) law%initial_stress(:, p) = &
        state%stress - matmul(law%matrix(:, :, law%matrix_of(p)), about%strain(:, p))
    end associate
  end subroutine linearise
end module epcont_plasticity_initial_stress
