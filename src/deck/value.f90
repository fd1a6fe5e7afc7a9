!> A field's characters and its entry in the catalogue to a value, or to what is wrong with it.
module epcont_deck_value
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: short_real
  use epcont_deck_card, only: card_fields
  use epcont_deck_entry, only: farthest, field_entry, kind_components, kind_integer, kind_real, kind_word
  use epcont_deck_field, only: scan_components, scan_integer, scan_malformed, scan_no_point, scan_real, &
                               scan_sound, scan_too_large, scan_too_long, scan_too_small, scan_word
  implicit none
  private
  public :: field_value, read_value, explain

  !> Faults that are not of form, beside the outcomes of a scan.
  integer, parameter :: out_of_range = -1, out_of_reach = -2
  !> What fields hold, by their kinds.
  character(len=*), parameter :: noun(4) = [character(len=20) :: &
    'a whole number', 'a real number', 'a list of directions', 'a word']

  !> What a field says. (Not initialised: that would take longer than reading it.)
  type :: field_value
    real(wp) :: number
    character(len=8) :: word   !! in capitals
    integer :: outcome         !! `scan_sound`, or what `explain` puts into words
  end type field_value

contains

  !> The value of a field; a blank one is malformed.
  pure subroutine read_value(card, slot, entry, value)
    type(card_fields), intent(in) :: card     !! its fields
    integer, intent(in) :: slot               !! which field
    type(field_entry), intent(in) :: entry    !! what it may hold
    type(field_value), intent(out) :: value   !! what it says
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
    if (value%outcome == scan_no_point .and. entry%point_optional) then
      if (card%is_large(slot)) value%outcome = scan_sound
    end if
    if (value%outcome /= scan_sound) return
    associate (number => value%number)
      if (entry%kind == kind_word) then
        if (entry%choices /= '' .and. index(' '//entry%choices//' ', ' '//trim(value%word)//' ') == 0) &
          value%outcome = out_of_range
      else if (number < entry%lowest .or. (entry%above_lowest .and. number <= entry%lowest) .or. &
               number > entry%highest .or. (entry%below_highest .and. number >= entry%highest)) then
        value%outcome = out_of_range
      else if (entry%kind == kind_real .and. entry%used) then   ! whole numbers are always within reach
        if (abs(number) > farthest .or. (number /= 0.0_wp .and. abs(number) < entry%least)) &
          value%outcome = out_of_reach
      end if
    end associate
  end subroutine read_value

  !> Why a field cannot be taken.
  pure subroutine explain(text, entry, value, what, remedy)
    character(len=*), intent(in) :: text      !! the field
    type(field_entry), intent(in) :: entry    !! what it may hold
    type(field_value), intent(in) :: value    !! what was read
    !> Is wrong with it, behind `field 4 (X1) `; would be right
    character(len=:), allocatable, intent(out) :: what, remedy
    integer :: last

    remedy = entry%allowed()
    select case (value%outcome)
    case (scan_no_point)
      what = 'is not a real number'
      last = verify(text(2:)//'.', '0123456789')   ! of its digits
      remedy = 'a real needs a decimal point: '//text(:last)//'.'//text(last + 1:)
      if (last == len(text)) remedy = remedy//'0'
    case (scan_too_large)
      what = 'is too large for a number'
      if (entry%kind == kind_real) remedy = 'at most 1.0E+30'
    case (scan_too_small)
      what = 'is too small for a number'
      remedy = '0.0, or at least 2.226E-308'
    case (out_of_reach)
      what = 'is too far from 1.0'
      remedy = 'other units: sizes'
      if (entry%least > 0.0_wp) remedy = remedy//' from '//short_real(entry%least)
      remedy = remedy//' to '//short_real(farthest)
      if (entry%least > 0.0_wp .and. .not. entry%above_lowest) remedy = remedy//', or 0.0'
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
  end subroutine explain
end module epcont_deck_value
