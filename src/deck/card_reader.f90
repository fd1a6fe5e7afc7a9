!> One card, field by field, into its table. Behind its fields there may be a list: of ids, `G1 G2 ..`, with
!> `G1 THRU G2` and `G1 THRU G2 BY step` where the card allows it; or of points, `X1 Y1 X2 Y2 .. ENDT`.
module epcont_deck_card_reader
  use epcont_base_text, only: text_of, upper
  use epcont_deck_card, only: card_fields
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_entry, only: field, field_entry, integer_field, kind_blank, kind_word, number_of
  use epcont_deck_field, only: scan_sound
  use epcont_deck_table, only: card_table, list_item
  use epcont_deck_value, only: explain, field_value, read_value
  implicit none
  private
  public :: read_card

contains

  !> Read a card into the last row of its table.
  subroutine read_card(card, table, faults)
    type(card_fields), intent(in) :: card        !! its fields
    type(card_table), intent(inout) :: table     !! those of its kind
    type(diagnostics), intent(inout) :: faults   !! what is wrong is added to them
    integer :: slot
    logical :: blank

    do slot = 1, size(table%entry%field)
      blank = slot > card%count
      if (.not. blank) blank = card%slot(slot)%last < card%slot(slot)%first
      if (blank) then
        call take_blank(slot)
      else if (table%entry%field(slot)%kind == kind_blank) then
        call refuse_surplus(slot)
      else
        call take_value(slot)
      end if
    end do
    if (table%entry%has_points) then
      call read_points()
    else if (allocated(table%entry%list_name)) then
      call read_ids()
    else
      do slot = size(table%entry%field) + 1, card%count
        if (card%slot(slot)%last >= card%slot(slot)%first) call refuse_surplus(slot)
      end do
    end if

  contains

    !> A field is at fault: `GRID 17: field 4 (X1) is ...`.
    subroutine refuse(slot, what, remedy)
      integer, intent(in) :: slot
      character(len=*), intent(in) :: what, remedy

      call faults%add_error(card%place(slot), table%identity(table%count)//': '// &
                            table%entry%field_text(slot)//' '//what, remedy)
    end subroutine refuse

    !> A field that the catalogue does not know must be blank.
    subroutine refuse_surplus(slot)
      integer, intent(in) :: slot
      character(len=:), allocatable :: remedy

      remedy = 'blank'
      if (.not. allocated(table%entry%list_name)) remedy = 'blank; '//trim(table%entry%name)//' ends with field '// &
                                                 text_of(number_of(size(table%entry%field)))
      call refuse(slot, 'must be blank', remedy)
    end subroutine refuse_surplus

    !> A blank field has its default, or the value of another; some may not be blank.
    subroutine take_blank(slot)
      integer, intent(in) :: slot
      logical :: needed

      associate (field => table%entry%field(slot), i => table%count)
        table%value(slot, i) = field%default
        if (field%same_as /= 0) table%value(slot, i) = table%value(slot + field%same_as, i)
        needed = field%required
        if (field%with /= 0) needed = needed .or. card%filled(slot + field%with)
        if (needed) call refuse(slot, 'is blank', field%allowed())
      end associate
    end subroutine take_blank

    !> Take the value of a field that is not blank.
    subroutine take_value(slot)
      integer, intent(in) :: slot
      type(field_value) :: value

      associate (entry => table%entry%field(slot), i => table%count)
        call read_value(card, slot, entry, value)
        if (value%outcome == scan_sound) then
          table%value(slot, i) = value%number
          if (entry%kind == kind_word) table%word(slot, i) = value%word
          table%given(slot, i) = .true.
        else
          call refuse_value(slot, entry, value)
        end if
      end associate
    end subroutine take_value

    !> Read a field of a list; one that is blank, or cannot be taken, is a fault.
    subroutine read_slot(slot, entry, value)
      integer, intent(in) :: slot
      type(field_entry), intent(in) :: entry    !! what it may hold
      type(field_value), intent(out) :: value

      call read_value(card, slot, entry, value)
      if (value%outcome /= scan_sound) call refuse_value(slot, entry, value)
    end subroutine read_slot

    !> Say why a field cannot be taken.
    subroutine refuse_value(slot, entry, value)
      integer, intent(in) :: slot
      type(field_entry), intent(in) :: entry
      type(field_value), intent(in) :: value
      character(len=:), allocatable :: what, remedy

      what = 'is blank'
      remedy = entry%allowed()
      if (card%filled(slot)) &
        call explain(card%text(card%slot(slot)%first:card%slot(slot)%last), entry, value, what, remedy)
      call refuse(slot, what, remedy)
    end subroutine refuse_value

    !> Does a slot hold this word?
    logical function is_word(slot, word)
      integer, intent(in) :: slot
      character(len=*), intent(in) :: word     !! in capitals

      is_word = .false.
      if (.not. card%filled(slot)) return
      associate (at => card%slot(slot))
        if (at%last - at%first + 1 == len(word)) is_word = upper(card%text(at%first:at%last)) == word
      end associate
    end function is_word

    !> The ids at the end of a card, one at least.
    subroutine read_ids()
      type(field_entry) :: id
      integer :: slot

      slot = table%entry%list_slot
      id = field('', 'id', '')
      if (.not. any(card%slot(slot:card%count)%last >= card%slot(slot:card%count)%first)) &
        call refuse(slot, 'is blank', id%allowed())
      do while (slot <= card%count)
        if (card%filled(slot)) call read_range(id, slot)
        slot = slot + 1
      end do
    end subroutine read_ids

    !> One id, or a range of them.
    subroutine read_range(id, slot)
      type(field_entry), intent(in) :: id
      integer, intent(inout) :: slot   !! the first of the range, then its last
      type(field_value) :: value
      type(list_item) :: item
      logical :: is_range

      item%place = card%place(slot)
      call read_slot(slot, id, value)
      if (value%outcome /= scan_sound) return
      item%from = nint(value%number)
      is_range = table%entry%has_ranges .and. is_word(slot + 1, 'THRU')
      if (is_range) then
        slot = slot + 2
        call read_slot(slot, id, value)
        if (value%outcome /= scan_sound) return
      end if
      item%to = nint(value%number)
      if (is_range .and. table%entry%has_steps) then
        call read_step(slot, item)
      else if (item%to < item%from) then
        call refuse(slot, 'is less than the id before THRU', 'an id of at least '//text_of(item%from))
      end if
      call table%add_item(item)
    end subroutine read_range

    !> The step of a range: 1 towards its end, or as `BY` behind it says; `slot` is then that of the step.
    subroutine read_step(slot, item)
      integer, intent(inout) :: slot
      type(list_item), intent(inout) :: item
      type(field_value) :: value
      integer :: length, most

      length = item%to - item%from
      item%step = merge(1, -1, length >= 0)
      if (.not. is_word(slot + 1, 'BY')) return
      slot = slot + 2
      most = item%step*max(1, abs(length))
      call read_slot(slot, integer_field('', '', min(item%step, most), max(item%step, most)), value)
      if (value%outcome /= scan_sound) return
      if (mod(length, nint(value%number)) == 0) then
        item%step = nint(value%number)
      else
        call refuse(slot, 'does not lead from '//text_of(item%from)//' to '//text_of(item%to), &
                    'a step that divides '//text_of(length))
      end if
    end subroutine read_step

    !> Points. A fault in one of them ends the list: what follows it would be taken for the wrong number.
    subroutine read_points()
      character(len=*), parameter :: end_word = 'ENDT'
      type(field_entry) :: number
      type(field_value) :: value(2)
      integer :: k, slot

      slot = table%entry%list_slot
      number = field('', 'real', '')
      do while (.not. is_word(slot, end_word))
        do k = 1, 2
          if (.not. card%filled(slot + k - 1)) then
            call refuse(slot + k - 1, 'is blank', 'a real, or '//end_word//' behind the last point')
            return
          end if
          call read_slot(slot + k - 1, number, value(k))
          if (value(k)%outcome /= scan_sound) return
        end do
        call table%add_item(list_item(point=value%number, place=card%place(slot)))
        slot = slot + 2
      end do
      do slot = slot + 1, card%count
        if (card%filled(slot)) &
          call faults%add_error(card%place(slot), table%identity(table%count)//': field '// &
                                text_of(number_of(slot))//' must be blank', &
                                'blank: '//end_word//' ends the card')
      end do
    end subroutine read_points
  end subroutine read_card
end module epcont_deck_card_reader
