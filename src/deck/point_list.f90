!> The list of points at the end of a card: `X1 Y1 X2 Y2 .. ENDT`.
module epcont_deck_point_list
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: upper
  use epcont_deck_card, only: card_fields
  use epcont_deck_complaint, only: add_fault, add_value_fault, field_text, identity
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_entry, only: card_entry, field_entry, number_of, real_field, slot_of
  use epcont_deck_field, only: scan_sound
  use epcont_deck_source, only: source
  use epcont_deck_table, only: card_table
  use epcont_deck_value, only: read_value
  implicit none
  private
  public :: read_points

  character(len=*), parameter :: end_word = 'ENDT'

contains

  !> Read the points. A fault in one of them ends the list: what follows it would be taken for the wrong number.
  subroutine read_points(lines, card, entry, table, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(card_entry), intent(in) :: entry
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    real(wp) :: point(2)
    integer :: slot
    logical :: sound

    slot = slot_of(entry%list_number)
    do while (.not. is_end(lines, card, slot))
      call read_number(lines, card, entry, slot, faults, point(1), sound)
      if (sound) call read_number(lines, card, entry, slot + 1, faults, point(2), sound)
      if (.not. sound) return
      call table%add_point(point, card%place(lines, slot))
      slot = slot + 2
    end do
    do slot = slot + 1, card%count
      if (card%filled(slot)) call faults%add_error(card%place(lines, slot), identity(lines, card)//': '// &
        field_text(number_of(slot), '')//' must be blank', 'blank: '//end_word//' ends the card')
    end do
  end subroutine read_points

  !> Does the slot hold the word ENDT?
  pure logical function is_end(lines, card, slot)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    integer, intent(in) :: slot

    is_end = .false.
    if (.not. card%filled(slot)) return
    is_end = upper(lines%text(card%first(slot):card%last(slot))) == end_word
  end function is_end

  !> One number of a point.
  subroutine read_number(lines, card, entry, slot, faults, number, sound)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(card_entry), intent(in) :: entry
    integer, intent(in) :: slot
    type(diagnostics), intent(inout) :: faults
    real(wp), intent(out) :: number
    logical, intent(out) :: sound
    type(field_entry) :: field
    character(len=8) :: word   ! there is none
    integer :: outcome

    number = 0.0_wp
    sound = .false.
    field = real_field(number_of(slot), entry%field_name(number_of(slot)), '', '')
    if (.not. card%filled(slot)) then
      call add_fault(lines, card, field, 'is blank', 'a real, or '//end_word//' behind the last point', faults)
    else
      call read_value(lines%text(card%first(slot):card%last(slot)), field, number, word, outcome)
      sound = outcome == scan_sound
      if (.not. sound) call add_value_fault(lines, card, slot, field, outcome, faults)
    end if
  end subroutine read_number
end module epcont_deck_point_list
