!> The library: input is a model made from arrays, output a certified answer (input/library/README.md).
module epcont
  use, intrinsic :: ieee_exceptions, only: ieee_all, ieee_get_status, ieee_set_halting_mode, &
      ieee_set_status, ieee_status_type
  use epcont_base_diagnostic, only: severity_error, severity_note, severity_warning
  use epcont_base_error, only: error_type, status_deck, status_internal, status_no_answer, status_numerical, &
      status_usage, status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_version, only: program_version
  use epcont_contact_geometry_complete, only: complete_arrays
  use epcont_element_kinematics, only: axisymmetric, plane_strain, plane_stress
  use epcont_model_arrays, only: add_elements, body_load, dof_tie, line_couple, linear_equation, named_line, &
      new_scene, scene_type, set_pairs, set_sections, side_pressure, spring_type, turning_platen
  use epcont_model_controls, only: controls_type, method_auto, method_inistr, method_modsec, method_newton, &
      method_secant, rule_auto, rule_conry, rule_joined, solver_auto, solver_band, &
      solver_frontal, uniaxial_curve
  use epcont_model_finding, only: findings, of_scene
  use epcont_model_marks, only: marks_of, part_name
  use epcont_model_yield_curve, only: bilinear_curve
  use epcont_model_model, only: model_type
  use epcont_plasticity_observer, only: observer
  use epcont_messages_array_words, only: in_array_words, name_item
  use epcont_messages_outcome, only: judge, outcome_type
  use epcont_solution, only: solution_type
  use epcont_system_threads, only: one_thread, threads_now, use_threads
  implicit none
  private
  public :: wp, program_version
  ! A model.
  public :: scene_type, new_scene, add_elements, set_sections, set_pairs
  public :: side_pressure, body_load, named_line, line_couple
  public :: dof_tie, turning_platen, linear_equation, spring_type
  public :: plane_strain, plane_stress, axisymmetric, uniaxial_curve, bilinear_curve
  ! Parameters, as on PARAM of a deck.
  public :: controls_type, method_auto, method_secant, method_modsec, method_inistr, method_newton, &
    rule_auto, rule_conry, rule_joined, solver_auto, solver_band, solver_frontal
  ! Its answer, outcome, and messages.
  public :: solve_scene, solution_type, outcome_type, findings
  public :: status_valid, status_no_answer, status_deck, status_usage, status_numerical, status_internal
  public :: severity_error, severity_warning, severity_note

contains

  !> Check a model and solve it.
  subroutine solve_scene(scene, solution, outcome, memory)
    type(scene_type), intent(in) :: scene           !! the model
    !> Answer, certificate, accuracy, as far as found; a rejected model does not change it. With
    !! `controls%sequence`, the loads start from the end of those of this solution.
    type(solution_type), intent(inout) :: solution
    type(outcome_type), intent(out) :: outcome      !! exit status, and all messages
    real(wp), intent(in), optional :: memory        !! limit [GB]; default: none
    type(error_type), allocatable :: error
    type(findings) :: found
    type(observer) :: watch
    real(wp) :: limit
    integer :: before(2), k
    type(ieee_status_type) :: traps
    type(model_type) :: model
    type(solution_type) :: none

    limit = huge(limit)
    if (present(memory)) limit = memory
    call ieee_get_status(traps)   ! of the caller; NaN is detected without traps
    call ieee_set_halting_mode(ieee_all, .false.)
    before = threads_now()
    call use_threads(one_thread)
    call complete_arrays(scene, model, found)
    if (scene%controls%sequence .and. found%errors == 0) call check_sequence()
    if (found%errors == 0) then
      if (.not. scene%controls%sequence) solution = none
      solution%model = model
      call solution%find_motions(found)
    end if
    outcome%status = status_deck
    outcome%word = 'rejected'
    if (found%errors == 0) then
      call solution%make_plan(watch)
      call solution%solve(limit, watch, error)
      if (allocated(error)) then
        outcome%status = error%status
        outcome%sentence = in_array_words(error%message)
      else
        ! pairs of lines have node numbers before
        solution%model%contact%pair_id = [(k, k=1, solution%model%contact%pairs)]
        outcome = judge(solution)
        outcome%sentence = in_array_words(outcome%sentence)
        outcome%has_answer = outcome%has_answer .and. solution%answer%carried
        if (.not. outcome%has_answer) solution%answer%load_factor = 0.0_wp
      end if
    end if
    call use_threads(before)
    call tell()
    call ieee_set_status(traps)

  contains

    !> Check that the loads can start from the end of those of the solution.
    subroutine check_sequence()
      if (.not. model%controls%by_increments .and. &
          any([(allocated(model%sections%curve(k)%strain), k=1, size(model%sections%curve))])) &
        call refuse('total theory has no memory of earlier loads', 'set controls%by_increments')
      if (.not. solution%model%controls%sequence) return   ! a new solution
      if (.not. solution%can_start()) &
        call refuse('the loads before did not reach their end', 'use another solution')
      k = findloc(marks_of(solution%model) == marks_of(model), .false., dim=1)
      if (k > 0) call refuse('the model is not that of the loads before: '//trim(part_name(k))//' differ', &
                             'change loads only, or use another solution')
    end subroutine check_sequence

    !> Reject a sequence.
    subroutine refuse(what, remedy)
      character(len=*), intent(in) :: what, remedy

      call found%add_error(of_scene, 0, 0, 'controls%sequence: '//what, remedy)
    end subroutine refuse

    !> Report messages about the model before those about its answer, with the names of the arrays; for a
    !! rejected model, only its first error.
    subroutine tell()
      do k = 1, outcome%found%count
        call found%add(outcome%found%list(k))
      end do
      if (found%count == 0) allocate (found%list(0))
      found%list = found%list(:found%count)
      do k = 1, found%count
        call name_item(model, found%list(k))
      end do
      k = findloc(found%list%severity, severity_error, dim=1)
      if (k > 0) outcome%sentence = found%list(k)%what//' ('//found%list(k)%remedy//')'
      outcome%found = found
    end subroutine tell
  end subroutine solve_scene
end module epcont
