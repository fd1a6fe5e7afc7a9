!> Evaluation of a solved state: stresses, pressures and zones, certificate and error estimates.
module epcont_evaluation
  use epcont_accuracy_accuracy, only: accuracy_type, assess, kept_estimates
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits
  use epcont_certificate_certificate, only: certificate_type, certify
  use epcont_certificate_increment_work, only: work_state
  use epcont_certificate_scene, only: look_through
  use epcont_contact_problem, only: contact_solved
  use epcont_flexibility_flexibility, only: pair_forces
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_solved_state, only: solved_state
  use epcont_model_controls, only: method_newton
  use epcont_model_expansion, only: find_free_strains
  use epcont_model_load_set, only: load_set
  use epcont_model_model, only: model_type
  use epcont_plan_planned_model, only: planned_model
  use epcont_plasticity_law_of_state, only: factor_law, linearise
  use epcont_plasticity_newton, only: newton_method
  use epcont_plasticity_observer, only: observer
  use epcont_result_answer, only: answer_type, pair_sticks
  use epcont_result_body_force, only: find_body_forces
  use epcont_result_contact_line, only: contact_line, find_contact_line
  use epcont_result_displacement_gradient, only: find_gradients
  use epcont_result_line_pressure, only: compare_sides
  use epcont_result_locking, only: find_locking
  use epcont_result_pressures, only: pair_pressures
  use epcont_result_stress_path, only: find_stress_path, stress_path
  use epcont_result_stresses, only: recover_stresses
  use epcont_result_zones, only: find_zones
  use epcont_system_stopwatch, only: stage_accuracy, stage_certificate, stage_stresses
  implicit none
  private
  public :: evaluated_model

  !> Largest number of steps of refinement, used if forces, gaps or the energy have a residual, or if rounding
  !! has taken too much of a pivot. Each step gains as many digits as the factors have.
  integer, parameter :: most_refinements = 3

  !> Growth of the loads with which the loading is tested.
  real(wp), parameter :: growth = 0.01_wp

  !> Data that the next load case reuses.
  type :: kept_factors
    logical :: another = .false.         !! another load case follows
    type(linear_problem), allocatable :: linear, virgin
    type(contact_line) :: line
    type(kept_estimates) :: estimates
  contains
    procedure :: forget
  end type kept_factors

  !> A planned model with its answer, certificate and error estimates.
  type, extends(planned_model) :: evaluated_model
    type(answer_type) :: answer
    type(certificate_type) :: certificate
    type(accuracy_type) :: accuracy
    type(kept_factors) :: kept           !! from load case to load case
    !> State before the increment, for the certificate; not allocated if the loads are not followed
    type(work_state), allocatable :: worked
    type(stress_path), allocatable :: stress_path        !! total theory; not allocated: unknown
  contains
    procedure :: evaluate
    procedure :: find_results
    procedure :: is_unbalanced
    procedure :: refine
    procedure :: assess_answer
    procedure, private :: test_loading
  end type evaluated_model

contains

  !> Find stresses, pressures and zones of the state found, and its certificate.
  subroutine evaluate(self, watch)
    class(evaluated_model), intent(inout) :: self
    class(observer), intent(inout) :: watch

    call self%find_results(watch)
    associate (model => self%model, answer => self%answer)
      call certify(model, answer, self%iteration%off_curve, self%certificate, self%worked)
      if (answer%converged .and. self%certificate%valid) &
        self%certificate%scene = look_through(model, answer%displacement, answer%contact%force)
    end associate
    call watch%lap(stage_certificate)
  end subroutine evaluate

  !> Find stresses, pressures and zones of the state found.
  subroutine find_results(self, watch)
    class(evaluated_model), intent(inout) :: self
    class(observer), intent(inout) :: watch
    logical, allocatable :: touching(:)

    associate (model => self%model, kept => self%kept, answer => self%answer)
      if (.not. allocated(kept%line%node)) kept%line = find_contact_line(model)
      if (kept%linear%materials%yields .and. .not. allocated(answer%point)) &
        answer%point = kept%linear%materials%states(answer%strain)
      associate (force => answer%contact%force, volume => kept%linear%operator%volume)
        call recover_stresses(model, kept%linear, &
                              model%loads%load + pair_forces(model, answer%contact%row_forces()), &
                              answer)
        answer%locking = find_locking(model, volume, answer%stress, answer%equivalent_stress, &
            answer%secant_modulus)
        answer%gradient = find_gradients(model, volume, answer%displacement)
        touching = kept%line%in_contact(answer%contact%touching)
        answer%pressure = pair_pressures(model, kept%line, touching, force)
        answer%zones = find_zones(kept%line, touching, force, answer%pressure)
        if (model%contact%has_friction()) call find_stick_zones(model, kept%line, touching, answer)
        call compare_sides(model, answer%contact%touching, force, answer%pressure, answer%lines, answer%apart)
        answer%bodies = find_body_forces(model, answer%contact%row_forces())
      end associate
    end associate
    call watch%lap(stage_stresses)
  end subroutine find_results

  !> Find the zones that stick: the traction that is missing up to slip vanishes at their ends, like the
  !! pressure at the ends of a contact.
  subroutine find_stick_zones(model, line, touching, answer)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)           !! [pairs]
    type(answer_type), intent(inout) :: answer
    real(wp), dimension(size(touching)) :: missing, sideways
    logical :: sticking(size(touching))

    associate (contact => answer%contact, pair => model%contact%sliding, mu => model%contact%friction)
      sticking = mu > 0.0_wp   ! pairs that supports hold on a line of symmetry have no tangential row
      sideways = 0.0_wp
      sticking(pair) = answer%friction_states(pair) == pair_sticks
      sideways(pair) = contact%friction_force
      missing = 0.0_wp
      where (contact%force > 0.0_wp) &
        missing = max(answer%pressure, 0.0_wp)*max(mu*contact%force - abs(sideways), 0.0_wp)/contact%force
      answer%stick_zones = find_zones(line, touching .and. sticking, sideways, missing)
    end associate
  end subroutine find_stick_zones

  !> Are forces, gaps or the energy out of balance, or has a pivot lost too many digits?
  pure logical function is_unbalanced(self)
    class(evaluated_model), intent(in) :: self

    is_unbalanced = self%answer%converged .and. &
                    .not. (self%certificate%balanced .and. self%answer%lost() <= lost_digits)
  end function is_unbalanced

  !> Refine the answer. Gaps far below a prescribed displacement are rounding, and contact forces from them
  !! have a residual. Values that the certificate finds worse are not used.
  subroutine refine(self, steps, watch)
    class(evaluated_model), intent(inout) :: self
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
      if (steps == most_refinements) exit
      if (.not. self%is_unbalanced() .and. self%answer%last_correction <= lost_digits) exit
    end do
    if (.not. self%certificate%has_spoilt(found_certificate)) return
    self%answer = found
    self%certificate = found_certificate
  end subroutine refine

  !> Estimate the errors of the answer with its tangent stiffness, for every method and step.
  subroutine assess_answer(self, watch)
    class(evaluated_model), intent(inout) :: self
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
    call self%test_loading(watch)
  end subroutine assess_answer

  !> Test the assumptions of total theory on the loading. The stresses under slightly more load follow from
  !! the tangent.
  subroutine test_loading(self, watch)
    class(evaluated_model), intent(inout) :: self
    class(observer), intent(inout) :: watch
    type(load_set) :: loads, none
    type(solved_state) :: later

    if (allocated(self%stress_path)) deallocate (self%stress_path)
    associate (answer => self%answer, controls => self%model%controls, linear => self%kept%linear)
      if (controls%by_increments .or. controls%paper_ratio .or. .not. (answer%converged .and. &
          any(answer%plastic) .and. answer%condition < huge(1.0_wp))) return
      loads = self%model%loads
      call self%model%loads%set_between(none, loads, 1.0_wp + growth)
      call find_free_strains(self%model)
      call linear%take_case(self%planned_model)
      call linear%solve(self%planned_model, answer%contact%touching, later, watch)
      self%model%loads = loads
      if (later%contact%state == contact_solved) self%stress_path = &
        find_stress_path(self%model, answer, answer%elastic_stress, later%point_stress, growth)
    end associate
  end subroutine test_loading

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
end module epcont_evaluation
