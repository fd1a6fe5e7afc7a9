!> A field's characters and its entry in the catalogue to a value, or to what is wrong with it.
module epcont_deck_value
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: short_real
  use epcont_deck_card, only: card_fields
  use epcont_deck_complaint, only: add_fault
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_entry, only: farthest, field_entry, kind_components, kind_integer, kind_real, kind_word
  use epcont_deck_field, only: scan_components, scan_integer, scan_malformed, scan_no_point, scan_real, &
                               scan_sound, scan_too_large, scan_too_long, scan_too_small, scan_word
  use epcont_deck_table, only: card_table
  implicit none
  private
  public :: field_value, read_slot

  !> Faults that are not of form, beside the outcomes of a scan.
  integer, parameter :: out_of_range = -1, out_of_reach = -2
  !> What fields hold, by their kinds.
  character(len=*), parameter :: noun(4) = [character(len=20) :: &
    'a whole number', 'a real number', 'a list of directions', 'a word']

  !> What a field says. (Not initialised: that would take longer than reading it.)
  type :: field_value
    real(wp) :: number
    character(len=8) :: word   !! in capitals
    logical :: sound           !! it can be taken
  end type field_value

contains

  !> Read a field; one that is blank, or cannot be taken, is a fault.
  subroutine read_slot(card, table, slot, entry, value, faults)
    type(card_fields), intent(in) :: card   !! its fields
    type(card_table), intent(in) :: table     !! the card is its last
    integer, intent(in) :: slot               !! which field
    type(field_entry), intent(in) :: entry    !! what it may hold
    type(field_value), intent(out) :: value   !! what the field says
    type(diagnostics), intent(inout) :: faults   !! what is wrong is added to them
    integer :: outcome

    associate (at => card%slot(slot))
      call read_value(card%text(at%first:at%last), entry, value, outcome)
    end associate
    if (outcome == scan_no_point .and. entry%point_optional) then
      if (card%is_large(slot)) outcome = scan_sound
    end if
    value%sound = outcome == scan_sound
    if (.not. value%sound) call refuse(card, table, slot, entry, value, outcome, faults)
  end subroutine read_slot

  !> Say why a field cannot be taken.
  subroutine refuse(card, table, slot, entry, value, outcome, faults)
    type(card_fields), intent(in) :: card
    type(card_table), intent(in) :: table
    integer, intent(in) :: slot
    type(field_entry), intent(in) :: entry
    type(field_value), intent(in) :: value
    integer, intent(in) :: outcome
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: what, remedy

    if (card%filled(slot)) then
      associate (at => card%slot(slot))
        call fault_of(card%text(at%first:at%last), entry, value, outcome, what, remedy)
      end associate
      call add_fault(card, table, slot, what, remedy, faults)
    else
      call add_fault(card, table, slot, 'is blank', entry%allowed(), faults)
    end if
  end subroutine refuse

  !> The value of a field; a blank one is malformed. `outcome` is `scan_sound`, or what `fault_of` puts into
  !! words.
  pure subroutine read_value(text, entry, value, outcome)
    character(len=*), intent(in) :: text     !! without blanks around it
    type(field_entry), intent(in) :: entry
    type(field_value), intent(out) :: value
    integer, intent(out) :: outcome
    integer(i8) :: whole

    outcome = scan_sound
    value%number = 0.0_wp
    value%word = ''
    select case (entry%kind)
    case (kind_integer)
      call scan_integer(text, whole, outcome)
      value%number = real(whole, wp)
    case (kind_real)
      call scan_real(text, value%number, outcome)
    case (kind_components)
      call scan_components(text, whole, outcome)
      value%number = real(whole, wp)
    case (kind_word)
      call scan_word(text, value%word, outcome)
    end select
    if (outcome == scan_sound) outcome = judged(value, entry)
  end subroutine read_value

  !> Whether a value of the right form is one that is allowed.
  pure integer function judged(value, entry) result(outcome)
    type(field_value), intent(in) :: value
    type(field_entry), intent(in) :: entry

    outcome = scan_sound
    if (entry%kind == kind_word) then
      if (entry%choices /= '' .and. index(' '//entry%choices//' ', ' '//trim(value%word)//' ') == 0) &
        outcome = out_of_range
      return
    end if
    associate (number => value%number)
      if (number < entry%lowest .or. (entry%above_lowest .and. number <= entry%lowest) .or. &
          number > entry%highest .or. (entry%below_highest .and. number >= entry%highest)) then
        outcome = out_of_range
      else if (entry%kind == kind_real .and. entry%used) then   ! whole numbers are always within reach
        if (abs(number) > farthest .or. (number /= 0.0_wp .and. abs(number) < entry%least)) &
          outcome = out_of_reach
      end if
    end associate
  end function judged

  !> A fault in words: `what` goes behind `field 4 (X1) `.
  pure subroutine fault_of(text, entry, value, outcome, what, remedy)
    character(len=*), intent(in) :: text  !! the field
    type(field_entry), intent(in) :: entry
    type(field_value), intent(in) :: value
    integer, intent(in) :: outcome
    character(len=:), allocatable, intent(out) :: what, remedy

    remedy = entry%allowed()
    select case (outcome)
    case (scan_no_point)
      what = 'is not a real number'
      remedy = 'a real needs a decimal point: '//with_point(text)
    case (scan_too_large)
      what = 'is too large for a number'
      if (entry%kind == kind_real) remedy = 'at most 1.0E+30'
    case (scan_too_small)
      what = 'is too small for a number'
      remedy = '0.0, or at least 2.226E-308'
    case (out_of_reach)
      what = 'is too far from 1.0'
      remedy = reach_of(entry)
    case (scan_too_long)
      what = 'has more than 8 characters'
    case (scan_malformed)
      what = 'is not '//trim(noun(entry%kind))
    case default
      what = 'is out of range'
      if (entry%kind == kind_word) what = 'is not a word known here'
      if (entry%withdrawn /= '' .and. value%word == entry%withdrawn) &
        what = 'is '//trim(entry%withdrawn)//', which is no longer there'
      if (entry%instead /= '' .and. value%number == entry%highest) then
        what = 'is '//text//', '//trim(entry%reason)
        remedy = 'less, such as '//trim(entry%instead)
      end if
    end select
  end subroutine fault_of

  !> The sizes that a number which has an effect may have, in words.
  pure function reach_of(entry) result(text)
    type(field_entry), intent(in) :: entry
    character(len=:), allocatable :: text

    text = 'other units: sizes'
    if (entry%least > 0.0_wp) text = text//' from '//short_real(entry%least)
    text = text//' to '//short_real(farthest)
    if (entry%least > 0.0_wp .and. .not. entry%above_lowest) text = text//', or 0.0'
  end function reach_of

  !> A real written without point, with it: `1E5` becomes `1.E5`.
  pure function with_point(text) result(real_text)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: real_text
    integer :: last

    last = verify(text(2:), '0123456789')
    if (last == 0) then
      real_text = text//'.0'
    else
      real_text = text(:last)//'.'//text(last + 1:)
    end if
  end function with_point
end module epcont_deck_value
