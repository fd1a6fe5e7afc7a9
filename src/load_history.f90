!> Loads of a load case, followed to their end: the result, checked and evaluated. In flow theory each
!> increment is checked, the next load case of a sequence starts from the end of this one, and a second run
!> with another number of increments shows their error.
module epcont_load_history
  use epcont_base_kinds, only: wp
  use epcont_certificate_certificate, only: certificate_type
  use epcont_certificate_yielding, only: replayed_history
  use epcont_contact_problem, only: contact_solved
  use epcont_evaluation, only: evaluated_model
  use epcont_model_load_set, only: load_set
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plasticity_load_path, only: load_path, path_end
  use epcont_plasticity_observer, only: observer
  use epcont_result_answer, only: answer_type
  use epcont_result_increment, only: errors_of_increments, increment_errors, increment_of, increment_record, &
      other_number
  use epcont_system_stopwatch, only: stage_contact, stage_stiffness
  implicit none
  private
  public :: loaded_model

  !> If PARAM ACCURACY chooses the number of increments: the first and the largest number.
  integer, parameter :: first_steps = 8, most_steps = 256

  !> End of a load case, from which the next one of a sequence starts.
  type, extends(path_end) :: case_end
    ! Of the certificate:
    type(replayed_history), allocatable :: replayed(:)   !! plastic history [points]
    real(wp), allocatable :: slid(:)     !! tangential displacements [length] [tangential rows]
  end type case_end

  type, extends(evaluated_model) :: loaded_model
    logical :: unique = .true.           !! contact forces are unique, as far as the contact solver must know
    type(increment_record), allocatable :: increment(:)   !! flow theory: increments of this load case [any]
    type(increment_errors), allocatable :: increment_error   !! not allocated: unknown
    integer :: steps = 1                 !! flow theory: increments of this run
    integer, private :: other_steps = 1  !! of the run to compare with
    type(load_set), private :: loads     !! of the load case; the model has those of the state found
    !> Ends of the load case before, in flow theory: of this run, and of that with other increments. Not
    !! allocated: unloaded
    type(case_end), allocatable, private :: start
    type(path_end), allocatable, private :: other_start, other_end
    type(increment_record), allocatable, private :: other   !! end of this load case with other increments
  contains
    procedure :: begin_case
    procedure :: follow
    procedure :: follow_increments
    procedure :: end_case
    procedure :: can_start
    procedure, private :: has_memory
    procedure, private :: begin_replay
    procedure, private :: follow_others
    procedure, private :: is_fine_enough
    procedure, private :: take_as_other
    procedure, private :: errors
    procedure, private :: end_figures
    procedure :: is_flow
    procedure, private :: end_of
    procedure, private :: add_increment
  end type loaded_model

contains

  !> Begin a load case, whose loads the model has.
  pure subroutine begin_case(self)
    class(loaded_model), intent(inout) :: self

    if (self%iteration%follows) self%loads = self%model%loads   ! else the path has one step, which keeps them
    if (allocated(self%increment_error)) deallocate (self%increment_error)
  end subroutine begin_case

  !> Follow the loads in this number of load steps, and evaluate the state found.
  subroutine follow(self, load_steps, watch)
    class(loaded_model), intent(inout) :: self
    integer, intent(in) :: load_steps    !! of this load case, if something can yield
    class(observer), intent(inout) :: watch
    type(iteration_plan) :: plan
    type(answer_type) :: none
    type(certificate_type) :: no_certificate
    type(load_path) :: path
    integer :: refinements

    if (allocated(self%increment)) deallocate (self%increment)
    allocate (self%increment(0))
    self%answer = none
    self%certificate = no_certificate
    plan = self%iteration
    if (plan%follows) plan%load_steps = load_steps
    if (plan%follows) self%model%loads = self%loads
    call self%begin_replay()
    associate (kept => self%kept, answer => self%answer)
      plan%keeps = kept%another
      call path%begin(self%planned_model, plan, kept%linear, kept%virgin, self%start)
      call watch%lap(stage_stiffness)
      do
        call path%advance(self%planned_model, kept%linear, answer, watch)
        if (.not. answer%converged .or. answer%lost_contact .or. path%is_complete()) exit
        if (.not. self%model%controls%flow_theory) cycle
        call self%evaluate(watch)
        if (self%is_unbalanced()) call self%refine(refinements, watch)
        if (.not. self%certificate%valid) exit
        call self%add_increment(path%iterations())
        call path%commit(self%planned_model, kept%linear, answer)
        if (allocated(self%certificate%history)) self%replayed = self%certificate%history
        self%slid = self%certificate%slid
      end do
      call path%finish(kept%linear, kept%virgin, answer)
      if (kept%linear%rule%failed .or. answer%failed_body > 0 .or. &
          answer%contact%state /= contact_solved) return
      self%unique = kept%linear%rule%is_unique(self%planned_model, kept%linear%factored_bodies)
    end associate
    call watch%lap(stage_contact)
    if (self%unique) call self%evaluate(watch)
    if (self%unique .and. self%is_flow() .and. path%is_complete()) &
      call self%add_increment(size(self%answer%history))
  end subroutine follow

  !> Follow the loads by flow theory, in another number of increments for their error, then in that of the
  !! load case. If PARAM ACCURACY chooses the number, it is doubled until the error is small enough.
  subroutine follow_increments(self, watch)
    class(loaded_model), intent(inout) :: self
    class(observer), intent(inout) :: watch

    associate (controls => self%model%controls)
      self%steps = controls%load_steps
      if (controls%steps_by_accuracy) self%steps = first_steps
      self%other_steps = other_number(self%steps)
      call self%follow_others(watch)
      do
        call self%follow(self%steps, watch)
        if (.not. controls%steps_by_accuracy .or. self%steps >= most_steps) exit
        if (self%is_fine_enough()) exit
        call self%take_as_other()
        self%steps = 2*self%steps
      end do
    end associate
  end subroutine follow_increments

  !> Is the error by the size of the increments within PARAM ACCURACY, or do more increments not help?
  pure logical function is_fine_enough(self)
    class(loaded_model), intent(in) :: self
    type(increment_errors) :: found

    is_fine_enough = .true.
    if (.not. (self%answer%converged .and. self%certificate%valid .and. allocated(self%other))) return
    if (self%answer%lost_contact) return
    found = self%errors()
    associate (wanted => self%model%controls%accuracy)
      if (size(self%answer%contact%force) > 0) then
        is_fine_enough = found%pressure <= wanted*self%answer%largest_pressure()
      else
        is_fine_enough = found%stress <= wanted*maxval(self%answer%equivalent_stress)
      end if
    end associate
  end function is_fine_enough

  !> Compare the next run with this one.
  subroutine take_as_other(self)
    class(loaded_model), intent(inout) :: self

    self%other = self%end_figures()
    self%other_steps = self%steps
    self%other_end = self%end_of()
    deallocate (self%kept%linear)   ! it has the tangent of the end
  end subroutine take_as_other

  !> Errors by the size of the increments, from both runs.
  pure type(increment_errors) function errors(self)
    class(loaded_model), intent(in) :: self

    errors = errors_of_increments(self%end_figures(), self%other, self%steps, self%other_steps)
  end function errors

  !> Figures at the end of a load case, with the stresses.
  pure type(increment_record) function end_figures(self)
    class(loaded_model), intent(in) :: self

    end_figures = increment_of(self%answer, size(self%answer%history))
    end_figures%stress = self%answer%stress
  end function end_figures

  !> Follow the loads in another number of increments, for their error.
  subroutine follow_others(self, watch)
    class(loaded_model), intent(inout) :: self
    class(observer), intent(inout) :: watch
    type(iteration_plan) :: plan
    type(answer_type) :: none
    type(load_path) :: path

    if (allocated(self%other)) deallocate (self%other)
    self%answer = none
    plan = self%iteration
    plan%load_steps = self%other_steps
    plan%keeps = .true.
    self%model%loads = self%loads
    associate (kept => self%kept, answer => self%answer)
      call path%begin(self%planned_model, plan, kept%linear, kept%virgin, self%other_start)
      do
        call path%advance(self%planned_model, kept%linear, answer, watch)
        if (.not. answer%converged .or. answer%lost_contact .or. path%is_complete()) exit
        call path%commit(self%planned_model, kept%linear, answer)
      end do
      call path%finish(kept%linear, kept%virgin, answer)
      if (answer%converged .and. path%is_complete()) then
        call self%find_results(watch)
        self%other = self%end_figures()
        self%other_end = self%end_of()
      end if
      deallocate (kept%linear)   ! it has the tangent of the end
    end associate
  end subroutine follow_others

  !> Add an increment to the list. gfortran 12 leaks an array constructor of such a type.
  pure subroutine add_increment(self, iterations)
    class(loaded_model), intent(inout) :: self
    integer, intent(in) :: iterations   !! solves up to its end
    type(increment_record), allocatable :: more(:)
    integer :: n

    n = size(self%increment)
    allocate (more(n + 1))
    more(:n) = self%increment
    more(n + 1) = increment_of(self%answer, iterations)
    call move_alloc(more, self%increment)
  end subroutine add_increment

  !> End of the loads that the model has.
  type(path_end) function end_of(self) result(last)
    class(loaded_model), intent(inout) :: self

    last%loads = self%model%loads
    last%state = self%answer%solved_state
    if (self%iteration%yields) call self%kept%linear%materials%commit(self%answer%point)
    call move_alloc(self%kept%linear%materials%committed, last%history)
  end function end_of

  !> Let the certificate begin at the start of the path.
  subroutine begin_replay(self)
    class(loaded_model), intent(inout) :: self

    if (allocated(self%replayed)) deallocate (self%replayed)
    if (allocated(self%slid)) deallocate (self%slid)
    if (.not. self%is_flow()) return
    if (allocated(self%start)) then
      if (allocated(self%start%replayed)) self%replayed = self%start%replayed
      self%slid = self%start%slid
    else if (self%iteration%yields) then
      allocate (self%replayed(self%model%mesh%points))
    end if
  end subroutine begin_replay

  !> End a load case: estimate the error of its increments, and keep its end for the next one of a sequence.
  !! Without plastic strain, equilibrium does not depend on the loads before.
  subroutine end_case(self, valid)
    class(loaded_model), intent(inout) :: self
    logical, intent(in) :: valid   !! the answer is valid

    if (valid .and. self%is_flow() .and. allocated(self%other)) self%increment_error = self%errors()
    if (allocated(self%start)) deallocate (self%start)
    if (allocated(self%other_start)) deallocate (self%other_start)
    if (.not. (valid .and. self%has_memory())) return
    allocate (self%start)
    self%start%path_end = self%end_of()
    if (allocated(self%certificate%history)) self%start%replayed = self%certificate%history
    self%start%slid = self%certificate%slid
    if (allocated(self%other)) call move_alloc(self%other_end, self%other_start)
  end subroutine end_case

  !> Can a load case start where the one before has ended?
  pure logical function can_start(self)
    class(loaded_model), intent(in) :: self

    can_start = allocated(self%start) .or. .not. self%has_memory()
  end function can_start

  !> Are the loads followed in increments: by flow theory, or with friction?
  pure logical function is_flow(self)
    class(loaded_model), intent(in) :: self

    is_flow = self%model%controls%flow_theory .and. self%iteration%follows
  end function is_flow

  !> Does the answer of a load case depend on those before?
  pure logical function has_memory(self)
    class(loaded_model), intent(in) :: self

    has_memory = self%model%controls%sequence .and. self%is_flow()
  end function has_memory
end module epcont_load_history
