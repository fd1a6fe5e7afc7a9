!> Models solved from decks that are written in a line.
module solved_scene
  use deck_texts, only: write_lines
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_base_diagnostic, only: diagnostics
  use epcont_build_build, only: build_model
  use epcont_certificate_certificate, only: certify
  use epcont_model_finding, only: findings
  use epcont_plasticity_observer, only: observer
  use epcont_solution, only: scene => solution_type
  implicit none
  private
  public :: certify_again, outward, scene, solve, solve_file

  !> A square of two triangles.
  character(len=*), parameter, public :: square = &
    'PARAM,PLANE,STRAIN|GRID,1,,0.0,0.0|GRID,2,,1.0,0.0|GRID,3,,1.0,1.0|GRID,4,,0.0,1.0|' // &
    'CTRIA3,1,1,1,2,3|CTRIA3,2,1,1,3,4|PSHELL,1,1,1.0|MAT1,1,2.1+5,,0.3|'
  !> It stands on a rigid floor of two nodes, unconstrained vertically.
  character(len=*), parameter, public :: block_on_floor = square // &
    'GRID,11,,0.0,0.0|GRID,12,,1.0,0.0|SPC1,1,1,1,4|SPC1,1,12,11,12|SUPORT,3,2|CORD2R,1,,0.0,0.0,0.0,0.0,0.0,1.0,+|' // &
    '+,0.0,1.0,0.0|CGAP,21,21,11,1,,,,1|CGAP,22,21,12,2,,,,1|PGAP,21,0.0|'
  character(len=*), parameter, public :: pressed = 'FORCE,1,3,0,100.,0.0,-1.0|FORCE,1,4,0,100.,0.0,-1.0|'

  character(len=*), parameter :: path = 'scene.dat'

contains

  !> Solve a deck whose lines end with bars.
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

  !> The certificate of a result that a test has changed.
  subroutine certify_again(solved, curve_tolerance)
    type(scene), intent(inout) :: solved
    real(wp), intent(in), optional :: curve_tolerance
    real(wp) :: tolerance

    tolerance = 0.0_wp
    if (present(curve_tolerance)) tolerance = curve_tolerance
    call certify(solved%model, solved%answer, tolerance, solved%certificate)
  end subroutine certify_again

  !> Mean radial displacement of the nodes at a radius.
  real(wp) function outward(solved, radius)
    type(scene), intent(in) :: solved
    real(wp), intent(in) :: radius
    real(wp), allocatable :: r(:)
    logical, allocatable :: there(:)

    r = norm2(solved%model%mesh%x, dim=1)
    there = abs(r - radius) < 1.0e-6_wp*radius
    outward = sum(sum(solved%model%mesh%x*solved%answer%displacement, dim=1)/r, mask=there)/count(there)
  end function outward
end module solved_scene
