!> The library: a scene made from arrays in, a certified answer out (input/library/README.md).
module epcont
  use epcont_base_error, only: error_type, raise, status_deck, status_no_answer, status_numerical, &
                               status_usage, status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_version, only: program_version
  use epcont_contact_geometry_complete, only: complete_model, is_complete, raise_first
  use epcont_element_kinematics, only: axisymmetric, plane_strain, plane_stress
  use epcont_model_controls, only: controls_type, method_auto, method_inistr, method_modsec, method_newton, &
                                   method_secant, precision_double, precision_mixed, precision_open, &
                                   precision_single, rule_auto, rule_block, rule_conry, solver_auto, &
                                   solver_band, solver_frontal, uniaxial_curve
  use epcont_model_finding, only: findings
  use epcont_model_given, only: add_elements, new_scene, set_pairs, set_sections
  use epcont_model_model, only: line_couple, model_type, named_line
  use epcont_model_pressure, only: add_pressure_on => add_pressure, element_behind
  use epcont_model_yield_curve, only: bilinear_curve
  use epcont_plasticity_observer, only: observer
  use epcont_report_outcome, only: judge, outcome_type
  use epcont_solution, only: solution_type
  use epcont_system_threads, only: use_one_thread
  implicit none
  private
  public :: wp, program_version
  ! A scene, and what is wrong with it.
  public :: model_type, new_scene, add_elements, set_sections, set_pairs, complete_model, add_pressure
  public :: plane_strain, plane_stress, axisymmetric, uniaxial_curve, bilinear_curve, named_line, line_couple
  public :: findings, error_type
  ! What a deck says by PARAM.
  public :: controls_type, method_auto, method_secant, method_modsec, method_inistr, method_newton, &
    rule_auto, rule_conry, rule_block, solver_auto, solver_band, solver_frontal, precision_open, &
    precision_double, precision_mixed, precision_single
  ! Its answer, and what came of it.
  public :: solve_model, solution_type, outcome_type
  public :: status_valid, status_no_answer, status_deck, status_usage, status_numerical

contains

  !> Solve a scene that `complete_model` has made complete.
  subroutine solve_model(model, solution, outcome, error, memory)
    type(model_type), intent(in) :: model           !! the scene
    type(solution_type), intent(out) :: solution    !! answer, certificate, accuracy, where there is one
    type(outcome_type), intent(out) :: outcome      !! whether there is, and whether it is valid
    !> A body is loose, or there is not enough memory: nothing was solved
    type(error_type), allocatable, intent(out) :: error
    real(wp), intent(in), optional :: memory        !! that may be taken, at most [GB]
    type(findings) :: found
    type(observer) :: watch
    real(wp) :: limit

    limit = huge(limit)
    if (present(memory)) limit = memory
    if (is_complete(model)) then
      call use_one_thread()
      solution%model = model
      call solution%find_motions(found)
      call raise_first(model, found, error)
    else
      call raise(error, status_deck, 'the scene is not complete (wanted: complete_model, without an error)')
    end if
    if (.not. allocated(error)) then
      call solution%make_plan(watch)
      call solution%solve(limit, watch, error)
    end if
    if (allocated(error)) then
      outcome%status = error%status
      outcome%word = 'refused'
      outcome%sentence = error%message
    else
      outcome = judge(solution)
    end if
  end subroutine solve_model

  !> Pressure on a side of the boundary, linear from one of its corners to the other: after `complete_model`.
  subroutine add_pressure(model, element, corner, pressure, theta, error)
    type(model_type), intent(inout) :: model   !! the scene
    integer, intent(in) :: element             !! whose side it is
    integer, intent(in) :: corner(2)           !! nodes at the ends of the side
    real(wp), intent(in) :: pressure(2)        !! at these, positive into the element [stress]
    real(wp), intent(in) :: theta              !! counter-clockwise from the inward normal [degree]
    type(error_type), allocatable, intent(out) :: error   !! there is no such side, or it is inside a body
    integer :: side

    side = 0
    if (is_complete(model) .and. element > 0 .and. element <= model%elements) &
      side = model%side_between(element, corner(1), corner(2))
    if (side == 0) then
      call raise(error, status_deck, 'there is no side between these nodes (wanted: corners of an element'// &
                                     ' of a complete scene)')
    else if (element_behind(model, element, side) > 0) then
      call raise(error, status_deck, 'a pressure inside a body (wanted: a side of its boundary)')
    else if (.not. all(abs([pressure, theta]) <= huge(1.0_wp))) then
      call raise(error, status_deck, 'a pressure or its direction is no number (wanted: finite ones)')
    else
      call add_pressure_on(model, element, side, corner(1), pressure, theta)
    end if
  end subroutine add_pressure
end module epcont
