!> Solve the load cases of a pattern one after the other. Each starts with the plan, the factors and the
!> contact state of the previous one. Also the texts that a run prints for a load case.
module epcont_app_case_runs
  use epcont_app_arguments, only: word_type
  use epcont_app_process, only: print_error, print_text
  use epcont_app_progress_display, only: progress_type
  use epcont_base_diagnostic, only: place_type
  use epcont_base_error, only: error_type, status_no_answer, status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: newline, plural, shown, text_of
  use epcont_messages_outcome, only: judge, limit_of_pressure, outcome_type, reason_of, remark_lines
  use epcont_model_load_cases, only: put_case
  use epcont_report_columns, only: known, listed_number, number, right
  use epcont_report_results, only: results_type
  use epcont_report_run, only: run_results
  use epcont_system_stopwatch, only: stage_writing
  implicit none
  private
  public :: deck_run, solve_pattern

  !> Names, limits and outcome of the run of a deck.
  type :: deck_run
    character(len=:), allocatable :: path   !! of the deck
    character(len=:), allocatable :: name   !! in lines of standard output
    real(wp) :: memory = huge(1.0_wp)       !! limit [GB]
    logical :: quiet = .false.              !! no lines on standard output
    logical :: solved = .false.             !! one load case or more
    integer :: status = status_valid        !! exit status: the largest of all load cases
    !> Lines for standard output and standard error of each load case that is solved, and the number of load
    !! cases for which they are printed [load cases]
    type(word_type), allocatable, private :: line(:), remarks(:)
    integer, private :: printed = 0
  contains
    procedure :: print_case
  end type deck_run

contains

  !> Solve the load cases of a pattern, store their results, and print the outcome of each.
  subroutine solve_pattern(run, cases, of_deck, results, watch, error)
    type(run_results), intent(inout) :: run         !! with the plan of the pattern
    integer, intent(in) :: cases(:)                 !! of the pattern
    type(deck_run), intent(inout) :: of_deck
    type(results_type), intent(inout) :: results
    type(progress_type), intent(inout) :: watch
    type(error_type), allocatable, intent(out) :: error
    integer :: k

    do k = 1, size(cases)
      run%case = cases(k)
      if (run%has_cases()) call put_case(run%cases, run%case, run%model)
      run%kept%another = k < size(cases)
      if (run%case == 1 .or. run%can_start()) then
        call run%solve(of_deck%memory, watch, error)
        if (allocated(error)) then
          error%message = of_deck%path//': '//error%message
          return
        end if
        run%outcome = judge(run)
        if (size(cases) > 1 .and. allocated(run%as_given)) call run%outcome%found%add_note(place_type(), &
          'nodes without a pair came near: this load case was solved again with '// &
          plural(run%model%contact%pairs - run%as_given%model%contact%pairs, 'more pair'))
      else
        run%outcome = not_solved()
        call run%attempts%begin()
        call run%kept%forget()   ! the next load case may have other contacts
      end if
      of_deck%solved = .true.
      call results%add_case(run, error)
      if (allocated(error)) return
      call watch%erase()
      call of_deck%print_case(run)
      if (size(cases) > 1) call run%return_to_given()
      call watch%lap(stage_writing)
    end do
  end subroutine solve_pattern

  !> Outcome of a load case of a sequence that could not start.
  type(outcome_type) function not_solved() result(outcome)

    outcome%status = status_no_answer
    outcome%word = 'not solved'
    outcome%sentence = 'it starts from the end of the SUBCASE before, which was not reached'
    outcome%at_load = ''
  end function not_solved

  !> Print the outcome of a load case, when those of all load cases before it in the deck are printed.
  subroutine print_case(self, run)
    class(deck_run), intent(inout) :: self
    type(run_results), intent(in) :: run   !! with the outcome

    if (.not. allocated(self%line)) &
      allocate (self%line(size(run%deck%subcase)), self%remarks(size(run%deck%subcase)))
    self%status = max(self%status, run%outcome%status)
    self%remarks(run%case)%text = remarks_of(run, self%path)
    self%line(run%case)%text = line_of(run, self%name)
    do while (self%printed < size(self%line))
      if (.not. allocated(self%line(self%printed + 1)%text)) exit
      self%printed = self%printed + 1
      call print_error(self%remarks(self%printed)%text)
      if (.not. self%quiet) call print_text(self%line(self%printed)%text, self%status)
    end do
  end subroutine print_case

  !> Make lines for standard error: warnings, and the reason if the answer is not valid, each after the name
  !! of the deck.
  pure function remarks_of(run, path) result(lines)
    type(run_results), intent(in) :: run     !! with its outcome
    character(len=*), intent(in) :: path     !! of the deck
    character(len=:), allocatable :: lines, text
    integer :: from, to

    text = remark_lines(run%outcome%found, .false.)
    if (len(run%outcome%sentence) > 0) text = text//run%outcome%sentence//newline
    lines = ''
    from = 1
    do while (from <= len(text))
      to = from + index(text(from:), newline) - 1
      lines = lines//shown(path)//case_name(run)//': '//text(from:to)
      from = to + 1
    end do
  end function remarks_of

  !> Make the line for standard output: name, status, largest pressure (with a note if it is singular or the
  !! mesh too coarse), first approach.
  pure function line_of(run, name) result(text)
    type(run_results), intent(in) :: run     !! with its outcome
    character(len=*), intent(in) :: name     !! of the deck
    character(len=:), allocatable :: limit, text

    text = name//case_name(run)//'  '//run%outcome%word//run%outcome%at_load
    if (.not. run%outcome%has_answer) return
    if (run%model%contact%pairs > 0) then
      text = text//'  p_max'//right(listed_number(known, run%answer%largest_pressure(), 0.0_wp), 13)
      limit = limit_of_pressure(run)
      if (len(reason_of(limit)) > 0) text = text//' ('//limit//')'
    end if
    if (text(len(text):) == ':') text = text(:len(text) - 1)   ! without a pressure
    if (run%motions%count > 0) &
      text = text//'  approach'//right(listed_number(number, run%answer%contact%approach(1), 0.0_wp), 13)
  end function line_of

  !> ` SUBCASE 3`; empty if the deck has one load case.
  pure function case_name(run) result(text)
    type(run_results), intent(in) :: run
    character(len=:), allocatable :: text

    text = ''
    if (run%has_cases()) text = ' SUBCASE '//text_of(run%deck%subcase(run%case)%id)
  end function case_name
end module epcont_app_case_runs
