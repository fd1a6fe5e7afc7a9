!> Solution of one model: from the plan to a certified answer, in as many attempts as necessary.
module epcont_solution
  use epcont_accuracy_accuracy, only: accuracy_type
  use epcont_attempts, only: attempt_list, attempts, because_near, because_no_contact, &
    because_not_converged, because_not_unique, because_refused, because_singular, because_unbalanced, &
    more_pairs, more_steps, other_rule, refinement
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_load_history, only: loaded_model
  use epcont_verdict, only: find_verdict, reason_none, verdict_type
  use epcont_contact_geometry_nearness, only: find_nodes_that_came_near, pair_nodes_that_came_near
  use epcont_contact_problem, only: contact_solved, contact_stalled
  use epcont_model_contact_rows, only: line_contact
  use epcont_plan_forecast, only: check_memory
  use epcont_plan_planned_model, only: planned_model
  use epcont_plan_side_by_side, only: plan_threads
  use epcont_plasticity_observer, only: observer
  use epcont_system_threads, only: granted_threads
  implicit none
  private
  public :: solution_type

  !> Factor of the number of load steps, if the planned number gives no answer.
  integer, parameter :: times_the_steps = 5

  !> A model with its answer, certificate and error estimates. There are no displacements if a body's
  !! stiffness could not be factored (`answer%failed_body`), or without contact equilibrium
  !! (`answer%contact%state`).
  type, extends(loaded_model) :: solution_type
    type(verdict_type) :: verdict
    !> The model before nodes that came near in this load case got pairs; not allocated if there were no such
    !! nodes
    type(planned_model), allocatable :: as_given
    type(attempt_list) :: attempts       !! after the first solve
  contains
    procedure :: solve
    procedure :: return_to_given
    procedure, private :: solve_as_planned
    procedure, private :: choose_attempt
    procedure, private :: make_attempt
    procedure, private :: why_more_steps
    procedure, private :: why_other_rule
    procedure, private :: why_more_pairs
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
    call self%begin_case()
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
    call self%end_case(self%verdict%reason == reason_none)
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
        why = merge(because_unbalanced, 0, self%is_unbalanced())
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
                  .not. self%is_flow() .and. size(answer%history) > 1 .and. &
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
    call self%iteration%set_tolerances(self%model%controls)
    call watch%expect(self%expected%operations)
    if (self%is_flow()) then
      call self%follow_increments(watch)
    else
      call self%follow(self%model%controls%load_steps, watch)
    end if
  end subroutine solve_as_planned

  !> Return to the model without the pairs of nodes that came near in this load case, so that other load cases
  !! are solved independently.
  subroutine return_to_given(self)
    class(solution_type), intent(inout) :: self

    if (.not. allocated(self%as_given)) return
    self%planned_model = self%as_given
    deallocate (self%as_given)
    call self%kept%forget()
  end subroutine return_to_given

end module epcont_solution
