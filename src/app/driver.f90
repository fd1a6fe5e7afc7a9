!> One deck from file to results.
module epcont_app_driver
  use epcont_app_arguments, only: arguments_type, stem_of
  use epcont_app_forecast_text, only: forecast_text
  use epcont_app_process, only: print_error, print_text
  use epcont_app_progress_display, only: progress_type, timing_text
  use epcont_base_diagnostic, only: diagnostics
  use epcont_base_error, only: error_type, status_deck, status_valid
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: newline, shown, text_of
  use epcont_build_build, only: build_model, tell
  use epcont_deck_deck, only: read_deck
  use epcont_deck_render, only: render, render_notes
  use epcont_linalg_rate, only: measured_rate
  use epcont_model_load_cases, only: put_case
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_report_columns, only: known, listed_number, number, right
  use epcont_report_file, only: file_lock, lock_files, unlock_files
  use epcont_report_outcome, only: judge, limit_of_pressure, reason_of, remark_lines
  use epcont_report_results, only: remove_results, results_type
  use epcont_report_run, only: run_results
  use epcont_system_large_pages, only: heap_step, take_heap
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
    type(run_results) :: run
    type(results_type) :: results
    type(error_type), allocatable :: error
    type(file_lock) :: lock
    logical :: writes, written   ! results are wanted; they are written, as far as that could be done

    status = status_valid
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
      call prepare()
      if (allocated(error)) return
      if (run%faults%errors > 0) then
        call print_error(render(run%faults, run%deck%source))
        status = status_deck
        call say(name//'  rejected')
        return
      end if
      if (arguments%asks('--check')) then
        call say(name//'  checked')
      else
        call run%make_plan(watch)
        if (arguments%asks('--plan')) call say_plans()
      end if
      call print_error(render(run%faults, run%deck%source))
      if (.not. writes) then
        if (.not. arguments%asks('--check')) call say_forecast()
        return
      end if
      run%deck_notes = render_notes(run%faults, run%deck%source)
      if (run%cases%patterns == 1) call run%deck%forget_text()
      call solve_cases()
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
    subroutine solve_cases()
      integer :: p, worst

      results%stem = stem
      results%all_tables = arguments%asks('--tables')
      results%brief = arguments%asks('--brief')
      results%vtk = arguments%asks('--vtk')
      call results%begin(run)
      worst = status_valid
      do p = 1, run%cases%patterns
        if (p > 1) call take_pattern(p)
        call solve_pattern(run%cases%of_pattern(p), worst)
        if (allocated(error)) return
        call results%add_plan(run, run%cases%of_pattern(p))
      end do
      call results%finish(run, error)
      call watch%lap(stage_writing)
      status = worst
    end subroutine solve_cases

    !> The scene with other freedoms held.
    subroutine take_pattern(p)
      integer, intent(in) :: p
      type(diagnostics) :: told   ! all of it is known

      call build_model(run%deck, run%model, told, of_pattern=p)
      call run%find_motions(told)
      call run%make_plan(watch)
    end subroutine take_pattern

    !> Load cases that share a plan; from the first again where one has changed the pairs of the scene.
    subroutine solve_pattern(cases, worst)
      integer, intent(in) :: cases(:)
      integer, intent(inout) :: worst    !! status so far
      integer :: k, of_these

      k = 1
      of_these = status_valid
      do while (k <= size(cases))
        run%case = cases(k)
        if (run%has_cases()) call put_case(run%cases, run%case, run%model)
        run%kept%another = k < size(cases)
        call run%solve(arguments%memory, watch, error)
        if (allocated(error)) error%message = path//': '//error%message
        if (allocated(error)) return
        if (run%replanned .and. k > 1) then
          k = 1
          of_these = status_valid
          cycle
        end if
        call take_case()
        if (allocated(error)) return
        of_these = max(of_these, status)
        k = k + 1
      end do
      worst = max(worst, of_these)
    end subroutine solve_pattern

    !> Judge a load case, and say and write what came of it.
    subroutine take_case()
      run%outcome = judge(run)
      status = run%outcome%status
      call results%add_case(run, error)
      written = .true.
      call watch%lap(stage_writing)
      call watch%erase()
      if (allocated(error)) return
      call say_lines(remark_lines(run%outcome%found, .false.))
      if (len(run%outcome%sentence) > 0) call say_lines(run%outcome%sentence//newline)
      call say(one_line())
    end subroutine take_case

    !> What the run would take on this machine: on standard error, since plans are compared.
    subroutine say_forecast()
      call print_error(name//': '//forecast_text( &
        run%planned_scene, size(run%cases%case), run%cases%patterns, &
        run%rows_of_tables(arguments%asks('--tables')), sum(watch%spent(2, :)), measured_rate())//newline)
    end subroutine say_forecast

    !> Read and check.
    subroutine prepare()
      integer, parameter :: memory_of_deck = 8   ! until it is solved, over its size
      integer(i8) :: bytes

      inquire (file=path, size=bytes)
      call take_heap(min(memory_of_deck*bytes, int(heap_step, i8)))
      call read_deck(path, run%deck, run%faults, error)
      call watch%lap(stage_reading)
      if (allocated(error)) return
      call build_model(run%deck, run%model, run%faults, run%cases)
      call watch%lap(stage_model)
      if (run%faults%errors > 0) return
      call run%find_motions(run%faults)
      call tell(run%deck, run%model%kinds, run%faults)
      call check_patterns()
      call watch%lap(stage_plan)
    end subroutine prepare

    !> What is wrong with the scene where load cases hold other freedoms than the first, and not there too.
    subroutine check_patterns()
      type(planned_scene) :: other
      type(diagnostics) :: faults
      integer :: i, p

      do p = 2, run%cases%patterns
        faults = diagnostics()
        call build_model(run%deck, other%model, faults, of_pattern=p)
        if (faults%errors == 0) call other%find_motions(faults)
        call tell(run%deck, other%model%kinds, faults)
        do i = 1, faults%count
          if (.not. run%faults%has(faults%list(i))) call run%faults%add(faults%list(i))
        end do
      end do
    end subroutine check_patterns

    !> Lines on standard error, each behind the name of the deck.
    subroutine say_lines(text)
      character(len=*), intent(in) :: text
      integer :: from, to

      from = 1
      do while (from <= len(text))
        to = from + index(text(from:), newline) - 2
        call print_error(shown(path)//case_name()//': '//text(from:to + 1))
        from = to + 2
      end do
    end subroutine say_lines

    !> A line on standard output.
    subroutine say(text)
      character(len=*), intent(in) :: text

      if (.not. arguments%asks('--quiet')) call print_text(text, status)
    end subroutine say

    !> Which load case is meant, where there are several.
    pure function case_name() result(text)
      character(len=:), allocatable :: text

      text = ''
      if (run%has_cases()) text = ' SUBCASE '//text_of(run%deck%subcase(run%case)%id)
    end function case_name

    !> Stem, status, largest pressure, first approach; of a pressure that has no limit, or none that the mesh
    !! shows, that too.
    pure function one_line() result(text)
      character(len=:), allocatable :: limit, text

      text = name//case_name()//'  '//run%outcome%word
      if (.not. run%outcome%has_answer) return
      if (run%model%pairs > 0) then
        text = text//'  p_max'//right(listed_number(known, run%answer%largest_pressure(), 0.0_wp), 13)
        limit = limit_of_pressure(run)
        if (len(reason_of(limit)) > 0) text = text//' ('//limit//')'
      end if
      if (run%motions%count > 0) &
        text = text//'  approach'//right(listed_number(number, run%answer%contact%approach(1), 0.0_wp), 13)
    end function one_line
  end subroutine run_deck
end module epcont_app_driver
