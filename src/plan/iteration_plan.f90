!> Which plastic iteration this scene gets, which rule finds the pairs in contact in each of its solves, the
!> precision of factors and flexibility, and why.
module epcont_plan_iteration_plan
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: controls_type, method_auto, method_newton, method_secant, &
    precision_double, precision_mixed, precision_open, precision_single, rule_auto, rule_block, &
    rule_conry
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: iteration_plan, plan_iteration, plan_precision

  !> TOL of NEWTON, which gets there in a step or two more, and of the methods that pay for every digit.
  real(wp), parameter :: newton_tolerance = 1.0e-8_wp, secant_tolerance = 0.01_wp
  !> TOL of NEWTON with factors in single precision, which leave 1e-6 to 1e-4.
  real(wp), parameter :: single_tolerance = 1.0e-3_wp

  !> TOL as a part of PARAM ACCURACY. Stopping leaves an error of contact pressures of at most 0.3 TOL by
  !! NEWTON and 50 TOL by the others (seven scenes of contact beyond yield, TOL from 0.1 to 1.E-4): less than
  !! a tenth of the accuracy, thus.
  real(wp), parameter :: newton_part = 1.0_wp/10, secant_part = 1.0_wp/500

  !> The methods but NEWTON stop by displacements, as the paper does. Where a travel or a slender body
  !! hides the strains in them, stresses may still be far off: they may be by no more than this times TOL.
  real(wp), parameter :: looseness = 10.0_wp

  !> PARAM ACCURACY from which on single precision, which leaves 1e-6 to 4e-3, need not be refined: scenes
  !! take 0.6 to 1.0 of the time of double then, and few have to be solved anew.
  real(wp), parameter, public :: loose_accuracy = 0.05_wp
  !> Error of displacements, strains and contact forces, relative, that an answer of single precision may
  !! have: this, and no more than that part of PARAM ACCURACY.
  real(wp), parameter :: largest_error = 0.01_wp, part_of_accuracy = 0.1_wp

  !> Pairs from which on AUTO is BLOCK, which is level with CONRY there and faster from 200 on (`tools/bench
  !! --part 2`). Below, both take less than a fifth of a millisecond, and each pivot of CONRY is an event of
  !! the growing load that the listing can show.
  integer, parameter, public :: many_pairs = 100

  type :: iteration_plan
    logical :: yields = .false.            !! there is something that can yield; else there is no iteration
    integer :: load_steps = 1              !! more than one only where something can yield
    integer :: method = method_secant
    logical :: chosen_here = .false.       !! the deck leaves the method to us
    !> Largest change, and largest estimated error, of a displacement that ends the iteration.
    real(wp) :: tolerance = 0.0_wp
    integer :: precision = precision_double  !! of the factors
    !> Largest that single precision may leave in displacements, strains and forces.
    real(wp) :: rounding_error = 0.0_wp
    !> What stands against solving anew in double; not allocated: nothing.
    character(len=:), allocatable :: against_double
    integer :: threads = 1                 !! that bodies may be worked on by, side by side
    logical :: by_blocks = .false.         !! contact by RULE BLOCK, else CONRY
    logical :: joined = .false.            !! or by RULE JOINED: then neither
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
      plan%by_blocks = asked%rule == rule_block .or. &   ! joined bodies that are taken apart, as AUTO has it
                       (asked%rule /= rule_conry .and. model%pairs >= many_pairs)
      plan%joined = joined
      plan%from_first_pivot = asked%original
      plan%yields = any([(model%can_yield(e), e=1, model%elements)])
      plan%precision = plan_precision(asked, plan%yields)
      if (joined) plan%precision = precision_double
      plan%rounding_error = largest_error
      if (asked%accuracy > 0.0_wp) plan%rounding_error = min(largest_error, part_of_accuracy*asked%accuracy)
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
      else if (.not. by_newton) then
        plan%tolerance = secant_tolerance
      else
        plan%tolerance = merge(single_tolerance, newton_tolerance, plan%precision == precision_single)
      end if
      if (plan%yields) plan%off_curve = plan%tolerance*merge(1.0_wp, looseness, by_newton)
    end associate
  end function plan_iteration

  !> That of the deck, else that of the accuracy it wants, else double. Refinement pays where bodies are
  !! factored once (0.8 of the time of double with 42 000 nodes, level with 11 000); where each iteration
  !! factors them, it takes 1.3 to 1.6 times as long.
  pure integer function plan_precision(controls, yields) result(precision)
    type(controls_type), intent(in) :: controls   !! what the deck asks for
    logical, intent(in) :: yields    !! something can yield

    precision = controls%precision
    if (precision /= precision_open) return
    precision = precision_double
    if (controls%accuracy >= loose_accuracy) then
      precision = precision_single
    else if (controls%accuracy > 0.0_wp .and. .not. yields) then
      precision = precision_mixed
    end if
  end function plan_precision
end module epcont_plan_iteration_plan
