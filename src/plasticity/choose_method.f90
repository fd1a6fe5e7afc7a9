!> Choice of the iteration method.
module epcont_plasticity_choose_method
  use epcont_model_controls, only: method_inistr, method_modsec, method_newton
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plasticity_initial_stress, only: initial_stress_method
  use epcont_plasticity_newton, only: newton_method
  use epcont_plasticity_secant, only: secant_method
  implicit none
  private
  public :: choose_method, mixes

contains

  !> Create the method, without data, as at the start of each load.
  subroutine choose_method(plan, method)
    type(iteration_plan), intent(in) :: plan
    class(secant_method), allocatable, intent(out) :: method

    select case (plan%method)
    case (method_newton)
      allocate (newton_method :: method)
    case (method_inistr)
      allocate (initial_stress_method :: method)
    case default
      allocate (secant_method :: method)
    end select
    if (mixes(plan)) allocate (method%mixer)
  end subroutine choose_method

  !> Does the method combine its last states?
  pure logical function mixes(plan)
    type(iteration_plan), intent(in) :: plan

    mixes = any(plan%method == [method_modsec, method_inistr])
  end function mixes
end module epcont_plasticity_choose_method
