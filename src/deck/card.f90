!> Assemble the physical lines of a card: its name and its fields, each with its columns.
!>
!> Small field: a name and eight fields of 8 columns. Large field (`*` behind the name): four of 16
!> columns, two lines to a row. Free field: commas. All may be mixed in one card:
!>
!>     GRID    1               0.0     0.0             a name, fields 2 to 9
!>     GRID*   1                               0.0     fields 2 to 5
!>     *       0.0                                     fields 6 to 9
!>     +       ...                                     fields 12 to 19
module epcont_deck_card
  use epcont_base_diagnostic, only: diagnostics, place_type
  use epcont_base_text, only: text_of
  use epcont_deck_entry, only: fields_a_line
  use epcont_deck_source, only: source
  implicit none
  private
  public :: card_fields, gather, continues, find_name

  integer, parameter :: &
    width = 8, &            !! columns of a small field
    longest_fixed = 80, &   !! columns of a fixed line
    longest_free = 256      !! columns of a free line

  !> Data field of a card.
  type :: card_slot
    integer :: first = 1, last = 0   !! the value in the text of the card; last < first: blank
    type(place_type) :: place        !! the whole field
  end type card_slot

  !> Fields of one card. Slots number the data fields: slots 1 to 8 are the fields 2 to 9, slots 9 to 16 the
  !! fields 12 to 19, and so on.
  type :: card_fields
    character(len=:), allocatable :: text       !! its lines, joined
    integer :: name_first = 1, name_last = 0    !! name in the text, without `*`
    integer :: count = 0                        !! slots: eight for each row
    type(card_slot), allocatable :: slot(:)     !! with a blank slot after the last [count + 1 or more]
    logical :: sound = .true.                   !! the lines can be cut into fields
    type(place_type), private :: name_place
  contains
    procedure :: filled
    procedure :: place
  end type card_fields

  !> Line of a card that is being cut.
  type :: line_state
    integer :: at                      !! number of the line
    integer :: before = 0, length = 0  !! characters of the card's text before this line, and in this line
    integer :: comma                   !! column of its first comma; 0 if its fields have fixed width
    integer :: first_slot, fields      !! first slot, and number of slots (8 or 4)
    logical :: half_open = .false.     !! the previous line was the first half of a large-field row
    integer :: mark   !! position in the text after the previous line's fields: its mark `+A` has the A here
  end type line_state

contains

  !> Collect the card that begins at `line`, which is not blank, with its continuations.
  subroutine gather(lines, line, card, faults)
    type(source), intent(in) :: lines   !! of the deck
    integer, intent(in) :: line   !! first line of the card
    type(card_fields), intent(inout) :: card   !! its arrays are reused
    type(diagnostics), intent(inout) :: faults   !! errors of form are added
    type(line_state) :: now
    integer :: at

    if (.not. allocated(card%slot)) then
      allocate (card%slot(64))
      card%text = repeat(' ', longest_free)
    end if
    card%count = 0
    card%sound = .true.
    do at = line, lines%count
      associate (next => lines%line(at))
        if (next%last < next%first) cycle
        if (at > line .and. .not. continues(lines%text(next%first:next%last))) exit
      end associate
      now%at = at
      call add_line(lines, at == line, card, now, faults)
    end do
  end subroutine gather

  !> Add the fields of one line.
  subroutine add_line(lines, is_first, card, now, faults)
    type(source), intent(in) :: lines
    logical, intent(in) :: is_first   !! first line of the card
    type(card_fields), intent(inout) :: card
    type(line_state), intent(inout) :: now
    type(diagnostics), intent(inout) :: faults
    logical :: large
    character(len=width) :: own   ! continuation mark, without its `+`

    associate (text => lines%line(now%at))
      now%before = now%before + now%length
      now%length = text%last - text%first + 1
      do while (len(card%text) < now%before + now%length)
        card%text = card%text//card%text
      end do
      card%text(now%before + 1:now%before + now%length) = lines%text(text%first:text%last)
    end associate
    call inspect(lines, card, now, faults)
    if (is_first) then
      call find_name(card%text(:now%length), now%comma, card%name_first, card%name_last, large)
      card%name_place = place_type(now%at, card%name_first, max(card%name_first, card%name_last))
    else
      large = card%text(now%before + 1:now%before + 1) == '*'
      if (now%mark <= now%before) then   ! nothing to compare: decks may be sorted
        own = card%text(now%before + 2:now%before + min(merge(now%comma - 1, width, now%comma > 0), &
                                                        now%length))
        if (own /= '' .and. own /= card%text(now%mark:now%before)) &
          call refuse(card, now%at, 1, width, &
                      'continues '//trim(own)//', not '//card%text(now%mark:now%before)// &
                      ' of the line before', 'keep the lines of a card together', faults)
      end if
    end if
    now%mark = now%before + merge(longest_fixed - width + 2, now%length + 1, now%comma == 0)
    if (.not. card%sound) return
    call open_slots(large, card, now)
    if (now%comma > 0) then
      call cut_free(now, card, faults)
    else
      call cut_fixed(now, card)
    end if
  end subroutine add_line

  !> Inspect a line: find its first comma, and report forbidden characters.
  subroutine inspect(lines, card, now, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(inout) :: card
    type(line_state), intent(inout) :: now
    type(diagnostics), intent(inout) :: faults
    integer :: code, column, k, longest

    now%comma = 0
    if (lines%line(now%at)%special <= lines%line(now%at)%last) &
      now%comma = index(card%text(now%before + 1:now%before + now%length), ',')
    do k = lines%line(now%at)%special, lines%line(now%at)%last
      code = iachar(lines%text(k:k))
      column = k - lines%line(now%at)%first + 1
      if (code == 9) then
        if (now%comma > 0) cycle   ! allowed like a blank: columns do not count
        call refuse(card, now%at, column, column, 'a tab in column '//text_of(column), &
                    'use blanks (a tab has no defined width), or commas', faults)
        return
      else if (code < 32 .or. code > 126) then
        call refuse(card, now%at, column, column, &
                    'a character that is not printable ASCII (code '//text_of(code)//')', &
                    'use ASCII except in comments and titles', faults)
        return
      end if
    end do
    longest = merge(longest_free, longest_fixed, now%comma > 0)
    if (now%length > longest) &
      call refuse(card, now%at, longest + 1, now%length, &
                  'the line goes on beyond column '//text_of(longest), 'leave these columns blank', faults)
  end subroutine inspect

  !> Report a line that cannot be cut into fields.
  subroutine refuse(card, at, first, last, what, remedy, faults)
    type(card_fields), intent(inout) :: card
    integer, intent(in) :: at            !! number of the line
    integer, intent(in) :: first, last   !! columns
    character(len=*), intent(in) :: what, remedy
    type(diagnostics), intent(inout) :: faults

    card%sound = .false.
    call faults%add_error(place_type(at, first, last), what, remedy)
  end subroutine refuse

  !> Add slots for the fields of a line: a new row of eight, or the second half of a large-field row. They are
  !! blank, and lie after the end of the line until it is cut.
  subroutine open_slots(large, card, now)
    logical, intent(in) :: large
    type(card_fields), intent(inout) :: card
    type(line_state), intent(inout) :: now

    now%fields = merge(fields_a_line/2, fields_a_line, large)
    now%first_slot = card%count + 1
    now%half_open = large .and. .not. now%half_open
    if (large .and. .not. now%half_open) then
      now%first_slot = now%first_slot - now%fields
    else
      card%count = card%count + fields_a_line
    end if
    if (card%count >= size(card%slot)) card%slot = [card%slot, card%slot]
    if (now%half_open .or. now%comma > 0) &   ! all other slots are cut, even after the end of the line
      card%slot(now%first_slot:card%count) = card_slot(place=place_type(now%at, now%length + 1, &
                                                                        now%length + 1))
    card%slot(card%count + 1)%last = 0
  end subroutine open_slots

  !> Cut a line of fields of fixed width.
  subroutine cut_fixed(now, card)
    type(line_state), intent(in) :: now
    type(card_fields), intent(inout) :: card
    integer :: slot, step, left, from, to

    step = width*fields_a_line/now%fields
    left = width
    do slot = now%first_slot, now%first_slot + now%fields - 1
      from = now%before + left + 1
      to = min(from + step - 1, now%before + now%length)
      if (from <= to) call trim_blanks(card%text, from, to)
      card%slot(slot) = card_slot(from, to, place_type(now%at, left + 1, left + step))
      left = left + step
    end do
  end subroutine cut_fixed

  !> Cut a line at its commas. Only a continuation mark may follow the data fields.
  subroutine cut_free(now, card, faults)
    type(line_state), intent(in) :: now
    type(card_fields), intent(inout) :: card
    type(diagnostics), intent(inout) :: faults
    integer :: slot, from, to, left, right

    slot = now%first_slot
    left = now%comma + 1
    do while (left <= now%length)
      right = left - 2 + index(card%text(now%before + left:now%before + now%length), ',')
      if (right < left - 1) right = now%length
      from = now%before + left
      to = now%before + right
      call trim_blanks(card%text, from, to)
      if (slot < now%first_slot + now%fields) then
        card%slot(slot) = card_slot(from, to, place_type(now%at, left, max(left, right)))
      else if (from <= to .and. &
               (slot > now%first_slot + now%fields .or. scan(card%text(from:max(from, to)), '+*') /= 1)) then
        call refuse(card, now%at, from - now%before, now%length, &
                    'more than '//text_of(now%fields)//' data fields on a line', &
                    'continue on the next line', faults)
        return
      end if
      slot = slot + 1
      left = right + 2
    end do
  end subroutine cut_free

  !> Is the line a continuation: does it begin with a blank field, `+...` or `*...`?
  pure logical function continues(text)
    character(len=*), intent(in) :: text   !! line that is not blank
    integer :: at

    continues = text(1:1) == '+' .or. text(1:1) == '*'
    if (continues) return
    do at = 1, min(width, len(text))
      if (iachar(text(at:at)) > iachar(' ')) exit
    end do
    continues = at > width .or. text(at:at) == ','
  end function continues

  !> Find the name of a card in its first line; a `*` after the name means large fields.
  pure subroutine find_name(text, comma, first, last, large)
    character(len=*), intent(in) :: text     !! first line
    integer, intent(in) :: comma             !! column of the first comma; 0 if there is no comma
    integer, intent(out) :: first, last      !! range of the name, without `*`
    logical, intent(out) :: large   !! a `*` follows the name

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

  !> Move `from` and `to` inwards over blanks and tabs. Character codes are compared, because comparing a
  !! character with a blank becomes a call of len_trim, which costs more than the loop.
  pure subroutine trim_blanks(text, from, to)
    character(len=*), intent(in) :: text
    integer, intent(inout) :: from, to

    do while (to >= from)
      if (iachar(text(to:to)) > iachar(' ')) exit
      to = to - 1
    end do
    if (iachar(text(from:from)) > iachar(' ')) return   ! the usual case
    do while (from < to)
      if (iachar(text(from:from)) > iachar(' ')) exit
      from = from + 1
    end do
  end subroutine trim_blanks

  !> Is a slot filled?
  pure logical function filled(self, slot)
    class(card_fields), intent(in) :: self
    integer, intent(in) :: slot

    filled = .false.
    if (slot <= self%count) filled = self%slot(slot)%last >= self%slot(slot)%first
  end function filled

  !> Columns of a slot: those of the whole field; those of the name if the slot is 0 or the card has no line
  !! for it; those after the end of the line if the line ends before the slot.
  pure type(place_type) function place(self, slot)
    class(card_fields), intent(in) :: self
    integer, intent(in) :: slot   !! 0 for the name

    place = self%name_place
    if (slot > 0 .and. slot <= self%count) place = self%slot(slot)%place
  end function place
end module epcont_deck_card
