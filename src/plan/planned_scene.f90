!> What every room behind the plan reads and none changes.
module epcont_plan_planned_scene
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_numbering, only: numbering_type
  implicit none
  private
  public :: planned_scene

  type :: planned_scene
    type(model_type) :: model
    type(free_motions) :: motions          !! of its bodies
    type(numbering_type) :: numbering      !! of its equations
  end type planned_scene
end module epcont_plan_planned_scene
