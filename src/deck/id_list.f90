!> The list of ids at the end of a card: `G1 G2 ..`, and `G1 THRU G2`, `G1 THRU G2 BY step` where the card allows it.
module epcont_deck_id_list
  use epcont_base_kinds, only: i8
  use epcont_base_text, only: text_of, upper
  use epcont_deck_card, only: card_fields
  use epcont_deck_complaint, only: add_fault, add_value_fault, field_text, identity
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_entry, only: card_entry, field_entry, id_field, integer_field, largest_id, number_of, &
                               slot_of
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
    integer :: slot, from, to, first, step

    slot = slot_of(entry%list_number)
    if (.not. any(card%last(slot:card%count) >= card%first(slot:card%count))) then
      item = id_field(entry%list_number, entry%field_name(entry%list_number), '')
      call add_fault(lines, card, item, 'is blank', item%allowed(), faults)
    end if
    do while (slot <= card%count)
      if (card%filled(slot)) then
        call read_item(lines, card, entry, slot, faults, from)
        to = from
        if (entry%has_ranges .and. from > 0 .and. is_word(lines, card, slot + 1, 'THRU')) then
          first = slot
          slot = slot + 2
          call read_item(lines, card, entry, slot, faults, to)
          step = 1
          if (to > 0 .and. entry%has_steps) then
            call read_step(lines, card, entry, slot, from, to, faults, step)
          else if (to > 0 .and. to < from) then
            call add_backward(lines, card, entry, slot, from, faults)
          end if
          if (to > 0) call table%add_item(from, to, card%place(lines, first), step)
        else if (from > 0) then
          call table%add_item(from, to, card%place(lines, slot))
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

  !> The step of a range, of 1 towards its end, or as `BY` behind it says; `slot` is then that of the step.
  subroutine read_step(lines, card, entry, slot, from, to, faults, step)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(card_entry), intent(in) :: entry
    integer, intent(inout) :: slot
    integer, intent(in) :: from, to
    type(diagnostics), intent(inout) :: faults
    integer, intent(out) :: step
    type(field_entry) :: item
    integer(i8) :: number
    integer :: outcome, most

    step = merge(1, -1, to >= from)
    if (.not. is_word(lines, card, slot + 1, 'BY')) return
    slot = slot + 2
    most = step*max(1, abs(to - from))
    item = integer_field(number_of(slot), entry%field_name(number_of(slot)), '', min(step, most), max(step, most))
    if (.not. card%filled(slot)) then
      call add_fault(lines, card, item, 'is blank', item%allowed(), faults)
      return
    end if
    call scan_integer(lines%text(card%first(slot):card%last(slot)), number, outcome)
    if (outcome == scan_sound .and. (number < min(step, most) .or. number > max(step, most))) outcome = out_of_range
    if (outcome /= scan_sound) then
      call add_value_fault(lines, card, slot, item, outcome, faults)
    else if (mod(to - from, int(number)) /= 0) then
      call add_fault(lines, card, item, 'does not lead from '//text_of(from)//' to '//text_of(to), &
                     'a step that divides '//text_of(to - from), faults)
    else
      step = int(number)
    end if
  end subroutine read_step

  !> Does the slot hold this word?
  pure logical function is_word(lines, card, slot, word)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    integer, intent(in) :: slot
    character(len=*), intent(in) :: word

    is_word = .false.
    if (.not. card%filled(slot)) return
    if (card%last(slot) - card%first(slot) == len(word) - 1) is_word = upper(lines%text(card%first(slot):card%last(slot))) == word
  end function is_word

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
