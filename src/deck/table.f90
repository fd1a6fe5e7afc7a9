!> Table of the cards with one name, field by field.
module epcont_deck_table
  use epcont_base_diagnostic, only: place_type
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_deck_entry, only: card_entry, kind_word
  implicit none
  private
  public :: card_table, list_item

  !> Item of the list of a card: the ids from one to another, or a record of numbers.
  type :: list_item
    integer :: from = 0, to = 0, step = 1   !! ids
    real(wp) :: number(3) = 0.0_wp          !! numbers of a record, which may have fewer; integers are exact
    type(place_type) :: place               !! columns of its first field
  end type list_item

  !> All cards with one name.
  type :: card_table
    type(card_entry) :: entry                          !! catalogue entry
    integer :: count = 0                               !! cards
    real(wp), allocatable :: value(:, :)               !! numbers; integers are exact [columns, count]
    logical, allocatable :: given(:, :)                !! the field is not blank [columns, count]
    character(len=8), allocatable :: word(:, :)        !! words, if the card has such fields [columns, count]
    logical, allocatable :: sound(:)                   !! the card has no error [count]
    integer, allocatable :: line(:)                    !! first line of the card [count]
    integer :: items = 0                               !! number of items in all lists
    type(list_item), allocatable :: list(:)            !! items of all cards [items or more]
    !> Card i has the items list_start(i) to list_start(i+1)-1 [count + 1]
    integer, allocatable :: list_start(:)
  contains
    procedure :: begin
    procedure :: column
    procedure :: number
    procedure :: has
    procedure :: identity
    procedure :: begin_list
    procedure :: add_item
  end type card_table

contains

  !> Table of cards that are not read yet.
  subroutine begin(self, entry, line)
    class(card_table), intent(out) :: self
    type(card_entry), intent(in) :: entry   !! catalogue entry
    integer, intent(in) :: line(:)          !! first line of each card
    integer :: columns

    columns = size(entry%field)
    self%entry = entry
    self%line = line
    self%count = size(line)
    allocate (self%value(columns, self%count), source=0.0_wp)
    allocate (self%given(columns, self%count), source=.false.)
    if (any(entry%field%kind == kind_word)) allocate (self%word(columns, self%count), source=repeat(' ', 8))
    allocate (self%sound(self%count), source=.false.)
    allocate (self%list_start(self%count + 1), source=1)
    allocate (self%list(16))
  end subroutine begin

  !> Column of a field. An unknown name is an internal error.
  pure integer function column(self, name)
    class(card_table), intent(in) :: self
    character(len=*), intent(in) :: name   !! name of the field

    do column = size(self%entry%field), 1, -1
      if (self%entry%field(column)%name == name) return
    end do
    error stop 'no such field in the catalogue of cards'
  end function column

  !> Number in a field of a card.
  pure real(wp) function number(self, name, i)
    class(card_table), intent(in) :: self
    character(len=*), intent(in) :: name   !! name of the field
    integer, intent(in) :: i               !! row of the card

    number = self%value(self%column(name), i)
  end function number

  !> Is a field of a card not blank?
  pure logical function has(self, name, i)
    class(card_table), intent(in) :: self
    character(len=*), intent(in) :: name   !! name of the field
    integer, intent(in) :: i               !! row of the card

    has = self%given(self%column(name), i)
  end function has

  !> Name of a card in messages: `GRID 17`, `PARAM PLANE`; `GRID` if the card has no name.
  pure function identity(self, i) result(text)
    class(card_table), intent(in) :: self
    integer, intent(in) :: i   !! row of the card
    character(len=:), allocatable :: text

    text = trim(self%entry%name)
    if (.not. self%given(1, i)) return
    if (self%entry%field(1)%kind == kind_word) then
      text = text//' '//trim(self%word(1, i))
    else
      text = text//' '//text_of(nint(self%value(1, i)))
    end if
  end function identity

  !> Begin the list of a card. All items that are added later belong to it.
  pure subroutine begin_list(self, card)
    class(card_table), intent(inout) :: self
    integer, intent(in) :: card   !! row of the card

    self%list_start(card:card + 1) = self%items + 1
  end subroutine begin_list

  !> Add an item to the list of a card.
  pure subroutine add_item(self, card, item)
    class(card_table), intent(inout) :: self
    integer, intent(in) :: card           !! card whose list was begun last
    type(list_item), intent(in) :: item   !! ids or a record

    if (self%items == size(self%list)) self%list = [self%list, self%list]
    self%items = self%items + 1
    self%list(self%items) = item
    self%list_start(card + 1) = self%items + 1
  end subroutine add_item
end module epcont_deck_table
