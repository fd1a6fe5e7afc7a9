!> What is known of one deck's run: all that the listing, the tables and the messages are written from.
module epcont_report_run
  use epcont_accuracy_accuracy, only: accuracy_type
  use epcont_base_error, only: status_valid
  use epcont_certificate_certificate, only: certificate_type
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: outcome_type, remarks_type, run_results

  !> What came of a run.
  type :: outcome_type
    integer :: status = status_valid            !! exit status
    character(len=:), allocatable :: word       !! valid, no equilibrium, ...
    character(len=:), allocatable :: sentence   !! empty where the answer is valid
    logical :: has_answer = .false.             !! displacements and forces were found
  end type outcome_type

  !> Warnings and notes.
  type :: remarks_type
    integer :: warnings = 0, notes = 0
    character(len=:), allocatable :: of_deck     !! in lines; of warnings the place is followed by `warning: `
    character(len=:), allocatable :: of_answer   !! in lines, each a warning
    character(len=:), allocatable :: noted       !! notes of the answer, in lines
  end type remarks_type

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
end module epcont_report_run
