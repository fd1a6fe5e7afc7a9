!> Stresses of the elements and reactions of the supports.
module epcont_result_stresses
  use epcont_assembly_fields, only: nodal_forces
  use epcont_base_kinds, only: wp
  use epcont_material_curve, only: material_type, section_materials
  use epcont_material_elasticity, only: equivalent_stress
  use epcont_material_total_theory, only: respond, response_type
  use epcont_model_model, only: model_type
  use epcont_plasticity_state, only: scene_state
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: recover_stresses

contains

  !> Fill in stresses, strains, moduli and reactions. `applied` are the nodal forces of loads and pairs [2, nodes].
  pure subroutine recover_stresses(model, state, applied, answer)
    type(model_type), intent(in) :: model
    type(scene_state), intent(in) :: state
    real(wp), intent(in) :: applied(:, :)
    type(answer_type), intent(inout) :: answer
    type(material_type), allocatable :: material(:)
    type(response_type) :: response
    real(wp) :: across
    integer :: e

    material = section_materials(model)
    allocate (answer%stress(4, model%elements), answer%equivalent_stress(model%elements))
    allocate (answer%equivalent_strain(model%elements), answer%secant_modulus(model%elements))
    allocate (answer%plastic(model%elements), answer%beyond(model%elements))
    do e = 1, model%elements
      associate (m => material(model%section(e)), strain => state%strain(:, e), stress => state%stress(:, e))
        ! The mean stress is elastic whatever the iteration has left open.
        across = 0.0_wp
        if (m%plane_strain) across = 3.0_wp*m%bulk*(strain(1) + strain(2)) - stress(1) - stress(2)
        answer%stress(:, e) = [stress(1), stress(2), across, stress(3)]
        answer%equivalent_stress(e) = equivalent_stress(answer%stress(:, e))
        response = respond(m, strain)
        answer%equivalent_strain(e) = response%curve%total
        answer%secant_modulus(e) = m%young
        if (response%curve%yielded) answer%secant_modulus(e) = 1.0_wp/(1.0_wp/response%curve%modulus + m%shift)
        answer%plastic(e) = response%curve%yielded
        answer%beyond(e) = response%curve%beyond
      end associate
    end do
    answer%reaction = reactions(model, state, applied)
  end subroutine recover_stresses

  !> What the supports must hold [force] [2, nodes].
  pure function reactions(model, state, applied) result(reaction)
    type(model_type), intent(in) :: model
    type(scene_state), intent(in) :: state
    real(wp), intent(in) :: applied(:, :)
    real(wp), allocatable :: reaction(:, :)
    real(wp), allocatable :: force(:, :)
    integer :: c, node

    force = nodal_forces(model, state%stress)
    allocate (reaction(2, model%nodes), source=0.0_wp)
    do node = 1, model%nodes
      do c = 1, 2
        associate (leader => model%leader(c, node))
          if (model%held(c, leader)) reaction(c, leader) = reaction(c, leader) + force(c, node) - applied(c, node)
        end associate
      end do
    end do
  end function reactions
end module epcont_result_stresses
