!> The bulk data: each card checked field by field against the catalogue, and stored in its table.
module epcont_deck_bulk
  use epcont_base_text, only: text_of, upper
  use epcont_deck_card, only: card_fields, continues, find_name, gather
  use epcont_deck_card_kinds, only: card_kinds, card_param
  use epcont_deck_catalogue, only: catalogue, parameters
  use epcont_deck_complaint, only: add_fault, add_unknown
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_entry, only: card_entry, field_entry, kind_blank, kind_word, number_of
  use epcont_deck_field, only: scan_sound, scan_word
  use epcont_deck_list, only: read_list
  use epcont_deck_source, only: source
  use epcont_deck_spelling, only: suggestion
  use epcont_deck_table, only: card_table
  use epcont_deck_value, only: field_value, read_slot
  implicit none
  private
  public :: read_bulk

  !> Kinds of lines beside those of the cards that begin there.
  integer, parameter :: no_card = -1, unknown_card = 0

contains

  !> Read the cards from line `first` on.
  subroutine read_bulk(lines, first, table, faults)
    type(source), intent(in) :: lines   !! of the deck
    integer, intent(in) :: first                              !! the first line that is not of case control
    type(card_table), allocatable, intent(out) :: table(:)    !! the cards of each kind [card_kinds]
    type(diagnostics), intent(inout) :: faults   !! what is wrong is added to them
    type(card_entry) :: entry(card_kinds)
    type(field_entry), allocatable :: parameter_entry(:)
    type(card_fields) :: card
    character(len=8) :: names(card_kinds)
    integer, allocatable :: kind(:)
    integer :: many(card_kinds), line, k, errors

    entry = catalogue()
    parameter_entry = parameters()
    names = entry%name
    call find_kinds(lines, first, names, kind, many)
    allocate (table(card_kinds))
    do k = 1, card_kinds
      call table(k)%begin(entry(k), many(k))
    end do
    do line = first, lines%count
      if (kind(line) == no_card) cycle
      errors = faults%error_count()
      call gather(lines, line, card, faults)
      if (kind(line) == unknown_card) then
        if (card%sound) call add_unknown(card, names, faults)
        cycle
      end if
      associate (cards => table(kind(line)))
        call cards%add_card(line)
        if (kind(line) == card_param .and. card%sound) &
          call choose_parameter(card, parameter_entry, cards%entry%field(2), faults)
        if (faults%error_count() == errors) call read_card(card, cards, faults)
        cards%sound(cards%count) = faults%error_count() == errors
      end associate
    end do
    do k = 1, card_kinds
      call add_notes(lines, table(k), faults)
    end do
  end subroutine read_bulk

  !> The kind of the card that begins on each line. Cards of one name mostly follow each other.
  pure subroutine find_kinds(lines, first, names, kind, many)
    type(source), intent(in) :: lines
    integer, intent(in) :: first
    character(len=8), intent(in) :: names(:)
    integer, allocatable, intent(out) :: kind(:)
    integer, intent(out) :: many(:)   !! how many there are of each kind
    character(len=8) :: text, before
    logical :: begun
    integer :: i, found

    allocate (kind(lines%count), source=no_card)
    many = 0
    begun = .false.
    before = ''
    found = unknown_card   ! a card without a name
    do i = first, lines%count
      associate (line => lines%line(i))
        if (line%last < line%first) cycle
        if (begun) then
          if (continues(lines%text(line%first:line%last))) cycle
        end if
        begun = .true.
        text = lines%text(line%first:min(line%last, line%first + 7))
        if (line%special <= line%last) then   ! with a comma the name may be longer
          found = kind_of(lines%text(line%first:line%last), names)
          before = ''
        else if (text /= before) then
          found = kind_of(text, names)
          before = text
        end if
        kind(i) = found
        if (found /= unknown_card) many(found) = many(found) + 1
      end associate
    end do
  end subroutine find_kinds

  !> The kind of the card that a line begins.
  pure integer function kind_of(text, names) result(kind)
    character(len=*), intent(in) :: text
    character(len=8), intent(in) :: names(:)
    character(len=8) :: name
    integer :: first, last
    logical :: large

    call find_name(text, index(text, ','), first, last, large)
    name = upper(text(first:min(last, first + 7)))
    do kind = 1, size(names)
      if (names(kind) == name) return
    end do
    kind = unknown_card
  end function kind_of

  !> Which PARAM it is, and so what its value may be: any word where the name is none, and a fault where it is
  !! unknown.
  subroutine choose_parameter(card, parameter_entry, value_entry, faults)
    type(card_fields), intent(in) :: card
    type(field_entry), intent(in) :: parameter_entry(:)
    type(field_entry), intent(out) :: value_entry
    type(diagnostics), intent(inout) :: faults
    character(len=8) :: word, names(size(parameter_entry))
    integer :: outcome, i

    value_entry = field_entry('VALUE', kind_word, required=.true.)
    outcome = -1
    if (card%filled(1)) call scan_word(card%text(card%slot(1)%first:card%slot(1)%last), word, outcome)
    if (outcome /= scan_sound) return
    names = parameter_entry%name
    do i = 1, size(names)
      if (names(i) == word) then
        value_entry = parameter_entry(i)
        value_entry%name = 'VALUE'
        return
      end if
    end do
    call faults%add_error(card%place(1), 'unknown parameter '//trim(word), &
                          suggestion(word, names, 'epcont --cards PARAM lists the parameters'))
  end subroutine choose_parameter

  !> Read one card into the last row of its table.
  subroutine read_card(card, table, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    integer :: slot, fields
    logical :: blank

    fields = size(table%entry%field)
    do slot = 1, fields
      blank = slot > card%count
      if (.not. blank) blank = card%slot(slot)%last < card%slot(slot)%first
      if (blank) then
        call take_blank(card, table, slot, faults)
      else if (table%entry%field(slot)%kind == kind_blank) then
        call add_surplus(card, table, slot, faults)
      else
        call read_field(card, table, slot, faults)
      end if
    end do
    if (table%entry%has_list()) then
      call read_list(card, table, faults)
    else
      do slot = fields + 1, card%count
        if (card%slot(slot)%last >= card%slot(slot)%first) call add_surplus(card, table, slot, faults)
      end do
    end if
  end subroutine read_card

  !> Read one field that is not blank.
  subroutine read_field(card, table, slot, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(inout) :: table
    integer, intent(in) :: slot
    type(diagnostics), intent(inout) :: faults
    type(field_value) :: value

    associate (field => table%entry%field(slot), i => table%count)
      call read_slot(card, table, slot, field, value, faults)
      if (value%sound) then
        table%value(slot, i) = value%number
        if (field%kind == kind_word) table%word(slot, i) = value%word
        table%given(slot, i) = .true.
      end if
      if (field%used) return
      table%noted(slot) = table%noted(slot) + 1
      if (table%noted(slot) == 1) table%noted_card(slot) = i
    end associate
  end subroutine read_field

  !> A blank field has its default, or the value of another; some may not be blank.
  subroutine take_blank(card, table, slot, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(inout) :: table
    integer, intent(in) :: slot
    type(diagnostics), intent(inout) :: faults
    logical :: needed

    associate (field => table%entry%field(slot), i => table%count)
      table%value(slot, i) = field%default
      if (field%same_as /= 0) table%value(slot, i) = table%value(slot + field%same_as, i)
      needed = field%required
      if (field%with /= 0) needed = needed .or. card%filled(slot + field%with)
      if (needed) call add_fault(card, table, slot, 'is blank', field%allowed(), faults)
    end associate
  end subroutine take_blank

  !> A field that the catalogue does not know must be blank.
  subroutine add_surplus(card, table, slot, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(in) :: table
    integer, intent(in) :: slot
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: remedy

    remedy = 'blank'
    associate (entry => table%entry)
      if (.not. entry%has_list()) &
        remedy = 'blank; '//trim(entry%name)//' ends with field '//text_of(number_of(size(entry%field)))
    end associate
    call add_fault(card, table, slot, 'must be blank', remedy, faults)
  end subroutine add_surplus

  !> List once each field that was filled and has no effect.
  subroutine add_notes(lines, table, faults)
    type(source), intent(in) :: lines
    type(card_table), intent(in) :: table
    type(diagnostics), intent(inout) :: faults
    type(card_fields) :: card
    type(diagnostics) :: unheard
    integer :: slot

    do slot = 1, size(table%noted)
      if (table%noted(slot) == 0) cycle
      call gather(lines, table%line(table%noted_card(slot)), card, unheard)
      call faults%add_note(card%place(slot), trim(table%entry%name)//': '//table%entry%field_text(slot)// &
                           ' has no effect (cards with it: '//text_of(table%noted(slot))//')')
    end do
  end subroutine add_notes
end module epcont_deck_bulk
