!> A solver that the deck asks for and the program was built without.
module epcont_report_solver
  use epcont_deck_card_kinds, only: card_param
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_linalg_sparse, only: sparse_available
  use epcont_model_controls, only: solver_sparse
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: report_solver_fault

contains

  subroutine report_solver_fault(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    type(diagnostics), intent(inout) :: faults

    if (model%controls%solver /= solver_sparse .or. sparse_available()) return
    call faults%add_error(deck%place(card_param, deck%parameter_row('SOLVER'), 2), &
                          'PARAM SOLVER: this epcont was built without MUMPS, so there is no SPARSE', &
                          'SOLVER AUTO, BAND or FRONTAL, or a build with libmumps-seq-dev installed')
  end subroutine report_solver_fault
end module epcont_report_solver
