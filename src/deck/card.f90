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
  use epcont_deck_entry, only: fields_a_line
  use epcont_deck_source, only: source
  implicit none
  private
  public :: card_fields, gather, continues, find_name

  integer, parameter :: width = 8            !! columns of a small field
  integer, parameter :: longest_fixed = 80   !! columns of a fixed line
  integer, parameter :: longest_free = 256   !! columns of a free line

  !> One line of a card. From it the columns of its slots follow, for which only faults ask.
  type :: card_line
    integer :: line = 0               !! which it is in the deck
    integer :: first = 1, last = 0    !! where it stands in the text of the card
    integer :: comma = 0              !! its first comma there; 0: a line of fields of fixed width
    integer :: slot = 1               !! the first of its slots
    integer :: fields = 0             !! slots on it, 8 or 4
  end type card_line

  !> The fields of one card. A slot is a data field: slots 1 to 8 are the fields 2 to 9, slots 9 to 16 the
  !> fields 12 to 19, and so on.
  type :: card_fields
    integer :: next = 0                        !! first line behind the card
    character(len=:), allocatable :: text      !! its lines, one behind the other
    integer :: count = 0                       !! slots: eight for each row
    integer, allocatable :: first(:), last(:)  !! [slots or more] the value in the text; last < first: blank
    logical :: sound = .true.                  !! the lines can be cut into fields
    logical, private :: half_open = .false.    !! the last line was the first half of a large-field row
    integer, private :: used = 0               !! characters of its text
    integer, private :: lines = 0
    type(card_line), allocatable, private :: at(:)  !! [lines or more]
  contains
    procedure :: filled
    procedure :: is_large
    procedure :: is_word
    procedure :: name
    procedure :: place
  end type card_fields

contains

  !> Collect the card that begins at `line`, which is not blank, with its continuations.
  subroutine gather(lines, line, card, faults)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    type(card_fields), intent(inout) :: card   !! its arrays are used again
    type(diagnostics), intent(inout) :: faults

    if (.not. allocated(card%at)) then
      allocate (card%at(16))
      allocate (card%first(64), card%last(64), source=1)
      card%text = repeat(' ', longest_free)
    end if
    card%lines = 0
    card%used = 0
    card%count = 0
    card%sound = .true.
    card%half_open = .false.
    card%next = line
    do while (card%next <= lines%count)
      associate (at => lines%line(card%next))
        if (at%last >= at%first) then
          if (card%next > line .and. .not. continues(lines%text(at%first:at%last))) exit
          call add_line(lines, card%next, card, faults)
        end if
      end associate
      card%next = card%next + 1
    end do
  end subroutine gather

  !> Is the line a continuation: its first field blank, `+...` or `*...`?
  pure logical function continues(text)
    character(len=*), intent(in) :: text   !! the line, which is not blank
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
  subroutine add_line(lines, line, card, faults)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    type(card_fields), intent(inout) :: card
    type(diagnostics), intent(inout) :: faults
    logical :: large
    integer :: length, first, last

    length = lines%line(line)%last - lines%line(line)%first + 1
    do while (len(card%text) < card%used + length)
      card%text = card%text//card%text
    end do
    if (card%lines == size(card%at)) card%at = [card%at, card%at]
    card%lines = card%lines + 1
    associate (at => card%at(card%lines))
      at = card_line(line, card%used + 1, card%used + length, slot=card%count + 1)
      card%used = at%last
      card%text(at%first:at%last) = lines%text(lines%line(line)%first:lines%line(line)%last)
      call inspect(lines, at, card%sound, faults)
      if (card%lines == 1) then
        call find_name(card%text(:at%last), at%comma, first, last, large)
      else
        large = card%text(at%first:at%first) == '*'
      end if
      if (.not. card%sound) return
      call open_slots(card, at, large)
      call cut(card, at, faults)
    end associate
  end subroutine add_line

  !> Look through a line: its first comma, and what may not be there.
  subroutine inspect(lines, at, sound, faults)
    type(source), intent(in) :: lines
    type(card_line), intent(inout) :: at
    logical, intent(inout) :: sound  !! becomes false where there is a fault
    type(diagnostics), intent(inout) :: faults
    integer :: k, code, longest

    associate (line => lines%line(at%line))
      do k = line%special, line%last
        code = iachar(lines%text(k:k))
        if (code < 32 .or. code > 126) then
          sound = .false.
          call add_character_fault(lines%columns(at%line, k, k), code, faults)
          return
        end if
        if (at%comma == 0 .and. lines%text(k:k) == ',') at%comma = at%first + k - line%first
      end do
    end associate
    longest = merge(longest_free, longest_fixed, at%comma > 0)
    if (at%last - at%first < longest) return
    sound = .false.
    call faults%add_error(place_type(at%line, longest + 1, at%last - at%first + 1), &
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

  !> The name of a card in its first line; a `*` behind it means large fields.
  pure subroutine find_name(text, comma, first, last, large)
    character(len=*), intent(in) :: text     !! the line
    integer, intent(in) :: comma             !! the first; 0: none
    integer, intent(out) :: first, last      !! the name, without `*`
    logical, intent(out) :: large

    first = 1
    last = min(width, len(text))
    if (comma > 0) last = comma - 1
    call trim_blanks(text, first, last)
    large = .false.
    if (last > first) large = text(last:last) == '*'
    if (.not. large) return
    last = last - 1
    call trim_blanks(text, first, last)
  end subroutine find_name

  !> Slots for the fields of a line: a new row of eight, or the second half of a large-field row. They are blank.
  pure subroutine open_slots(card, at, large)
    type(card_fields), intent(inout) :: card
    type(card_line), intent(inout) :: at
    logical, intent(in) :: large

    at%fields = merge(fields_a_line/2, fields_a_line, large)
    if (large .and. card%half_open) then
      at%slot = at%slot - at%fields
    else
      card%count = card%count + fields_a_line
      if (card%count > size(card%first)) then
        card%first = [card%first, card%first]
        card%last = [card%last, card%last]
      end if
      card%last(at%slot:card%count) = 0
    end if
    card%half_open = large .and. .not. card%half_open
  end subroutine open_slots

  !> Cut a line into its fields. Behind those of a free line only a continuation mark may stand.
  subroutine cut(card, at, faults)
    type(card_fields), intent(inout) :: card
    type(card_line), intent(in) :: at
    type(diagnostics), intent(inout) :: faults
    integer :: slot, from, to, left, right

    left = first_column(at)
    slot = at%slot
    do while (left <= at%last)
      right = field_end(card, at, left)
      from = left
      to = right
      call trim_blanks(card%text, from, to)
      if (slot < at%slot + at%fields) then
        card%first(slot) = from
        card%last(slot) = to
      else if (at%comma == 0) then
        return   ! columns behind the fields are never data
      else if (from <= to .and. (slot > at%slot + at%fields .or. scan(card%text(from:max(from, to)), '+*') /= 1)) then
        card%sound = .false.
        call faults%add_error(columns(at, from, at%last), 'more than '//text_of(at%fields)//' data fields on a line', &
                              'a continuation line for the rest')
        return
      end if
      slot = slot + 1
      left = right + merge(2, 1, at%comma > 0)
    end do
  end subroutine cut

  !> Where the first data field of a line begins.
  pure integer function first_column(at)
    type(card_line), intent(in) :: at

    first_column = at%first + width
    if (at%comma > 0) first_column = at%comma + 1
  end function first_column

  !> The last character of the field that begins at `left`.
  pure integer function field_end(card, at, left)
    type(card_fields), intent(in) :: card
    type(card_line), intent(in) :: at
    integer, intent(in) :: left

    if (at%comma == 0) then
      field_end = min(left + field_width(at) - 1, at%last)
    else
      field_end = left + index(card%text(left:at%last), ',') - 2
      if (field_end < left - 1) field_end = at%last
    end if
  end function field_end

  !> Columns of each field on a line without commas.
  pure integer function field_width(at)
    type(card_line), intent(in) :: at

    field_width = merge(width, 2*width, at%fields == fields_a_line)
  end function field_width

  !> Move `from` and `to` inwards over blanks. These are compared by their codes: a character compared with a blank
  !! becomes a call of len_trim, which for so few characters costs more than the loop; so does an unrolled loop.
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

  !> Is there anything in a slot?
  pure logical function filled(self, slot)
    class(card_fields), intent(in) :: self
    integer, intent(in) :: slot   !! which field

    filled = .false.
    if (slot <= self%count) filled = self%last(slot) >= self%first(slot)
  end function filled

  !> Does a slot hold this word?
  pure logical function is_word(self, slot, word)
    class(card_fields), intent(in) :: self
    integer, intent(in) :: slot              !! which field
    character(len=*), intent(in) :: word     !! in capitals

    is_word = .false.
    if (.not. self%filled(slot)) return
    if (self%last(slot) - self%first(slot) + 1 /= len(word)) return
    is_word = upper(self%text(self%first(slot):self%last(slot))) == word
  end function is_word

  !> The name as it is written, without `*`.
  pure function name(self)
    class(card_fields), intent(in) :: self
    character(len=:), allocatable :: name
    integer :: first, last
    logical :: large

    call find_name(self%text(:self%at(1)%last), self%at(1)%comma, first, last, large)
    name = self%text(first:last)
  end function name

  !> Whether a slot is a large field of a fixed line: sixteen columns.
  pure logical function is_large(self, slot)
    class(card_fields), intent(in) :: self
    integer, intent(in) :: slot   !! which field
    type(place_type) :: place

    place = self%place(slot)
    is_large = place%last - place%first == 15
  end function is_large

  !> The columns of a slot: those of the whole field, of the name for slot 0 and where the card has no such line, and
  !! behind the line's end where it does not say anything of the slot.
  pure type(place_type) function place(self, slot)
    class(card_fields), intent(in) :: self
    integer, intent(in) :: slot   !! which field; 0: the name
    integer :: k, left, first, last
    logical :: large

    if (slot < 1 .or. slot > self%count) then
      call find_name(self%text(:self%at(1)%last), self%at(1)%comma, first, last, large)
      place = columns(self%at(1), first, last)
      return
    end if
    associate (at => self%at(line_of(self, slot)))
      left = first_column(at)
      if (slot >= at%slot + at%fields) left = at%last + 1
      if (at%comma == 0 .and. slot < at%slot + at%fields) then
        left = left + (slot - at%slot)*field_width(at)
        place = columns(at, left, left + field_width(at) - 1)
        return
      end if
      do k = at%slot + 1, slot
        if (left <= at%last) left = field_end(self, at, left) + 2
      end do
      left = min(left, at%last + 1)
      place = columns(at, left, field_end(self, at, left))
    end associate
  end function place

  !> Characters of a line, at least the first of them, as columns.
  pure type(place_type) function columns(at, first, last)
    type(card_line), intent(in) :: at
    integer, intent(in) :: first, last   !! in the text of the card

    columns = place_type(at%line, first - at%first + 1, max(first, last) - at%first + 1)
  end function columns

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
end module epcont_deck_card
