!> Solution of one model: from the plan to a certified answer, in as many attempts as necessary.
module epcont_solution
  use epcont_accuracy_accuracy, only: accuracy_type, assess, kept_estimates
  use epcont_attempts, only: attempt_list, attempts, because_near, because_no_contact, &
    because_not_converged, because_not_unique, because_refused, because_singular, because_unbalanced, &
    more_pairs, more_steps, other_rule, refinement
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
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_load_set, only: load_set
  use epcont_plan_forecast, only: check_memory
  use epcont_plan_iteration_plan, only: iteration_plan
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

  !> Largest number of steps of refinement, used if forces, gaps or the energy have a residual, or if rounding
  !! has taken too much of a pivot. Each step gains as many digits as the factors have.
  integer, parameter :: most_refinements = 3
  !> Factor of the number of load steps, if the planned number gives no answer.
  integer, parameter :: times_the_steps = 5

  !> Data that the next load case reuses (`follow_loads`).
  type :: kept_factors
    logical :: another = .false.         !! another load case follows
    type(linear_problem), allocatable :: linear, virgin
    type(contact_line) :: line
    type(kept_estimates) :: estimates
  contains
    procedure :: forget
  end type kept_factors

  !> A model with its answer, certificate and error estimates. There are no displacements if a body's
  !! stiffness could not be factored (`answer%failed_body`), or without contact equilibrium
  !! (`answer%contact%state`).
  type, extends(planned_model) :: solution_type
    type(answer_type) :: answer
    type(certificate_type) :: certificate
    type(accuracy_type) :: accuracy
    type(verdict_type) :: verdict
    type(kept_factors) :: kept           !! from load case to load case
    !> The model before nodes that came near in this load case got pairs; not allocated if there were no such
    !! nodes
    type(planned_model), allocatable :: as_given
    type(attempt_list) :: attempts       !! after the first solve
    type(load_set), private :: loads     !! of the load case; the model has those of the state found
    logical, private :: unique = .true.  !! contact forces are unique, as far as the contact solver must know
  contains
    procedure :: solve
    procedure :: return_to_given
    procedure, private :: solve_as_planned
    procedure, private :: follow
    procedure, private :: choose_attempt
    procedure, private :: make_attempt
    procedure, private :: why_more_steps
    procedure, private :: why_other_rule
    procedure, private :: why_refine
    procedure, private :: why_more_pairs
    procedure, private :: refine
    procedure, private :: evaluate
    procedure, private :: assess_answer
  end type solution_type

contains

  !> Solve a planned model, in more attempts as long as there is a reason for one.
  subroutine solve(self, limit, watch, error)
    class(solution_type), intent(inout) :: self
    real(wp), intent(in) :: limit                         !! of memory [GB]
    class(observer), intent(inout) :: watch               !! takes the time, and is called after each solve
    type(error_type), allocatable, intent(out) :: error   !! there is not enough memory
    type(accuracy_type) :: none
    integer :: what, why

    self%accuracy = none
    if (allocated(self%as_given)) deallocate (self%as_given)
    call self%attempts%begin()
    self%loads = self%model%loads
    call self%solve_as_planned(limit, watch, error)
    do
      if (allocated(error)) return
      call self%choose_attempt(what, why)
      if (why == 0) exit
      call self%make_attempt(what, why, limit, watch, error)
    end do
    if (self%answer%failed_body == 0 .and. self%answer%contact%state == contact_solved) &
      call self%assess_answer(watch)
    self%verdict = find_verdict(self%answer, self%certificate, self%model%contact%contact_is_off)
    if (.not. self%kept%another) call self%kept%forget()
    if (allocated(self%kept%virgin) .and. allocated(self%kept%linear)) deallocate (self%kept%linear)
  end subroutine solve

  !> Choose the first attempt of the list that has a reason.
  subroutine choose_attempt(self, what, why)
    class(solution_type), intent(inout) :: self
    integer, intent(out) :: what, why   !! 0: no attempt has a reason

    do what = 1, attempts
      why = 0
      if (.not. self%attempts%has_left(what)) cycle
      select case (what)
      case (more_steps)
        why = self%why_more_steps()
      case (other_rule)
        why = self%why_other_rule()
      case (refinement)
        why = self%why_refine()
      case (more_pairs)
        call self%why_more_pairs(why)
      end select
      if (why > 0) exit
    end do
  end subroutine choose_attempt

  !> Make an attempt.
  subroutine make_attempt(self, what, why, limit, watch, error)
    class(solution_type), intent(inout) :: self
    integer, intent(in) :: what, why
    real(wp), intent(in) :: limit
    class(observer), intent(inout) :: watch
    type(error_type), allocatable, intent(out) :: error
    integer :: many

    many = 0
    if (what == more_steps) many = times_the_steps*self%model%controls%load_steps
    if (what == refinement) call self%refine(many, watch)
    call self%attempts%add(what, why, many)
    select case (what)
    case (more_steps)
      deallocate (self%kept%linear)
      call self%follow(many, watch)
    case (other_rule, more_pairs)
      if (what == other_rule) self%other_rule = .not. self%other_rule
      call self%kept%forget()
      call self%make_plan(watch)
      call self%solve_as_planned(limit, watch, error)
    end select
  end subroutine make_attempt

  !> Reason for more load steps: there is neither an answer nor a limit load, with a method that epcont has
  !> chosen. Without a result of the first solve, more steps do not help.
  pure integer function why_more_steps(self) result(why)
    class(solution_type), intent(in) :: self

    associate (answer => self%answer, plan => self%iteration)
      why = merge(because_not_converged, 0, plan%chosen_here .and. plan%yields .and. &
                  size(answer%history) > 1 .and. &
                  .not. (answer%converged .or. answer%runs_away .or. answer%lacks_memory))
    end associate
  end function why_more_steps

  !> Reason for the other contact solver: this one has found no active set, or a result that it cannot
  !! explain. If neither finds one, the solver that can explain the failure gives the result.
  integer function why_other_rule(self) result(why)
    class(solution_type), intent(in) :: self

    why = 0
    if (.not. self%has_other_rule()) return
    associate (answer => self%answer, rule => self%kept%linear%rule)
      if (rule%explains .and. self%attempts%count_of(other_rule) > 0) return
      if (rule%failed .or. answer%contact%state == contact_stalled) then
        why = because_no_contact
      else if (rule%explains .or. answer%lacks_memory) then
        return
      else if (answer%failed_body > 0) then
        why = because_singular
      else if (answer%contact%state /= contact_solved) then
        return
      else if (.not. self%unique) then
        why = because_not_unique
      else if (answer%converged .and. .not. self%certificate%valid) then
        why = because_refused
      end if
    end associate
  end function why_other_rule

  !> Are forces, gaps or the energy out of balance, or has a pivot lost too many digits?
  pure integer function why_refine(self) result(why)
    class(solution_type), intent(in) :: self

    why = merge(because_unbalanced, 0, self%answer%converged .and. &
                .not. (self%certificate%balanced .and. self%answer%lost() <= lost_digits))
  end function why_refine

  !> Find nodes that penetrate without a pair, and make pairs for them.
  subroutine why_more_pairs(self, why)
    class(solution_type), intent(inout) :: self
    integer, intent(out) :: why
    type(line_contact), allocatable :: contacts(:)
    logical :: near

    why = 0
    if (self%answer%failed_body > 0) return
    call find_nodes_that_came_near(self%model, self%answer%displacement, self%answer%contact%touching, &
                                   contacts, near)
    if (.not. near) return
    if (.not. allocated(self%as_given)) self%as_given = self%planned_model
    call pair_nodes_that_came_near(self%model, contacts, near)
    if (near) why = because_near
  end subroutine why_more_pairs

  !> Solve the model as planned.
  subroutine solve_as_planned(self, limit, watch, error)
    class(solution_type), intent(inout) :: self
    real(wp), intent(in) :: limit
    class(observer), intent(inout) :: watch
    type(error_type), allocatable, intent(out) :: error

    call check_memory(self%expected%bytes, limit, error)
    if (allocated(error)) return
    self%iteration%threads = plan_threads(self%numbering, self%expected%bytes, granted_threads())
    call watch%expect(self%expected%operations)
    call self%follow(self%model%controls%load_steps, watch)
  end subroutine solve_as_planned

  !> Follow the loads in this number of load steps, and evaluate the state found.
  subroutine follow(self, load_steps, watch)
    class(solution_type), intent(inout) :: self
    integer, intent(in) :: load_steps    !! of this load case, if something can yield
    class(observer), intent(inout) :: watch
    type(iteration_plan) :: plan
    type(answer_type) :: none
    type(certificate_type) :: no_certificate

    self%answer = none
    self%certificate = no_certificate
    plan = self%iteration
    if (plan%yields) plan%load_steps = load_steps
    self%model%loads = self%loads
    associate (kept => self%kept, answer => self%answer)
      call follow_loads(self%planned_model, plan, kept%another, kept%linear, kept%virgin, &
                        answer%followed_loads, watch)
      if (kept%linear%rule%failed .or. answer%failed_body > 0 .or. &
          answer%contact%state /= contact_solved) return
      self%unique = kept%linear%rule%is_unique(self%planned_model, kept%linear%factored_bodies)
    end associate
    call watch%lap(stage_contact)
    if (self%unique) call self%evaluate(watch)
  end subroutine follow

  !> Refine the answer. Gaps far below a prescribed displacement are rounding, and contact forces from them
  !! have a residual. Values that the certificate finds worse are not used.
  subroutine refine(self, steps, watch)
    class(solution_type), intent(inout) :: self
    integer, intent(out) :: steps        !! number of steps taken
    class(observer), intent(inout) :: watch
    type(answer_type) :: found           ! before refinement
    type(certificate_type) :: found_certificate

    found = self%answer
    found_certificate = self%certificate
    steps = 0
    do
      call self%kept%linear%sharpen(self%planned_model, self%answer%solved_state, &
                                    self%answer%last_correction, watch)
      if (self%answer%last_correction >= huge(1.0_wp)) exit
      steps = steps + 1
      call self%evaluate(watch)
      if (steps == most_refinements .or. self%why_refine() == 0 .and. &
          self%answer%last_correction <= lost_digits) exit
    end do
    if (.not. self%certificate%has_spoilt(found_certificate)) return
    self%answer = found
    self%certificate = found_certificate
  end subroutine refine

  !> Return to the model without the pairs of nodes that came near in this load case, so that other load cases
  !! are solved independently.
  subroutine return_to_given(self)
    class(solution_type), intent(inout) :: self

    if (.not. allocated(self%as_given)) return
    self%planned_model = self%as_given
    deallocate (self%as_given)
    call self%kept%forget()
  end subroutine return_to_given

  !> Discard the factors: they are made again for the next solve, or are not needed.
  subroutine forget(self)
    class(kept_factors), intent(inout) :: self
    type(kept_estimates) :: none
    type(contact_line) :: no_line

    if (allocated(self%linear)) deallocate (self%linear)
    if (allocated(self%virgin)) deallocate (self%virgin)
    self%estimates = none
    self%line = no_line
  end subroutine forget

  !> Find stresses, pressures and zones of the state found, and its certificate.
  subroutine evaluate(self, watch)
    class(solution_type), intent(inout) :: self
    class(observer), intent(inout) :: watch
    logical, allocatable :: touching(:)

    associate (model => self%model, kept => self%kept, answer => self%answer)
      if (.not. allocated(kept%line%node)) kept%line = find_contact_line(model)
      if (kept%linear%materials%yields .and. .not. allocated(answer%point)) &
        answer%point = kept%linear%materials%states(answer%strain)
      associate (force => answer%contact%force, volume => kept%linear%operator%volume)
        call recover_stresses(model, kept%linear, &
                              model%loads%load + pair_forces(model, force), &
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
        call certify(model, answer, self%iteration%off_curve, self%certificate)
        if (answer%converged .and. self%certificate%valid) &
          self%certificate%scene = look_through(model, answer%displacement, force)
      end associate
    end associate
    call watch%lap(stage_certificate)
  end subroutine evaluate

  !> Estimate the errors of the answer with its tangent stiffness, for every method and step.
  subroutine assess_answer(self, watch)
    class(solution_type), intent(inout) :: self
    class(observer), intent(inout) :: watch
    type(newton_method) :: tangent
    integer :: failed_body

    associate (answer => self%answer, kept => self%kept)
      if (answer%converged .and. .not. self%model%controls%paper_ratio .and. any(answer%plastic)) then
        if (self%iteration%method /= method_newton .and. &
            .not. answer%history(size(answer%history))%by_tangent) then
          call linearise(self%planned_model, tangent, answer%solved_state, kept%linear, watch)
          call factor_law(self%planned_model, tangent, answer%solved_state, kept%linear, failed_body, watch)
          if (failed_body > 0) answer%condition = huge(1.0_wp)
        end if
      end if
      call assess(self%planned_model, kept%linear, kept%line, kept%estimates, answer, self%accuracy)
      ! an open pair has no pressure
      where (.not. answer%contact%touching .and. answer%pressure > 0.0_wp) answer%pressure = -1.0_wp
    end associate
    call watch%lap(stage_accuracy)
  end subroutine assess_answer
end module epcont_solution
