!> A solver that the deck asks for and that is not there.
module epcont_report_solver
  use epcont_deck_card_kinds, only: card_param
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_linalg_sparse, only: sparse_fault
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
    character(len=:), allocatable :: fault

    if (model%controls%solver /= solver_sparse) return
    fault = sparse_fault()
    if (len(fault) == 0) return
    call faults%add_error(deck%place(card_param, deck%parameter_row('SOLVER'), 2), &
                          'PARAM SOLVER: there is no MUMPS, which SPARSE takes: '//fault, &
                          'SOLVER AUTO, BAND or FRONTAL, or an epcont built, and run, where libmumps-seq-dev is installed')
  end subroutine report_solver_fault
end module epcont_report_solver
