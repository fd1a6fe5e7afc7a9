!> Physical lines to one card: its name and its fields, each with the columns where it stands.
!>
!> Small field: a name and eight fields of 8 columns. Large field (`*` behind the name): four of 16
!> columns, two lines to a row. Free field: commas. All may be mixed in one card:
!>
!>     GRID    1               0.0     0.0             a name, fields 2 to 9
!>     GRID*   1                               0.0     fields 2 to 5
!>     *       0.0                                     fields 6 to 9
!>     +       ...                                     fields 12 to 19
module epcont_deck_card
  use epcont_base_text, only: text_of, upper
  use epcont_deck_diagnostic, only: diagnostics, place_type
  use epcont_deck_source, only: source
  implicit none
  private
  public :: card_fields, gather

  integer, parameter :: width = 8            !! columns of a small field
  integer, parameter :: last_data = 72       !! columns behind are never data
  integer, parameter :: longest_fixed = 80   !! columns of a fixed line
  integer, parameter :: longest_free = 256   !! columns of a free line

  !> One line of a card. From it the columns of its slots follow, for which only faults ask.
  type :: card_line
    integer :: line = 0    !! which it is
    integer :: slot = 0    !! the first of its slots
    integer :: fields = 0  !! slots on it, 8 or 4
    integer :: comma = 0   !! its first comma, in the buffer; 0: a line of fields of fixed width
  end type card_line

  !> The fields of one card. A slot is a data field: slots 1 to 8 are the fields 2 to 9, slots 9 to 16 the
  !> fields 12 to 19, and so on.
  type :: card_fields
    integer :: line = 0                          !! line of the name
    integer :: next = 0                          !! first line behind the card
    integer :: name_first = 1, name_last = 0     !! the name in the buffer, without `*`
    character(len=8) :: name = ''                !! the name in capitals, cut at eight characters
    integer :: count = 0                         !! slots: eight for each row
    integer, allocatable :: first(:), last(:)    !! [slots or more] the value in the buffer; last < first: blank
    logical :: sound = .true.                    !! the lines can be cut into fields
    logical, private :: half_open = .false.      !! the last line was the first half of a large-field row
    logical, private :: large_name = .false.     !! there is a `*` behind the name
    integer, private :: name_field = 0           !! where the eight columns of the name begin; 0: it has not as many
    integer, private :: lines = 0                !! of the card
    type(card_line), allocatable, private :: at(:)  !! [lines or more]
  contains
    procedure :: filled
    procedure :: is_large
    procedure :: place
    procedure :: name_place
  end type card_fields

contains

  !> Whether a slot is a large field of a fixed line: sixteen columns.
  pure logical function is_large(self, lines, slot)
    class(card_fields), intent(in) :: self
    type(source), intent(in) :: lines
    integer, intent(in) :: slot
    type(place_type) :: place

    place = self%place(lines, slot)
    is_large = place%last - place%first == 15
  end function is_large

  !> Collect the card that begins at `line`, which is not blank, with its continuations.
  subroutine gather(lines, line, card, faults)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    type(card_fields), intent(inout) :: card  !! its arrays are used again
    type(diagnostics), intent(inout) :: faults

    if (.not. allocated(card%first)) call extend(card, 64)
    card%line = line
    card%lines = 0
    card%count = 0
    card%sound = .true.
    card%half_open = .false.
    call add_line(lines, line, .true., card, faults)
    card%next = line + 1
    do while (card%next <= lines%count)
      if (lines%last(card%next) >= lines%first(card%next)) then
        if (.not. continues(lines%text(lines%first(card%next):lines%last(card%next)))) exit
        call add_line(lines, card%next, .false., card, faults)
      end if
      card%next = card%next + 1
    end do
  end subroutine gather

  !> Is the line a continuation: its first field blank, `+...` or `*...`?
  pure logical function continues(text)
    character(len=*), intent(in) :: text
    integer :: at

    continues = text(1:1) == '+' .or. text(1:1) == '*'
    if (continues) return
    do at = 1, min(width, len(text))
      if (iachar(text(at:at)) /= iachar(' ')) exit
    end do
    continues = at > width
    if (.not. continues) continues = text(at:at) == ','
  end function continues

  !> Add the fields of one line.
  subroutine add_line(lines, line, starts, card, faults)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    logical, intent(in) :: starts  !! the line holds the card's name
    type(card_fields), intent(inout) :: card
    type(diagnostics), intent(inout) :: faults
    integer :: comma, name_end
    logical :: large

    call inspect(lines, line, comma, card%sound, faults)
    name_end = lines%first(line) + width - 1
    if (comma > 0) name_end = comma - 1
    name_end = min(name_end, lines%last(line))
    if (starts) then
      call take_name(lines%text, lines%first(line), name_end, card)
      large = card%large_name
    else
      large = lines%text(lines%first(line):lines%first(line)) == '*'
    end if
    if (.not. card%sound) return
    call open_slots(line, large, comma, card)
    if (comma > 0) then
      call cut_free(lines, card%at(card%lines), card, faults)
    else
      call cut_fixed(lines, card%at(card%lines), card)
    end if
  end subroutine add_line

  !> Look through a line: its first comma, and what may not be there.
  subroutine inspect(lines, line, comma, sound, faults)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    integer, intent(out) :: comma    !! in the buffer; 0: none
    logical, intent(inout) :: sound  !! becomes false where there is a fault
    type(diagnostics), intent(inout) :: faults
    integer :: at, code, longest

    comma = 0
    at = lines%special(line)
    do while (at <= lines%last(line))
      code = iachar(lines%text(at:at))
      if (code < 32 .or. code > 126) then
        call add_character_fault(lines%columns(line, at, at), code, faults)
        sound = .false.
        return
      end if
      if (comma == 0 .and. lines%text(at:at) == ',') comma = at
      at = at + 1
    end do
    longest = merge(longest_free, longest_fixed, comma > 0)
    if (lines%last(line) - lines%first(line) < longest) return
    sound = .false.
    call faults%add_error(place_type(line, longest + 1, lines%last(line) - lines%first(line) + 1), &
                          'the line goes on beyond column '//text_of(longest), 'nothing here')
  end subroutine inspect

  subroutine add_character_fault(place, code, faults)
    type(place_type), intent(in) :: place
    integer, intent(in) :: code
    type(diagnostics), intent(inout) :: faults

    if (code == 9) then
      call faults%add_error(place, 'a tab in column '//text_of(place%first), 'blanks: a tab has no width in columns')
    else
      call faults%add_error(place, 'a character that is not printable ASCII (code '//text_of(code)//')', &
                            'only comments and titles may hold such')
    end if
  end subroutine add_character_fault

  !> The name in `text(from:to)`; a `*` behind it means large fields. Most cards have the name of the one before.
  subroutine take_name(text, from, to, card)
    character(len=*), intent(in) :: text
    integer, intent(in) :: from, to
    type(card_fields), intent(inout) :: card
    integer :: before

    before = card%name_field
    card%name_field = merge(from, 0, to - from == width - 1)
    if (before > 0 .and. card%name_field > 0) then
      if (text(from:from + (width - 1)) == text(before:before + (width - 1))) then   ! of known length: no call
        card%name_first = card%name_first + from - before
        card%name_last = card%name_last + from - before
        return
      end if
    end if
    card%name_first = from
    card%name_last = to
    call trim_blanks(text, card%name_first, card%name_last)
    card%large_name = .false.
    if (card%name_last > card%name_first) card%large_name = text(card%name_last:card%name_last) == '*'
    if (card%large_name) then
      card%name_last = card%name_last - 1
      call trim_blanks(text, card%name_first, card%name_last)
    end if
    card%name = upper(text(card%name_first:min(card%name_last, card%name_first + 7)))
  end subroutine take_name

  !> Slots for the fields of a line: a new row of eight, or the second half of a large-field row. They are blank.
  subroutine open_slots(line, large, comma, card)
    integer, intent(in) :: line
    logical, intent(in) :: large
    integer, intent(in) :: comma  !! the first comma, in the buffer; 0: none
    type(card_fields), intent(inout) :: card
    integer :: slot

    if (large .and. card%half_open) then
      slot = card%count - 3
      card%half_open = .false.
    else
      slot = card%count + 1
      card%half_open = large
      card%count = card%count + 8
      if (card%count > size(card%first)) call extend(card, 2*card%count)
      card%last(slot:slot + 7) = 0
    end if
    card%lines = card%lines + 1
    card%at(card%lines) = card_line(line, slot, merge(4, 8, large), comma)
  end subroutine open_slots

  !> Cut a line of fields of fixed width.
  subroutine cut_fixed(lines, at, card)
    type(source), intent(in) :: lines
    type(card_line), intent(in) :: at
    type(card_fields), intent(inout) :: card
    integer :: slot, step, left, from, to, last

    step = field_width(at)
    last = lines%last(at%line)
    left = lines%first(at%line) + width
    do slot = at%slot, at%slot + at%fields - 1
      if (left > last) exit
      from = left
      to = min(left + step - 1, last)
      call trim_blanks(lines%text, from, to)
      card%first(slot) = from
      card%last(slot) = to
      left = left + step
    end do
  end subroutine cut_fixed

  !> Columns of each field on a line without commas.
  pure integer function field_width(at)
    type(card_line), intent(in) :: at

    field_width = (last_data - width)/at%fields
  end function field_width

  !> Cut a line at its commas. Behind the data fields only a continuation mark may stand.
  subroutine cut_free(lines, at, card, faults)
    type(source), intent(in) :: lines
    type(card_line), intent(in) :: at
    type(card_fields), intent(inout) :: card
    type(diagnostics), intent(inout) :: faults
    integer :: slot, from, to, left, right

    left = at%comma + 1
    slot = at%slot
    do while (left <= lines%last(at%line))
      right = field_end(lines, at%line, left)
      from = left
      to = right
      call trim_blanks(lines%text, from, to)
      if (slot < at%slot + at%fields) then
        card%first(slot) = from
        card%last(slot) = to
      else if (from <= to .and. (slot > at%slot + at%fields .or. scan(lines%text(from:max(from, to)), '+*') /= 1)) then
        card%sound = .false.
        call faults%add_error(lines%columns(at%line, from, lines%last(at%line)), &
                              'more than '//text_of(at%fields)//' data fields on a line', 'a continuation line for the rest')
        return
      end if
      slot = slot + 1
      left = right + 2
    end do
  end subroutine cut_free

  !> The last character of the field that begins at `left`: before the next comma, or at the end of the line.
  pure integer function field_end(lines, line, left)
    type(source), intent(in) :: lines
    integer, intent(in) :: line, left

    field_end = left + index(lines%text(left:lines%last(line)), ',') - 2
    if (field_end < left - 1) field_end = lines%last(line)
  end function field_end

  !> Move `from` and `to` inwards over blanks. These are compared by their codes: a character compared with a blank becomes
  !! a call of len_trim, which for so few characters costs more than the loop; so does an unrolled loop.
  pure subroutine trim_blanks(text, from, to)
    character(len=*), intent(in) :: text
    integer, intent(inout) :: from, to

    !GCC$ unroll 1
    do to = to, from, -1
      if (iachar(text(to:to)) /= iachar(' ')) exit
    end do
    if (iachar(text(from:from)) /= iachar(' ')) return   ! mostly so
    do while (from < to)
      if (iachar(text(from:from)) /= iachar(' ')) exit
      from = from + 1
    end do
  end subroutine trim_blanks

  !> Room for `slots` slots.
  subroutine extend(card, slots)
    type(card_fields), intent(inout) :: card
    integer, intent(in) :: slots
    type(card_line), allocatable :: longer(:)

    allocate (longer(slots/4))   ! no line has less slots
    if (allocated(card%at)) longer(:size(card%at)) = card%at
    call move_alloc(longer, card%at)
    call lengthen(card%first, slots)
    call lengthen(card%last, slots)
  end subroutine extend

  subroutine lengthen(list, length)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: length
    integer, allocatable :: longer(:)

    allocate (longer(length), source=1)
    if (allocated(list)) longer(:size(list)) = list
    call move_alloc(longer, list)
  end subroutine lengthen

  !> Is there anything in a slot?
  pure logical function filled(self, slot)
    class(card_fields), intent(in) :: self
    integer, intent(in) :: slot

    filled = .false.
    if (slot <= self%count) filled = self%last(slot) >= self%first(slot)
  end function filled

  !> The columns of a slot: those of the whole field, of the name where the card has no such line, and behind the line's end
  !! where it does not say anything of the slot.
  pure function place(self, lines, slot)
    class(card_fields), intent(in) :: self
    type(source), intent(in) :: lines
    integer, intent(in) :: slot
    type(place_type) :: place
    integer :: i, left, before, line

    place = self%name_place(lines)
    if (slot > self%count) return
    line = line_of(self, slot)
    associate (at => self%at(line))
      before = slot - at%slot
      left = lines%last(at%line) + 1
      if (before < at%fields .and. at%comma == 0) then
        left = width + before*field_width(at)
        place = place_type(at%line, left + 1, left + field_width(at))
        return
      else if (before < at%fields) then
        left = at%comma + 1
        do i = 1, before
          if (left <= lines%last(at%line)) left = field_end(lines, at%line, left) + 2
        end do
      end if
      left = min(left, lines%last(at%line) + 1)
      place = lines%columns(at%line, left, max(left, field_end(lines, at%line, left)))
    end associate
  end function place

  !> The last line of the card that begins with this slot or one before it.
  pure integer function line_of(self, slot) result(low)
    type(card_fields), intent(in) :: self
    integer, intent(in) :: slot
    integer :: high, middle

    low = 1
    high = self%lines
    do while (low < high)
      middle = high - (high - low)/2
      if (self%at(middle)%slot <= slot) then
        low = middle
      else
        high = middle - 1
      end if
    end do
  end function line_of

  !> The columns of the name.
  pure function name_place(self, lines) result(place)
    class(card_fields), intent(in) :: self
    type(source), intent(in) :: lines
    type(place_type) :: place

    place = lines%columns(self%line, self%name_first, max(self%name_first, self%name_last))
  end function name_place
end module epcont_deck_card
