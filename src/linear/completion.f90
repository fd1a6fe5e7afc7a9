!> What follows from the deformation, the strains and the contact that a solve has found.
module epcont_linear_completion
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_effect
  use epcont_contact_problem, only: contact_problem
  use epcont_flexibility_flexibility, only: gap_opening
  use epcont_material_linear_law, only: linear_law
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_linear_scene_state, only: scene_state
  implicit none
  private
  public :: complete_state

contains

  !> Stresses, displacements and gaps of a state.
  pure subroutine complete_state(scene, law, problem, part, state)
    type(planned_scene), intent(in) :: scene         !! what was solved
    type(linear_law), intent(in) :: law              !! by this law
    type(contact_problem), intent(in) :: problem     !! its initial gaps and motions
    real(wp), intent(in) :: part                     !! of what supports prescribe
    type(scene_state), intent(inout) :: state        !! with deformation, strain and contact
    real(wp), allocatable :: opening(:), travel(:)   ! of gaps by deformation, by what supports travel [length]
    real(wp), allocatable :: moved(:)                ! closing of a gap by each free motion [length]
    real(wp) :: gap, terms                           ! what the gap is the sum of, added up
    integer :: i, k, node

    state%point_stress = law%stress(state%strain)
    state%displacement = state%deformation + part*scene%model%travel
    do k = 1, scene%motions%count
      do node = 1, scene%model%nodes
        state%displacement(:, node) = state%displacement(:, node) &
          + state%contact%approach(k)*scene%motions%displacement(scene%model, node, k)
      end do
    end do
    opening = gap_opening(scene%model, state%deformation)
    travel = part*gap_opening(scene%model, scene%model%travel)
    associate (contact => state%contact, model => scene%model)
      do k = 1, model%pairs
        if (contact%force(k) > 0.0_wp) cycle
        ! Where a rigid stop takes the load, what the flexibility says of this gap is rounding of two deformations
        ! that cancel: a pair that seemed to touch may be open, as the displacements have it.
        moved = problem%motion(k, :)*contact%approach
        gap = problem%initial_gap(k) + (opening(k) + travel(k)) - sum(moved)
        terms = abs(problem%initial_gap(k)) + abs(travel(k)) + sum(abs(moved))
        do i = model%row_start(k), model%row_start(k + 1) - 1
          terms = terms + abs(model%row_weight(i))*maxval(abs(state%deformation(:, model%row_node(i))))
        end do
        if (contact%touching(k) .and. gap <= no_effect*terms) cycle
        contact%touching(k) = .false.
        contact%gap(k) = max(gap, 0.0_wp)
      end do
    end associate
  end subroutine complete_state
end module epcont_linear_completion
