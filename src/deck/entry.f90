!> What the catalogue says of a card and of each of its fields.
module epcont_deck_entry
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  implicit none
  private
  public :: field_entry, card_entry, new_card
  public :: id_field, integer_field, real_field, components_field, word_field, any_field
  public :: positive, cause, noted
  public :: slot_of, number_of

  !> Kinds of fields.
  integer, parameter, public :: kind_integer = 1, kind_real = 2, kind_components = 3, kind_word = 4, kind_any = 5
  !> The largest id.
  integer, parameter, public :: largest_id = 99999999
  !> Data fields on one line: numbers 2 to 9, then 12 to 19, and so on.
  integer, parameter :: fields_a_line = 8

  !> Sizes of numbers that have an effect: at most `farthest`; where zero is none, at least `least_divisor`; of what loads a
  !! scene (force, pressure, prescribed displacement, gap), zero or at least `least_cause`. Then works are numbers, though
  !! they are squares of it over stiffnesses, areas and lengths of `farthest`, and of what rounding leaves where loads cancel.
  real(wp), parameter, public :: farthest = 1.0e30_wp, least_divisor = 1.0e-30_wp, least_cause = 1.0e-60_wp

  !> One field of a card, or one PARAM. The procedures below make it; its user refines it.
  type :: field_entry
    integer :: number = 0              !! position, the card's name being 1
    character(len=8) :: name = ''
    integer :: kind = kind_any
    logical :: used = .true.           !! false: noted, that is accepted without effect
    logical :: required = .false.      !! may not be blank
    integer :: with = 0                !! may not be blank where the field of this number is filled
    integer :: same_as = 0             !! a blank means the value of the field of this number
    real(wp) :: default = 0.0_wp       !! the value of a blank field
    logical :: has_default = .false.   !! false: a blank has a meaning of its own
    real(wp) :: lowest = -huge(1.0_wp), highest = huge(1.0_wp)
    real(wp) :: least = 0.0_wp           !! least size, zero apart, of a number that has an effect
    logical :: point_optional = .false.  !! in large field a real without a decimal point serves too
    logical :: above_lowest = .false., below_highest = .false.  !! the limit itself is out of range
    character(len=:), allocatable :: choices  !! the words allowed, with blanks between; any if not allocated
    character(len=:), allocatable :: withdrawn  !! a word that was allowed once
    character(len=:), allocatable :: unit
    character(len=:), allocatable :: meaning
    character(len=:), allocatable :: reason   !! why the upper limit is out of range, or why nothing but zero is in
    character(len=:), allocatable :: instead  !! a value near the upper limit that would do
  contains
    procedure :: allowed
    procedure :: choices_text
  end type field_entry

  !> A card: its fields, and after them perhaps a list, of ids or of points, that is open at the end.
  type :: card_entry
    character(len=8) :: name = ''
    character(len=:), allocatable :: meaning
    type(field_entry), allocatable :: field(:)   !! in order of position [columns]
    integer, allocatable :: column_at(:)         !! by slot: the index into `field`; 0 where the field must be blank
    integer :: list_number = 0                   !! where the list begins; 0: there is none
    logical :: has_ranges = .false.              !! the list may hold `G1 THRU G2`
    logical :: has_steps = .false.               !! ranges may fall, or go on `BY` a step
    logical :: has_points = .false.              !! the list is of points `X1 Y1 X2 Y2 .. ENDT`, not of ids
    character(len=:), allocatable :: list_name, list_meaning
    logical :: has_words = .false.
  contains
    procedure :: add
    procedure :: add_list
    procedure :: add_points
    procedure :: column
    procedure :: last_number
    procedure :: field_name
  end type card_entry

contains

  !> The n-th data field of a card is at the position `number_of(n)`: every tenth and eleventh hold continuation marks.
  elemental integer function number_of(slot)
    integer, intent(in) :: slot

    number_of = 10*((slot - 1)/fields_a_line) + mod(slot - 1, fields_a_line) + 2
  end function number_of

  !> The inverse of `number_of`.
  elemental integer function slot_of(number)
    integer, intent(in) :: number

    slot_of = fields_a_line*((number - 2)/10) + mod(number - 2, 10) + 1
  end function slot_of

  function new_card(name, meaning) result(card)
    character(len=*), intent(in) :: name, meaning
    type(card_entry) :: card

    card%name = name
    card%meaning = meaning
    allocate (card%field(0), card%column_at(0))
  end function new_card

  !> Add a field behind the others.
  subroutine add(self, field)
    class(card_entry), intent(inout) :: self
    type(field_entry), intent(in) :: field
    type(field_entry), allocatable :: longer(:)
    integer :: slot

    allocate (longer(size(self%field) + 1))
    longer(:size(self%field)) = self%field
    longer(size(longer)) = field
    call move_alloc(longer, self%field)
    slot = slot_of(field%number)
    self%column_at = [self%column_at, spread(0, 1, slot - 1 - size(self%column_at)), size(self%field)]
    self%has_words = self%has_words .or. field%kind == kind_word
  end subroutine add

  !> End the card with a list of ids from position `number` on.
  subroutine add_list(self, number, name, meaning, has_ranges)
    class(card_entry), intent(inout) :: self
    integer, intent(in) :: number
    character(len=*), intent(in) :: name, meaning
    logical, intent(in) :: has_ranges

    self%list_number = number
    self%list_name = name
    self%list_meaning = meaning
    self%has_ranges = has_ranges
  end subroutine add_list

  !> End the card with a list of points from position `number` on: `X1 Y1 X2 Y2 .. ENDT`.
  subroutine add_points(self, number, meaning)
    class(card_entry), intent(inout) :: self
    integer, intent(in) :: number
    character(len=*), intent(in) :: meaning

    self%list_number = number
    self%list_name = ''
    self%list_meaning = meaning
    self%has_points = .true.
  end subroutine add_points

  !> The index of a field by its name; 0 where the card has none of that name.
  pure integer function column(self, name)
    class(card_entry), intent(in) :: self
    character(len=*), intent(in) :: name

    do column = size(self%field), 1, -1
      if (self%field(column)%name == name) return
    end do
    column = 0
  end function column

  !> The last position that may be filled.
  pure integer function last_number(self)
    class(card_entry), intent(in) :: self

    last_number = number_of(size(self%column_at))
    if (self%list_number > 0) last_number = huge(1)
  end function last_number

  !> The name of the field at position `number`; blank where it has none.
  pure function field_name(self, number) result(name)
    class(card_entry), intent(in) :: self
    integer, intent(in) :: number
    character(len=:), allocatable :: name
    integer :: slot

    name = ''
    slot = slot_of(number)
    if (self%has_points .and. number >= self%list_number) then
      slot = slot - slot_of(self%list_number)
      name = merge('X', 'Y', mod(slot, 2) == 0)//text_of(slot/2 + 1)
    else if (self%list_number > 0 .and. number >= self%list_number) then
      name = self%list_name//text_of(slot - slot_of(self%list_number) + 1)
    else if (slot <= size(self%column_at)) then
      if (self%column_at(slot) > 0) name = trim(self%field(self%column_at(slot))%name)
    end if
  end function field_name

  !> An id: from 1 to 99999999.
  function id_field(number, name, meaning, required, with) result(field)
    integer, intent(in) :: number
    character(len=*), intent(in) :: name, meaning
    logical, intent(in), optional :: required  !! default: true, unless it goes with another
    integer, intent(in), optional :: with
    type(field_entry) :: field

    field = new_field(number, name, kind_integer, meaning, '')
    field%lowest = 1.0_wp
    field%highest = real(largest_id, wp)
    field%required = .not. present(with)
    if (present(required)) field%required = required
    if (present(with)) field%with = with
  end function id_field

  !> A whole number from `lowest` to `highest`; a blank is `default`, or has a meaning of its own.
  function integer_field(number, name, meaning, lowest, highest, default) result(field)
    integer, intent(in) :: number
    character(len=*), intent(in) :: name, meaning
    integer, intent(in) :: lowest, highest
    integer, intent(in), optional :: default
    type(field_entry) :: field

    field = new_field(number, name, kind_integer, meaning, '')
    field%lowest = real(lowest, wp)
    field%highest = real(highest, wp)
    field%has_default = present(default)
    if (present(default)) field%default = real(default, wp)
  end function integer_field

  !> A real. Without default and not required, a blank has a meaning of its own.
  function real_field(number, name, meaning, unit, default, required) result(field)
    integer, intent(in) :: number
    character(len=*), intent(in) :: name, meaning, unit
    real(wp), intent(in), optional :: default
    logical, intent(in), optional :: required
    type(field_entry) :: field

    field = new_field(number, name, kind_real, meaning, unit)
    field%has_default = present(default)
    if (present(default)) field%default = default
    if (present(required)) field%required = required
  end function real_field

  !> Directions, digits from 1 to 6.
  function components_field(number, name, meaning, required, with) result(field)
    integer, intent(in) :: number
    character(len=*), intent(in) :: name, meaning
    logical, intent(in) :: required
    integer, intent(in), optional :: with
    type(field_entry) :: field

    field = new_field(number, name, kind_components, meaning, '')
    field%required = required
    if (present(with)) field%with = with
  end function components_field

  !> A word, one of `choices` where they are given.
  function word_field(number, name, meaning, choices) result(field)
    integer, intent(in) :: number
    character(len=*), intent(in) :: name, meaning
    character(len=*), intent(in), optional :: choices
    type(field_entry) :: field

    field = new_field(number, name, kind_word, meaning, '')
    field%required = .true.
    if (present(choices)) field%choices = choices
  end function word_field

  !> A field that may hold anything and has no effect.
  function any_field(number, name, meaning) result(field)
    integer, intent(in) :: number
    character(len=*), intent(in) :: name, meaning
    type(field_entry) :: field

    field = new_field(number, name, kind_any, meaning, '')
    field%used = .false.
  end function any_field

  function new_field(number, name, kind, meaning, unit) result(field)
    integer, intent(in) :: number, kind
    character(len=*), intent(in) :: name, meaning, unit
    type(field_entry) :: field

    field%number = number
    field%name = name
    field%kind = kind
    field%meaning = meaning
    field%unit = unit
  end function new_field

  !> A field that is above zero.
  function positive(plain) result(field)
    type(field_entry), intent(in) :: plain
    type(field_entry) :: field

    field = plain
    field%lowest = 0.0_wp
    field%above_lowest = .true.
    field%least = least_divisor
  end function positive

  !> A field that loads the scene.
  function cause(plain) result(field)
    type(field_entry), intent(in) :: plain
    type(field_entry) :: field

    field = plain
    field%least = least_cause
  end function cause

  !> A field that is checked and has no effect.
  function noted(plain) result(field)
    type(field_entry), intent(in) :: plain
    type(field_entry) :: field

    field = plain
    field%used = .false.
  end function noted

  !> What the field may hold, in words: `a real above 0.0`.
  pure function allowed(self) result(text)
    class(field_entry), intent(in) :: self
    character(len=:), allocatable :: text

    select case (self%kind)
    case (kind_integer)
      text = 'a whole number from '//text_of(nint(self%lowest))//' to '//text_of(nint(self%highest))
      if (self%lowest >= self%highest) text = text_of(nint(self%lowest))//' or blank'
    case (kind_real)
      text = real_range(self)
    case (kind_components)
      text = 'digits from 1 to 6, each at most once'
    case (kind_word)
      text = self%choices_text()
    case default
      text = 'anything'
    end select
    if (self%lowest >= self%highest .and. allocated(self%reason)) text = text//': '//self%reason
  end function allowed

  pure function real_range(self) result(text)
    type(field_entry), intent(in) :: self
    character(len=:), allocatable :: text
    logical :: lower, upper

    lower = self%lowest > -huge(1.0_wp)
    upper = self%highest < huge(1.0_wp)
    if (.not. (lower .or. upper)) then
      text = 'a real such as 1.5, 1.5E-3 or 1.5-3'
    else if (self%lowest >= self%highest) then
      text = decimal(self%lowest)//' or blank'
    else
      text = 'a real'
      if (lower) text = text//trim(merge(' above', ' from ', self%above_lowest))//' '//decimal(self%lowest)
      if (upper) text = text//trim(merge(' to below', ' to      ', self%below_highest))//' '//decimal(self%highest)
    end if
  end function real_range

  !> A limit as it would be written in a deck.
  pure function decimal(number) result(text)
    real(wp), intent(in) :: number
    character(len=:), allocatable :: text
    character(len=24) :: buffer

    write (buffer, '(f0.4)') number
    text = buffer(:verify(buffer, ' 0', back=.true.))
    if (text(len(text):) == '.') text = text//'0'
    if (text(1:1) == '.') text = '0'//text
  end function decimal

  !> `STRAIN or STRESS`.
  pure function choices_text(self) result(text)
    class(field_entry), intent(in) :: self
    character(len=:), allocatable :: text
    integer :: from, to

    if (.not. allocated(self%choices)) then
      text = 'a word of at most 8 characters, first a letter'
      return
    end if
    text = self%choices
    to = len(text) + 1
    from = index(text, ' ', back=.true.)
    if (from == 0) return
    text = commas(text(:from - 1))//' or '//text(from + 1:to - 1)
  end function choices_text

  !> A comma behind each word but the last.
  pure function commas(words) result(text)
    character(len=*), intent(in) :: words
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, len(words)
      if (words(i:i) == ' ') text = text//','
      text = text//words(i:i)
    end do
  end function commas
end module epcont_deck_entry
