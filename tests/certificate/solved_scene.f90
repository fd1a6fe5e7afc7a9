!> Scenes solved from decks that are written in a line.
module solved_scene
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_base_diagnostic, only: diagnostics
  use epcont_build_build, only: build_model
  use epcont_model_finding, only: findings
  use epcont_plasticity_observer, only: observer
  use epcont_solution, only: scene => solution_type
  implicit none
  private
  public :: scene, solve, solve_file

  character(len=*), parameter :: path = 'scene.dat'


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
    type(findings) :: loose
    type(observer) :: watch

    call read_deck(path, deck, faults, error)
    call build_model(deck, solved%model, faults)
    if (faults%errors > 0) error stop 'solved_scene: the deck is not sound'
    call solved%find_motions(loose)
    if (loose%errors > 0) error stop 'solved_scene: a body is loose'
    call solved%make_plan(watch)
    call solved%solve(huge(1.0_wp), watch, error)
  end subroutine solve_file
end module solved_scene
