!> The story of one scene: from the model to a certified answer.
module epcont_analysis
  use epcont_assembly_bodies, only: factor_bodies, factored_bodies
  use epcont_base_kinds, only: wp
  use epcont_certificate_certificate, only: certificate_type, certify
  use epcont_contact_problem, only: contact_problem, contact_solved
  use epcont_contact_simplex, only: solve_contact
  use epcont_flexibility_flexibility, only: add_body_flexibility, gap_opening, motion_columns, motion_resultants, &
                                            pair_forces
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_numbering, only: numbering_type
  use epcont_result_answer, only: answer_type
  use epcont_result_contact_line, only: contact_line, find_contact_line
  use epcont_result_stresses, only: recover_stresses
  implicit none
  private
  public :: analyse

contains

  !> Solve the scene. `singular` is a body whose stiffness could not be factored (0: none); without contact
  !! equilibrium (`answer%contact%state`) there are no displacements.
  subroutine analyse(model, motions, numbering, answer, certificate, singular)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(numbering_type), intent(in) :: numbering
    type(answer_type), intent(out) :: answer
    type(certificate_type), intent(out) :: certificate
    integer, intent(out) :: singular
    type(factored_bodies) :: bodies
    type(contact_problem) :: problem
    type(contact_line) :: line
    real(wp), allocatable :: applied(:, :)
    integer :: b

    call factor_bodies(model, numbering, bodies, singular)
    if (singular > 0) return
    answer%condition = bodies%condition

    allocate (problem%flexibility(model%pairs, model%pairs), source=0.0_wp)
    do b = 1, model%bodies
      call add_body_flexibility(model, numbering, b, bodies%body(b), problem%flexibility)
    end do
    problem%initial_gap = model%initial_gap
    problem%load_gap = gap_opening(model, bodies%displacements(model, numbering, model%load))
    problem%motion = motion_columns(model, motions)
    problem%resultant = motion_resultants(model, motions)
    call solve_contact(problem, answer%contact)
    if (answer%contact%state /= contact_solved) return

    applied = model%load + pair_forces(model, answer%contact%force)
    answer%displacement = bodies%displacements(model, numbering, applied)
    call add_motions(model, motions, answer)
    call recover_stresses(model, applied, answer)
    line = find_contact_line(model)
    answer%pressure = merge(answer%contact%force/max(line%tributary, tiny(1.0_wp)), -1.0_wp, line%tributary > 0.0_wp)
    call certify(model, answer%displacement, answer%reaction, answer%stress, answer%contact%force, certificate)
  end subroutine analyse

  !> Add the rigid motions to the displacements.
  subroutine add_motions(model, motions, answer)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(answer_type), intent(inout) :: answer
    integer :: k, node

    do k = 1, motions%count
      do node = 1, model%nodes
        answer%displacement(:, node) = answer%displacement(:, node) &
                                       + answer%contact%approach(k)*motions%displacement(model, node, k)
      end do
    end do
  end subroutine add_motions
end module epcont_analysis
