!> Scenes solved from decks that are written in a line.
module solved_scene
  use deck_texts, only: write_lines
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
  public :: outward, scene, solve, solve_file

  character(len=*), parameter :: path = 'scene.dat'

contains

  !> Solve a deck whose lines end in bars.
  subroutine solve(cards, solved)
    character(len=*), intent(in) :: cards
    type(scene), intent(out) :: solved

    call write_lines(path, cards//'ENDDATA|')
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

  !> Mean displacement outwards of the nodes at a radius.
  real(wp) function outward(solved, radius)
    type(scene), intent(in) :: solved
    real(wp), intent(in) :: radius
    real(wp), allocatable :: r(:)
    logical, allocatable :: there(:)

    r = norm2(solved%model%x, dim=1)
    there = abs(r - radius) < 1.0e-6_wp*radius
    outward = sum(sum(solved%model%x*solved%answer%displacement, dim=1)/r, mask=there)/count(there)
  end function outward
end module solved_scene
