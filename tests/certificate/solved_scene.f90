!> Scenes solved from decks that are written in a line.
module solved_scene
  use epcont_accuracy_accuracy, only: accuracy_type
  use epcont_analysis, only: analyse
  use epcont_base_error, only: error_type
  use epcont_certificate_certificate, only: certificate_type
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_build_build, only: build_model
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: find_free_motions, motion_fault
  use epcont_plan_iteration_plan, only: plan_iteration
  use epcont_plan_numbering, only: number_equations
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_plasticity_onlooker, only: onlooker
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: scene, solve, solve_file

  character(len=*), parameter :: path = 'scene.dat'

  type :: scene
    type(model_type) :: model
    type(answer_type) :: answer
    type(certificate_type) :: certificate
    type(accuracy_type) :: accuracy
    integer :: singular = 0
  end type scene

contains

  !> Solve a deck whose lines end in bars.
  subroutine solve(cards, solved)
    character(len=*), intent(in) :: cards
    type(scene), intent(out) :: solved
    character(len=:), allocatable :: text
    integer :: i, unit

    text = cards//'ENDDATA|'
    do i = 1, len(text)
      if (text(i:i) == '|') text(i:i) = new_line('a')
    end do
    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace')
    write (unit) text
    close (unit)
    call solve_file(path, solved)
  end subroutine solve

  !> Solve a deck.
  subroutine solve_file(path, solved)
    character(len=*), intent(in) :: path
    type(scene), intent(out) :: solved
    type(deck_type) :: deck
    type(diagnostics) :: faults
    type(error_type), allocatable :: error
    type(planned_scene) :: planned
    type(motion_fault), allocatable :: loose(:)
    type(onlooker) :: watch

    call read_deck(path, deck, faults, error)
    call build_model(deck, solved%model, faults)
    if (faults%error_count() > 0) error stop 'solved_scene: the deck is not sound'
    planned%model = solved%model
    call find_free_motions(planned%model, planned%motions, loose)
    planned%numbering = number_equations(planned%model)
    if (size(loose) > 0) error stop 'solved_scene: a body is loose'
    call analyse(planned, plan_iteration(planned%model), solved%answer, solved%certificate, solved%accuracy, watch)
    solved%singular = solved%answer%singular
  end subroutine solve_file
end module solved_scene
