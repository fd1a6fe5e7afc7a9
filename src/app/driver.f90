!> One deck from file to results.
module epcont_app_driver
  use, intrinsic :: iso_fortran_env, only: error_unit
  use epcont_accuracy_accuracy, only: accuracy_type
  use epcont_analysis, only: analyse
  use epcont_app_arguments, only: arguments_type, stem_of
  use epcont_app_console, only: print_text
  use epcont_app_progress_display, only: progress_type
  use epcont_app_terminal, only: print_error
  use epcont_base_error, only: error_type, status_deck, status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: shown
  use epcont_build_build, only: build_model
  use epcont_contact_geometry_nearness, only: enter_nodes_that_came_near
  use epcont_deck_deck, only: read_deck
  use epcont_deck_render, only: render
  use epcont_plan_forecast, only: check_memory, forecast, forecast_type
  use epcont_plan_free_motion, only: find_free_motions, motion_fault
  use epcont_plan_iteration_plan, only: iteration_plan, plan_iteration
  use epcont_plan_numbering, only: number_equations, numbering_type
  use epcont_plan_side_by_side, only: plan_threads
  use epcont_report_file, only: file_lock, lock_files, unlock_files
  use epcont_report_limit, only: limit_of_largest, reason_of
  use epcont_report_motions, only: report_motion_faults
  use epcont_report_number, only: column_number, known_column
  use epcont_report_outcome, only: judge, outcome_type
  use epcont_report_plan_text, only: plan_text
  use epcont_report_remarks, only: remark_answer, remarks_of_deck
  use epcont_report_results, only: remove_results, run_results, write_results
  use epcont_report_timing, only: timing_text
  use epcont_result_answer, only: answer_type
  use epcont_system_memory, only: peak_memory
  use epcont_system_stopwatch, only: stage_model, stage_numbering, stage_plan, stage_reading, stage_writing, stopwatch
  use epcont_system_threads, only: granted_threads
  implicit none
  private
  public :: run_deck

  !> A scene is solved again while nodes come near that had no pair, but not more often.
  integer, parameter :: most_solves = 8

contains

  !> Run one deck; `status` is its exit status.
  subroutine run_deck(path, arguments, status)
    character(len=*), intent(in) :: path
    type(arguments_type), intent(in) :: arguments
    integer, intent(out) :: status
    type(progress_type) :: watch

    call watch%begin(shown(stem_of(path)), arguments%progress, arguments%quiet)
    call follow_deck(path, arguments, watch, status)
    if (arguments%timing) call print_error(timing_text(shown(stem_of(path)), watch, peak_memory()))
  end subroutine run_deck

  !> From file to results, alone at work on them; what is there afterwards is of this run.
  subroutine follow_deck(path, arguments, watch, status)
    character(len=*), intent(in) :: path
    type(arguments_type), intent(in) :: arguments
    type(progress_type), intent(inout) :: watch
    integer, intent(out) :: status
    type(error_type), allocatable :: error
    type(file_lock) :: lock
    logical :: written

    if (arguments%check .or. arguments%plan) then
      call solve_deck(path, arguments, watch, status, written)
      return
    end if
    call lock_files(output_stem(path, arguments), lock, error)
    if (allocated(error)) then
      status = error%status
      write (error_unit, '(a)') shown(error%message)
      return
    end if
    call solve_deck(path, arguments, watch, status, written)
    if (.not. written) call remove_results(output_stem(path, arguments))
    call unlock_files(lock)
  end subroutine follow_deck

  !> From file to results, and what there is to say of it.
  subroutine solve_deck(path, arguments, watch, status, written)
    character(len=*), intent(in) :: path
    type(arguments_type), intent(in) :: arguments
    type(progress_type), intent(inout) :: watch
    integer, intent(out) :: status
    logical, intent(out) :: written   !! results, as far as that could be done
    type(error_type), allocatable :: error, in_double
    type(run_results) :: run
    type(numbering_type) :: numbering
    type(iteration_plan) :: iteration
    type(forecast_type) :: expected
    integer :: singular, solve
    logical :: entered

    status = status_valid
    written = .false.
    call prepare(path, run, watch, error)
    if (.not. allocated(error)) then
      write (error_unit, '(a)', advance='no') render(run%faults, run%deck%source)
      if (run%faults%error_count() > 0) status = status_deck
      if (status == status_deck .or. arguments%check) then
        call say(arguments, shown(stem_of(path))//'  '//trim(merge('rejected', 'checked ', status == status_deck)), status)
        return
      end if
      call make_plan(run, numbering, iteration, expected, watch)
      if (arguments%plan) then
        call print_text(shown(stem_of(path))//run%plan, status)
        return
      end if
      run%remarks = remarks_of_deck(run%faults, run%deck%source)
      call run%deck%forget_text()
      do solve = 1, most_solves
        call check_memory(expected%bytes, arguments%memory, error)
        call check_memory(expected%double_bytes, arguments%memory, in_double)
        if (allocated(in_double)) iteration%against_double = in_double%message
        if (allocated(error)) exit
        iteration%threads = plan_threads(numbering, expected%bytes, granted_threads())
        call watch%expect(iteration, run%model%controls%most_iterations, expected%operations)
        call analyse(run%model, run%motions, numbering, iteration, run%answer, run%certificate, run%accuracy, singular, watch)
        if (singular > 0 .or. solve == most_solves) exit
        call enter_nodes_that_came_near(run%model, run%answer%displacement, run%answer%contact%touching, entered)
        if (.not. entered) exit
        call make_plan(run, numbering, iteration, expected, watch)
      end do
      if (allocated(error)) then
        error%message = path//': '//error%message
      else
        run%outcome = judge(run%model, run%motions, run%answer, run%certificate, singular)
        status = run%outcome%status
        if (run%outcome%has_answer) &
          call remark_answer(run%model, run%motions, run%answer, run%certificate%scene, run%remarks)
        call write_results(run, output_stem(path, arguments), arguments%all_tables, arguments%vtk, error)
        written = .true.
        call watch%lap(stage_writing)
        call watch%erase()
      end if
    end if
    if (allocated(error)) then
      status = error%status
      write (error_unit, '(a)') shown(error%message)
    else
      call tell(shown(path)//': ', run%remarks%of_answer)
      if (len(run%outcome%sentence) > 0) write (error_unit, '(a)') shown(path)//': '//run%outcome%sentence
      call say(arguments, one_line(shown(stem_of(path)), run%answer, run%accuracy, run%outcome), status)
    end if
  end subroutine solve_deck

  !> Lines on standard error, each behind the name of the deck.
  subroutine tell(name, text)
    character(len=*), intent(in) :: name, text
    integer :: from, to

    from = 1
    do while (from <= len(text))
      to = from + index(text(from:), new_line('a')) - 2
      write (error_unit, '(a)') name//text(from:to)
      from = to + 2
    end do
  end subroutine tell

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
    type(motion_fault), allocatable :: loose(:)

    call read_deck(path, run%deck, run%faults, error)
    call watch%lap(stage_reading)
    if (allocated(error)) return
    call build_model(run%deck, run%model, run%faults)
    call watch%lap(stage_model)
    if (run%faults%error_count() > 0) return
    call find_free_motions(run%model, run%motions, loose)
    call report_motion_faults(run%deck, run%model, loose, run%faults)
    call watch%lap(stage_plan)
  end subroutine prepare

  !> What will be solved, and how; in words, too.
  subroutine make_plan(run, numbering, iteration, expected, watch)
    type(run_results), intent(inout) :: run
    type(numbering_type), intent(out) :: numbering
    type(iteration_plan), intent(out) :: iteration
    type(forecast_type), intent(out) :: expected
    class(stopwatch), intent(inout) :: watch

    numbering = number_equations(run%model)
    call watch%lap(stage_numbering)
    iteration = plan_iteration(run%model)
    expected = forecast(run%model, run%motions, numbering, iteration)
    run%plan = plan_text(run%model, run%motions, iteration, numbering, expected)
    call watch%lap(stage_plan)
  end subroutine make_plan

  !> Stem, status, largest pressure, first approach; of a pressure that has no limit, or none that the mesh shows, that too.
  pure function one_line(stem, answer, accuracy, outcome) result(text)
    character(len=*), intent(in) :: stem
    type(answer_type), intent(in) :: answer
    type(accuracy_type), intent(in) :: accuracy
    type(outcome_type), intent(in) :: outcome
    character(len=:), allocatable :: limit, text

    text = stem//'  '//outcome%word
    if (.not. outcome%has_answer) return
    if (size(answer%pressure) > 0) then
      text = text//'  p_max'//known_column(answer%largest_pressure(), 0.0_wp)
      limit = limit_of_largest(answer, accuracy)
      if (len(reason_of(limit)) > 0) text = text//' ('//limit//')'
    end if
    if (size(answer%contact%approach) > 0) &
      text = text//'  approach'//column_number(answer%contact%approach(1), 0.0_wp)
  end function one_line

  subroutine say(arguments, text, status)
    type(arguments_type), intent(in) :: arguments
    character(len=*), intent(in) :: text
    integer, intent(inout) :: status

    if (.not. arguments%quiet) call print_text(text, status)
  end subroutine say
end module epcont_app_driver
