!> The story of one scene: from the model to a certified answer.
module epcont_solution
  use epcont_accuracy_accuracy, only: accuracy_type, assess, kept_estimates
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits
  use epcont_certificate_certificate, only: certificate_type, certify
  use epcont_certificate_scene, only: look_through
  use epcont_verdict, only: find_verdict, verdict_type
  use epcont_contact_geometry_nearness, only: find_nodes_that_came_near, pair_nodes_that_came_near
  use epcont_contact_problem, only: contact_solved, contact_stalled
  use epcont_flexibility_flexibility, only: pair_forces
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_model_controls, only: method_newton
  use epcont_model_model, only: line_contact
  use epcont_plan_forecast, only: check_memory
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_joining, only: can_join
  use epcont_plan_planned_model, only: planned_model
  use epcont_plan_side_by_side, only: plan_threads
  use epcont_plasticity_load_path, only: follow_loads
  use epcont_plasticity_law_of_state, only: factor_law, linearise
  use epcont_plasticity_newton, only: newton_method
  use epcont_plasticity_observer, only: observer
  use epcont_result_answer, only: answer_type
  use epcont_result_body_force, only: find_body_forces
  use epcont_result_contact_line, only: contact_line, find_contact_line
  use epcont_result_displacement_gradient, only: find_gradients
  use epcont_result_line_pressure, only: compare_sides
  use epcont_result_locking, only: find_locking
  use epcont_result_pressures, only: pair_pressures
  use epcont_result_stresses, only: recover_stresses
  use epcont_result_zones, only: find_zones
  use epcont_system_stopwatch, only: stage_accuracy, stage_certificate, stage_contact, stage_stresses
  use epcont_system_threads, only: granted_threads
  implicit none
  private
  public :: solution_type

  !> A scene is solved again while nodes come near that had no pair, but not more often.
  integer, parameter :: most_solves = 8
  !> Steps of refinement where forces, gaps or the energy are out of balance, or rounding has taken too much
  !! of a pivot; each gains as many digits as the factors have.
  integer, parameter :: most_refinements = 3
  !> So many times the load steps, where those asked for did not lead to an answer.
  integer, parameter :: more_steps = 5

  !> What load cases hand on, where another follows (`follow_loads`).
  type :: kept_factors
    logical :: another = .false.         !! case follows
    type(linear_problem), allocatable :: linear, virgin
    type(contact_line) :: line
    type(kept_estimates) :: estimates
  contains
    procedure :: forget
  end type kept_factors

  !> A scene with its answer, and what that is worth. Where a body's stiffness could not be factored
  !! (`answer%failed_body`), or without contact equilibrium (`answer%contact%state`), there are no
  !! displacements.
  type, extends(planned_model) :: solution_type
    type(answer_type) :: answer
    type(certificate_type) :: certificate
    type(accuracy_type) :: accuracy
    type(verdict_type) :: verdict
    type(kept_factors) :: kept           !! from load case to load case
    !> The scene before nodes that came near in this load case got pairs; not allocated if there were none
    type(planned_model), allocatable :: as_given
  contains
    procedure :: solve
    procedure :: return_to_given
  end type solution_type

contains

  !> Solve a scene whose plan is made, anew with more pairs while nodes come near that had none.
  subroutine solve(self, limit, watch, error)
    class(solution_type), intent(inout) :: self
    real(wp), intent(in) :: limit                         !! of memory [GB]
    class(observer), intent(inout) :: watch               !! takes the time, and is told of each solve
    type(error_type), allocatable, intent(out) :: error   !! there is not enough memory
    type(line_contact), allocatable :: contacts(:)
    integer :: count, failures
    logical :: failed, near

    if (allocated(self%as_given)) deallocate (self%as_given)
    failures = 0
    do count = 1, most_solves + 2   ! two more, should a rule find no contact
      call check_memory(self%expected%bytes, limit, error)
      if (allocated(error)) return
      self%iteration%threads = plan_threads(self%numbering, self%expected%bytes, granted_threads())
      call watch%expect(self%expected%operations)
      call analyse(self%planned_model, self%kept, self%answer, self%certificate, self%accuracy, watch, &
                   failed)
      ! What neither rule finds, the simplex has the words for.
      if (failed .and. (self%iteration%joined .or. failures == 0 .and. can_join(self%model))) then
        failures = failures + 1
        self%other_rule = .not. self%other_rule
      else
        if (self%answer%failed_body > 0 .or. count >= most_solves) exit
        call find_nodes_that_came_near(self%model, self%answer%displacement, self%answer%contact%touching, &
                                       contacts, near)
        if (.not. near) exit
        if (.not. allocated(self%as_given)) self%as_given = self%planned_model
        call pair_nodes_that_came_near(self%model, contacts, near)
        if (.not. near) exit
      end if
      call self%kept%forget()
      call self%make_plan(watch)
    end do
    self%verdict = find_verdict(self%answer, self%certificate, self%model%contact_is_off)
    if (.not. self%kept%another) call self%kept%forget()
    if (allocated(self%kept%virgin) .and. allocated(self%kept%linear)) deallocate (self%kept%linear)
  end subroutine solve

  !> Return to the scene without the pairs of nodes that came near in this load case: other load cases are
  !! solved as if they were alone.
  subroutine return_to_given(self)
    class(solution_type), intent(inout) :: self

    if (.not. allocated(self%as_given)) return
    self%planned_model = self%as_given
    deallocate (self%as_given)
    call self%kept%forget()
  end subroutine return_to_given

  !> Factors are made anew for the next solve, or are no longer wanted.
  subroutine forget(self)
    class(kept_factors), intent(inout) :: self
    type(kept_estimates) :: none
    type(contact_line) :: no_line

    if (allocated(self%linear)) deallocate (self%linear)
    if (allocated(self%virgin)) deallocate (self%virgin)
    self%estimates = none
    self%line = no_line
  end subroutine forget

  !> Solve the scene as it is.
  subroutine analyse(scene, kept, answer, certificate, accuracy, watch, failed)
    type(planned_model), intent(in) :: scene
    type(kept_factors), intent(inout) :: kept
    type(answer_type), intent(out) :: answer
    type(certificate_type), intent(out) :: certificate
    type(accuracy_type), intent(out) :: accuracy
    class(observer), intent(inout) :: watch
    logical, intent(out) :: failed      !! the other rule is to find the contact

    call follow_or_step()
    failed = kept%linear%rule%failed .or. &
             scene%numbering%joined .and. answer%failed_body > 0 .and. .not. answer%lacks_memory .or. &
             .not. scene%numbering%joined .and. answer%contact%state == contact_stalled
    if (failed .or. answer%failed_body > 0 .or. answer%contact%state /= contact_solved) return
    failed = .not. kept%linear%rule%is_unique(scene, kept%linear%factored_bodies)
    call watch%lap(stage_contact)
    if (failed) return
    call evaluate_refined()
    failed = scene%numbering%joined .and. answer%converged .and. .not. certificate%valid
    if (failed) return
    call use_tangent()
    call assess(scene, kept%linear, kept%line, kept%estimates, answer, accuracy)
    ! An open pair does not press.
    where (.not. answer%contact%touching .and. answer%pressure > 0.0_wp) answer%pressure = -1.0_wp
    call watch%lap(stage_accuracy)

  contains

    !> The stiffness that tells what errors do to an answer: its tangent, by whatever method and step it was
    !! found.
    subroutine use_tangent()
      type(newton_method) :: tangent
      integer :: failed_body

      if (.not. answer%converged .or. scene%model%controls%paper_ratio .or. .not. any(answer%plastic)) return
      if (scene%iteration%method == method_newton .or. answer%history(size(answer%history))%by_tangent) return
      call linearise(scene, tangent, answer%solved_state, kept%linear, watch)
      call factor_law(scene, tangent, answer%solved_state, kept%linear, failed_body, watch)
      if (failed_body > 0) answer%condition = huge(1.0_wp)
    end subroutine use_tangent

    !> What was found, refined where rounding has left too much, and its certificate.
    subroutine evaluate_refined()
      type(answer_type) :: found                      ! before refinement
      type(certificate_type) :: found_certificate
      integer :: step

      call evaluate()
      do step = 1, most_refinements
        if (.not. answer%converged .or. certificate%balanced .and. answer%lost() <= lost_digits .and. &
            (step == 1 .or. answer%last_correction <= lost_digits)) exit
        if (step == 1) then
          found = answer
          found_certificate = certificate
        end if
        call kept%linear%sharpen(scene, answer%load_factor, answer%solved_state, answer%last_correction, &
                                 watch)
        call evaluate()
      end do
      ! Gaps far below a travel are rounding, and contact found from them is out of balance.
      if (step > 1 .and. certificate%has_spoilt(found_certificate)) then
        answer = found
        certificate = found_certificate
      end if
    end subroutine evaluate_refined

    !> Stresses, pressures and zones of the state that was found, and their certificate.
    subroutine evaluate()
      logical, allocatable :: touching(:)

      if (.not. allocated(kept%line%node)) kept%line = find_contact_line(scene%model)
      if (kept%linear%materials%yields .and. .not. allocated(answer%point)) &
        answer%point = kept%linear%materials%states(answer%strain)
      associate (model => scene%model, force => answer%contact%force, volume => kept%linear%operator%volume)
        call recover_stresses(model, kept%linear, answer%load_factor*model%load + pair_forces(model, force), &
                              answer)
        answer%locking = find_locking(model, volume, answer%stress, answer%equivalent_stress, &
            answer%secant_modulus)
        answer%gradient = find_gradients(model, volume, answer%displacement)
        touching = kept%line%in_contact(answer%contact%touching)
        answer%pressure = pair_pressures(model, kept%line, touching, force)
        answer%zones = find_zones(kept%line, touching, force, answer%pressure)
        call compare_sides(model, answer%contact%touching, force, answer%pressure, answer%lines, answer%apart)
        answer%bodies = find_body_forces(model, force)
        call watch%lap(stage_stresses)
        call certify(model, answer, scene%iteration%off_curve, certificate)
        if (answer%converged .and. certificate%valid) &
          certificate%scene = look_through(model, answer%displacement, force)
      end associate
      call watch%lap(stage_certificate)
    end subroutine evaluate

    !> Follow the loads; where the method was chosen here and has found neither an answer nor a limit load, in
    !! more steps.
    subroutine follow_or_step()
      type(iteration_plan) :: plan

      plan = scene%iteration
      if (plan%yields) plan%load_steps = scene%model%controls%load_steps   ! of this load case
      call follow_loads(scene, plan, kept%another, kept%linear, kept%virgin, answer%followed_loads, watch)
      ! What the first solve does not find, steps do not.
      if (plan%chosen_here .and. plan%yields .and. size(answer%history) > 1 .and. &
          .not. (answer%converged .or. answer%runs_away .or. answer%lacks_memory)) then
        plan%load_steps = more_steps*plan%load_steps
        deallocate (kept%linear)
        call follow_loads(scene, plan, kept%another, kept%linear, kept%virgin, answer%followed_loads, watch)
      end if
      answer%load_steps = plan%load_steps
    end subroutine follow_or_step
  end subroutine analyse
end module epcont_solution
