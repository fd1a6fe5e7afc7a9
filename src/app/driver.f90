!> One deck from file to results.
module epcont_app_driver
  use, intrinsic :: iso_fortran_env, only: error_unit
  use epcont_analysis, only: analyse
  use epcont_app_arguments, only: arguments_type, stem_of
  use epcont_app_console, only: print_text
  use epcont_base_error, only: error_type, status_deck, status_valid
  use epcont_base_kinds, only: wp
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_render, only: render
  use epcont_model_build, only: build_model
  use epcont_model_model, only: model_type
  use epcont_plan_forecast, only: check_memory, forecast, forecast_type
  use epcont_plan_free_motion, only: find_free_motions, free_motions, motion_fault
  use epcont_plan_iteration_plan, only: iteration_plan, plan_iteration
  use epcont_plan_numbering, only: number_equations, numbering_type
  use epcont_report_motions, only: report_motion_faults
  use epcont_report_number, only: column_number
  use epcont_report_outcome, only: judge, outcome_type
  use epcont_report_plan, only: plan_text
  use epcont_report_results, only: run_results, write_results
  use epcont_report_solver, only: report_solver_fault
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: run_deck

contains

  !> Run one deck; `status` is its exit status.
  subroutine run_deck(path, arguments, status)
    character(len=*), intent(in) :: path
    type(arguments_type), intent(in) :: arguments
    integer, intent(out) :: status
    type(error_type), allocatable :: error
    type(run_results) :: run
    type(numbering_type) :: numbering
    type(iteration_plan) :: iteration
    type(forecast_type) :: expected
    integer :: singular

    status = status_valid
    call prepare(path, run%deck, run%model, run%motions, run%faults, error)
    if (.not. allocated(error)) then
      write (error_unit, '(a)', advance='no') render(run%faults, run%deck%source)
      if (run%faults%error_count() > 0) status = status_deck
      if (status == status_deck .or. arguments%check) then
        call say(arguments, stem_of(path)//'  '//trim(merge('rejected', 'checked ', status == status_deck)), status)
        return
      end if
      numbering = number_equations(run%model)
      iteration = plan_iteration(run%model)
      expected = forecast(run%model, numbering, iteration)
      run%plan = plan_text(run%model, run%motions, iteration, numbering, expected)
      if (arguments%plan) then
        call print_text(stem_of(path)//run%plan, status)
        return
      end if
      call check_memory(run%model, expected, arguments%memory, error)
      if (allocated(error)) error%message = path//': '//error%message
      if (.not. allocated(error)) then
        call analyse(run%model, run%motions, numbering, iteration, run%answer, run%certificate, run%accuracy, singular)
        run%outcome = judge(run%model, run%motions, run%answer, run%certificate, singular)
        status = run%outcome%status
        call write_results(run, output_stem(path, arguments), arguments%all_tables, arguments%vtk, error)
      end if
    end if
    if (allocated(error)) then
      status = error%status
      write (error_unit, '(a)') error%message
    else
      if (len(run%outcome%sentence) > 0) write (error_unit, '(a)') path//': '//run%outcome%sentence
      call say(arguments, one_line(stem_of(path), run%answer, run%outcome), status)
    end if
  end subroutine run_deck

  !> Path of the result files, without their suffixes.
  pure function output_stem(path, arguments) result(stem)
    character(len=*), intent(in) :: path
    type(arguments_type), intent(in) :: arguments
    character(len=:), allocatable :: stem

    stem = stem_of(path)
    if (len(arguments%directory) > 0) stem = arguments%directory//'/'//stem
  end function output_stem

  !> Read and check.
  subroutine prepare(path, deck, model, motions, faults, error)
    character(len=*), intent(in) :: path
    type(deck_type), intent(out) :: deck
    type(model_type), intent(out) :: model
    type(free_motions), intent(out) :: motions
    type(diagnostics), intent(inout) :: faults
    type(error_type), allocatable, intent(out) :: error
    type(motion_fault), allocatable :: loose(:)

    call read_deck(path, deck, faults, error)
    if (allocated(error)) return
    call build_model(deck, model, faults)
    if (faults%error_count() > 0) return
    call find_free_motions(model, motions, loose)
    call report_motion_faults(deck, model, loose, faults)
    call report_solver_fault(deck, model, faults)
  end subroutine prepare

  !> Stem, status, largest pressure, first approach.
  pure function one_line(stem, answer, outcome) result(text)
    character(len=*), intent(in) :: stem
    type(answer_type), intent(in) :: answer
    type(outcome_type), intent(in) :: outcome
    character(len=:), allocatable :: text

    text = stem//'  '//outcome%word
    if (.not. outcome%has_answer) return
    if (size(answer%pressure) > 0) &
      text = text//'  p_max'//column_number(max(0.0_wp, maxval(answer%pressure)), 0.0_wp)
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
