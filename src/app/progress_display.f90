!> How far a run is, on standard error: on a terminal one line, drawn anew after each solve and erased at the
!> end; else, where it is asked for, a line a solve.
module epcont_app_progress_display
  use epcont_app_console, only: is_terminal, newline, print_error, terminal_columns
  use epcont_base_kinds, only: wp
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plasticity_expectation, only: expectation_type, new_expectation
  use epcont_plasticity_onlooker, only: iteration_record, onlooker
  use epcont_report_progress_line, only: progress_line
  implicit none
  private
  public :: progress_type

  !> Nobody waits for runs that are shorter [s].
  real(wp), parameter :: short_run = 1.0_wp

  type, extends(onlooker) :: progress_type
    character(len=:), allocatable, private :: stem   !! of the deck
    logical, private :: shown = .false.
    logical, private :: on_terminal = .false.
    real(wp), private :: silent_to = short_run       !! nothing is shown of runs that are shorter [s]
    integer, private :: drawn = 0                    !! characters that stand on the terminal
    type(expectation_type), private :: expected
  contains
    procedure :: begin
    procedure :: expect
    procedure :: solved
    procedure :: erase
    procedure, private :: show
  end type progress_type

contains

  !> A deck begins.
  subroutine begin(self, stem, asked, quiet)
    class(progress_type), intent(out) :: self
    character(len=*), intent(in) :: stem   !! of the deck
    logical, intent(in) :: asked   !! for every solve of every run, wherever standard error goes
    logical, intent(in) :: quiet   !! nothing but what is asked for

    self%stem = stem
    self%on_terminal = is_terminal()
    self%shown = asked .or. (self%on_terminal .and. .not. quiet)
    if (asked) self%silent_to = 0.0_wp
    call self%start()
  end subroutine begin

  !> The plan is made; solves begin.
  subroutine expect(self, plan, most_iterations, operations)
    class(progress_type), intent(inout) :: self
    type(iteration_plan), intent(in) :: plan   !! how yielding is iterated
    integer, intent(in) :: most_iterations   !! at a load
    real(wp), intent(in) :: operations       !! of a solve

    if (.not. self%shown) return
    self%expected = new_expectation(plan, most_iterations, operations, self%elapsed())
    call self%show(iteration_record())
  end subroutine expect

  !> A solve has been done; `over` if it was the last at its load.
  subroutine solved(self, now, over)
    class(progress_type), intent(inout) :: self
    type(iteration_record), intent(in) :: now   !! what it is like
    logical, intent(in) :: over   !! it was the last at its load

    if (.not. self%shown) return
    call self%expected%learn(now, over, self%elapsed())
    call self%show(now)
  end subroutine solved

  subroutine show(self, now)
    class(progress_type), intent(inout) :: self
    type(iteration_record), intent(in) :: now
    character(len=:), allocatable :: line

    if (max(self%elapsed(), self%expected%seconds, self%expected%first_solve) < self%silent_to) return
    if (self%on_terminal) then
      ! A line that fills the last column may go on in the next row, where it could not be erased.
      line = progress_line(self%stem, self%elapsed(), self%expected, now, terminal_columns() - 1)
      call print_error(achar(13)//line//repeat(' ', max(0, self%drawn - len(line))))
      self%drawn = max(self%drawn, len(line))
    else
      call print_error(progress_line(self%stem, self%elapsed(), self%expected, now, huge(1))//newline)
    end if
  end subroutine show

  !> Take the line off the terminal, before anything else is written there.
  subroutine erase(self)
    class(progress_type), intent(inout) :: self

    if (self%drawn > 0) call print_error(achar(13)//repeat(' ', self%drawn)//achar(13))
    self%drawn = 0
  end subroutine erase
end module epcont_app_progress_display
