!> The methods by their names in the deck.
module epcont_plasticity_methods
  use epcont_model_controls, only: method_inistr, method_modsec, method_newton
  use epcont_plasticity_initial_stress, only: initial_stress_method
  use epcont_plasticity_method, only: plastic_method
  use epcont_plasticity_modified_secant, only: modified_secant_method
  use epcont_plasticity_newton, only: newton_method
  use epcont_plasticity_secant, only: secant_method
  implicit none
  private
  public :: choose_method

contains

  ! A subroutine, since gfortran 12 loses the memory of a polymorphic function result.
  subroutine choose_method(kind, method)
    integer, intent(in) :: kind    !! method_secant, ...
    class(plastic_method), allocatable, intent(out) :: method

    select case (kind)
    case (method_modsec)
      allocate (modified_secant_method :: method)
      method%telling_steps = huge(1)   ! a mixture's last steps are not its slowest
    case (method_inistr)
      allocate (initial_stress_method :: method)
      method%keeps_stiffness = .true.
      method%telling_steps = huge(1)
    case (method_newton)
      allocate (newton_method :: method)
    case default
      allocate (secant_method :: method)
    end select
  end subroutine choose_method
end module epcont_plasticity_methods
