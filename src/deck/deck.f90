!> A deck for the rest of the program: its case control, and a table for each card name.
module epcont_deck_deck
  use epcont_base_diagnostic, only: diagnostics, place_type
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: upper
  use epcont_deck_bulk, only: read_bulk
  use epcont_deck_card, only: card_fields, gather
  use epcont_deck_card_kinds, only: card_cbar, card_celas1, card_celas2, card_cgap, card_grid, card_param, &
      element_cards
  use epcont_deck_case_control, only: case_control, read_case_control
  use epcont_deck_source, only: read_source, source
  use epcont_deck_table, only: card_table
  implicit none
  private
  public :: deck_type, card_table, read_deck

  !> Contents of a deck: titles, chosen sets and requested output (case control), and the cards.
  type, extends(case_control) :: deck_type
    type(source) :: source                         !! text of the deck
    logical :: whole = .true.                      !! all files were read to their ends
    type(card_table), allocatable :: card(:)  !! cards by kind, with their catalogue entries [card_kinds]
  contains
    procedure :: place
    procedure :: is_part
    procedure :: is_sequence
    procedure :: parameter_row
    procedure :: parameter_word
    procedure :: parameter_value
    procedure :: forget_text
  end type deck_type

contains

  !> Read a deck. `faults` collects its errors; `error` is set if the file cannot be read.
  subroutine read_deck(path, deck, faults, error)
    character(len=*), intent(in) :: path   !! path of the file
    type(deck_type), intent(out) :: deck   !! contents
    type(diagnostics), intent(inout) :: faults   !! findings about the deck are added
    type(error_type), allocatable, intent(out) :: error   !! the file cannot be read
    integer :: bulk

    call read_source(path, deck%source, faults, error)
    if (allocated(error)) return
    deck%whole = faults%errors == 0
    call read_case_control(deck%source, deck%case_control, bulk, faults)
    call read_bulk(deck%source, bulk, deck%card, faults)
    if (.not. deck%source%ended) call check_end(deck, faults)
  end subroutine read_deck

  !> Report a missing ENDDATA, because the deck may be cut off. If a header has the numbers of nodes and
  !! elements that were read, this is a note.
  subroutine check_end(deck, faults)
    type(deck_type), intent(inout) :: deck       !! marked as incomplete if it looks cut off
    type(diagnostics), intent(inout) :: faults   !! an error or a note is added
    integer, parameter :: elements(*) = [element_cards, card_cbar, card_cgap, card_celas1, card_celas2]
    integer :: counts(2)
    type(place_type) :: place

    call read_header(deck%source, counts, place)
    deck%whole = deck%whole .and. all(counts == [deck%card(card_grid)%count, sum(deck%card(elements)%count)])
    if (place%line > 0 .and. deck%whole) then
      call faults%add_note(place, 'ENDDATA is missing; nodes and elements are as many as this header says')
    else
      deck%whole = .false.
      call faults%add_error(place_type(), 'ENDDATA is missing: the deck looks cut off', &
                            'end the deck with ENDDATA')
    end if
  end subroutine check_end

  !> Read the numbers of nodes and elements in a header by pyNastran: comments such as `$pyNastran: nnodes=9`.
  subroutine read_header(lines, counts, place)
    type(source), intent(in) :: lines        !! of the deck
    integer, intent(out) :: counts(2)        !! -1 if absent
    type(place_type), intent(out) :: place   !! columns of the last of them
    character(len=*), parameter :: key(2) = [character(len=10) :: 'NNODES=', 'NELEMENTS=']
    integer, parameter :: longest = 80       ! lines of a header
    character(len=:), allocatable :: text
    integer :: at, k, line, status

    counts = -1
    do line = 1, lines%count
      text = upper(lines%whole_line(line, longest))
      if (index(text, '$PYNASTRAN:') /= 1) cycle
      do k = 1, size(key)
        at = index(text, trim(key(k)))
        if (at == 0) cycle
        read (text(at + len_trim(key(k)):), '(i20)', iostat=status) counts(k)
        if (status /= 0) counts(k) = -1
        place = place_type(line, 1, len(text))
      end do
    end do
  end subroutine read_header

  !> Free the memory of the text, unless it is to be listed, and of all cards except the parameters. The
  !! numbers of cards remain known.
  pure subroutine forget_text(self)
    class(deck_type), intent(inout) :: self
    integer :: k

    if (self%echo_unsorted .or. self%echo_sorted) return
    self%source = source()
    do k = 1, size(self%card)
      if (k /= card_param) self%card(k) = card_table(self%card(k)%entry, self%card(k)%count)
    end do
  end subroutine forget_text

  !> Columns of a field of a card. The card is cut into fields again to find them. Items of lists keep their
  !! columns, because a card may have ten thousand items.
  type(place_type) function place(self, card, i, field)
    class(deck_type), intent(in) :: self
    integer, intent(in) :: card   !! table: card_grid, ...
    integer, intent(in) :: i      !! row of the card
    integer, intent(in) :: field  !! column; 0: name of the card; -k: item k of all its lists
    type(card_fields) :: fields
    type(diagnostics) :: unheard

    if (field < 0) then
      place = self%card(card)%list(-field)%place
    else
      call gather(self%source, self%card(card)%line(i), fields, unheard)
      place = fields%place(field)
    end if
  end function place

  !> Are the load cases part of a longer history: does it continue earlier loads, or is its end saved?
  pure logical function is_part(self)
    class(deck_type), intent(in) :: self

    is_part = self%restart /= '' .or. self%parameter_word('SAVE') == 'YES'
  end function is_part

  !> Does each load case start from the end of the one before?
  pure logical function is_sequence(self)
    class(deck_type), intent(in) :: self

    if (size(self%subcase) > 1) is_sequence = self%sequence%line > 0
    if (size(self%subcase) == 1) is_sequence = self%is_part()
  end function is_sequence

  !> Row of the first PARAM card of a name; 0 if there is no such card.
  pure integer function parameter_row(self, name) result(row)
    class(deck_type), intent(in) :: self
    character(len=*), intent(in) :: name   !! name of the parameter

    row = findloc(self%card(card_param)%word(1, :) == name, .true., dim=1)
  end function parameter_row

  !> Word of a PARAM; blank if the card has an error or does not exist.
  pure function parameter_word(self, name) result(word)
    class(deck_type), intent(in) :: self
    character(len=*), intent(in) :: name   !! name of the parameter
    character(len=8) :: word
    integer :: row

    word = ''
    row = self%parameter_row(name)
    if (row > 0) word = self%card(card_param)%word(2, row)
  end function parameter_word

  !> Number of a PARAM; 0 if it has an error; `default` if there is no such card.
  pure real(wp) function parameter_value(self, name, default) result(value)
    class(deck_type), intent(in) :: self
    character(len=*), intent(in) :: name   !! name of the parameter
    real(wp), intent(in) :: default   !! the value without such a card
    integer :: row

    value = default
    row = self%parameter_row(name)
    if (row > 0) value = self%card(card_param)%value(2, row)
  end function parameter_value
end module epcont_deck_deck
