!> Read a card, field by field, into its table. A list may follow its fields: ids `G1 G2 ..`, with `G1 THRU
!> G2` and `G1 THRU G2 BY step` if the card allows it; or records `X1 Y1 X2 Y2 ..`.
module epcont_deck_card_reader
  use epcont_base_diagnostic, only: diagnostics
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: short_real, text_of, upper
  use epcont_deck_card, only: card_fields
  use epcont_deck_entry, only: farthest, field_entry, kind_blank, kind_components, kind_integer, kind_real, &
      kind_word, largest_id, least_cause, number_of
  use epcont_deck_field, only: scan_components, scan_integer, scan_malformed, scan_no_point, scan_real, &
      scan_sound, scan_too_far, scan_too_long, scan_word
  use epcont_deck_table, only: card_table, list_item
  implicit none
  private
  public :: read_card

  !> Elements of lists of ids.
  type(field_entry), parameter :: &
    id = field_entry(kind=kind_integer, lowest=1.0_wp, highest=real(largest_id, wp))

  !> Error of range, in addition to the outcomes of a scan.
  integer, parameter :: out_of_range = -1
  !> Contents of fields, by their kinds.
  character(len=*), parameter :: noun(4) = [character(len=20) :: &
    'a whole number', 'a real number', 'a list of directions', 'a word']

  !> Value of a field. It is not initialised, because that would take longer than reading it.
  type :: field_value
    real(wp) :: number
    character(len=8) :: word   !! in upper case
    integer :: outcome         !! `scan_sound`, or the error
  end type field_value

contains

  !> Read a card into its row of a table.
  subroutine read_card(card, table, row, faults)
    type(card_fields), intent(in) :: card        !! fields of the card
    type(card_table), intent(inout) :: table     !! table of cards with its name
    integer, intent(in) :: row                   !! row of the card
    type(diagnostics), intent(inout) :: faults   !! errors are added
    integer :: slot

    do slot = 1, size(table%entry%field)
      associate (at => card%slot(min(slot, card%count + 1)))   ! the slot after the last is blank
        if (at%last < at%first) then
          call take_blank()
        else if (table%entry%field(slot)%kind == kind_blank) then
          call refuse_surplus()
        else
          call take_value()
        end if
      end associate
    end do
    if (allocated(table%entry%record)) then
      call read_records(card, row, table, faults)
    else if (allocated(table%entry%list_name)) then
      call read_ids(card, row, table, faults)
    else
      do slot = size(table%entry%field) + 1, card%count
        if (card%filled(slot)) call refuse_surplus()
      end do
    end if

  contains

    !> Report a filled field that the catalogue does not know.
    subroutine refuse_surplus()
      character(len=:), allocatable :: remedy

      remedy = 'leave it blank'
      if (table%entry%list_slot == huge(1)) remedy = 'leave it blank; '//trim(table%entry%name)// &
        ' ends with field '//text_of(number_of(size(table%entry%field)))
      call refuse(card, table, row, slot, 'must be blank', remedy, faults)
    end subroutine refuse_surplus

    !> Give a blank field its default, or the value of another field; report it if it may not be blank.
    subroutine take_blank()

      associate (field => table%entry%field(slot))
        table%value(slot, row) = field%default
        if (field%same_as /= 0) table%value(slot, row) = table%value(slot + field%same_as, row)
        if (field%required .or. card%filled(slot + field%with(1)) .or. card%filled(slot + field%with(2))) &
          call refuse(card, table, row, slot, 'is blank', 'give '//field%allowed(), faults)
      end associate
    end subroutine take_blank

    !> Take the value of a field that is not blank.
    subroutine take_value()
      type(field_value) :: value

      call read_slot(card, table, row, slot, table%entry%field(slot), value, faults)
      if (value%outcome /= scan_sound) return
      table%value(slot, row) = value%number
      if (table%entry%field(slot)%kind == kind_word) table%word(slot, row) = value%word
      table%given(slot, row) = .true.
    end subroutine take_value
  end subroutine read_card

  !> Report an error in a field: `GRID 17: field 4 (X1) is ...`.
  subroutine refuse(card, table, row, slot, what, remedy, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(in) :: table
    integer, intent(in) :: row, slot
    character(len=*), intent(in) :: what, remedy
    type(diagnostics), intent(inout) :: faults

    call faults%add_error(card%place(slot), table%identity(row)//': '// &
                          table%entry%field_text(slot)//' '//what, remedy)
  end subroutine refuse

  !> Read the value of a field; a blank one is malformed.
  pure subroutine read_value(card, slot, entry, value)
    type(card_fields), intent(in) :: card
    integer, intent(in) :: slot               !! slot of the field
    type(field_entry), intent(in) :: entry    !! allowed contents
    type(field_value), intent(out) :: value   !! value that was read
    integer(i8) :: whole

    value%outcome = scan_sound
    value%number = 0.0_wp
    value%word = ''
    associate (first => card%slot(slot)%first, last => card%slot(slot)%last)
      select case (entry%kind)
      case (kind_integer)
        call scan_integer(card%text(first:last), whole, value%outcome)
        value%number = real(whole, wp)
      case (kind_real)
        call scan_real(card%text(first:last), value%number, value%outcome)
      case (kind_components)
        call scan_components(card%text(first:last), whole, value%outcome)
        value%number = real(whole, wp)
      case (kind_word)
        call scan_word(card%text(first:last), value%word, value%outcome)
      end select
    end associate
    if (value%outcome == scan_no_point .and. entry%point_optional) value%outcome = scan_sound
    if (value%outcome /= scan_sound) return
    associate (number => value%number)
      if (entry%kind == kind_word) then
        if (entry%choices /= '' .and. index(' '//entry%choices//' ', ' '//trim(value%word)//' ') == 0) &
          value%outcome = out_of_range
      else if (number < entry%lowest .or. (entry%above_lowest .and. number <= entry%lowest) .or. &
               number > entry%highest .or. (entry%below_highest .and. number >= entry%highest)) then
        value%outcome = out_of_range
      else if (entry%kind == kind_real .and. entry%used) then   ! integers are always within reach
        if (abs(number) > farthest .or. (number /= 0.0_wp .and. abs(number) < entry%least)) &
          value%outcome = scan_too_far
      end if
    end associate
  end subroutine read_value

  !> Does a slot hold this word?
  logical function is_word(card, slot, word)
    type(card_fields), intent(in) :: card
    integer, intent(in) :: slot
    character(len=*), intent(in) :: word     !! in upper case

    is_word = .false.
    if (.not. card%filled(slot)) return
    associate (at => card%slot(slot))
      is_word = upper(card%text(at%first:at%last)) == word
    end associate
  end function is_word

  !> Read a field; report an error if it is blank or not accepted.
  subroutine read_slot(card, table, row, slot, entry, value, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(in) :: table
    integer, intent(in) :: row, slot
    type(field_entry), intent(in) :: entry    !! allowed contents
    type(field_value), intent(out) :: value
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: what, remedy

    call read_value(card, slot, entry, value)
    if (value%outcome == scan_sound) return
    associate (at => card%slot(slot))
      call explain(entry, value, card%text(at%first:at%last), what, remedy)
    end associate
    call refuse(card, table, row, slot, what, remedy, faults)
  end subroutine read_slot

  !> Read the ids at the end of a card, at least one.
  subroutine read_ids(card, row, table, faults)
    type(card_fields), intent(in) :: card
    integer, intent(in) :: row
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    integer :: k, slot

    slot = table%entry%list_slot
    if (.not. any([(card%filled(k), k=slot, card%count)])) call refuse(card, table, row, slot, 'is blank', &
                                                                       'give '//id%allowed(), faults)
    do while (slot <= card%count)
      if (card%filled(slot)) call read_range(card, row, slot, table, faults)
      slot = slot + 1
    end do
  end subroutine read_ids

  !> Read one id, or a range of ids.
  subroutine read_range(card, row, slot, table, faults)
    type(card_fields), intent(in) :: card
    integer, intent(in) :: row
    integer, intent(inout) :: slot   !! slot of the first id of the range; on exit that of its last
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    type(field_value) :: value
    type(list_item) :: item
    logical :: is_range

    item%place = card%place(slot)
    call read_slot(card, table, row, slot, id, value, faults)
    if (value%outcome /= scan_sound) return
    item%from = nint(value%number)
    is_range = table%entry%has_ranges .and. is_word(card, slot + 1, 'THRU')
    if (is_range) then
      slot = slot + 2
      call read_slot(card, table, row, slot, id, value, faults)
      if (value%outcome /= scan_sound) return
    end if
    item%to = nint(value%number)
    if (is_range .and. table%entry%has_steps) then
      call read_step(card, row, slot, item, table, faults)
    else if (item%to < item%from) then
      call refuse(card, table, row, slot, 'is less than the id before THRU', &
                  'give an id of at least '//text_of(item%from), faults)
      return
    end if
    call table%add_item(row, item)
  end subroutine read_range

  !> Read the step of a range: 1 towards its end, or the number after `BY`; `slot` is then the slot of the
  !! step.
  subroutine read_step(card, row, slot, item, table, faults)
    type(card_fields), intent(in) :: card
    integer, intent(in) :: row
    integer, intent(inout) :: slot
    type(list_item), intent(inout) :: item
    type(card_table), intent(in) :: table
    type(diagnostics), intent(inout) :: faults
    type(field_value) :: value
    integer :: length, most

    length = item%to - item%from
    item%step = merge(1, -1, length >= 0)
    if (.not. is_word(card, slot + 1, 'BY')) return
    slot = slot + 2
    most = item%step*max(1, abs(length))
    call read_slot(card, table, row, slot, &
                   field_entry(kind=kind_integer, lowest=real(min(item%step, most), wp), &
        highest=real(max(item%step, most), wp)), value, faults)
    if (value%outcome /= scan_sound) return
    if (mod(length, nint(value%number)) == 0) then
      item%step = nint(value%number)
    else
      call refuse(card, table, row, slot, &
                  'does not lead from '//text_of(item%from)//' to '//text_of(item%to), &
                  'give a step that divides '//text_of(length), faults)
    end if
  end subroutine read_step

  !> Read records, at least one. The list ends at the first error, because the following values would be read
  !! as the wrong fields.
  subroutine read_records(card, row, table, faults)
    type(card_fields), intent(in) :: card
    integer, intent(in) :: row
    type(card_table), intent(inout) :: table
    type(diagnostics), intent(inout) :: faults
    integer :: slot, first, k, record
    type(list_item) :: item
    type(field_value) :: value

    record = 1
    first = table%entry%list_slot
    do while (.not. at_end(card, table, first))
      item%place = card%place(first)
      do k = 1, size(table%entry%record)
        call read_part(card, table, row, first + k - 1, table%entry%record(k), value, faults)
        item%number(k) = value%number
        if (value%outcome /= scan_sound) return
      end do
      call table%add_item(row, item)
      record = record + 1
      do k = first + size(table%entry%record), table%entry%record_slot(record) - 1
        if (card%filled(k)) call refuse(card, table, row, k, 'must be blank', &
                                        'leave it blank: the next follows on the next line', faults)
      end do
      first = table%entry%record_slot(record)
    end do
    if (table%entry%end_word == '') return
    do slot = first + 1, card%count
      if (card%filled(slot)) &
        call faults%add_error(card%place(slot), table%identity(row)//': field '// &
                              text_of(number_of(slot))//' must be blank', &
                              'leave it blank: '//table%entry%end_word//' ends the card')
    end do
  end subroutine read_records

  !> Does no record begin at a slot?
  logical function at_end(card, table, slot)
    type(card_fields), intent(in) :: card
    type(card_table), intent(in) :: table
    integer, intent(in) :: slot
    integer :: k

    if (table%entry%end_word /= '') then
      at_end = is_word(card, slot, table%entry%end_word)
    else
      at_end = slot > table%entry%list_slot .and. .not. any([(card%filled(k), k=slot, card%count)])
    end if
  end function at_end

  !> Read a field of a record. A blank field has its default, if it has one.
  subroutine read_part(card, table, row, slot, entry, value, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(in) :: table
    integer, intent(in) :: row, slot
    type(field_entry), intent(in) :: entry   !! allowed contents
    type(field_value), intent(out) :: value
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: remedy

    value%number = entry%default
    value%outcome = merge(scan_malformed, scan_sound, entry%required)
    if (card%filled(slot)) then
      call read_slot(card, table, row, slot, entry, value, faults)
    else if (entry%required) then
      remedy = 'give '//entry%allowed()
      if (table%entry%end_word /= '') &
        remedy = 'give a real, or '//table%entry%end_word//' after the last point'
      call refuse(card, table, row, slot, 'is blank', remedy, faults)
    end if
  end subroutine read_part

  !> Describe the error of a value, and the allowed values.
  subroutine explain(entry, value, text, what, remedy)
    type(field_entry), intent(in) :: entry    !! allowed contents
    type(field_value), intent(in) :: value
    character(len=*), intent(in) :: text      !! text of the field
    character(len=:), allocatable, intent(out) :: what, remedy
    integer :: last

    remedy = 'give '//entry%allowed()
    select case (value%outcome)
    case (scan_no_point)
      what = 'is not a real number'
      last = verify(text(2:)//'.', '0123456789')   ! last of its digits
      remedy = 'add the decimal point: '//text(:last)//'.'//text(last + 1:)
      if (last == len(text)) remedy = remedy//'0'
    case (scan_too_far)
      what = 'is too far from 1.0'
      remedy = 'use other units: magnitudes from '//short_real(max(entry%least, least_cause))//' to '// &
               short_real(farthest)
      if (.not. entry%above_lowest) remedy = remedy//', or 0.0'
    case (scan_too_long)
      what = 'has more than 8 characters'
    case (scan_malformed)
      what = 'is not '//trim(noun(entry%kind))
      if (len(text) == 0) what = 'is blank'
    case default
      what = 'is out of range'
      if (entry%kind == kind_word) what = 'is not an allowed word'
    end select
  end subroutine explain
end module epcont_deck_card_reader
