!> The story of one scene: from the model to a certified answer.
module epcont_analysis
  use epcont_accuracy_accuracy, only: accuracy_type, assess
  use epcont_base_kinds, only: wp
  use epcont_certificate_certificate, only: certificate_type, certify
  use epcont_certificate_scene, only: look_through
  use epcont_contact_problem, only: contact_solved
  use epcont_flexibility_flexibility, only: pair_forces
  use epcont_model_controls, only: precision_double
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_numbering, only: numbering_type
  use epcont_plasticity_iteration, only: follow_loads, plastic_run
  use epcont_plasticity_method, only: plastic_method
  use epcont_plasticity_methods, only: choose_method
  use epcont_plasticity_onlooker, only: onlooker
  use epcont_plasticity_scene_state, only: scene_state
  use epcont_result_answer, only: answer_type, largest_loss
  use epcont_result_body_force, only: find_body_forces
  use epcont_result_contact_line, only: contact_line, find_contact_line, in_contact
  use epcont_result_displacement_gradient, only: find_gradients
  use epcont_result_line_pressure, only: compare_sides
  use epcont_result_locking, only: find_locking
  use epcont_result_pressures, only: pair_pressures
  use epcont_result_stresses, only: recover_stresses
  use epcont_result_zones, only: find_zones
  use epcont_system_stopwatch, only: stage_accuracy, stage_certificate, stage_stresses
  implicit none
  private
  public :: analyse

  !> Steps of refinement where forces, gaps or the energy are out of balance, or rounding has taken too much of a pivot; each
  !! gains as many digits as the factors have.
  integer, parameter :: most_refinements = 3
  !> So many times the load steps, where those asked for did not lead to an answer.
  integer, parameter :: more_steps = 5

contains

  !> Solve the scene. `singular` is a body whose stiffness could not be factored (0: none); without contact
  !! equilibrium (`answer%contact%state`) there are no displacements.
  subroutine analyse(model, motions, numbering, plan, answer, certificate, accuracy, singular, watch)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(numbering_type), intent(in) :: numbering
    type(iteration_plan), intent(in) :: plan
    type(answer_type), intent(out) :: answer
    type(certificate_type), intent(out) :: certificate
    type(accuracy_type), intent(out) :: accuracy
    integer, intent(out) :: singular
    class(onlooker), intent(inout) :: watch
    type(plastic_run) :: run
    type(contact_line) :: line
    type(answer_type) :: raw, found                  ! without what follows from the state; before refinement
    type(certificate_type) :: found_certificate
    type(scene_state) :: state
    integer :: step

    call solve(model, motions, numbering, plan, run, answer, watch)
    singular = run%singular
    answer%lacks_memory = run%lacks_memory
    if (singular > 0 .or. allocated(answer%against_double)) return
    answer%contact = run%state%contact
    if (answer%contact%state /= contact_solved) return

    call take_over(run, answer)
    raw = answer
    line = find_contact_line(model)
    call evaluate(model, plan, run, line, answer, certificate, watch)
    do step = 1, most_refinements
      if (.not. run%converged .or. certificate%balanced .and. answer%lost() <= largest_loss .and. &
          (step == 1 .or. answer%last_correction <= largest_loss)) exit
      if (step == 1) then
        found = answer
        found_certificate = certificate
        state = run%state
      end if
      call run%scene%sharpen(model, motions, numbering, run%law, run%load_factor, run%state, raw%last_correction, watch)
      answer = raw
      call evaluate(model, plan, run, line, answer, certificate, watch)
    end do
    ! Gaps far below a travel are rounding, and contact found from them is out of balance.
    if (step > 1 .and. certificate%has_spoilt(found_certificate)) then
      answer = found
      certificate = found_certificate
      run%state = state
    end if
    call assess(model, motions, numbering, run, line, answer, accuracy)
    where (.not. answer%contact%touching .and. answer%pressure > 0.0_wp) answer%pressure = -1.0_wp   ! an open pair does not press
    call watch%lap(stage_accuracy)
  end subroutine analyse

  !> Stresses, pressures and zones of the state that was found, and their certificate.
  subroutine evaluate(model, plan, run, line, answer, certificate, watch)
    type(model_type), intent(in) :: model
    type(iteration_plan), intent(in) :: plan
    type(plastic_run), intent(inout) :: run   !! states of the points are found where they are not
    type(contact_line), intent(in) :: line
    type(answer_type), intent(inout) :: answer
    type(certificate_type), intent(out) :: certificate
    class(onlooker), intent(inout) :: watch
    real(wp), allocatable :: load(:, :)
    logical, allocatable :: touching(:)

    if (run%materials%yields .and. .not. allocated(run%state%point)) &
      run%state%point = run%materials%states(run%state%strain)
    answer%contact = run%state%contact
    answer%displacement = run%state%displacement
    answer%deformation = run%state%deformation
    load = run%load_factor*model%load
    call recover_stresses(model, run%scene%operator, run%materials, run%state, &
                          load + pair_forces(model, answer%contact%force), answer)
    answer%locking = find_locking(model, run%scene%operator%volume, answer%stress, answer%equivalent_stress, answer%secant_modulus)
    answer%gradient = find_gradients(model, run%scene%operator%volume, answer%displacement)
    touching = in_contact(line, answer%contact%touching)
    answer%pressure = pair_pressures(model, line, touching, answer%contact%force)
    answer%zones = find_zones(model, line, touching, answer%contact%force, answer%pressure)
    answer%lines = compare_sides(model, answer%contact%touching, answer%contact%force, answer%pressure)
    answer%bodies = find_body_forces(model, answer%contact%force)
    call watch%lap(stage_stresses)
    call certify(model, answer, plan%off_curve, certificate)
    if (answer%converged .and. certificate%valid) &
      certificate%scene = look_through(model, answer%displacement, answer%contact%force)
    call watch%lap(stage_certificate)
  end subroutine evaluate

  !> Solve by the plan; what factors in single precision give no answer for, or one worth nothing, is solved by others in double.
  subroutine solve(model, motions, numbering, plan, run, answer, watch)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(numbering_type), intent(in) :: numbering
    type(iteration_plan), intent(in) :: plan
    type(plastic_run), intent(out) :: run
    type(answer_type), intent(inout) :: answer
    class(onlooker), intent(inout) :: watch
    type(iteration_plan) :: now

    now = plan
    answer%asked_precision = plan%precision
    answer%largest_rounding_error = plan%rounding_error
    call follow_or_step(model, motions, numbering, now, run, watch)
    if (plan%precision /= precision_double .and. .not. (run%converged .and. run%rounding_error <= plan%rounding_error)) then
      if (allocated(plan%against_double)) then
        answer%against_double = plan%against_double
        return
      end if
      now%precision = precision_double
      now%load_steps = plan%load_steps
      call follow_or_step(model, motions, numbering, now, run, watch)
    end if
    answer%precision = now%precision
    answer%load_steps = now%load_steps
    answer%asked_load_steps = plan%load_steps
  end subroutine solve

  !> Follow the loads; where the method was chosen here and has found neither an answer nor a limit load, in more steps.
  subroutine follow_or_step(model, motions, numbering, plan, run, watch)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(numbering_type), intent(in) :: numbering
    type(iteration_plan), intent(inout) :: plan   !! its load steps become those that were taken
    type(plastic_run), intent(out) :: run
    class(onlooker), intent(inout) :: watch
    class(plastic_method), allocatable :: method

    call choose_method(plan%method, method)
    call follow_loads(model, motions, numbering, plan, method, run, watch)
    if (.not. (plan%chosen_here .and. plan%yields) .or. run%converged .or. run%runs_away .or. run%lacks_memory) return
    ! What the first solve does not find, steps do not; single precision is followed by double.
    if (size(run%history) <= 1 .or. plan%precision /= precision_double) return
    plan%load_steps = more_steps*plan%load_steps
    call choose_method(plan%method, method)
    call follow_loads(model, motions, numbering, plan, method, run, watch)
  end subroutine follow_or_step

  !> What the loop has found, and how.
  pure subroutine take_over(run, answer)
    type(plastic_run), intent(in) :: run
    type(answer_type), intent(inout) :: answer

    answer%history = run%history
    answer%factorizations = run%factorizations
    answer%converged = run%converged
    answer%runs_away = run%runs_away
    answer%load_factor = run%load_factor
    answer%condition = run%condition
    answer%weakest = run%weakest
    answer%rounding_error = run%rounding_error
    answer%unloaded = run%unloaded
    answer%first_unloaded = run%first_unloaded
  end subroutine take_over
end module epcont_analysis
