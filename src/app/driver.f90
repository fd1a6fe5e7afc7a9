!> One deck from file to results.
module epcont_app_driver
  use epcont_app_arguments, only: arguments_type, stem_of
  use epcont_app_case_runs, only: deck_run, solve_pattern
  use epcont_app_process, only: print_error, print_text
  use epcont_app_progress_display, only: progress_type, timing_text
  use epcont_base_diagnostic, only: diagnostics
  use epcont_base_error, only: error_type, status_deck, status_valid
  use epcont_base_text, only: newline, shown
  use epcont_build_build, only: build_model, tell
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_deck_render, only: render, render_notes
  use epcont_model_load_cases, only: load_cases
  use epcont_plan_planned_model, only: planned_model
  use epcont_report_file, only: file_lock, lock_files, unlock_files
  use epcont_report_results, only: remove_results, results_type
  use epcont_report_run, only: run_results
  use epcont_system_memory, only: peak_memory
  use epcont_system_stopwatch, only: stage_model, stage_plan, stage_reading, stage_writing
  implicit none
  private
  public :: run_deck

contains

  !> From file to results, alone at work on them; what is there afterwards is of this run.
  subroutine run_deck(path, arguments, status)
    character(len=*), intent(in) :: path   !! of the deck
    type(arguments_type), intent(in) :: arguments   !! of the command line
    integer, intent(out) :: status   !! its exit status
    character(len=:), allocatable :: name, stem   ! of the deck, shown; of the results, with folder
    type(progress_type) :: watch
    type(deck_type), target :: deck
    type(load_cases), target :: cases
    type(run_results) :: run
    type(results_type) :: results
    type(error_type), allocatable :: error
    type(file_lock) :: lock
    logical :: writes, written   ! results are wanted; they are written, as far as that could be done

    status = status_valid
    run%deck => deck
    run%cases => cases
    stem = stem_of(path)
    name = shown(stem)
    if (len(arguments%directory) > 0) stem = arguments%directory//'/'//stem
    call watch%begin(name, arguments%asks('--progress'), arguments%asks('--quiet'))
    writes = .not. (arguments%asks('--check') .or. arguments%asks('--plan'))
    written = .false.
    if (writes) call lock_files(stem, lock, error)
    if (.not. allocated(error)) then
      call solve_deck()
      if (writes .and. .not. written) call remove_results(stem)
      if (writes) call unlock_files(lock)
    end if
    if (allocated(error)) then
      call print_error(shown(error%message)//newline)
      status = error%status
    end if
    if (arguments%asks('--timing')) call print_error(timing_text(name, watch, peak_memory()))

  contains

    !> From file to results, and what there is to say of it.
    subroutine solve_deck()
      call prepare(path, watch, run, error)
      if (allocated(error)) return
      if (run%faults%errors > 0) then
        call print_error(render(run%faults, run%deck%source))
        status = status_deck
        call say(arguments, name//'  rejected', status)
        return
      end if
      if (arguments%asks('--check')) then
        call say(arguments, name//'  checked', status)
      else
        run%plan_cases = size(run%cases%of_pattern(1))
        call run%make_plan(watch)
        if (arguments%asks('--plan')) call say_plans()
      end if
      call print_error(render(run%faults, run%deck%source))
      if (.not. writes) return
      run%deck_notes = render_notes(run%faults, run%deck%source)
      if (run%cases%patterns == 1) call run%deck%forget_text()
      call solve_patterns()
    end subroutine solve_deck

    !> The plans of all load cases.
    subroutine say_plans()
      integer :: p

      call results%begin(run)
      do p = 1, run%cases%patterns
        if (p > 1) call take_pattern(p)
        call results%add_plan(run, run%cases%of_pattern(p))
      end do
      call print_text(name//results%plan, status)
    end subroutine say_plans

    !> All load cases: those with the same freedoms held one after the other, since they share factors.
    subroutine solve_patterns()
      type(deck_run) :: of_deck
      integer :: p

      of_deck = deck_run(path, name, arguments%memory, arguments%asks('--quiet'))
      results%stem = stem
      results%all_tables = arguments%asks('--tables')
      results%brief = arguments%asks('--brief')
      results%vtk = arguments%asks('--vtk')
      call results%begin(run)
      do p = 1, run%cases%patterns
        if (p > 1) call take_pattern(p)
        call solve_pattern(run, run%cases%of_pattern(p), of_deck, results, watch, error)
        written = of_deck%solved
        status = max(status, of_deck%status)
        if (allocated(error)) return
        call results%add_plan(run, run%cases%of_pattern(p))
      end do
      call results%finish(run, error)
      call watch%lap(stage_writing)
    end subroutine solve_patterns

    !> The scene with other freedoms held.
    subroutine take_pattern(p)
      integer, intent(in) :: p
      type(diagnostics) :: told   ! all of it is known

      call build_model(run%deck, run%model, told, of_pattern=p)
      call run%find_motions(told)
      run%plan_cases = size(run%cases%of_pattern(p))
      call run%make_plan(watch)
    end subroutine take_pattern
  end subroutine run_deck

  !> Read and check.
  subroutine prepare(path, watch, run, error)
    character(len=*), intent(in) :: path
    type(progress_type), intent(inout) :: watch
    type(run_results), intent(inout) :: run
    type(error_type), allocatable, intent(inout) :: error

    call read_deck(path, run%deck, run%faults, error)
    call watch%lap(stage_reading)
    if (allocated(error)) return
    call build_model(run%deck, run%model, run%faults, run%cases)
    call watch%lap(stage_model)
    if (run%faults%errors > 0) return
    call run%find_motions(run%faults)
    call tell(run%deck, run%faults, 1)
    call check_patterns()
    call watch%lap(stage_plan)

  contains

    !> What is wrong with the scene where load cases hold other freedoms than the first, and not there too.
    subroutine check_patterns()
      type(planned_model) :: other
      type(diagnostics) :: faults
      integer :: i, p

      do p = 2, run%cases%patterns
        faults = diagnostics()
        call build_model(run%deck, other%model, faults, of_pattern=p)
        if (faults%errors == 0) call other%find_motions(faults)
        call tell(run%deck, faults, findloc(run%cases%case%pattern, p, dim=1))
        do i = 1, faults%count
          if (.not. run%faults%has(faults%list(i))) call run%faults%add(faults%list(i))
        end do
      end do
    end subroutine check_patterns
  end subroutine prepare

  !> A line on standard output.
  subroutine say(arguments, text, status)
    type(arguments_type), intent(in) :: arguments
    character(len=*), intent(in) :: text
    integer, intent(inout) :: status

    if (.not. arguments%asks('--quiet')) call print_text(text, status)
  end subroutine say
end module epcont_app_driver
