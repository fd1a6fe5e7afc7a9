!> What is known of one deck's run: all that the listing, the tables and the messages are written from.
module epcont_report_run
  use epcont_base_diagnostic, only: diagnostics
  use epcont_deck_deck, only: deck_type
  use epcont_report_outcome, only: outcome_type
  use epcont_solution, only: solution_type
  implicit none
  private
  public :: run_results

  !> One deck's way, from its cards to its answer.
  type, extends(solution_type) :: run_results
    type(deck_type) :: deck
    type(diagnostics) :: faults
    character(len=:), allocatable :: deck_notes   !! its warnings and notes, in lines
    type(outcome_type) :: outcome
  end type run_results
end module epcont_report_run
