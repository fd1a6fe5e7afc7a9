!> State of the run of one deck: the input of the listing, the tables and the messages.
module epcont_report_run
  use epcont_base_diagnostic, only: diagnostics
  use epcont_base_text, only: text_of
  use epcont_deck_deck, only: deck_type
  use epcont_model_load_cases, only: load_cases
  use epcont_messages_outcome, only: outcome_type
  use epcont_solution, only: solution_type
  implicit none
  private
  public :: run_results

  !> One deck, from its cards to its answer.
  type, extends(solution_type) :: run_results
    type(deck_type), pointer :: deck => null()    !! shared by its load cases
    type(load_cases), pointer :: cases => null()  !! shared too
    integer :: case = 1                           !! number of the current load case
    integer :: from_subcase = 0                   !! SUBCASE whose saved end the first one starts from; or 0
    type(diagnostics) :: faults
    character(len=:), allocatable :: deck_notes   !! its warnings and notes, in lines
    type(outcome_type) :: outcome
  contains
    procedure :: has_cases
    procedure :: case_suffix
    procedure :: wants_table
  end type run_results

contains

  !> Has the deck more than one load case?
  pure logical function has_cases(self)
    class(run_results), intent(in) :: self

    has_cases = size(self%deck%subcase) > 1
  end function has_cases

  !> Suffix of the files of one load case, after the name of the deck: `.case3`; empty if there is only one
  !! load case.
  pure function case_suffix(self) result(suffix)
    class(run_results), intent(in) :: self
    character(len=:), allocatable :: suffix

    suffix = ''
    if (self%has_cases()) suffix = '.case'//text_of(self%deck%subcase(self%case)%id)
  end function case_suffix

  !> Is a table requested, if the model has it?
  pure logical function wants_table(self, name, all_tables)
    class(run_results), intent(in) :: self
    character(len=*), intent(in) :: name   !! of the table
    logical, intent(in) :: all_tables      !! on the command line

    associate (case => self%deck%subcase(self%case))
      wants_table = .true.
      if (name == 'nodes') wants_table = all_tables .or. case%displacement .or. case%spcforces
      if (name == 'elements' .or. name == 'plastic') wants_table = all_tables .or. case%stress
    end associate
  end function wants_table
end module epcont_report_run
