!> Iteration to equilibrium at one load, for any method.
module epcont_plasticity_equilibrium_iteration
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: solved_to
  use epcont_contact_problem, only: contact_solved, contact_stalled
  use epcont_element_kinematics, only: components, directions
  use epcont_linear_linear_problem, only: linear_problem, new_linear_problem
  use epcont_linear_solved_state, only: solved_state
  use epcont_material_linear_law, only: elastic_law
  use epcont_model_expansion, only: find_free_strains
  use epcont_model_load_set, only: load_set
  use epcont_model_controls, only: method_inistr, method_newton, method_secant
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_planned_model, only: planned_model
  use epcont_plasticity_choose_method, only: choose_method, mixes
  use epcont_plasticity_error_estimate, only: error_estimate, finite_ratio
  use epcont_plasticity_law_of_state, only: factor_law, linearise
  use epcont_plasticity_newton, only: newton_method
  use epcont_plasticity_observer, only: iteration_record, observer
  use epcont_plasticity_path_end, only: path_end
  use epcont_plasticity_secant, only: secant_method
  use epcont_system_stopwatch, only: stage_yielding
  implicit none
  private
  public :: equilibrium_iteration

  !> If displacements are this multiple of those of the first solve, with a perfectly plastic curve, nothing
  !! carries the load.
  real(wp), parameter :: far_away = 1.0e4_wp
  !> The error estimate is tested by a tangent step after few solves, after many, if the remaining error is a
  !! large multiple of the last change (slow convergence), with acceleration, and with prescribed
  !! displacements, which hide the error in the largest displacement.
  integer, parameter :: few_solves = 4, many_solves = 8
  real(wp), parameter :: slow = 3.0_wp
  !> A tangent step that shows more than this multiple of the estimate is not a test of it.
  real(wp), parameter :: most_doubt = 1.0e2_wp
  !> A tangent with at least this part of the secant matrix is not used for the test.
  real(wp), parameter :: too_stiff = 1.0e-3_wp
  !> Changes that stop decreasing are rounding up to this part of the largest displacement; larger ones are a
  !! failure.
  real(wp), parameter :: stagnant = 1.0e-3_wp

  type :: equilibrium_iteration
    type(iteration_plan) :: plan                    !! method and tolerances; may differ from the model's
    type(linear_problem), allocatable :: linear     !! as after the last solve
    !> With factors of the unloaded state, if another load case needs them and the model yields
    type(linear_problem), allocatable :: virgin
    type(load_set) :: start                         !! loads at the start of the path; no `load`: unloaded
    type(load_set), allocatable :: last             !! at its end, if it has several load steps
    real(wp) :: load_factor = 1.0_wp                !! part of the path
    type(solved_state), allocatable :: state         !! state at this load
    type(solved_state) :: committed                  !! state before it: the last committed one
    logical :: converged = .false.
    logical :: runs_away = .false.                  !! no equilibrium: displacements grow without end
    integer :: failed_body = 0                      !! body that could not be factored
    type(iteration_record), allocatable :: history(:)   !! every solve
    type(solved_state), private :: about             !! state about which the law is linear
    type(iteration_record), private :: now          !! the last solve
    !> Total theory: stresses of the first solve, of elastic bodies [components, points]
    real(wp), allocatable :: first_stress(:, :)
    logical, allocatable :: touching(:)             !! active set, from which the next search starts [pairs]
    real(wp), allocatable, private :: force(:)      !! the last contact forces [force] [pairs]
    type(error_estimate), private :: estimate
    integer, private :: factored_before = 0         !! bodies, for load cases before
    integer, private :: yielded = 0                 !! points that yield in the state that the law is about
    logical, private :: stiff = .false.             !! the model has been factored
    logical, private :: elastic = .false.           !! with the law of a state that has not yielded
  contains
    procedure :: begin
    procedure :: take_loads
    procedure :: iterate
    procedure :: go_back
    procedure :: return_to
    procedure :: factorizations
    procedure, private :: put_loads
    procedure, private :: set_law
    procedure, private :: judge
    procedure, private :: measure
    procedure, private :: is_over
    procedure, private :: wants_test
    procedure, private :: step_by_tangent
  end type equilibrium_iteration

contains

  !> Begin at the start of the path. The first load case is one without `linear`; the others have it from the
  !! one before, and the factors of the unloaded state.
  subroutine begin(self, scene, from)
    class(equilibrium_iteration), intent(inout) :: self
    type(planned_model), intent(inout) :: scene     !! gets the loads of the first load step
    class(path_end), intent(in), optional :: from   !! start of the path; absent: unloaded

    if (self%plan%load_steps > 1 .or. present(from)) self%last = scene%model%loads
    if (present(from)) self%start = from%loads
    associate (contact => scene%model%contact)
      contact%slipped = spread(0.0_wp, 1, size(contact%sliding))
      if (present(from)) contact%slipped = contact%slides(from%state%displacement)
    end associate
    call self%put_loads(scene, 1.0_wp/self%plan%load_steps)
    if (allocated(self%virgin)) self%linear = self%virgin
    self%stiff = allocated(self%linear)
    self%elastic = self%stiff
    if (self%stiff) then
      call self%linear%take_case(scene)
      call move_alloc(self%linear%touching, self%touching)
    else
      allocate (self%linear)
      call new_linear_problem(scene, self%plan, self%linear)
    end if
    associate (linear => self%linear, model => scene%model)
      self%factored_before = linear%factorizations
      linear%rule%keeps = self%plan%keeps .and. .not. linear%materials%yields
      if (allocated(linear%materials%committed)) deallocate (linear%materials%committed)   ! of another case
      if (present(from)) then
        if (allocated(from%history)) linear%materials%committed = from%history
        self%committed = from%state
      else
        allocate (self%committed%displacement(directions, model%mesh%nodes), source=0.0_wp)
        allocate (self%committed%strain(components, model%mesh%points), source=0.0_wp)
      end if
      if (linear%materials%yields) self%committed%point = linear%materials%states(self%committed%strain)
      allocate (self%force(model%contact%pairs), source=0.0_wp)
    end associate
    call self%go_back()
    allocate (self%history(0))
  end subroutine begin

  !> Put the loads of a part of the path on the model.
  subroutine take_loads(self, scene, part)
    class(equilibrium_iteration), intent(inout) :: self
    type(planned_model), intent(inout) :: scene
    real(wp), intent(in) :: part   !! from 0 to 1

    call self%put_loads(scene, part)
    call self%linear%take_case(scene)
  end subroutine take_loads

  !> Put the loads of a part of the path on the model, before its bodies are known.
  subroutine put_loads(self, scene, part)
    class(equilibrium_iteration), intent(inout) :: self
    type(planned_model), intent(inout) :: scene
    real(wp), intent(in) :: part   !! from 0 to 1

    self%load_factor = part
    if (.not. allocated(self%last)) return
    call scene%model%loads%set_between(self%start, self%last, part)
    call find_free_strains(scene%model)
  end subroutine put_loads

  !> Iterate at one load. The result is the last state, or if this has not converged, the state closest to
  !! equilibrium.
  subroutine iterate(self, scene, watch)
    class(equilibrium_iteration), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(observer), intent(inout) :: watch         !! takes the time, and is called after each solve
    class(secant_method), allocatable :: method
    type(solved_state), allocatable :: found
    real(wp) :: farthest, least_residual, travel
    integer :: iteration

    self%converged = .false.
    least_residual = huge(1.0_wp)
    if (allocated(self%state)) deallocate (self%state)
    allocate (self%state, found)
    ! The law may be the tangent of the last step.
    if (.not. self%stiff) self%linear%law = elastic_law(self%linear%materials)
    call choose_method(self%plan, method)
    call self%estimate%begin()
    do iteration = 1, scene%model%controls%most_iterations
      call self%set_law(scene, method, watch)
      if (self%failed_body > 0) return
      call self%linear%solve(scene, self%touching, found, watch)
      if (found%contact%state /= contact_solved) then
        ! No contact about a later state, such as one beyond the limit load: the previous state is the result,
        ! not converged.
        if (iteration == 1 .or. found%contact%state /= contact_stalled) call move_alloc(found, self%state)
        return
      end if
      self%now = iteration_record(iteration=iteration)
      call self%judge(scene, found, watch)
      travel = maxval(abs(found%displacement))
      if (iteration == 1) farthest = far_away*travel
      if (self%linear%materials%yields .and. .not. (scene%model%controls%by_increments .or. &
          allocated(self%first_stress))) self%first_stress = found%point_stress
      ! Do not report a diverged state: its numbers may be close to overflow.
      self%runs_away = .not. self%converged .and. scene%model%sections%has_flat_curve() .and. &
        travel > farthest
      if (self%runs_away) return
      if (.not. self%plan%from_first_pivot) self%touching = found%contact%touching
      self%force = found%contact%force
      ! After the last load step no linearisation is needed.
      if (self%linear%materials%yields .and. .not. (self%converged .and. self%load_factor >= 1.0_wp)) &
        call method%advance(scene%model, self%linear, found, self%about)
      call watch%lap(stage_yielding)
      call watch%solved(self%now)
      if (.not. self%converged .and. self%now%residual > least_residual) cycle
      least_residual = self%now%residual
      call move_alloc(found, self%state)
      if (self%converged) return
      if (allocated(self%state%point)) deallocate (self%state%point)
      allocate (found)
    end do
  end subroutine iterate

  !> Return to the committed state, to continue with other loads. It may have other pairs.
  subroutine go_back(self)
    class(equilibrium_iteration), intent(inout) :: self

    self%about = self%committed
    if (.not. allocated(self%about%contact%force)) return
    if (size(self%about%contact%force) /= size(self%force)) return
    self%force = self%about%contact%force
    self%touching = self%about%contact%touching
  end subroutine go_back

  !> Return to an earlier state: its loads, and the stiffness about it.
  subroutine return_to(self, scene, state, part, watch)
    class(equilibrium_iteration), intent(inout) :: self
    type(planned_model), intent(inout) :: scene
    type(solved_state), intent(in) :: state
    real(wp), intent(in) :: part                    !! of the path
    class(observer), intent(inout) :: watch
    class(secant_method), allocatable :: method

    call self%take_loads(scene, part)
    self%about = state
    self%stiff = self%stiff .and. self%plan%method == method_inistr   ! it is elastic at any load
    call choose_method(self%plan, method)
    call self%set_law(scene, method, watch)
  end subroutine return_to

  !> Count the factored bodies.
  pure integer function factorizations(self)
    class(equilibrium_iteration), intent(in) :: self

    factorizations = self%linear%factorizations - self%factored_before
  end function factorizations

  !> Set the law about the last state and make its stiffness, unless a body cannot be factored.
  subroutine set_law(self, scene, method, watch)
    class(equilibrium_iteration), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(secant_method), intent(inout) :: method
    class(observer), intent(inout) :: watch

    self%failed_body = 0
    method%blend = 0.0_wp
    self%yielded = 0
    if (allocated(self%about%point)) self%yielded = count(self%about%point%yielded)
    call linearise(scene, method, self%about, self%linear, watch)
    if (self%stiff .and. (self%plan%method == method_inistr .or. self%elastic .and. self%yielded == 0)) return
    self%elastic = self%yielded == 0
    call factor_law(scene, method, self%about, self%linear, self%failed_body, watch)
    self%stiff = .true.
    if (self%plan%keeps .and. self%elastic .and. self%linear%materials%yields .and. &
        .not. allocated(self%virgin)) self%virgin = self%linear
  end subroutine set_law

  !> Record a solve, and decide whether it is the last one, or a tangent step is next.
  subroutine judge(self, scene, found, watch)
    class(equilibrium_iteration), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    type(solved_state), allocatable, intent(inout) :: found
    class(observer), intent(inout) :: watch

    call self%measure(scene, found)
    associate (now => self%now)
      call self%estimate%estimate(self%about, found, self%force, mixes(self%plan), now)
      if (now%yielded + self%yielded == 0 .or. now%residual <= solved_to .and. now%error < 0.0_wp) then
        now%error = merge(now%change, 0.0_wp, now%iteration > 1)   ! changes are only rounding
        now%force_error = merge(now%force_change, 0.0_wp, now%iteration > 1)
      end if
    end associate
    self%history = [self%history, self%now]
    self%converged = self%is_over()
    if (self%converged .and. self%wants_test(scene)) call self%step_by_tangent(scene, found, watch)
  end subroutine judge

  !> Measure the change from the last state, and the stress error. Equilibrium and contact are exact in each
  !! solve, so these are the only residuals.
  subroutine measure(self, scene, found)
    class(equilibrium_iteration), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    type(solved_state), intent(inout) :: found         !! its points are set here

    associate (now => self%now, materials => self%linear%materials)
      now%load_factor = self%load_factor
      now%change = finite_ratio(maxval(abs(found%displacement - self%about%displacement)), &
                         maxval(abs(found%displacement)))
      now%force_change = finite_ratio(maxval(abs(found%contact%force - self%force)), &
                                      maxval(found%contact%force))
      now%touching = count(found%contact%touching)
      now%pivots = found%contact%pivots
      if (.not. materials%yields) return
      found%point = materials%states(found%strain)
      call materials%measure(scene%model, found%point, found%point_stress, now%residual, now%yielded)
    end associate
  end subroutine measure

  !> Is the iteration over? It is if the change of displacements and the estimated error are within tolerance.
  !! If nothing has yielded, the first solve was exact. If the stress error is rounding and changes stop
  !! decreasing, rounding allows no smaller ones.
  pure logical function is_over(self)
    class(equilibrium_iteration), intent(in) :: self

    associate (now => self%now, plan => self%plan)
      is_over = now%yielded + self%yielded == 0
      if (now%change <= plan%tolerance .and. now%residual <= plan%off_curve) is_over = is_over .or. &
        now%residual <= solved_to .or. now%error >= 0.0_wp .and. &
        self%estimate%doubt*now%error <= plan%tolerance
      if (now%iteration > 3 .and. now%residual <= solved_to .and. now%change <= stagnant) &
        is_over = is_over .or. now%change >= self%history(size(self%history) - 2)%change
    end associate
  end function is_over

  !> Is the error estimate to be tested, and is there a tangent for it?
  pure logical function wants_test(self, scene)
    class(equilibrium_iteration), intent(in) :: self
    type(planned_model), intent(in) :: scene

    associate (now => self%now, method => self%plan%method)
      wants_test = method /= method_secant .or. now%iteration <= few_solves .or. &
                   now%iteration > many_solves .or. now%error > slow*now%change .or. &
                   any(scene%model%loads%prescribed /= 0.0_wp)
      wants_test = wants_test .and. now%residual > solved_to .and. method /= method_newton .and. &
                   .not. (scene%model%controls%paper_ratio .or. scene%model%controls%by_increments)
    end associate
  end function wants_test

  !> Make the last step with the tangent: its change is the remaining error. If this exceeds the tolerance,
  !! restore the previous state, with less trust in the estimates.
  subroutine step_by_tangent(self, scene, found, watch)
    class(equilibrium_iteration), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    type(solved_state), allocatable, intent(inout) :: found
    class(observer), intent(inout) :: watch
    type(newton_method) :: tangent
    type(solved_state), allocatable :: next
    type(solved_state) :: before
    type(iteration_record) :: last

    self%converged = .false.
    if (self%now%iteration == scene%model%controls%most_iterations) return
    before = self%about
    last = self%now
    self%about = found
    self%force = found%contact%force
    self%now%iteration = self%now%iteration + 1
    self%now%change = huge(1.0_wp)
    allocate (next)
    self%stiff = .false.   ! no factors of a tangent are reused
    call self%set_law(scene, tangent, watch)
    if (self%failed_body == 0 .and. tangent%blend < too_stiff) then
      call self%linear%solve(scene, found%contact%touching, next, watch)
      if (next%contact%state == contact_solved) call self%measure(scene, next)
    end if
    self%failed_body = 0
    self%converged = self%now%change <= self%plan%tolerance .and. self%now%residual <= self%plan%off_curve
    if (self%converged) then
      self%now%error = self%now%change
      self%now%force_error = self%now%force_change
      self%now%by_tangent = .true.
      self%history = [self%history, self%now]
      call move_alloc(next, found)
    else
      self%estimate%doubt = max(2.0_wp*self%estimate%doubt, min(self%now%change/last%error, most_doubt))
      self%now = last
      self%about = before
      self%linear%law = elastic_law(self%linear%materials)
    end if
    self%stiff = .false.
  end subroutine step_by_tangent
end module epcont_plasticity_equilibrium_iteration
