!> The cards of one name, field by field, as the reader hands them on.
module epcont_deck_table
  use epcont_base_kinds, only: wp
  use epcont_deck_diagnostic, only: place_type
  use epcont_deck_entry, only: card_entry, field_entry
  implicit none
  private
  public :: card_table, new_table

  integer, parameter :: first_room = 16  !! cards (or list items) a table holds before it first grows

  !> All cards of one name. While it is being read its arrays have room to spare; `finish` cuts them to size.
  type :: card_table
    integer :: count = 0                               !! cards
    character(len=8), allocatable :: name(:)           !! of each field [columns]
    real(wp), allocatable :: default(:)                !! value of a blank field [columns]
    integer, allocatable :: defaulted(:)               !! the columns where that is not zero
    integer, allocatable :: same_as(:)                 !! column whose value a blank takes, or 0 [columns]
    real(wp), allocatable :: value(:, :)               !! numbers; integers are exact [columns, count]
    logical, allocatable :: given(:, :)                !! the field is not blank [columns, count]
    character(len=8), allocatable :: word(:, :)        !! words; only where the card has such fields [columns, count]
    logical, allocatable :: sound(:)                   !! the reader found no fault in the card [count]
    integer, allocatable :: line(:)                    !! where the card begins [count]
    integer, allocatable :: noted(:)                   !! how often each field without effect is filled [columns]
    integer, allocatable :: noted_card(:)              !! the first card in which it is [columns]
    !> Open lists: card i has the items list_start(i) to list_start(i+1)-1, each the ids list_from to list_to by
    !! list_step, or the point list_point. [count + 1], [items], [2, items]
    integer, allocatable :: list_start(:), list_from(:), list_to(:), list_step(:)
    real(wp), allocatable :: list_point(:, :)
    type(place_type), allocatable :: list_place(:)     !! where each item stands [items]
    integer :: items = 0                               !! in all lists
  contains
    procedure :: column
    procedure :: reserve
    procedure :: add_card
    procedure :: add_item
    procedure :: add_point
    procedure :: finish
    procedure :: forget_fields
  end type card_table

contains

  !> An empty table for the cards of an entry of the catalogue.
  function new_table(entry) result(table)
    type(card_entry), intent(in) :: entry
    type(card_table) :: table
    integer :: columns, i

    columns = size(entry%field)
    allocate (table%name(columns), table%default(columns), table%same_as(columns))
    do i = 1, columns
      table%name(i) = entry%field(i)%name
      table%default(i) = entry%field(i)%default
      table%same_as(i) = column_at(entry%field, entry%field(i)%same_as)
    end do
    table%defaulted = pack([(i, i=1, columns)], table%default /= 0.0_wp)
    allocate (table%noted(columns), table%noted_card(columns), source=0)
    allocate (table%list_start(1), source=1)
    allocate (table%value(columns, 0), table%given(columns, 0), table%sound(0), table%line(0))
    allocate (table%list_from(0), table%list_to(0), table%list_step(0), table%list_place(0), table%list_point(2, 0))
    if (entry%has_words) allocate (table%word(columns, 0))
  end function new_table

  !> The column of the field at a position; 0 where there is none.
  pure integer function column_at(field, number)
    type(field_entry), intent(in) :: field(:)
    integer, intent(in) :: number

    do column_at = size(field), 1, -1
      if (field(column_at)%number == number) return
    end do
    column_at = 0
  end function column_at

  !> The column of a field by name. A name that the catalogue has not is a fault of the program.
  pure integer function column(self, name)
    class(card_table), intent(in) :: self
    character(len=*), intent(in) :: name

    do column = size(self%name), 1, -1
      if (self%name(column) == name) return
    end do
    error stop 'no such field in the catalogue of cards'
  end function column

  !> Room for `cards` cards; more may come.
  subroutine reserve(self, cards)
    class(card_table), intent(inout) :: self
    integer, intent(in) :: cards

    if (cards > size(self%line)) call resize(self, cards)
  end subroutine reserve

  !> Add a card, all its fields blank; it begins at the source line `line`.
  subroutine add_card(self, line)
    class(card_table), intent(inout) :: self
    integer, intent(in) :: line
    integer :: k

    if (self%count == size(self%line)) call resize(self, max(first_room, 2*self%count))
    self%count = self%count + 1
    do k = 1, size(self%defaulted)
      self%value(self%defaulted(k), self%count) = self%default(self%defaulted(k))
    end do
    self%sound(self%count) = .true.
    self%line(self%count) = line
    self%list_start(self%count + 1) = self%items + 1
  end subroutine add_card

  !> Add an item to the list of the last card.
  subroutine add_item(self, from, to, place, step)
    class(card_table), intent(inout) :: self
    integer, intent(in) :: from, to        !! the first and the last id
    type(place_type), intent(in) :: place  !! of the first
    integer, intent(in), optional :: step  !! from one id to the next; default 1

    if (self%items == size(self%list_from)) call resize_list(self, max(first_room, 2*self%items))
    self%items = self%items + 1
    self%list_from(self%items) = from
    self%list_to(self%items) = to
    self%list_step(self%items) = 1
    if (present(step)) self%list_step(self%items) = step
    self%list_place(self%items) = place
    self%list_start(self%count + 1) = self%items + 1
  end subroutine add_item

  !> Add a point to the list of the last card.
  subroutine add_point(self, point, place)
    class(card_table), intent(inout) :: self
    real(wp), intent(in) :: point(2)
    type(place_type), intent(in) :: place   !! of its first number

    call self%add_item(0, 0, place)
    if (size(self%list_point, 2) < self%items) call resize_points(self%list_point, size(self%list_from))
    self%list_point(:, self%items) = point
  end subroutine add_point

  !> Cut the arrays to size.
  subroutine finish(self)
    class(card_table), intent(inout) :: self

    call resize(self, self%count)
    call resize_list(self, self%items)
    if (size(self%list_point) > 0) call resize_points(self%list_point, self%items)
  end subroutine finish

  !> All but the count of cards.
  pure subroutine forget_fields(self)
    class(card_table), intent(inout) :: self

    deallocate (self%value, self%given, self%sound, self%line, self%list_start)
    deallocate (self%list_from, self%list_to, self%list_step, self%list_place, self%list_point)
    if (allocated(self%word)) deallocate (self%word)
  end subroutine forget_fields

  !> Room for `room` cards, the cards so far kept; all fields of the others are blank, and zero.
  subroutine resize(self, room)
    type(card_table), intent(inout) :: self
    integer, intent(in) :: room
    real(wp), allocatable :: value(:, :)
    logical, allocatable :: given(:, :)
    character(len=8), allocatable :: word(:, :)
    integer :: columns, kept

    columns = size(self%name)
    kept = self%count
    if (room == size(self%line)) return
    allocate (value(columns, room), given(columns, room))
    value = 0.0_wp
    given = .false.
    value(:, :kept) = self%value(:, :kept)
    given(:, :kept) = self%given(:, :kept)
    call move_alloc(value, self%value)
    call move_alloc(given, self%given)
    call resize_logicals(self%sound, room)
    call resize_integers(self%line, room)
    call resize_integers(self%list_start, room + 1)
    if (.not. allocated(self%word)) return
    allocate (word(columns, room))
    word = ''
    word(:, :kept) = self%word(:, :kept)
    call move_alloc(word, self%word)
  end subroutine resize

  !> Room for `room` items of lists, the items so far kept.
  subroutine resize_list(self, room)
    type(card_table), intent(inout) :: self
    integer, intent(in) :: room
    type(place_type), allocatable :: place(:)

    call resize_integers(self%list_from, room)
    call resize_integers(self%list_to, room)
    call resize_integers(self%list_step, room)
    allocate (place(room))
    place(:self%items) = self%list_place(:self%items)
    call move_alloc(place, self%list_place)
  end subroutine resize_list

  subroutine resize_points(point, room)
    real(wp), allocatable, intent(inout) :: point(:, :)
    integer, intent(in) :: room
    real(wp), allocatable :: resized(:, :)
    integer :: kept

    allocate (resized(2, room))
    kept = min(room, size(point, 2))
    resized(:, :kept) = point(:, :kept)
    call move_alloc(resized, point)
  end subroutine resize_points

  subroutine resize_integers(list, length)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: length
    integer, allocatable :: resized(:)
    integer :: kept

    allocate (resized(length))
    kept = min(length, size(list))
    resized(:kept) = list(:kept)
    call move_alloc(resized, list)
  end subroutine resize_integers

  subroutine resize_logicals(list, length)
    logical, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: length
    logical, allocatable :: resized(:)
    integer :: kept

    allocate (resized(length))
    kept = min(length, size(list))
    resized(:kept) = list(:kept)
    call move_alloc(resized, list)
  end subroutine resize_logicals
end module epcont_deck_table
