!> Which plastic iteration this scene gets, which rule finds the pairs in contact in each of its solves, and
!> why.
module epcont_plan_iteration_plan
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: method_auto, method_newton, method_secant, rule_auto
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: iteration_plan, plan_iteration

  !> TOL of NEWTON, which gets there in a step or two more, and of the methods that pay for every digit.
  real(wp), parameter :: newton_tolerance = 1.0e-8_wp, secant_tolerance = 0.01_wp

  !> TOL as a part of PARAM ACCURACY. Stopping leaves an error of contact pressures of at most 0.3 TOL by
  !! NEWTON and 50 TOL by the others (seven scenes of contact beyond yield, TOL from 0.1 to 1.E-4): less than
  !! a tenth of the accuracy, thus.
  real(wp), parameter :: newton_part = 1.0_wp/10, secant_part = 1.0_wp/500

  !> The methods but NEWTON stop by displacements, as the paper does. Where a travel or a slender body
  !! hides the strains in them, stresses may still be far off: they may be by no more than this times TOL.
  real(wp), parameter :: looseness = 10.0_wp

  type :: iteration_plan
    logical :: yields = .false.            !! there is something that can yield; else there is no iteration
    integer :: load_steps = 1              !! more than one only where something can yield
    integer :: method = method_secant
    logical :: chosen_here = .false.       !! the deck leaves the method to us
    !> Largest change, and largest estimated error, of a displacement that ends the iteration.
    real(wp) :: tolerance = 0.0_wp
    integer :: threads = 1                 !! that bodies may be worked on by, side by side
    logical :: joined = .false.            !! contact by RULE JOINED, else CONRY
    logical :: rule_chosen_here = .false.  !! the deck leaves that to us
    logical :: from_first_pivot = .false.  !! each contact problem, not from the last set of contacts
    real(wp) :: off_curve = 0.0_wp         !! largest distance of a stress from its curve that does, with it
  end type iteration_plan

contains

  !> What this scene gets.
  pure function plan_iteration(model, joined) result(plan)
    type(model_type), intent(in) :: model   !! the scene
    logical, intent(in) :: joined           !! its bodies are one system
    type(iteration_plan) :: plan
    logical :: by_newton
    integer :: e

    associate (asked => model%controls)
      plan%rule_chosen_here = asked%rule == rule_auto
      plan%joined = joined
      plan%from_first_pivot = asked%original
      plan%yields = any([(model%can_yield(e), e=1, model%elements)])
      if (plan%yields) plan%load_steps = asked%load_steps
      plan%chosen_here = asked%method == method_auto
      plan%method = asked%method
      ! NEWTON has no tangent for MUP PAPER, which is there to follow the paper: by its own method, then.
      if (plan%chosen_here) plan%method = merge(method_secant, method_newton, asked%paper_ratio)
      by_newton = plan%method == method_newton
      if (asked%tolerance /= 0.0_wp) then
        plan%tolerance = asked%tolerance
      else if (asked%accuracy > 0.0_wp) then
        plan%tolerance = asked%accuracy*merge(newton_part, secant_part, by_newton)
      else
        plan%tolerance = merge(newton_tolerance, secant_tolerance, by_newton)
      end if
      if (plan%yields) plan%off_curve = plan%tolerance*merge(1.0_wp, looseness, by_newton)
    end associate
  end function plan_iteration
end module epcont_plan_iteration_plan
