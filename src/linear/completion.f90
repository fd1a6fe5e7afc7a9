!> What follows from the deformation, the strains and the contact that a solve has found.
module epcont_linear_completion
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_effect
  use epcont_contact_problem, only: contact_problem
  use epcont_flexibility_flexibility, only: gap_opening
  use epcont_material_linear_law, only: linear_law
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_linear_scene_state, only: scene_state
  implicit none
  private
  public :: complete_state

contains

  !> Stresses, displacements and gaps of a state.
  pure subroutine complete_state(scene, law, problem, part, state)
    type(planned_scene), intent(in) :: scene
    type(linear_law), intent(in) :: law
    type(contact_problem), intent(in) :: problem
    real(wp), intent(in) :: part   !! of what supports prescribe
    type(scene_state), intent(inout) :: state

    state%point_stress = law%stress(state%strain)
    state%displacement = state%deformation + part*scene%model%travel
    call add_motions(scene%model, scene%motions, state)
    call measure_gaps(scene%model, problem, part, state)
  end subroutine complete_state

  !> Gaps of the pairs without force as the displacements have them. Where a rigid stop takes the load, what
  !! the flexibility says of the others is rounding of two deformations that cancel: a pair that seemed to
  !! touch may be open.
  pure subroutine measure_gaps(model, problem, part, state)
    type(model_type), intent(in) :: model
    type(contact_problem), intent(in) :: problem
    real(wp), intent(in) :: part
    type(scene_state), intent(inout) :: state
    real(wp), allocatable :: opening(:), travel(:)   !! of the gaps by the deformation, by what supports travel [length] [pairs]
    real(wp) :: gap, terms   !! what the gap is the sum of, added up
    integer :: i, k

    opening = gap_opening(model, state%deformation)
    travel = part*gap_opening(model, model%travel)
    associate (contact => state%contact, g0 => problem%initial_gap, motion => problem%motion)
      do k = 1, model%pairs
        if (contact%force(k) > 0.0_wp) cycle
        gap = g0(k) + (opening(k) + travel(k)) - dot_product(motion(k, :), contact%approach)
        terms = abs(g0(k)) + abs(travel(k)) + sum(abs(motion(k, :)*contact%approach))
        do i = model%row_start(k), model%row_start(k + 1) - 1
          terms = terms + abs(model%row_weight(i))*maxval(abs(state%deformation(:, model%row_node(i))))
        end do
        if (contact%touching(k) .and. gap <= no_effect*terms) cycle
        contact%touching(k) = .false.
        contact%gap(k) = max(gap, 0.0_wp)
      end do
    end associate
  end subroutine measure_gaps

  !> Add the rigid motions to the displacements.
  pure subroutine add_motions(model, motions, state)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(scene_state), intent(inout) :: state
    integer :: k, node

    do k = 1, motions%count
      do node = 1, model%nodes
        state%displacement(:, node) = state%displacement(:, node) &
                                      + state%contact%approach(k)*motions%displacement(model, node, k)
      end do
    end do
  end subroutine add_motions
end module epcont_linear_completion
