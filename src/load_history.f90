!> Loads of a load case, followed to their end: the result, checked and evaluated. In flow theory each
!> increment is checked, the next load case of a sequence starts from the end of this one, and a second run
!> with another number of increments shows their error.
module epcont_load_history
  use epcont_base_archive, only: archive
  use epcont_base_kinds, only: wp
  use epcont_certificate_certificate, only: certificate_type
  use epcont_certificate_increment_work, only: work_state, work_without_end
  use epcont_contact_problem, only: contact_solved
  use epcont_evaluation, only: evaluated_model
  use epcont_model_load_set, only: load_set
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plasticity_load_path, only: load_path
  use epcont_plasticity_observer, only: observer
  use epcont_plasticity_path_end, only: path_end
  use epcont_result_answer, only: answer_type
  use epcont_result_increment, only: errors_of_increments, increment_errors, increment_of, increment_record, &
      other_number, state_to_draw
  use epcont_system_stopwatch, only: stage_contact, stage_stiffness
  implicit none
  private
  public :: loaded_model

  !> If PARAM ACCURACY chooses the number of increments: the first and the largest number.
  integer, parameter :: first_steps = 8, most_steps = 256

  !> End of a load case, from which the next one of a sequence starts.
  type, extends(path_end) :: case_end
    type(work_state) :: worked   !! of the certificate
  end type case_end

  type, extends(evaluated_model) :: loaded_model
    logical :: unique = .true.           !! contact forces are unique, as far as the contact solver must know
    type(increment_record), allocatable :: increment(:)   !! flow theory: increments of this load case [any]
    type(increment_errors), allocatable :: increment_error   !! not allocated: unknown
    integer, private :: increments = 0   !! in this list so far
    logical :: keeps_states = .false.    !! keep the state after each increment, for a drawing
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
    procedure :: has_end
    procedure :: pass_ends
    procedure, private :: has_memory
    procedure, private :: follow_path
    procedure, private :: check_increment
    procedure, private :: begin_replay
    procedure, private :: follow_others
    procedure, private :: is_fine_enough
    procedure, private :: take_as_other
    procedure, private :: errors
    procedure, private :: end_figures
    procedure :: is_flow
    procedure, private :: end_of
    procedure, private :: add_increment
    procedure, private :: make_room
  end type loaded_model

contains

  !> Begin a load case, whose loads the model has.
  pure subroutine begin_case(self)
    class(loaded_model), intent(inout) :: self

    if (self%iteration%follows) self%loads = self%model%loads   ! else the path has one step, which keeps them
    if (allocated(self%increment_error)) deallocate (self%increment_error)
    if (allocated(self%start) .and. .not. self%is_flow()) deallocate (self%start)
  end subroutine begin_case

  !> Follow the loads in this number of load steps, and evaluate the state found.
  subroutine follow(self, load_steps, watch)
    class(loaded_model), intent(inout) :: self
    integer, intent(in) :: load_steps    !! of this load case, if something can yield
    class(observer), intent(inout) :: watch
    type(certificate_type) :: none
    logical :: complete

    if (allocated(self%increment)) deallocate (self%increment)
    allocate (self%increment(0))
    self%increments = 0
    self%certificate = none
    call self%begin_replay()
    call self%follow_path(load_steps, .true., watch, complete)
    associate (rule => self%kept%linear%rule, answer => self%answer)
      if (.not. rule%failed .and. answer%failed_body == 0 .and. answer%contact%state == contact_solved) then
        self%unique = rule%is_unique(self%planned_model, self%kept%linear%factored_bodies)
        call rule%find_others(self%answer%contact)
        call watch%lap(stage_contact)
        if (self%unique) call self%evaluate(watch)
      end if
    end associate
  end subroutine follow

  !> Follow the loads, until a load step does not converge. In flow theory each increment is committed.
  subroutine follow_path(self, load_steps, is_result, watch, complete)
    class(loaded_model), intent(inout) :: self
    integer, intent(in) :: load_steps
    logical, intent(in) :: is_result   !! evaluate each increment; false: only for the error of the increments
    class(observer), intent(inout) :: watch
    logical, intent(out) :: complete   !! all loads are applied
    type(answer_type) :: none
    type(iteration_plan) :: plan
    type(load_path) :: path

    self%answer = none
    plan = self%iteration
    if (plan%follows) plan%load_steps = load_steps
    if (plan%follows) self%model%loads = self%loads
    plan%keeps = self%kept%another .or. .not. is_result
    associate (kept => self%kept, answer => self%answer)
      if (is_result) then
        if (allocated(self%start)) call answer%begin_at(self%start, self%model%contact%pairs)
        call path%begin(self%planned_model, plan, kept%linear, kept%virgin, self%start)
      else
        call path%begin(self%planned_model, plan, kept%linear, kept%virgin, self%other_start)
      end if
      call watch%lap(stage_stiffness)
      do
        call path%advance(self%planned_model, kept%linear, answer, watch)
        if (.not. answer%converged .or. answer%lost_contact .or. path%is_complete()) exit
        if (.not. self%model%controls%by_increments) cycle
        if (is_result) then
          call self%check_increment(path%iterations(), watch)
          if (.not. self%certificate%valid) exit
        end if
        call path%commit(self%planned_model, kept%linear, answer)
        if (is_result) self%worked = self%certificate%worked
      end do
      complete = path%is_complete()
      call path%finish(kept%linear, kept%virgin, answer)
    end associate
  end subroutine follow_path

  !> Evaluate and check an increment, and add it to the list.
  subroutine check_increment(self, iterations, watch)
    class(loaded_model), intent(inout) :: self
    integer, intent(in) :: iterations   !! solves up to its end
    class(observer), intent(inout) :: watch
    integer :: refinements

    call self%evaluate(watch)
    if (self%is_unbalanced()) call self%refine(refinements, watch)
    if (self%certificate%valid) call self%add_increment(iterations)
  end subroutine check_increment

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
        self%other_steps = self%steps
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
    self%other_end = self%end_of()
    if (self%iteration%yields) deallocate (self%kept%linear)   ! it has the tangent of the end
  end subroutine take_as_other

  !> Errors by the size of the increments, from both runs.
  pure type(increment_errors) function errors(self)
    class(loaded_model), intent(in) :: self

    errors = errors_of_increments(self%end_figures(), self%other, self%steps, self%other_steps)
  end function errors

  !> Figures at the end of a load case, with the stresses.
  pure type(increment_record) function end_figures(self)
    class(loaded_model), intent(in) :: self

    end_figures = increment_of(self%answer, size(self%answer%history), self%model%contact%sliding)
    end_figures%stress = self%answer%stress
    if (allocated(self%answer%contact%friction_force)) &
      end_figures%friction = self%answer%contact%friction_force
  end function end_figures

  !> Follow the loads in another number of increments, for their error.
  subroutine follow_others(self, watch)
    class(loaded_model), intent(inout) :: self
    class(observer), intent(inout) :: watch
    logical :: complete

    if (allocated(self%other)) deallocate (self%other)
    call self%follow_path(self%other_steps, .false., watch, complete)
    if (self%answer%converged .and. complete) then
      call self%find_results(watch)
      call self%take_as_other()
    else
      deallocate (self%kept%linear)   ! it has the tangent of the end
    end if
  end subroutine follow_others

  !> Add an increment to the list.
  pure subroutine add_increment(self, iterations)
    class(loaded_model), intent(inout) :: self
    integer, intent(in) :: iterations   !! solves up to its end

    if (self%increments == size(self%increment)) call self%make_room(max(1, 2*self%increments))
    self%increments = self%increments + 1
    associate (now => self%increment(self%increments), worked => self%certificate%worked)
      now = increment_of(self%answer, iterations, self%model%contact%sliding)
      now%friction_work = worked%friction_work
      now%dissipated = worked%dissipated
      if (self%increments > 1) &
        now%dissipated = now%dissipated + self%increment(self%increments - 1)%dissipated
      if (self%keeps_states) now%state = state_to_draw(self%answer)
    end associate
  end subroutine add_increment

  !> Change the length of the list. gfortran 12 leaks an array constructor of such a type.
  pure subroutine make_room(self, length)
    class(loaded_model), intent(inout) :: self
    integer, intent(in) :: length   !! at least the number of increments
    type(increment_record), allocatable :: list(:)

    allocate (list(length))
    list(:self%increments) = self%increment(:self%increments)
    call move_alloc(list, self%increment)
  end subroutine make_room

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

    if (allocated(self%worked)) deallocate (self%worked)
    if (.not. (self%is_flow() .or. self%model%controls%sequence)) return
    if (allocated(self%start)) then
      self%worked = self%start%worked
    else
      self%worked = work_without_end(self%model)
    end if
  end subroutine begin_replay

  !> End a load case: add its last increment, estimate the error of the increments, and keep its end for the
  !! next one of a sequence. Elastic bodies without contact do not depend on the loads before, but friction in
  !! the next one does.
  subroutine end_case(self, valid)
    class(loaded_model), intent(inout) :: self
    logical, intent(in) :: valid   !! the answer is valid

    if (valid .and. self%is_flow()) call self%add_increment(size(self%answer%history))
    call self%make_room(self%increments)
    if (valid .and. self%is_flow() .and. allocated(self%other)) self%increment_error = self%errors()
    if (allocated(self%start)) deallocate (self%start)
    if (allocated(self%other_start)) deallocate (self%other_start)
    if (.not. (valid .and. self%model%controls%sequence)) return
    allocate (self%start)
    self%start%path_end = self%end_of()
    self%start%worked = self%certificate%worked
    if (.not. self%is_flow()) then
      self%other_start = self%start%path_end
    else if (allocated(self%other)) then
      call move_alloc(self%other_end, self%other_start)
    end if
  end subroutine end_case

  !> Store the ends of the last load case in an archive, or restore them as the start of the next one. They
  !! exist if the load case has reached its end (`has_end`).
  pure subroutine pass_ends(self, file)
    class(loaded_model), intent(inout) :: self
    type(archive), intent(inout) :: file
    logical, allocatable :: other(:)

    if (file%reading) allocate (self%start)
    call self%start%pass(file)
    call self%start%worked%pass(file)
    other = [allocated(self%other_start)]
    call file%pass(other)
    if (file%reading .and. other(1)) allocate (self%other_start)
    if (other(1)) call self%other_start%pass(file)
  end subroutine pass_ends

  !> Is there an end of a load case for the next one to start from? Friction may come with the contacts that
  !! are off in this one.
  pure logical function has_end(self)
    class(loaded_model), intent(in) :: self

    has_end = allocated(self%start) .and. (self%has_memory() .or. self%model%contact%contact_is_off)
  end function has_end

  !> Can a load case start where the one before has ended?
  pure logical function can_start(self)
    class(loaded_model), intent(in) :: self

    can_start = allocated(self%start) .or. .not. self%has_memory()
  end function can_start

  !> Are the loads followed in increments: by flow theory, or with friction?
  pure logical function is_flow(self)
    class(loaded_model), intent(in) :: self

    is_flow = self%model%controls%by_increments .and. self%iteration%follows
  end function is_flow

  !> Does the answer of a load case depend on those before?
  pure logical function has_memory(self)
    class(loaded_model), intent(in) :: self

    has_memory = self%model%controls%sequence .and. self%is_flow()
  end function has_memory
end module epcont_load_history
