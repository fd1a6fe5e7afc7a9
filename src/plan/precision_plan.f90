!> The precision of factors and flexibility, and what it may leave.
module epcont_plan_precision_plan
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: controls_type, precision_double, precision_mixed, precision_open, precision_single
  implicit none
  private
  public :: plan_precision, largest_rounding_error

  !> PARAM ACCURACY from which on single precision, which leaves 1e-6 to 4e-3, need not be refined: scenes take 0.6 to 1.0
  !! of the time of double then, and few have to be solved anew.
  real(wp), parameter, public :: loose_accuracy = 0.05_wp
  !> Error of displacements, strains and contact forces, relative, that an answer of single precision may have: this, and no
  !! more than that part of PARAM ACCURACY.
  real(wp), parameter :: largest_error = 0.01_wp, part_of_accuracy = 0.1_wp

contains

  !> That of the deck, else that of the accuracy it wants, else double. Refinement pays where bodies are factored once (0.8 of
  !! the time of double with 42 000 nodes, level with 11 000); where each iteration factors them, it takes 1.3 to 1.6 times as long.
  pure integer function plan_precision(controls, yields) result(precision)
    type(controls_type), intent(in) :: controls
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

  !> What single precision may leave.
  pure real(wp) function largest_rounding_error(controls) result(largest)
    type(controls_type), intent(in) :: controls

    largest = largest_error
    if (controls%accuracy > 0.0_wp) largest = min(largest, part_of_accuracy*controls%accuracy)
  end function largest_rounding_error
end module epcont_plan_precision_plan
