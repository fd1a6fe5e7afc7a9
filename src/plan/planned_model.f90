!> Model and plan of its solution. Later folders read both; none changes them.
module epcont_plan_planned_model
  use epcont_model_finding, only: findings
  use epcont_model_model, only: model_type
  use epcont_plan_forecast, only: forecast, forecast_type
  use epcont_plan_free_motion, only: find_free_motions, free_motions
  use epcont_plan_iteration_plan, only: iteration_plan, plan_iteration
  use epcont_plan_joining, only: can_join, joins
  use epcont_plan_numbering, only: number_equations, numbering_type
  use epcont_system_stopwatch, only: stage_numbering, stage_plan, stopwatch
  implicit none
  private
  public :: planned_model

  type :: planned_model
    type(model_type) :: model
    type(free_motions) :: motions          !! rigid-body modes of its bodies
    type(numbering_type) :: numbering      !! of its equations
    type(iteration_plan) :: iteration      !! methods for contact and yielding
    type(forecast_type) :: expected        !! memory and work
    logical :: other_rule = .false.        !! the preferred contact solver has failed: use the other one
    integer :: plan_cases = 1              !! load cases that share the plan
  contains
    procedure :: find_motions
    procedure :: make_plan
    procedure :: has_other_rule
  end type planned_model

contains

  !> Find the rigid-body modes of all bodies.
  subroutine find_motions(self, found)
    class(planned_model), intent(inout) :: self
    type(findings), intent(inout) :: found   !! errors are added

    call find_free_motions(self%model, self%motions, found)
  end subroutine find_motions

  !> Plan the solution of the model, whose rigid-body modes are known.
  subroutine make_plan(self, watch)
    class(planned_model), intent(inout) :: self
    class(stopwatch), intent(inout) :: watch   !! takes the time

    self%iteration = plan_iteration(self%model, can_join(self%model) .and. &
                                                (joins(self%model) .neqv. self%other_rule))
    self%numbering = number_equations(self%model, self%iteration%joined)
    call watch%lap(stage_numbering)
    self%expected = forecast(self%model, self%motions, self%numbering, self%iteration, self%plan_cases)
    call watch%lap(stage_plan)
  end subroutine make_plan

  !> Can the plan's contact solver be replaced by the other one?
  logical function has_other_rule(self)
    class(planned_model), intent(in) :: self

    has_other_rule = self%iteration%joined .or. can_join(self%model)
  end function has_other_rule
end module epcont_plan_planned_model
