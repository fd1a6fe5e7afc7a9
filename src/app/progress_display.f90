!> Progress of a run on standard error. On a terminal it is one line, replaced after each solve and erased at
!> the end; otherwise, if requested, one line for each solve. Also the table of --timing.
module epcont_app_progress_display
  use epcont_app_process, only: print_error, terminal_columns
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: newline, short_real, text_of
  use epcont_plasticity_observer, only: iteration_record, observer
  use epcont_report_columns, only: rounding_number
  use epcont_system_stopwatch, only: stage_name, stages, stopwatch
  implicit none
  private
  public :: progress_type, progress_line, timing_text

  !> Shortest run time with progress [s], and fewest operations of a solve with progress before it.
  real(wp), parameter :: short_run = 1.0_wp, short_solve = 2.0e10_wp

  type, extends(observer) :: progress_type
    character(len=:), allocatable, private :: stem   !! of the deck
    logical, private :: on_terminal = .false.
    real(wp), private :: silent_to = 0.0_wp          !! run time before progress is shown [s]
    integer, private :: drawn = 0                    !! number of characters on the terminal
    real(wp), private :: operations = 0.0_wp         !! of a solve
  contains
    procedure :: begin
    procedure :: expect
    procedure :: solved => show
    procedure :: erase
  end type progress_type

contains

  !> Begin the progress of a deck.
  subroutine begin(self, stem, asked, quiet)
    class(progress_type), intent(out) :: self
    character(len=*), intent(in) :: stem   !! of the deck
    logical, intent(in) :: asked   !! show every solve of every run, on any standard error
    logical, intent(in) :: quiet   !! show only requested output

    self%stem = stem
    self%on_terminal = terminal_columns() > 0
    if (.not. asked) self%silent_to = merge(short_run, huge(short_run), self%on_terminal .and. .not. quiet)
    call self%start()
  end subroutine begin

  !> Announce the solves after the plan.
  subroutine expect(self, operations)
    class(progress_type), intent(inout) :: self
    real(wp), intent(in) :: operations   !! of a solve

    self%operations = operations
    call show(self, iteration_record())
  end subroutine expect

  !> Show the progress, if requested.
  subroutine show(self, now)
    class(progress_type), intent(inout) :: self
    type(iteration_record), intent(in) :: now   !! data of the solve; iteration 0: before the first one
    character(len=:), allocatable :: line

    if (self%elapsed() < self%silent_to .and. .not. &
        (now%iteration == 0 .and. self%operations >= short_solve .and. self%silent_to <= short_run)) return
    line = progress_line(self%stem, self%elapsed(), self%operations, now)
    if (self%on_terminal) then
      ! A line that fills the last column may continue in the next row, where it cannot be erased.
      line = line(:min(len(line), terminal_columns() - 1))
      call print_error(achar(13)//line//repeat(' ', max(0, self%drawn - len(line))))
      self%drawn = max(self%drawn, len(line))
    else
      call print_error(line//newline)
    end if
  end subroutine show

  !> Erase the line on the terminal before other output.
  subroutine erase(self)
    class(progress_type), intent(inout) :: self

    if (self%drawn > 0) call print_error(achar(13)//repeat(' ', self%drawn)//achar(13))
    self%drawn = 0
  end subroutine erase

  !> Make the progress line: elapsed time, then the operations of a solve, or the results of the last solve,
  !! in the words of the listing.
  pure function progress_line(stem, elapsed, operations, now) result(text)
    character(len=*), intent(in) :: stem             !! name of the deck
    real(wp), intent(in) :: elapsed                  !! [s]
    real(wp), intent(in) :: operations               !! of a solve
    type(iteration_record), intent(in) :: now        !! iteration 0: before the first solve
    character(len=:), allocatable :: text

    text = stem//': '//text_of(nint(elapsed))//' s'
    if (now%iteration == 0) then
      text = text//', solving: '//short_real(operations)//' operations'
    else
      text = text//', iteration '//text_of(now%iteration)//', load factor '//short_real(now%load_factor)// &
             ', change '//rounding_number(now%change)//', yielded '//text_of(now%yielded)//', in contact '// &
             text_of(now%touching)
    end if
  end function progress_line

  !> Make the table of --timing, one row for each stage. Each row begins with the name of the deck, so that
  !! several decks can share a file.
  pure function timing_text(stem, watch, peak) result(text)
    character(len=*), intent(in) :: stem    !! name of the deck
    class(stopwatch), intent(in) :: watch   !! times of the stages
    integer(i8), intent(in) :: peak         !! memory [bytes]
    character(len=:), allocatable :: text
    character(len=13) :: buffer
    integer :: k

    text = stem//': stage               wall s  processor s'//newline
    do k = 1, stages
      text = text//row(stage_name(k), watch%spent(:, k))
    end do
    text = text//row('all          ', sum(watch%spent, dim=2))
    write (buffer, '(f13.1)') real(peak, wp)/1.0e6_wp
    text = text//stem//': peak memory  '//buffer//' MB'//newline

  contains

    pure function row(name, spent)
      character(len=13), intent(in) :: name
      real(wp), intent(in) :: spent(2)
      character(len=:), allocatable :: row
      character(len=39) :: line

      write (line, '(a13, 2f13.4)') name, spent
      row = stem//': '//line//newline
    end function row
  end function timing_text
end module epcont_app_progress_display
