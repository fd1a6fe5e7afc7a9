!> What is known of one deck's run: all that the listing, the tables and the messages are written from.
module epcont_report_run
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_report_outcome, only: outcome_type
  use epcont_solution, only: solution_type
  implicit none
  private
  public :: remarks_type, run_results

  !> Warnings and notes.
  type :: remarks_type
    integer :: warnings = 0, notes = 0
    character(len=:), allocatable :: of_deck     !! in lines; of warnings the place is followed by `warning: `
    character(len=:), allocatable :: of_answer   !! in lines, each a warning
    character(len=:), allocatable :: noted       !! notes of the answer, in lines
  end type remarks_type

  !> One deck's way, from its cards to its answer.
  type, extends(solution_type) :: run_results
    type(deck_type) :: deck
    type(diagnostics) :: faults
    type(remarks_type) :: remarks
    type(outcome_type) :: outcome
  end type run_results
end module epcont_report_run
