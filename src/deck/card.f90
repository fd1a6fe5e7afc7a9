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

  !> The fields of one card. A slot is a data field: slots 1 to 8 are the fields 2 to 9, slots 9 to 16 the
  !> fields 12 to 19, and so on.
  type :: card_fields
    integer :: line = 0                          !! line of the name
    integer :: next = 0                          !! first line behind the card
    integer :: name_first = 1, name_last = 0     !! the name in the buffer, without `*`
    character(len=8) :: name = ''                !! the name in capitals, cut at eight characters
    integer :: count = 0                         !! slots: eight for each row
    type(place_type), allocatable :: field(:)    !! [slots or more] the columns of the whole field
    integer, allocatable :: first(:), last(:)    !! [slots or more] the value in the buffer; last < first: blank
    logical :: sound = .true.                    !! the lines can be cut into fields
    logical, private :: half_open = .false.      !! the last line was the first half of a large-field row
  contains
    procedure :: filled
    procedure :: is_large
    procedure :: place
    procedure :: name_place
  end type card_fields

contains

  !> Whether a slot is a large field of a fixed line: sixteen columns.
  pure logical function is_large(self, slot)
    class(card_fields), intent(in) :: self
    integer, intent(in) :: slot

    is_large = self%field(slot)%last - self%field(slot)%first == 15
  end function is_large

  !> Collect the card that begins at `line`, which is not blank, with its continuations.
  subroutine gather(lines, line, card, faults)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    type(card_fields), intent(inout) :: card  !! its arrays are used again
    type(diagnostics), intent(inout) :: faults

    if (.not. allocated(card%field)) call extend(card, 64)
    card%line = line
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

    continues = .true.
    do at = 1, min(width, len(text))
      if (at == 1 .and. (text(1:1) == '+' .or. text(1:1) == '*')) return
      if (text(at:at) == ',') return
      if (text(at:at) /= ' ') exit
    end do
    continues = at > width
  end function continues

  !> Add the fields of one line.
  subroutine add_line(lines, line, starts, card, faults)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    logical, intent(in) :: starts  !! the line holds the card's name
    type(card_fields), intent(inout) :: card
    type(diagnostics), intent(inout) :: faults
    integer :: comma, name_end, slot
    logical :: large

    call inspect(lines, line, comma, card%sound, faults)
    name_end = lines%first(line) + width - 1
    if (comma > 0) name_end = comma - 1
    name_end = min(name_end, lines%last(line))
    if (starts) then
      call take_name(lines%text, lines%first(line), name_end, card, large)
    else
      large = lines%text(lines%first(line):lines%first(line)) == '*'
    end if
    if (.not. card%sound) return
    call open_slots(large, card, slot)
    if (comma > 0) then
      call cut_free(lines, line, comma, merge(4, 8, large), slot, card, faults)
    else
      call cut_fixed(lines, line, merge(4, 8, large), slot, card)
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
    do at = lines%special(line), lines%last(line)
      code = iachar(lines%text(at:at))
      if (code < 32 .or. code > 126) then
        call add_character_fault(lines%columns(line, at, at), code, faults)
        sound = .false.
        return
      end if
      if (comma == 0 .and. lines%text(at:at) == ',') comma = at
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

  !> The name in `text(from:to)`; a `*` behind it means large fields.
  subroutine take_name(text, from, to, card, large)
    character(len=*), intent(in) :: text
    integer, intent(in) :: from, to
    type(card_fields), intent(inout) :: card
    logical, intent(out) :: large

    card%name_first = from
    card%name_last = to
    call trim_blanks(text, card%name_first, card%name_last)
    large = .false.
    if (card%name_last > card%name_first) large = text(card%name_last:card%name_last) == '*'
    if (large) then
      card%name_last = card%name_last - 1
      call trim_blanks(text, card%name_first, card%name_last)
    end if
    card%name = text(card%name_first:min(card%name_last, card%name_first + 7))
    card%name = upper(card%name)
  end subroutine take_name

  !> The slot where the fields of a line begin: a new row of eight, or the second half of a large-field row.
  subroutine open_slots(large, card, slot)
    logical, intent(in) :: large
    type(card_fields), intent(inout) :: card
    integer, intent(out) :: slot

    if (large .and. card%half_open) then
      slot = card%count - 3
      card%half_open = .false.
    else
      slot = card%count + 1
      card%half_open = large
      card%count = card%count + 8
      if (card%count > size(card%field)) call extend(card, 2*card%count)
    end if
  end subroutine open_slots

  !> Blank slots to the end of the row, of which the line says nothing: they are behind its end.
  subroutine add_blanks(lines, line, slot, card)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    integer, intent(in) :: slot  !! the first of them
    type(card_fields), intent(inout) :: card
    integer :: i, behind

    behind = lines%last(line) - lines%first(line) + 2
    do i = slot, card%count
      card%field(i) = place_type(line, behind, behind)
      card%first(i) = 1
      card%last(i) = 0
    end do
  end subroutine add_blanks

  !> Cut a line of fields of fixed width.
  subroutine cut_fixed(lines, line, fields, slot, card)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    integer, intent(in) :: fields  !! on the line, 8 or 4
    integer, intent(in) :: slot    !! the first of them
    type(card_fields), intent(inout) :: card
    integer :: i, step, column, from, to

    step = (last_data - width)/fields
    column = width + 1
    do i = slot, slot + fields - 1
      card%field(i) = place_type(line, column, column + step - 1)
      from = lines%first(line) + column - 1
      to = min(from + step - 1, lines%last(line))
      call trim_blanks(lines%text, from, to)
      card%first(i) = from
      card%last(i) = to
      column = column + step
    end do
    call add_blanks(lines, line, slot + fields, card)
  end subroutine cut_fixed

  !> Cut a line at its commas. Behind the data fields only a continuation mark may stand.
  subroutine cut_free(lines, line, comma, fields, slot, card, faults)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    integer, intent(in) :: comma   !! the first comma, in the buffer
    integer, intent(in) :: fields  !! that the line may hold
    integer, intent(in) :: slot    !! the first of them
    type(card_fields), intent(inout) :: card
    type(diagnostics), intent(inout) :: faults
    integer :: i, from, to, left, right

    call add_blanks(lines, line, slot, card)
    left = comma + 1
    i = slot
    do while (left <= lines%last(line))
      right = index(lines%text(left:lines%last(line)), ',') + left - 2
      if (right < left - 1) right = lines%last(line)
      from = left
      to = right
      call trim_blanks(lines%text, from, to)
      if (i < slot + fields) then
        card%field(i) = lines%columns(line, left, max(right, left))
        card%first(i) = from
        card%last(i) = to
      else if (from <= to .and. (i > slot + fields .or. scan(lines%text(from:max(from, to)), '+*') /= 1)) then
        card%sound = .false.
        call faults%add_error(lines%columns(line, from, lines%last(line)), &
                              'more than '//text_of(fields)//' data fields on a line', 'a continuation line for the rest')
        return
      end if
      i = i + 1
      left = right + 2
    end do
  end subroutine cut_free

  !> Move `from` and `to` inwards over blanks. These are compared by their codes: a character compared with a blank becomes
  !! a call of len_trim, which for so few characters costs more than the loop.
  pure subroutine trim_blanks(text, from, to)
    character(len=*), intent(in) :: text
    integer, intent(inout) :: from, to

    do while (from <= to)
      if (iachar(text(to:to)) /= iachar(' ')) exit
      to = to - 1
    end do
    do while (from < to)
      if (iachar(text(from:from)) /= iachar(' ')) exit
      from = from + 1
    end do
  end subroutine trim_blanks

  !> Room for `slots` slots.
  subroutine extend(card, slots)
    type(card_fields), intent(inout) :: card
    integer, intent(in) :: slots
    type(place_type), allocatable :: longer(:)

    allocate (longer(slots))
    if (allocated(card%field)) longer(:size(card%field)) = card%field
    call move_alloc(longer, card%field)
    call lengthen(card%first, slots)
    call lengthen(card%last, slots)
  end subroutine extend

  subroutine lengthen(list, length)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: length
    integer, allocatable :: longer(:)

    allocate (longer(length), source=0)
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

  !> The columns of a slot; those of the name where the card has no such line.
  pure function place(self, lines, slot)
    class(card_fields), intent(in) :: self
    type(source), intent(in) :: lines
    integer, intent(in) :: slot
    type(place_type) :: place

    if (slot > self%count) then
      place = self%name_place(lines)
    else
      place = self%field(slot)
    end if
  end function place

  !> The columns of the name.
  pure function name_place(self, lines) result(place)
    class(card_fields), intent(in) :: self
    type(source), intent(in) :: lines
    type(place_type) :: place

    place = lines%columns(self%line, self%name_first, max(self%name_first, self%name_last))
  end function name_place
end module epcont_deck_card
