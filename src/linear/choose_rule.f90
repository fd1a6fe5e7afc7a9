!> The contact solver that the plan has chosen.
module epcont_linear_choose_rule
  use epcont_linear_contact_rule, only: contact_rule
  use epcont_linear_joined_rule, only: joined_rule
  use epcont_linear_simplex_rule, only: simplex_rule
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_planned_model, only: planned_model
  implicit none
  private
  public :: choose_rule

contains

  !> Make the contact solver, with all that does not depend on the material law.
  subroutine choose_rule(scene, plan, rule)
    type(planned_model), intent(in) :: scene
    type(iteration_plan), intent(in) :: plan   !! may differ from that of the model
    class(contact_rule), allocatable, intent(out) :: rule

    if (plan%joined) allocate (joined_rule :: rule)
    if (.not. plan%joined) allocate (simplex_rule :: rule)
    rule%explains = .not. plan%joined
    rule%threads = plan%threads
    associate (contact => scene%model%contact)
      if (contact%has_friction()) then
        rule%problem%friction = contact%friction(contact%sliding)
        rule%problem%pair_of = contact%sliding
      end if
    end associate
    rule%problem%travel = scene%motions%travels(scene%model)
    rule%problem%body = scene%motions%body
    call rule%see_case(scene)
  end subroutine choose_rule
end module epcont_linear_choose_rule
