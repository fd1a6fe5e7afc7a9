!> The precision of factors and flexibility.
module epcont_plan_precision_plan
  use epcont_model_controls, only: controls_type, precision_double, precision_open
  implicit none
  private
  public :: plan_precision

contains

  !> That of the deck, else double.
  pure integer function plan_precision(controls) result(precision)
    type(controls_type), intent(in) :: controls

    precision = controls%precision
    if (precision == precision_open) precision = precision_double
  end function plan_precision
end module epcont_plan_precision_plan
