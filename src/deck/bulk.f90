!> The bulk data: each card checked field by field against the catalogue, and stored in its table.
module epcont_deck_bulk
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_deck_card, only: card_fields, gather
  use epcont_deck_card_kinds, only: card_kinds, card_param
  use epcont_deck_catalogue, only: catalogue, parameters
  use epcont_deck_complaint, only: add_fault, add_unknown, add_value_fault, field_text, identity
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_entry, only: card_entry, field_entry, kind_word, number_of, slot_of
  use epcont_deck_field, only: scan_no_point, scan_sound, scan_word
  use epcont_deck_id_list, only: read_list
  use epcont_deck_point_list, only: read_points
  use epcont_deck_source, only: source
  use epcont_deck_spelling, only: likely_name
  use epcont_deck_table, only: card_table, new_table
  use epcont_deck_value, only: read_value
  implicit none
  private
  public :: read_bulk

contains

  !> Read the cards from line `first` on into `table`, one element for each entry of the catalogue.
  subroutine read_bulk(lines, first, table, faults)
    type(source), intent(in) :: lines
    integer, intent(in) :: first
    type(card_table), allocatable, intent(out) :: table(:)
    type(diagnostics), intent(inout) :: faults
    type(card_entry) :: entry(card_kinds)
    type(field_entry), allocatable :: parameter_entry(:)
    type(card_fields) :: card
    integer :: line, k, errors

    entry = catalogue()
    parameter_entry = parameters()
    allocate (table(card_kinds))
    do k = 1, card_kinds
      table(k) = new_table(entry(k))
    end do
    call reserve(lines, first, entry, table)
    k = 1
    line = first
    do while (line <= lines%count)
      card%next = line + 1
      if (.not. lines%blank(line)) then
        errors = faults%error_count()
        call gather(lines, line, card, faults)
        call find_card(card%name, entry, k)
        if (k == 0) then
          if (card%sound) call add_unknown(lines, card, entry, faults)
        else
          call table(k)%add_card(line)
          if (card%sound .and. k == card_param) then
            call read_parameter(lines, card, entry(k), parameter_entry, table(k), faults)
          else if (card%sound) then
            call read_card(lines, card, entry(k), table(k), faults)
          end if
          table(k)%sound(table(k)%count) = faults%error_count() == errors
        end if
      end if
      line = card%next
    end do
    do k = 1, card_kinds
      call table(k)%finish()
      call add_notes(lines, entry(k), table(k), faults)
    end do
  end subroutine read_bulk

  !> Room in each table for the cards that seem to be there, so that a large deck need not move its tables about.
  subroutine reserve(lines, first, entry, table)
    type(source), intent(in) :: lines
    integer, intent(in) :: first
    type(card_entry), intent(in) :: entry(:)
    type(card_table), intent(inout) :: table(:)
    character(len=8) :: text, before, name
    integer :: cards(size(entry))
    integer :: line, k, at, cut

    cards = 0
    k = 0
    before = ''
    do line = first, lines%count
      at = lines%first(line)
      if (lines%last(line) - at >= 7) then
        text = lines%text(at:at + 7)   ! of known length: no call
      else
        text = lines%text(at:lines%last(line))
      end if
      if (text(1:1) < 'A') cycle
      if (text /= before) then
        cut = scan(text//',', ',*')
        name = text(:cut - 1)
        call find_card(name, entry, k)
        before = text
      end if
      if (k > 0) cards(k) = cards(k) + 1
    end do
    do k = 1, size(entry)
      call table(k)%reserve(cards(k))
    end do
  end subroutine reserve

  !> The entry of a name, tried first where the last card had its; 0 where there is none.
  pure subroutine find_card(name, entry, k)
    character(len=8), intent(in) :: name
    type(card_entry), intent(in) :: entry(:)
    integer, intent(inout) :: k

    if (k > 0) then
      if (entry(k)%name == name) return
    end if
    do k = size(entry), 1, -1
      if (entry(k)%name == name) return
    end do
  end subroutine find_card

  !> Read one PARAM: what its second field may hold depends on its first.
  subroutine read_parameter(lines, card, entry, parameter_entry, table, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(card_entry), intent(in) :: entry
    type(field_entry), intent(in) :: parameter_entry(:)
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    type(card_entry) :: with_value
    integer :: named

    call find_parameter(lines, card, parameter_entry, faults, named)
    if (named < 0) return
    with_value = entry
    if (named > 0) with_value%field(2) = parameter_entry(named)
    call read_card(lines, card, with_value, table, faults)
  end subroutine read_parameter

  !> Read one card into the last row of its table.
  subroutine read_card(lines, card, entry, table, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(card_entry), intent(in) :: entry
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    integer :: slot, last, column
    logical :: blank

    last = max(card%count, size(entry%column_at))   ! behind `count` all are blank
    if (entry%list_number > 0) last = slot_of(entry%list_number) - 1
    do slot = 1, last
      column = 0
      if (slot <= size(entry%column_at)) column = entry%column_at(slot)
      blank = slot > card%count
      if (.not. blank) blank = card%last(slot) < card%first(slot)
      if (blank) then
        if (column > 0) call take_blank(lines, card, entry%field(column), column, table, faults)
      else if (column > 0) then
        call read_field(lines, card, slot, entry%field(column), column, table, faults)
      else
        call add_surplus(lines, card, slot, entry, faults)
      end if
    end do
    if (entry%has_points) then
      call read_points(lines, card, entry, table, faults)
    else if (entry%list_number > 0) then
      call read_list(lines, card, entry, table, faults)
    end if
  end subroutine read_card

  !> Which PARAM it is; 0 where the name is no word, -1 (with a fault) where it is unknown.
  subroutine find_parameter(lines, card, parameter_entry, faults, named)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(field_entry), intent(in) :: parameter_entry(:)
    type(diagnostics), intent(inout) :: faults
    integer, intent(out) :: named
    character(len=8) :: word, names(size(parameter_entry))
    character(len=:), allocatable :: remedy
    integer :: outcome, i

    named = 0
    if (.not. card%filled(1)) return
    call scan_word(lines%text(card%first(1):card%last(1)), word, outcome)
    if (outcome /= scan_sound) return
    do named = 1, size(parameter_entry)
      if (parameter_entry(named)%name == word) return
    end do
    named = -1
    names = parameter_entry%name
    i = likely_name(word, names)
    if (i > 0) then
      remedy = 'did you mean '//trim(parameter_entry(i)%name)//'?'
    else
      remedy = 'epcont --cards PARAM lists the parameters'
    end if
    call faults%add_error(card%place(lines, 1), 'unknown parameter '//trim(word), remedy)
  end subroutine find_parameter

  !> Read one field that is not blank into the last row of the table.
  subroutine read_field(lines, card, slot, entry, column, table, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    integer, intent(in) :: slot
    type(field_entry), intent(in) :: entry
    integer, intent(in) :: column
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    real(wp) :: value
    character(len=8) :: word
    integer :: outcome

    call read_value(lines%text(card%first(slot):card%last(slot)), entry, value, word, outcome)
    if (outcome == scan_no_point) then
      if (entry%point_optional .and. card%is_large(lines, slot)) outcome = scan_sound
    end if
    if (outcome == scan_sound) then
      table%value(column, table%count) = value
      if (entry%kind == kind_word) table%word(column, table%count) = word
      table%given(column, table%count) = .true.
    else
      call add_value_fault(lines, card, slot, entry, outcome, faults)
    end if
    if (entry%used) return
    table%noted(column) = table%noted(column) + 1
    if (table%noted(column) == 1) table%noted_card(column) = table%count
  end subroutine read_field

  !> A blank field: it may have the value of another, and there are some that may not be blank.
  subroutine take_blank(lines, card, entry, column, table, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(field_entry), intent(in) :: entry
    integer, intent(in) :: column
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    logical :: needed

    if (table%same_as(column) > 0) table%value(column, table%count) = table%value(table%same_as(column), table%count)
    needed = entry%required
    if (.not. needed .and. entry%with > 0) needed = card%filled(slot_of(entry%with))
    if (needed) call add_fault(lines, card, entry, 'is blank', entry%allowed(), faults)
  end subroutine take_blank

  !> A field that the catalogue does not know must be blank.
  subroutine add_surplus(lines, card, slot, entry, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    integer, intent(in) :: slot
    type(card_entry), intent(in) :: entry
    type(diagnostics), intent(inout) :: faults

    call faults%add_error(card%place(lines, slot), &
                          identity(lines, card)//': '//field_text(number_of(slot), '')//' must be blank', &
                          'blank; '//trim(entry%name)//' ends with field '//text_of(entry%last_number()))
  end subroutine add_surplus

  !> List once each field that was filled and has no effect.
  subroutine add_notes(lines, entry, table, faults)
    type(source), intent(in) :: lines
    type(card_entry), intent(in) :: entry
    type(card_table), intent(in) :: table
    type(diagnostics), intent(inout) :: faults
    type(card_fields) :: card
    type(diagnostics) :: unheard
    integer :: column

    do column = 1, size(table%noted)
      if (table%noted(column) == 0) cycle
      call gather(lines, table%line(table%noted_card(column)), card, unheard)
      call faults%add_note(card%place(lines, slot_of(entry%field(column)%number)), trim(entry%name)//': '// &
                           field_text(entry%field(column)%number, trim(entry%field(column)%name))// &
                           ' has no effect (cards with it: '//text_of(table%noted(column))//')')
    end do
  end subroutine add_notes
end module epcont_deck_bulk
