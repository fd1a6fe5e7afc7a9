!> Which rule finds the pairs in contact, and why.
module epcont_plan_contact_plan
  use epcont_model_controls, only: rule_auto, rule_block
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: contact_plan, plan_contact

  !> Pairs from which on AUTO is BLOCK, which is level with CONRY there and faster from 200 on (`tools/bench --part 2`). Below,
  !! both take less than a fifth of a millisecond, and each pivot of CONRY is an event of the growing load that the listing
  !! can show.
  integer, parameter, public :: many_pairs = 100

  type :: contact_plan
    logical :: by_blocks = .false.      !! RULE BLOCK, else CONRY
    logical :: chosen_here = .false.    !! the deck leaves the rule to us
  end type contact_plan

contains

  pure function plan_contact(model) result(plan)
    type(model_type), intent(in) :: model
    type(contact_plan) :: plan

    plan%chosen_here = model%controls%rule == rule_auto
    plan%by_blocks = model%controls%rule == rule_block .or. (plan%chosen_here .and. model%pairs >= many_pairs)
  end function plan_contact
end module epcont_plan_contact_plan
