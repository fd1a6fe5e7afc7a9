!> One deck from file to results.
module epcont_app_driver
  use epcont_app_arguments, only: arguments_type, stem_of
  use epcont_app_process, only: print_error, print_text
  use epcont_app_progress_display, only: progress_type, timing_text
  use epcont_base_error, only: error_type, status_deck, status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: newline, shown
  use epcont_build_build, only: build_model, tell
  use epcont_deck_deck, only: read_deck
  use epcont_deck_render, only: render, render_notes
  use epcont_report_columns, only: known, listed_number, number, right
  use epcont_report_file, only: file_lock, lock_files, unlock_files
  use epcont_report_outcome, only: judge, limit_of_pressure, reason_of, remark_lines
  use epcont_report_plan_text, only: plan_text
  use epcont_report_results, only: remove_results, write_results
  use epcont_report_run, only: run_results
  use epcont_system_memory, only: peak_memory
  use epcont_system_stopwatch, only: stage_model, stage_plan, stage_reading, stage_writing, stopwatch
  implicit none
  private
  public :: run_deck

contains

  !> From file to results, alone at work on them; what is there afterwards is of this run.
  subroutine run_deck(path, arguments, status)
    character(len=*), intent(in) :: path   !! of the deck
    type(arguments_type), intent(in) :: arguments   !! of the command line
    integer, intent(out) :: status   !! its exit status
    type(progress_type) :: watch
    type(error_type), allocatable :: error
    type(file_lock) :: lock
    logical :: writes, written

    call watch%begin(shown(stem_of(path)), arguments%asks('--progress'), arguments%asks('--quiet'))
    writes = .not. (arguments%asks('--check') .or. arguments%asks('--plan'))
    if (writes) call lock_files(output_stem(path, arguments), lock, error)
    if (allocated(error)) then
      call refuse(error, status)
    else
      call solve_deck(path, arguments, watch, status, written)
      if (writes .and. .not. written) call remove_results(output_stem(path, arguments))
      if (writes) call unlock_files(lock)
    end if
    if (arguments%asks('--timing')) call print_error(timing_text(shown(stem_of(path)), watch, peak_memory()))
  end subroutine run_deck

  !> From file to results, and what there is to say of it.
  subroutine solve_deck(path, arguments, watch, status, written)
    character(len=*), intent(in) :: path
    type(arguments_type), intent(in) :: arguments
    type(progress_type), intent(inout) :: watch
    integer, intent(out) :: status
    logical, intent(out) :: written   !! results, as far as that could be done
    type(error_type), allocatable :: error
    type(run_results) :: run
    character(len=:), allocatable :: name

    name = shown(stem_of(path))
    status = status_valid
    written = .false.
    call prepare(path, run, watch, error)
    if (.not. allocated(error)) then
      if (run%faults%errors > 0) then
        call print_error(render(run%faults, run%deck%source))
        status = status_deck
        call say(arguments, name//'  rejected', status)
        return
      end if
      if (arguments%asks('--check')) then
        call say(arguments, name//'  checked', status)
      else
        call run%make_plan(watch)
        if (arguments%asks('--plan')) call print_text(name//plan_text(run%planned_scene), status)
      end if
      call print_error(render(run%faults, run%deck%source))
      if (arguments%asks('--check') .or. arguments%asks('--plan')) return
      run%deck_notes = render_notes(run%faults, run%deck%source)
      call run%deck%forget_text()
      call run%solve(arguments%memory, watch, error)
      if (allocated(error)) error%message = path//': '//error%message
    end if
    if (.not. allocated(error)) then
      run%outcome = judge(run)
      status = run%outcome%status
      call write_results(run, output_stem(path, arguments), arguments%asks('--tables'), &
                         arguments%asks('--vtk'), error)
      written = .true.
      call watch%lap(stage_writing)
      call watch%erase()
    end if
    if (allocated(error)) then
      call refuse(error, status)
    else
      call say_lines(shown(path)//': ', remark_lines(run%outcome%found, .false.))
      if (len(run%outcome%sentence) > 0) call say_lines(shown(path)//': ', run%outcome%sentence//newline)
      call say(arguments, one_line(name, run), status)
    end if
  end subroutine solve_deck

  !> Say what is wrong.
  subroutine refuse(error, status)
    type(error_type), intent(in) :: error
    integer, intent(out) :: status

    call print_error(shown(error%message)//newline)
    status = error%status
  end subroutine refuse

  !> Lines on standard error, each behind the name of the deck.
  subroutine say_lines(name, text)
    character(len=*), intent(in) :: name, text
    integer :: from, to

    from = 1
    do while (from <= len(text))
      to = from + index(text(from:), newline) - 2
      call print_error(name//text(from:to + 1))
      from = to + 2
    end do
  end subroutine say_lines

  !> Path of the result files, without their suffixes.
  pure function output_stem(path, arguments) result(stem)
    character(len=*), intent(in) :: path
    type(arguments_type), intent(in) :: arguments
    character(len=:), allocatable :: stem

    stem = stem_of(path)
    if (len(arguments%directory) > 0) stem = arguments%directory//'/'//stem
  end function output_stem

  !> Read and check.
  subroutine prepare(path, run, watch, error)
    character(len=*), intent(in) :: path
    type(run_results), intent(inout) :: run
    class(stopwatch), intent(inout) :: watch
    type(error_type), allocatable, intent(out) :: error

    call read_deck(path, run%deck, run%faults, error)
    call watch%lap(stage_reading)
    if (allocated(error)) return
    call build_model(run%deck, run%model, run%faults)
    call watch%lap(stage_model)
    if (run%faults%errors > 0) return
    call run%find_motions(run%faults)
    call tell(run%deck, run%model%kinds, run%faults)
    call watch%lap(stage_plan)
  end subroutine prepare

  !> Stem, status, largest pressure, first approach; of a pressure that has no limit, or none that the mesh
  !! shows, that too.
  pure function one_line(stem, run) result(text)
    character(len=*), intent(in) :: stem
    type(run_results), intent(in) :: run
    character(len=:), allocatable :: limit, text

    text = stem//'  '//run%outcome%word
    if (.not. run%outcome%has_answer) return
    if (run%model%pairs > 0) then
      text = text//'  p_max'//right(listed_number(known, run%answer%largest_pressure(), 0.0_wp), 13)
      limit = limit_of_pressure(run)
      if (len(reason_of(limit)) > 0) text = text//' ('//limit//')'
    end if
    if (run%motions%count > 0) &
      text = text//'  approach'//right(listed_number(number, run%answer%contact%approach(1), 0.0_wp), 13)
  end function one_line

  subroutine say(arguments, text, status)
    type(arguments_type), intent(in) :: arguments
    character(len=*), intent(in) :: text
    integer, intent(inout) :: status

    if (.not. arguments%asks('--quiet')) call print_text(text, status)
  end subroutine say
end module epcont_app_driver
