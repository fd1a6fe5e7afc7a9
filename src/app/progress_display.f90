!> How far a run is, on standard error: on a terminal one line, drawn anew after each solve and erased at the
!> end; else, where it is asked for, a line a solve. And what --timing prints: where its time went.
module epcont_app_progress_display
  use epcont_app_process, only: print_error, terminal_columns
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: formatted, newline, short_real, text_of
  use epcont_plasticity_observer, only: iteration_record, observer
  use epcont_report_columns, only: rounding_number
  use epcont_system_stopwatch, only: stage_name, stages, stopwatch
  implicit none
  private
  public :: progress_type, progress_line, duration, timing_text

  !> Run time below which no progress is shown [s], and operations of a solve below which none is before it.
  real(wp), parameter :: short_run = 1.0_wp, short_solve = 2.0e10_wp

  type, extends(observer) :: progress_type
    character(len=:), allocatable, private :: stem   !! of the deck
    logical, private :: on_terminal = .false.
    real(wp), private :: silent_to = 0.0_wp          !! nothing is shown of runs that are shorter [s]
    integer, private :: drawn = 0                    !! characters that stand on the terminal
    real(wp), private :: operations = 0.0_wp         !! of a solve
  contains
    procedure :: begin
    procedure :: expect
    procedure :: solved
    procedure :: erase
  end type progress_type

contains

  !> A deck begins.
  subroutine begin(self, stem, asked, quiet)
    class(progress_type), intent(out) :: self
    character(len=*), intent(in) :: stem   !! of the deck
    logical, intent(in) :: asked   !! for every solve of every run, wherever standard error goes
    logical, intent(in) :: quiet   !! nothing but what is asked for

    self%stem = stem
    self%on_terminal = terminal_columns() > 0
    if (.not. asked) self%silent_to = merge(short_run, huge(short_run), self%on_terminal .and. .not. quiet)
    call self%start()
  end subroutine begin

  !> The plan is made; solves begin.
  subroutine expect(self, operations)
    class(progress_type), intent(inout) :: self
    real(wp), intent(in) :: operations   !! of a solve

    self%operations = operations
    call show(self, iteration_record())
  end subroutine expect

  !> A solve has been done.
  subroutine solved(self, now)
    class(progress_type), intent(inout) :: self
    type(iteration_record), intent(in) :: now   !! what it is like

    call show(self, now)
  end subroutine solved

  !> Show how far it is, where that is wanted.
  subroutine show(self, now)
    class(progress_type), intent(inout) :: self
    type(iteration_record), intent(in) :: now
    character(len=:), allocatable :: line
    integer :: width

    if (self%elapsed() < self%silent_to .and. .not. &
        (now%iteration == 0 .and. self%operations >= short_solve .and. self%silent_to <= short_run)) return
    ! A line that fills the last column may go on in the next row, where it could not be erased.
    width = merge(terminal_columns() - 1, huge(1), self%on_terminal)
    line = progress_line(self%stem, self%elapsed(), self%operations, now, width)
    if (self%on_terminal) then
      call print_error(achar(13)//line//repeat(' ', max(0, self%drawn - len(line))))
      self%drawn = max(self%drawn, len(line))
    else
      call print_error(line//newline)
    end if
  end subroutine show

  !> Take the line off the terminal, before anything else is written there.
  subroutine erase(self)
    class(progress_type), intent(inout) :: self

    if (self%drawn > 0) call print_error(achar(13)//repeat(' ', self%drawn)//achar(13))
    self%drawn = 0
  end subroutine erase

  !> Elapsed time, then the work of a solve, or what the last solve has found, in the words of the listing. Of
  !! a line that would be longer than `width` the last parts are left out, whole.
  pure function progress_line(stem, elapsed, operations, now, width) result(text)
    character(len=*), intent(in) :: stem             !! name of the deck
    real(wp), intent(in) :: elapsed                  !! [s]
    real(wp), intent(in) :: operations               !! of a solve
    type(iteration_record), intent(in) :: now        !! iteration 0: before the first solve
    integer, intent(in) :: width                     !! of the terminal, in columns
    character(len=:), allocatable :: text, more
    integer :: room

    text = stem//': '//duration(elapsed)
    more = ', solving: '//short_real(operations)//' operations'
    if (now%iteration > 0) then
      more = ', iteration '//text_of(now%iteration)//', load factor '//short_real(now%load_factor)// &
             ', change '//rounding_number(now%change)//', yielded '//text_of(now%yielded)//', touching '// &
             text_of(now%touching)
    end if
    room = max(0, width - len(text))
    if (len(text) > width) text = text(:width)
    ! A comma just behind the last column ends a part that has room.
    if (len(more) > room) more = more(:index(more(:room + 1), ',', back=.true.) - 1)
    text = text//more
  end function progress_line

  !> Seconds, minutes or hours in two or three digits.
  pure function duration(seconds) result(text)
    real(wp), intent(in) :: seconds   !! a time [s]
    character(len=:), allocatable :: text

    if (seconds < 9.95_wp) then
      text = formatted('(f4.1)', seconds)//' s'
    else if (seconds < 119.5_wp) then
      text = text_of(nint(seconds))//' s'
    else if (seconds < 119.5_wp*60) then
      text = text_of(nint(seconds/60))//' min'
    else
      text = formatted('(f12.1)', seconds/3600)//' h'
    end if
  end function duration

  !> A row a stage; each begins with the name of the deck, so that those of many decks in one file can be told
  !! apart.
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
