!> All that a run writes: the listing, and the tables beside it.
module epcont_report_results
  use epcont_accuracy_accuracy, only: accuracy_type
  use epcont_base_error, only: error_type
  use epcont_certificate_certificate, only: certificate_type
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_report_accuracy_text, only: list_accuracy
  use epcont_report_file, only: new_text_file, remove_file, text_file
  use epcont_report_iterations, only: list_iterations
  use epcont_report_listing, only: list_bodies, list_contact, list_deck, list_elements, list_lines, list_nodes, list_outcome, &
                                   list_summary, list_zones
  use epcont_report_outcome, only: outcome_type
  use epcont_report_remarks, only: list_remarks, remarks_type
  use epcont_report_tables, only: write_bodies, write_contact, write_elements, write_history, write_nodes, write_summary, &
                                  write_zones
  use epcont_report_vtk_bodies, only: write_vtk_bodies
  use epcont_report_vtk_contact, only: write_vtk_contact
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: run_results, write_results, remove_results, result_file

  !> A file of results: what stands behind the name of the deck, and what it holds.
  type :: result_file
    character(len=14) :: suffix
    character(len=76) :: text
  end type result_file

  type(result_file), parameter, public :: result_files(*) = [ &
    result_file('.lst', 'the listing, for people and for diffing: the same bytes on every run'), &
    result_file('.summary.csv', 'outcome, approaches, certificate and accuracy, in 17 digits like all tables'), &
    result_file('.contact.csv', 'pairs: place, normal, initial gap, force, pressure, gap, status'), &
    result_file('.zones.csv', 'runs of touching pairs: force, largest pressure and its limit, half-width'), &
    result_file('.bodies.csv', 'bodies: the force of contact on each, and how much it may be off'), &
    result_file('.history.csv', 'iterations: change, residual, pairs in contact, plastic elements'), &
    result_file('.nodes.csv', 'displacements and reactions; where the deck or --tables all asks for it'), &
    result_file('.elements.csv', 'stresses and states; where the deck or --tables all asks for it'), &
    result_file('.vtu', 'the bodies, for ParaView, with --vtk: displacements, stresses, states'), &
    result_file('.contact.vtu', 'the boundary in contact, for ParaView, with --vtk: pressures, gaps')]

  !> One deck's way, from its cards to its answer.
  type, extends(planned_scene) :: run_results
    type(deck_type) :: deck
    type(diagnostics) :: faults
    type(remarks_type) :: remarks
    character(len=:), allocatable :: plan   !! in words
    type(answer_type) :: answer
    type(certificate_type) :: certificate
    type(accuracy_type) :: accuracy
    type(outcome_type) :: outcome
  end type run_results

contains

  !> The listing and the tables; those of nodes and elements where the deck, or `all_tables`, asks for them. With `vtk` also
  !! files for ParaView.
  subroutine write_results(run, stem, all_tables, vtk, error)
    type(run_results), intent(in) :: run
    character(len=*), intent(in) :: stem   !! path of the files, without their suffixes
    logical, intent(in) :: all_tables, vtk
    type(error_type), allocatable, intent(out) :: error
    logical :: nodes, elements

    call remove_results(stem)
    nodes = all_tables .or. run%deck%displacement .or. run%deck%spcforces
    elements = all_tables .or. run%deck%stress
    call write_listing(run, stem, nodes, elements, error)
    associate (model => run%model, answer => run%answer)
      if (.not. allocated(error)) &
        call write_summary(stem, model, run%motions, answer, run%certificate, run%accuracy, run%outcome, run%remarks, error)
      if (.not. run%outcome%has_answer) return
      if (.not. allocated(error)) call write_contact(stem, model, answer, error)
      if (.not. allocated(error)) call write_zones(stem, model, answer, run%accuracy, error)
      if (.not. allocated(error) .and. model%pairs > 0) call write_bodies(stem, model, answer, run%accuracy, error)
      if (.not. allocated(error)) call write_history(stem, answer, error)
      if (.not. allocated(error) .and. nodes) call write_nodes(stem, model, answer, error)
      if (.not. allocated(error) .and. elements) call write_elements(stem, model, answer, error)
      if (.not. allocated(error) .and. vtk) call write_vtk_bodies(stem, model, answer, run%outcome%status, error)
      if (.not. allocated(error) .and. vtk .and. model%pairs > 0) &
        call write_vtk_contact(stem, model, answer, run%outcome%status, error)
    end associate
  end subroutine write_results

  !> Remove what an earlier run has left: what is there is of one run, also where this one is stopped, or has nothing to say.
  subroutine remove_results(stem)
    character(len=*), intent(in) :: stem
    integer :: i

    do i = 1, size(result_files)
      call remove_file(stem//trim(result_files(i)%suffix))
    end do
  end subroutine remove_results

  subroutine write_listing(run, stem, nodes, elements, error)
    type(run_results), intent(in) :: run
    character(len=*), intent(in) :: stem
    logical, intent(in) :: nodes, elements
    type(error_type), allocatable, intent(out) :: error
    type(text_file) :: file

    call new_text_file(stem//'.lst', file, error)
    if (allocated(error)) return
    call list_deck(file, run%deck)
    call list_remarks(file, run%remarks)
    call file%line(run%plan(:len(run%plan) - 1))
    call list_outcome(file, run%outcome)
    if (run%outcome%has_answer) then
      associate (model => run%model, answer => run%answer)
        call list_iterations(file, model, answer)
        if (model%pairs > 0) then
          call list_contact(file, model, answer)
          call list_zones(file, model, answer%zones)
          if (size(answer%lines) > 0) call list_lines(file, model, answer%lines)
          call list_bodies(file, model, answer%bodies, run%accuracy%body_force)
        end if
        if (nodes) call list_nodes(file, model, answer)
        if (elements) call list_elements(file, model, answer)
        call list_summary(file, model, run%motions, answer, run%certificate, run%accuracy, run%outcome)
        call list_accuracy(file, model, run%motions, answer, run%certificate, run%accuracy)
      end associate
    end if
    call file%finish(error)
  end subroutine write_listing
end module epcont_report_results
