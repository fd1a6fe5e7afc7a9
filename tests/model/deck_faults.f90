!> What the program says of a deck that is written in a line, and makes of it.
module deck_faults
  use epcont_base_error, only: error_type
  use epcont_base_text, only: text_of
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_base_diagnostic, only: diagnostics
  use epcont_deck_render, only: render
  use epcont_build_build, only: build_model, tell
  use epcont_model_model, only: model_type
  use epcont_plan_planned_scene, only: planned_scene
  implicit none
  private
  public :: faults_of, model_of, told

  !> A square of two triangles: nodes 1 to 4, elements 1 and 2; two of its nodes held.
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

  !> Two squares, one over the other, 0.1 apart, and what pairs between them need.
  character(len=*), parameter, public :: squares = &
    'PARAM,PLANE,STRAIN|PSHELL,1,1,1.0|MAT1,1,1.0+5,,0.3|SPC1,1,12,1,2,13,14|' // &
    'GRID,1,,0.0,0.0|GRID,2,,1.0,0.0|GRID,3,,1.0,1.0|GRID,4,,0.0,1.0|' // &
    'GRID,11,,0.0,1.1|GRID,12,,1.0,1.1|GRID,13,,1.0,2.1|GRID,14,,0.0,2.1|' // &
    'CTRIA3,1,1,1,2,3|CTRIA3,2,1,1,3,4|CTRIA3,3,1,11,12,13|CTRIA3,4,1,11,13,14|'
  character(len=*), parameter, public :: frame = 'CORD2R,1,,0.0,0.0,0.0,0.0,0.0,1.0|,0.0,1.0,0.0|PGAP,1,0.1|'

  character(len=*), parameter :: path = 'bad.dat'
  character(len=1), parameter :: newline = new_line('a')

contains

  !> What is said of a deck, its lines ended by bars; the lines of the answer are, too.
  function faults_of(cards) result(words)
    character(len=*), intent(in) :: cards
    character(len=:), allocatable :: words
    type(deck_type) :: deck
    type(diagnostics) :: faults
    type(error_type), allocatable :: error
    type(planned_scene) :: scene

    call write_deck(cards)
    call read_deck(path, deck, faults, error)
    call build_model(deck, scene%model, faults)
    if (faults%errors == 0) call scene%find_motions(faults)
    call tell(deck, faults)
    words = replaced(render(faults, deck%source), newline, '|')
  end function faults_of

  !> All that is said of a deck whose faults are told in short, `11:7-9: what is wrong|what would be right|` each, or `0: ...`
  !! of the deck as a whole: with its name, the line, carets below the place, and how many there are.
  function told(cards, faults) result(words)
    character(len=*), intent(in) :: cards, faults
    character(len=:), allocatable :: words
    character(len=*), parameter :: noun(2, 2) = reshape(['error   ', 'warning ', 'errors  ', 'warnings'], [2, 2])
    character(len=:), allocatable :: count, place, remedy, rest, what
    integer :: first, found(2), k, last, line

    words = ''
    found = 0
    rest = faults
    do while (len(rest) > 0)
      what = part(rest, 1)
      remedy = part(rest, 2)
      rest = rest(len(what) + len(remedy) + 3:)
      k = merge(2, 1, index(what, ': warning: ') > 0)
      found(k) = found(k) + 1
      if (what(:2) == '0:') then
        words = words//path//what(2:)//'|  '//remedy//'|'
      else
        place = replaced(replaced(what(:index(what, ': ') - 1), ':', ' '), '-', ' ')//' 0'
        read (place, *) line, first, last
        words = words//path//':'//what//'|  '//part(cards, line)//'|'// &
                repeat(' ', first + 1)//repeat('^', max(first, last) - first + 1)//' '//remedy//'|'
      end if
    end do
    count = ''
    do k = 1, 2
      if (found(k) > 0) count = count//', '//text_of(found(k))//' '//trim(noun(k, min(found(k), 2)))
    end do
    if (len(count) > 0) words = words//path//': '//count(3:)//'|'
  end function told

  !> One of the parts of a text, each ended by a bar.
  pure function part(text, which)
    character(len=*), intent(in) :: text
    integer, intent(in) :: which
    character(len=:), allocatable :: part
    integer :: k

    part = text
    do k = 2, which
      part = part(index(part, '|') + 1:)
    end do
    part = part(:index(part, '|') - 1)
  end function part

  !> The scene of a deck that is sound, its lines ended by bars.
  function model_of(cards) result(model)
    character(len=*), intent(in) :: cards
    type(model_type) :: model
    type(deck_type) :: deck
    type(diagnostics) :: faults
    type(error_type), allocatable :: error

    call write_deck(cards)
    call read_deck(path, deck, faults, error)
    call build_model(deck, model, faults)
    if (faults%errors > 0) error stop 'deck_faults: the deck is not sound'
  end function model_of

  subroutine write_deck(cards)
    character(len=*), intent(in) :: cards
    integer :: unit

    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace')
    write (unit) replaced(cards//'ENDDATA|', '|', newline)
    close (unit)
  end subroutine write_deck

  !> A text with one character for another.
  pure function replaced(text, old, new) result(other)
    character(len=*), intent(in) :: text
    character(len=1), intent(in) :: old, new
    character(len=len(text)) :: other
    integer :: i

    other = text
    do i = 1, len(text)
      if (text(i:i) == old) other(i:i) = new
    end do
  end function replaced
end module deck_faults
