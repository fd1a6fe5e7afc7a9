!> The list of ids at the end of a card: `G1 G2 ..`, and `G1 THRU G2` where the card allows it.
module epcont_deck_id_list
  use epcont_base_kinds, only: i8
  use epcont_base_text, only: text_of, upper
  use epcont_deck_card, only: card_fields
  use epcont_deck_complaint, only: add_fault, add_value_fault, field_text, identity
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_entry, only: card_entry, field_entry, id_field, largest_id, number_of, slot_of
  use epcont_deck_field, only: scan_integer, scan_sound
  use epcont_deck_source, only: source
  use epcont_deck_table, only: card_table
  use epcont_deck_value, only: out_of_range
  implicit none
  private
  public :: read_list

contains

  !> Read the list of ids at the end of a card.
  subroutine read_list(lines, card, entry, table, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(card_entry), intent(in) :: entry
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    type(field_entry) :: item
    integer :: slot, from, to

    slot = slot_of(entry%list_number)
    if (.not. any(card%last(slot:card%count) >= card%first(slot:card%count))) then
      item = id_field(entry%list_number, entry%field_name(entry%list_number), '')
      call add_fault(lines, card, item, 'is blank', item%allowed(), faults)
    end if
    do while (slot <= card%count)
      if (card%filled(slot)) then
        call read_item(lines, card, entry, slot, faults, from)
        to = from
        if (entry%has_ranges .and. from > 0 .and. is_thru(lines, card, slot + 1)) then
          slot = slot + 2
          call read_item(lines, card, entry, slot, faults, to)
          if (to > 0 .and. to < from) call add_backward(lines, card, entry, slot, from, faults)
          if (to > 0) call table%add_item(from, to, number_of(slot - 2))
        else if (from > 0) then
          call table%add_item(from, to, number_of(slot))
        end if
      end if
      slot = slot + 1
    end do
  end subroutine read_list

  !> One id of a list; 0 (with a fault) where it is not one.
  subroutine read_item(lines, card, entry, slot, faults, id)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(card_entry), intent(in) :: entry
    integer, intent(in) :: slot
    type(diagnostics), intent(inout) :: faults
    integer, intent(out) :: id
    type(field_entry) :: item
    integer(i8) :: number
    integer :: outcome

    id = 0
    if (card%filled(slot)) then
      call scan_integer(lines%text(card%first(slot):card%last(slot)), number, outcome)
      if (outcome == scan_sound .and. number > 0 .and. number <= largest_id) then
        id = int(number)
        return
      end if
    end if
    item = id_field(number_of(slot), entry%field_name(number_of(slot)), '')
    if (card%filled(slot)) then
      if (outcome == scan_sound) outcome = out_of_range
      call add_value_fault(lines, card, slot, item, outcome, faults)
    else
      call add_fault(lines, card, item, 'is blank', item%allowed(), faults)
    end if
  end subroutine read_item

  !> Does the slot hold the word THRU?
  pure logical function is_thru(lines, card, slot)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    integer, intent(in) :: slot

    is_thru = .false.
    if (.not. card%filled(slot)) return
    if (card%last(slot) - card%first(slot) == 3) is_thru = upper(lines%text(card%first(slot):card%last(slot))) == 'THRU'
  end function is_thru

  !> THRU that leads to a smaller id.
  subroutine add_backward(lines, card, entry, slot, from, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(card_entry), intent(in) :: entry
    integer, intent(in) :: slot, from
    type(diagnostics), intent(inout) :: faults

    character(len=:), allocatable :: field

    field = field_text(number_of(slot), entry%field_name(number_of(slot)))
    call faults%add_error(card%place(lines, slot), identity(lines, card)//': '//field//' is less than the id before THRU', &
                          'an id of at least '//text_of(from))
  end subroutine add_backward
end module epcont_deck_id_list
