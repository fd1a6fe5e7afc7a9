!> One deck from file to results.
module epcont_app_driver
  use epcont_app_arguments, only: arguments_type, stem_of
  use epcont_app_case_runs, only: deck_run, solve_pattern
  use epcont_app_process, only: print_error, print_text
  use epcont_app_progress_display, only: progress_type, timing_text
  use epcont_base_diagnostic, only: diagnostics
  use epcont_base_error, only: error_type, status_deck
  use epcont_base_text, only: newline, shown
  use epcont_build_build, only: build_model, tell
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_deck_render, only: render, render_notes
  use epcont_model_load_cases, only: load_cases
  use epcont_plan_planned_model, only: planned_model
  use epcont_report_file, only: file_lock, lock_files, unlock_files
  use epcont_report_restart, only: restore_end, save_end
  use epcont_report_results, only: remove_results, results_type
  use epcont_report_run, only: run_results
  use epcont_system_memory, only: peak_memory
  use epcont_system_stopwatch, only: stage_model, stage_plan, stage_reading, stage_writing
  implicit none
  private
  public :: run_deck

contains

  !> Read, solve and write one deck. A lock keeps other runs from the results; older ones are removed.
  subroutine run_deck(path, arguments, status)
    character(len=*), intent(in) :: path   !! of the deck
    type(arguments_type), intent(in) :: arguments   !! of the command line
    integer, intent(out) :: status   !! exit status of the deck
    character(len=:), allocatable :: stem   ! of the results, with folder
    type(deck_run) :: of_deck
    type(progress_type) :: watch
    type(deck_type), target :: deck
    type(load_cases), target :: cases
    type(run_results) :: run
    type(error_type), allocatable :: error
    type(file_lock) :: lock
    logical :: writes

    run%deck => deck
    run%cases => cases
    stem = stem_of(path)
    of_deck%path = path   ! one by one: gfortran 12 leaks a function's result in a structure constructor
    of_deck%name = shown(stem)
    of_deck%memory = arguments%memory
    of_deck%quiet = arguments%asks('--quiet')
    if (len(arguments%directory) > 0) stem = arguments%directory//'/'//stem
    call watch%begin(of_deck%name, arguments%asks('--progress'), of_deck%quiet)
    writes = .not. (arguments%asks('--check') .or. arguments%asks('--plan'))
    if (writes) call lock_files(stem, lock, error)
    if (.not. allocated(error)) then
      call solve_deck()
      if (writes .and. .not. of_deck%solved) call remove_results(stem)
      if (writes) call unlock_files(lock)
    end if
    status = of_deck%status
    if (allocated(error)) then
      call print_error(shown(error%message)//newline)
      status = max(status, error%status)
    end if
    if (arguments%asks('--timing')) call print_error(timing_text(of_deck%name, watch, peak_memory()))

  contains

    !> Read and check the deck; plan or solve it.
    subroutine solve_deck()
      call prepare(path, watch, run, error)
      if (allocated(error)) return
      call print_error(render(run%faults, run%deck%source))
      if (run%faults%errors > 0) then
        of_deck%status = status_deck
        if (.not. of_deck%quiet) call print_text(of_deck%name//'  rejected', of_deck%status)
      else if (.not. arguments%asks('--check')) then
        call solve_patterns()
      else if (.not. of_deck%quiet) then
        call print_text(of_deck%name//'  checked', of_deck%status)
      end if
    end subroutine solve_deck

    !> Plan all load cases, and solve them if results are wanted. Those of a pattern have the same supports
    !! and contacts, and share factors.
    subroutine solve_patterns()
      type(results_type) :: results
      integer :: p

      run%deck_notes = render_notes(run%faults, run%deck%source)
      if (run%cases%patterns == 1) call run%deck%forget_text()
      results%stem = stem
      results%all_tables = arguments%asks('--tables')
      results%brief = arguments%asks('--brief')
      run%keeps_states = arguments%asks('--vtk-all')
      results%vtk = arguments%asks('--vtk') .or. run%keeps_states
      call results%begin(run)
      do p = 1, run%cases%patterns
        call plan_pattern(p)
        if (writes) call solve_pattern(run, run%cases%of_pattern(p), of_deck, results, watch, error)
        if (allocated(error)) return
        call results%add_plan(run, run%cases%of_pattern(p))
      end do
      if (writes) then
        call results%finish(run, error)
        if (.not. allocated(error) .and. run%deck%parameter_word('SAVE') == 'YES') &
          call save_end(stem//'.restart', run, error)
      else
        call print_text(of_deck%name//results%plan, of_deck%status)
      end if
      call watch%lap(stage_writing)
    end subroutine solve_patterns

    !> Plan a pattern of load cases. The model has the supports of the first one.
    subroutine plan_pattern(p)
      integer, intent(in) :: p
      type(diagnostics) :: known   ! faults that are reported already

      if (p > 1) then
        call build_model(run%deck, run%model, known, of_pattern=p)
        call run%find_motions(known)
      end if
      run%plan_cases = size(run%cases%of_pattern(p))
      call run%make_plan(watch)
    end subroutine plan_pattern
  end subroutine run_deck

  !> Read the deck, make the model and check it for all load cases.
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
    if (run%faults%errors == 0 .and. run%deck%restart /= '') call restore_end(run)
    call watch%lap(stage_plan)

  contains

    !> Add the faults of the other patterns of load cases, except those that the first one has too.
    subroutine check_patterns()
      type(planned_model) :: other
      type(diagnostics) :: faults
      integer :: i, k, p

      do p = 2, run%cases%patterns
        faults = diagnostics()
        call build_model(run%deck, other%model, faults, of_pattern=p)
        if (faults%errors == 0) call other%find_motions(faults)
        call tell(run%deck, faults, findloc(run%cases%case%pattern, p, dim=1))
        do i = 1, faults%count
          if (all([(run%faults%list(k)%what /= faults%list(i)%what, k=1, run%faults%count)])) &
            call run%faults%add(faults%list(i))
        end do
      end do
    end subroutine check_patterns
  end subroutine prepare
end module epcont_app_driver
