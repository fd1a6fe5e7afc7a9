!> Choice of the plastic iteration of a model and of the contact solver in each of its solves.
module epcont_plan_iteration_plan
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: controls_type, method_auto, method_newton, method_secant, rule_auto
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: iteration_plan, plan_iteration

  !> Default TOL of NEWTON, which needs one or two more steps for it, and of the other methods, whose number
  !! of iterations grows with each digit.
  real(wp), parameter :: newton_tolerance = 1.0e-8_wp, secant_tolerance = 0.01_wp

  !> TOL divided by PARAM ACCURACY. Iteration errors of contact pressures are at most 0.3 TOL with NEWTON, and
  !! 50 TOL with the others (measured on seven models with yielded contact, TOL from 0.1 to 1.E-4). So they
  !! are below a tenth of the accuracy.
  real(wp), parameter :: newton_part = 1.0_wp/10, secant_part = 1.0_wp/500

  !> Largest stress error divided by TOL, for all methods except NEWTON. These stop by displacements, as in
  !! the paper. If a prescribed displacement or a slender body dominates the displacements, the stresses may
  !! still be wrong.
  real(wp), parameter :: looseness = 10.0_wp

  type :: iteration_plan
    logical :: yields = .false.            !! a material can yield; otherwise no iteration is needed
    logical :: follows = .false.           !! the loads are followed in steps: yielding, or friction
    integer :: load_steps = 1              !! more than one only if the loads are followed
    integer :: method = method_secant
    logical :: chosen_here = .false.       !! epcont chooses the method, not the deck
    !> Largest change, and largest estimated error, of a displacement with which the iteration ends
    real(wp) :: tolerance = 0.0_wp
    logical :: keeps = .false.             !! factors are kept for another load case
    integer :: threads = 1                 !! threads that work on bodies in parallel
    logical :: joined = .false.            !! contact solver JOINED, otherwise CONRY
    logical :: rule_chosen_here = .false.  !! epcont chooses the contact solver, not the deck
    logical :: from_first_pivot = .false.  !! contact solves start from no active set, not from the last
    real(wp) :: off_curve = 0.0_wp         !! largest stress error with which the iteration ends
  contains
    procedure :: set_tolerances
  end type iteration_plan

contains

  !> Choose the methods.
  pure function plan_iteration(model, joined) result(plan)
    type(model_type), intent(in) :: model
    logical, intent(in) :: joined           !! all bodies form one system
    type(iteration_plan) :: plan
    integer :: e

    associate (asked => model%controls)
      plan%rule_chosen_here = asked%rule == rule_auto
      plan%joined = joined
      plan%from_first_pivot = asked%original
      plan%yields = any([(model%can_yield(e), e=1, model%mesh%elements)])
      plan%follows = plan%yields .or. model%contact%has_friction()
      if (plan%follows) plan%load_steps = asked%load_steps
      plan%chosen_here = asked%method == method_auto
      plan%method = asked%method
      ! NEWTON has no tangent for MUP PAPER. That option follows the paper, so the paper's method is used.
      if (plan%chosen_here) plan%method = merge(method_secant, method_newton, asked%paper_ratio)
    end associate
    call plan%set_tolerances(model%controls)
  end function plan_iteration

  !> Set the tolerances of a load case.
  pure subroutine set_tolerances(self, asked)
    class(iteration_plan), intent(inout) :: self
    type(controls_type), intent(in) :: asked   !! of the load case
    logical :: tight

    ! Errors of an increment are carried on to the next ones.
    tight = self%method == method_newton .or. asked%by_increments
    if (asked%tolerance /= 0.0_wp) then
      self%tolerance = asked%tolerance
    else if (asked%accuracy > 0.0_wp .and. .not. asked%by_increments) then
      self%tolerance = asked%accuracy*merge(newton_part, secant_part, tight)
    else
      self%tolerance = merge(newton_tolerance, secant_tolerance, tight)
    end if
    if (self%yields) self%off_curve = self%tolerance*merge(1.0_wp, looseness, tight)
  end subroutine set_tolerances
end module epcont_plan_iteration_plan
