!> Messages of the program for a deck that is written in a line, and the model that it makes.
module deck_faults
  use deck_texts, only: bars, read_lines, told
  use epcont_deck_deck, only: deck_type
  use epcont_base_diagnostic, only: diagnostics
  use epcont_deck_render, only: render, render_notes
  use epcont_build_build, only: build_model, tell
  use epcont_model_load_cases, only: load_cases
  use epcont_model_model, only: model_type
  use epcont_plan_planned_model, only: planned_model
  implicit none
  private
  public :: faults_of, model_of, notes_of, told

  !> A square of two triangles: nodes 1 to 4, elements 1 and 2; two of its nodes are fixed.
  character(len=*), parameter, public :: square = &
    'PARAM,PLANE,STRAIN|' // &
    'GRID,1,,0.0,0.0|' // &
    'GRID,2,,1.0,0.0|' // &
    'GRID,3,,1.0,1.0|' // &
    'GRID,4,,0.0,1.0|' // &
    'CTRIA3,1,1,1,2,3|' // &
    'CTRIA3,2,1,1,3,4|' // &
    'PSHELL,1,1,1.0|' // &
    'MAT1,1,1.0+5,,0.3|'
  character(len=*), parameter, public :: held = 'SPC1,1,12,1,2|'

  !> Two squares, one over the other, 0.1 apart, and the cards that pairs between them need.
  character(len=*), parameter, public :: squares = &
    'PARAM,PLANE,STRAIN|PSHELL,1,1,1.0|MAT1,1,1.0+5,,0.3|SPC1,1,12,1,2,13,14|' // &
    'GRID,1,,0.0,0.0|GRID,2,,1.0,0.0|GRID,3,,1.0,1.0|GRID,4,,0.0,1.0|' // &
    'GRID,11,,0.0,1.1|GRID,12,,1.0,1.1|GRID,13,,1.0,2.1|GRID,14,,0.0,2.1|' // &
    'CTRIA3,1,1,1,2,3|CTRIA3,2,1,1,3,4|CTRIA3,3,1,11,12,13|CTRIA3,4,1,11,13,14|'
  character(len=*), parameter, public :: frame = 'CORD2R,1,,0.0,0.0,0.0,0.0,0.0,1.0|,0.0,1.0,0.0|PGAP,1,0.1|'

contains

  !> The errors and warnings of a deck whose lines end with bars; lines of the result do, too.
  function faults_of(cards) result(words)
    character(len=*), intent(in) :: cards
    character(len=:), allocatable :: words
    type(deck_type) :: deck
    type(diagnostics) :: faults

    call check_deck(cards, deck, faults)
    words = bars(render(faults, deck%source))
  end function faults_of

  !> The warnings and notes of a deck, as in the listing.
  function notes_of(cards) result(words)
    character(len=*), intent(in) :: cards
    character(len=:), allocatable :: words
    type(deck_type) :: deck
    type(diagnostics) :: faults

    call check_deck(cards, deck, faults)
    words = bars(render_notes(faults, deck%source))
  end function notes_of

  !> Read a deck and check it, with the supports and contacts of each load case.
  subroutine check_deck(cards, deck, faults)
    character(len=*), intent(in) :: cards
    type(deck_type), intent(out) :: deck
    type(diagnostics), intent(out) :: faults
    type(diagnostics) :: of_pattern
    type(load_cases) :: cases
    type(planned_model) :: scene
    integer :: i, k, p

    call read_lines(cards//'ENDDATA|', deck, faults)
    call build_model(deck, scene%model, faults, cases)
    if (faults%errors == 0) call scene%find_motions(faults)
    call tell(deck, faults, 1)
    do p = 2, cases%patterns
      of_pattern = diagnostics()
      call build_model(deck, scene%model, of_pattern, of_pattern=p)
      if (of_pattern%errors == 0) call scene%find_motions(of_pattern)
      call tell(deck, of_pattern, findloc(cases%case%pattern, p, dim=1))
      do i = 1, of_pattern%count
        if (all([(faults%list(k)%what /= of_pattern%list(i)%what, k=1, faults%count)])) call faults%add(of_pattern%list(i))
      end do
    end do
  end subroutine check_deck

  !> The model of a valid deck whose lines end with bars.
  function model_of(cards) result(model)
    character(len=*), intent(in) :: cards
    type(model_type) :: model
    type(deck_type) :: deck
    type(diagnostics) :: faults

    call read_lines(cards//'ENDDATA|', deck, faults)
    call build_model(deck, model, faults)
    if (faults%errors > 0) error stop 'deck_faults: the deck is not sound'
  end function model_of
end module deck_faults
