!> The cards of one name, field by field, as the reader hands them on.
module epcont_deck_table
  use epcont_base_diagnostic, only: place_type
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_deck_entry, only: card_entry, kind_word
  implicit none
  private
  public :: card_table, list_item

  !> One item of the open list of a card: the ids from one to another, or a record of numbers.
  type :: list_item
    integer :: from = 0, to = 0, step = 1   !! ids
    real(wp) :: number(3) = 0.0_wp          !! those of a record, which may be fewer; integers are exact
    type(place_type) :: place               !! where it begins
  end type list_item

  !> All cards of one name.
  type :: card_table
    type(card_entry) :: entry                          !! what the catalogue says of them
    integer :: count = 0                               !! cards
    real(wp), allocatable :: value(:, :)               !! numbers; integers are exact [columns, count]
    logical, allocatable :: given(:, :)                !! the field is not blank [columns, count]
    character(len=8), allocatable :: word(:, :)        !! words, where it has such fields [columns, count]
    logical, allocatable :: sound(:)                   !! the reader found no fault in the card [count]
    integer, allocatable :: line(:)                    !! where the card begins [count]
    integer :: items = 0                               !! in all lists
    type(list_item), allocatable :: list(:)            !! of all cards [items or more]
    !> card i has the items list_start(i) to list_start(i+1)-1 [count + 1]
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

  !> A table of cards that are still to be read.
  subroutine begin(self, entry, line)
    class(card_table), intent(out) :: self
    type(card_entry), intent(in) :: entry   !! what the catalogue says of them
    integer, intent(in) :: line(:)          !! where each begins
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

  !> The column of a field by name. A name that the catalogue has not is a fault of the program.
  pure integer function column(self, name)
    class(card_table), intent(in) :: self
    character(len=*), intent(in) :: name   !! of the field

    do column = size(self%entry%field), 1, -1
      if (self%entry%field(column)%name == name) return
    end do
    error stop 'no such field in the catalogue of cards'
  end function column

  !> The number in a field of a card.
  pure real(wp) function number(self, name, i)
    class(card_table), intent(in) :: self
    character(len=*), intent(in) :: name   !! of the field
    integer, intent(in) :: i               !! which card

    number = self%value(self%column(name), i)
  end function number

  !> Is a field of a card not blank?
  pure logical function has(self, name, i)
    class(card_table), intent(in) :: self
    character(len=*), intent(in) :: name   !! of the field
    integer, intent(in) :: i               !! which card

    has = self%given(self%column(name), i)
  end function has

  !> A card as messages name it: `GRID 17`, `PARAM PLANE`; `GRID` where it has no such name.
  pure function identity(self, i) result(text)
    class(card_table), intent(in) :: self
    integer, intent(in) :: i   !! which card
    character(len=:), allocatable :: text

    text = trim(self%entry%name)
    if (.not. self%given(1, i)) return
    if (self%entry%field(1)%kind == kind_word) then
      text = text//' '//trim(self%word(1, i))
    else
      text = text//' '//text_of(nint(self%value(1, i)))
    end if
  end function identity

  !> Begin the list of a card; items that are added from now on belong to it.
  pure subroutine begin_list(self, card)
    class(card_table), intent(inout) :: self
    integer, intent(in) :: card   !! which

    self%list_start(card:card + 1) = self%items + 1
  end subroutine begin_list

  !> Add an item to the list of a card.
  pure subroutine add_item(self, card, item)
    class(card_table), intent(inout) :: self
    integer, intent(in) :: card           !! the one that was begun last
    type(list_item), intent(in) :: item   !! ids or a record

    if (self%items == size(self%list)) self%list = [self%list, self%list]
    self%items = self%items + 1
    self%list(self%items) = item
    self%list_start(card + 1) = self%items + 1
  end subroutine add_item
end module epcont_deck_table
