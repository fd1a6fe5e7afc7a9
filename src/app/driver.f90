!> One deck from file to results.
module epcont_app_driver
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use epcont_analysis, only: analyse
  use epcont_app_arguments, only: arguments_type, stem_of
  use epcont_base_error, only: error_type, raise, status_deck, status_usage, status_valid
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: plural, text_of
  use epcont_certificate_certificate, only: certificate_type
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_render, only: render
  use epcont_model_build, only: build_model
  use epcont_model_model, only: model_type
  use epcont_plan_forecast, only: forecast, forecast_type
  use epcont_plan_free_motion, only: find_free_motions, free_motions, motion_fault
  use epcont_plan_iteration_plan, only: iteration_plan, plan_iteration
  use epcont_plan_numbering, only: number_equations, numbering_type
  use epcont_report_file, only: new_text_file, text_file
  use epcont_report_listing, only: list_contact, list_deck, list_elements, list_nodes, list_outcome, list_summary, &
                                   list_zones
  use epcont_report_iterations, only: list_iterations
  use epcont_report_motions, only: report_motion_faults
  use epcont_report_number, only: column_number
  use epcont_report_outcome, only: judge, outcome_type
  use epcont_report_plan, only: plan_text
  use epcont_report_tables, only: write_contact, write_elements, write_history, write_nodes, write_summary, write_zones
  use epcont_result_answer, only: answer_type
  use epcont_result_contact_line, only: contact_zone, find_contact_line, find_zones
  implicit none
  private
  public :: run_deck

contains

  !> Run one deck; `status` is its exit status.
  subroutine run_deck(path, arguments, status)
    character(len=*), intent(in) :: path
    type(arguments_type), intent(in) :: arguments
    integer, intent(out) :: status
    type(deck_type) :: deck
    type(diagnostics) :: faults
    type(error_type), allocatable :: error
    type(model_type) :: model
    type(free_motions) :: motions
    type(numbering_type) :: numbering
    type(iteration_plan) :: iteration
    type(forecast_type) :: expected
    type(answer_type) :: answer
    type(certificate_type) :: certificate
    type(outcome_type) :: outcome
    integer :: singular

    status = status_valid
    call prepare(path, deck, model, motions, faults, error)
    if (.not. allocated(error)) then
      write (error_unit, '(a)', advance='no') render(faults, deck%source)
      if (faults%error_count() > 0) status = status_deck
      if (status == status_deck .or. arguments%check) then
        call say(arguments, stem_of(path)//'  '//trim(merge('rejected', 'checked ', status == status_deck)))
        return
      end if
      numbering = number_equations(model)
      iteration = plan_iteration(model)
      expected = forecast(model, numbering)
      if (arguments%plan) then
        write (output_unit, '(a)', advance='no') stem_of(path)//plan_text(model, motions, iteration, numbering, expected)
        return
      end if
      if (real(expected%bytes, wp) > 1.0e9_wp*arguments%memory) then
        call raise(error, status_usage, path//': its matrices need '//text_of(expected%bytes/1000000_i8)// &
                   ' MB: --memory GB allows it')
      else
        call analyse(model, motions, numbering, iteration, answer, certificate, singular)
        outcome = judge(model, motions, answer, certificate, singular)
        status = outcome%status
        call write_results(path, arguments, deck, model, motions, answer, certificate, outcome, faults, &
                           plan_text(model, motions, iteration, numbering, expected), error)
      end if
    end if
    if (allocated(error)) then
      status = error%status
      write (error_unit, '(a)') error%message
    else
      if (len(outcome%sentence) > 0) write (error_unit, '(a)') path//': '//outcome%sentence
      call say(arguments, one_line(stem_of(path), answer, outcome))
    end if
  end subroutine run_deck

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
  end subroutine prepare

  !> The listing and the tables.
  subroutine write_results(path, arguments, deck, model, motions, answer, certificate, outcome, faults, plan, error)
    character(len=*), intent(in) :: path, plan
    type(arguments_type), intent(in) :: arguments
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(answer_type), intent(in) :: answer
    type(certificate_type), intent(in) :: certificate
    type(outcome_type), intent(in) :: outcome
    type(diagnostics), intent(in) :: faults
    type(error_type), allocatable, intent(out) :: error
    type(contact_zone), allocatable :: zones(:)
    type(text_file) :: file
    character(len=:), allocatable :: stem
    logical :: nodes, elements

    stem = stem_of(path)
    if (len(arguments%directory) > 0) stem = arguments%directory//'/'//stem
    nodes = arguments%all_tables .or. deck%displacement .or. deck%spcforces
    elements = arguments%all_tables .or. deck%stress
    call new_text_file(stem//'.lst', file, error)
    if (allocated(error)) return
    call list_deck(file, deck, faults)
    call file%line(plan(:len(plan) - 1))
    call list_outcome(file, outcome)
    if (outcome%has_answer) then
      allocate (zones(0))
      call list_iterations(file, model, answer)
      if (model%pairs > 0) then
        zones = find_zones(model, find_contact_line(model), answer%contact%touching, answer%contact%force, answer%pressure)
        call list_contact(file, model, answer)
        call list_zones(file, model, zones)
      end if
      if (nodes) call list_nodes(file, model, answer)
      if (elements) call list_elements(file, model, answer)
      call list_summary(file, model, motions, answer, certificate, outcome)
    end if
    call file%finish(error)
    if (.not. allocated(error)) call write_summary(stem, model, motions, answer, certificate, outcome, error)
    if (.not. outcome%has_answer) return
    if (.not. allocated(error)) call write_contact(stem, model, answer, error)
    if (.not. allocated(error)) call write_zones(stem, model, zones, error)
    if (.not. allocated(error)) call write_history(stem, answer, error)
    if (.not. allocated(error) .and. nodes) call write_nodes(stem, model, answer, error)
    if (.not. allocated(error) .and. elements) call write_elements(stem, model, answer, error)
  end subroutine write_results

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

  subroutine say(arguments, text)
    type(arguments_type), intent(in) :: arguments
    character(len=*), intent(in) :: text

    if (.not. arguments%quiet) write (output_unit, '(a)') text
  end subroutine say
end module epcont_app_driver
