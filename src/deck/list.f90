!> The list at the end of a card: ids, `G1 G2 ..`, with `G1 THRU G2` and `G1 THRU G2 BY step` where the card
!! allows it; or points, `X1 Y1 X2 Y2 .. ENDT`.
module epcont_deck_list
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_deck_card, only: card_fields
  use epcont_deck_complaint, only: add_fault
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_entry, only: field_entry, id_field, integer_field, number_of, real_field
  use epcont_deck_table, only: card_table, list_item
  use epcont_deck_value, only: field_value, read_slot
  implicit none
  private
  public :: read_list

contains

  !> Read the list of a card into its table.
  subroutine read_list(card, table, faults)
    type(card_fields), intent(in) :: card   !! its fields
    type(card_table), intent(inout) :: table     !! the card is its last
    type(diagnostics), intent(inout) :: faults   !! what is wrong is added to them

    if (table%entry%has_points) then
      call read_points(card, table, faults)
    else
      call read_ids(card, table, faults)
    end if
  end subroutine read_list

  subroutine read_ids(card, table, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    type(field_entry) :: id
    integer :: slot

    slot = table%entry%list_slot
    id = id_field('', '')
    if (.not. any(card%slot(slot:card%count)%last >= card%slot(slot:card%count)%first)) &
      call add_fault(card, table, slot, 'is blank', id%allowed(), faults)
    do while (slot <= card%count)
      if (card%filled(slot)) call read_range(card, table, id, slot, faults)
      slot = slot + 1
    end do
  end subroutine read_ids

  !> One id, or a range of them.
  subroutine read_range(card, table, id, slot, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(inout) :: table
    type(field_entry), intent(in) :: id
    integer, intent(inout) :: slot   !! the first of the range, then its last
    type(diagnostics), intent(inout) :: faults
    type(field_value) :: first, last
    type(list_item) :: item
    logical :: is_range

    item%place = card%place(slot)
    call read_slot(card, table, slot, id, first, faults)
    last = first
    is_range = table%entry%has_ranges .and. first%sound .and. card%is_word(slot + 1, 'THRU')
    if (is_range) then
      slot = slot + 2
      call read_slot(card, table, slot, id, last, faults)
    end if
    if (.not. last%sound) return
    item%from = nint(first%number)
    item%to = nint(last%number)
    if (is_range .and. table%entry%has_steps) then
      call read_step(card, table, slot, item, faults)
    else if (item%to < item%from) then
      call add_fault(card, table, slot, 'is less than the id before THRU', &
                     'an id of at least '//text_of(item%from), faults)
    end if
    call table%add_item(item)
  end subroutine read_range

  !> The step of a range: 1 towards its end, or as `BY` behind it says; `slot` is then that of the step.
  subroutine read_step(card, table, slot, item, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(in) :: table
    integer, intent(inout) :: slot
    type(list_item), intent(inout) :: item
    type(diagnostics), intent(inout) :: faults
    type(field_value) :: value
    integer :: length, most

    length = item%to - item%from
    item%step = merge(1, -1, length >= 0)
    if (.not. card%is_word(slot + 1, 'BY')) return
    slot = slot + 2
    most = item%step*max(1, abs(length))
    call read_slot(card, table, slot, &
                   integer_field('', '', min(item%step, most), max(item%step, most)), value, faults)
    if (.not. value%sound) return
    if (mod(length, nint(value%number)) == 0) then
      item%step = nint(value%number)
    else
      call add_fault(card, table, slot, 'does not lead from '//text_of(item%from)//' to '//text_of(item%to), &
                     'a step that divides '//text_of(length), faults)
    end if
  end subroutine read_step

  !> Points. A fault in one of them ends the list: what follows it would be taken for the wrong number.
  subroutine read_points(card, table, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    character(len=*), parameter :: end_word = 'ENDT'
    type(field_entry) :: number
    type(field_value) :: value
    real(wp) :: point(2)
    integer :: slot, k

    slot = table%entry%list_slot
    number = real_field('', '', '')
    do while (.not. card%is_word(slot, end_word))
      do k = 1, 2
        if (card%filled(slot + k - 1)) then
          call read_slot(card, table, slot + k - 1, number, value, faults)
        else
          call add_fault(card, table, slot + k - 1, 'is blank', &
                         'a real, or '//end_word//' behind the last point', faults)
          value%sound = .false.
        end if
        if (.not. value%sound) return
        point(k) = value%number
      end do
      call table%add_item(list_item(point=point, place=card%place(slot)))
      slot = slot + 2
    end do
    do slot = slot + 1, card%count
      if (card%filled(slot)) &
        call faults%add_error(card%place(slot), table%identity(table%count)//': field '// &
                              text_of(number_of(slot))//' must be blank', &
                              'blank: '//end_word//' ends the card')
    end do
  end subroutine read_points
end module epcont_deck_list
