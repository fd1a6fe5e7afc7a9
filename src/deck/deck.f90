!> A deck as the rest of the program sees it: what case control says, and a table of cards for each name.
module epcont_deck_deck
  use epcont_base_diagnostic, only: diagnostics, place_type
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_deck_bulk, only: read_bulk
  use epcont_deck_card, only: card_fields, gather
  use epcont_deck_card_kinds, only: card_param
  use epcont_deck_case_control, only: case_control, read_case_control
  use epcont_deck_source, only: read_source, source
  use epcont_deck_table, only: card_table
  implicit none
  private
  public :: deck_type, card_table, read_deck

  !> All that a deck says: titles, sets chosen and output wanted, as case control has it, and the cards.
  type, extends(case_control) :: deck_type
    type(source) :: source                         !! its text
    logical :: whole = .true.                      !! all files were read, to the end
    type(card_table), allocatable :: card(:)  !! its cards, and what the catalogue says of them [card_kinds]
  contains
    procedure :: place
    procedure :: parameter_row
    procedure :: parameter_word
    procedure :: parameter_value
    procedure :: forget_text
  end type deck_type

contains

  !> Read a deck. Faults in it are collected in `faults`; `error` is set where the file itself cannot be read.
  subroutine read_deck(path, deck, faults, error)
    character(len=*), intent(in) :: path   !! of the file
    type(deck_type), intent(out) :: deck   !! what it says
    type(diagnostics), intent(inout) :: faults   !! of the deck; they are added
    type(error_type), allocatable, intent(out) :: error   !! where the file cannot be read
    integer :: bulk

    call read_source(path, deck%source, faults, error)
    if (allocated(error)) return
    deck%whole = faults%errors == 0
    call read_case_control(deck%source, deck%case_control, bulk, faults)
    call read_bulk(deck%source, bulk, any(deck%subcase%temperature%id > 0), deck%card, faults)
  end subroutine read_deck

  !> The text, unless it is to be listed, and the fields of all cards but the parameters are done with: their
  !! memory is free for what follows. How many cards there are remains known.
  pure subroutine forget_text(self)
    class(deck_type), intent(inout) :: self
    integer :: k

    if (self%echo_unsorted .or. self%echo_sorted) return
    self%source = source()
    do k = 1, size(self%card)
      if (k /= card_param) self%card(k) = card_table(self%card(k)%entry, self%card(k)%count)
    end do
  end subroutine forget_text

  !> Where a field of a card stands; the card is cut into fields once more to find out. Items of lists, of
  !! which a card may have ten thousands, have kept their places.
  type(place_type) function place(self, card, i, field)
    class(deck_type), intent(in) :: self
    integer, intent(in) :: card   !! which table: card_grid, ...
    integer, intent(in) :: i      !! which card of it
    integer, intent(in) :: field  !! column in the table; 0: the name of the card; -k: item k of all its lists
    type(card_fields) :: fields
    type(diagnostics) :: unheard

    if (field < 0) then
      place = self%card(card)%list(-field)%place
    else
      call gather(self%source, self%card(card)%line(i), fields, unheard)
      place = fields%place(field)
    end if
  end function place

  !> The first PARAM card of a name; 0 where there is none.
  pure integer function parameter_row(self, name) result(row)
    class(deck_type), intent(in) :: self
    character(len=*), intent(in) :: name   !! of the parameter

    row = findloc(self%card(card_param)%word(1, :) == name, .true., dim=1)
  end function parameter_row

  !> The word that a PARAM says; blank if it is at fault, or there is no such card.
  pure function parameter_word(self, name) result(word)
    class(deck_type), intent(in) :: self
    character(len=*), intent(in) :: name   !! of the parameter
    character(len=8) :: word
    integer :: row

    word = ''
    row = self%parameter_row(name)
    if (row > 0) word = self%card(card_param)%word(2, row)
  end function parameter_word

  !> The number that a PARAM says, 0 if it is at fault; `default` where there is no such card.
  pure real(wp) function parameter_value(self, name, default) result(value)
    class(deck_type), intent(in) :: self
    character(len=*), intent(in) :: name   !! of the parameter
    real(wp), intent(in) :: default   !! the value without such a card
    integer :: row

    value = default
    row = self%parameter_row(name)
    if (row > 0) value = self%card(card_param)%value(2, row)
  end function parameter_value
end module epcont_deck_deck
