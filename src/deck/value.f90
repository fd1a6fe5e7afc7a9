!> A field's characters and its entry in the catalogue to a value, or to what is wrong with it.
module epcont_deck_value
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: short_real
  use epcont_deck_entry, only: farthest, field_entry, kind_any, kind_components, kind_integer, kind_real, kind_word
  use epcont_deck_field, only: scan_components, scan_integer, scan_malformed, scan_no_point, scan_real, scan_sound, &
                               scan_too_large, scan_too_long, scan_too_small, scan_word
  implicit none
  private
  public :: read_value, fault_of, out_of_range

  !> A fault that is not one of form, beside the outcomes of a scan.
  integer, parameter :: out_of_range = -1, out_of_reach = -2

contains

  !> The value of a field that is not blank. `outcome` is `scan_sound`, or what `fault_of` puts into words.
  pure subroutine read_value(text, entry, value, word, outcome)
    character(len=*), intent(in) :: text     !! without blanks around it
    type(field_entry), intent(in) :: entry
    real(wp), intent(out) :: value           !! of a number
    character(len=8), intent(out) :: word    !! of a word, in capitals
    integer, intent(out) :: outcome
    integer(i8) :: whole

    value = 0.0_wp
    word = ''
    select case (entry%kind)
    case (kind_integer)
      call scan_integer(text, whole, outcome)
      value = real(whole, wp)
    case (kind_real)
      call scan_real(text, value, outcome)
    case (kind_components)
      call scan_components(text, whole, outcome)
      value = real(whole, wp)
    case (kind_word)
      call scan_word(text, word, outcome)
      if (outcome == scan_sound .and. allocated(entry%choices)) then
        if (index(' '//entry%choices//' ', ' '//trim(word)//' ') == 0) outcome = out_of_range
      end if
      return
    case default
      outcome = scan_sound
      return
    end select
    if (outcome /= scan_sound) return
    if (.not. within(value, entry)) then
      outcome = out_of_range
    else if (entry%kind == kind_real .and. entry%used) then   ! whole numbers are always within reach
      if (.not. within_reach(value, entry)) outcome = out_of_reach
    end if
  end subroutine read_value

  pure logical function within(value, entry)
    real(wp), intent(in) :: value
    type(field_entry), intent(in) :: entry

    within = value >= entry%lowest .and. value <= entry%highest
    if (entry%above_lowest) within = within .and. value > entry%lowest
    if (entry%below_highest) within = within .and. value < entry%highest
  end function within

  pure logical function within_reach(value, entry)
    real(wp), intent(in) :: value
    type(field_entry), intent(in) :: entry

    within_reach = abs(value) <= farthest .and. (value == 0.0_wp .or. abs(value) >= entry%least)
  end function within_reach

  !> A fault in words: `what` goes behind `field 4 (X1) `.
  pure subroutine fault_of(text, entry, outcome, what, remedy)
    character(len=*), intent(in) :: text  !! the field
    type(field_entry), intent(in) :: entry
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
      what = 'is not '//noun(entry%kind)
    case default
      call range_fault(text, entry, what, remedy)
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

  pure subroutine range_fault(text, entry, what, remedy)
    character(len=*), intent(in) :: text
    type(field_entry), intent(in) :: entry
    character(len=:), allocatable, intent(out) :: what
    character(len=:), allocatable, intent(inout) :: remedy
    character(len=8) :: word
    real(wp) :: value
    integer :: outcome

    what = 'is out of range'
    if (entry%kind == kind_word) what = 'is not a word known here'
    if (allocated(entry%withdrawn)) then
      call scan_word(text, word, outcome)
      if (word == entry%withdrawn) what = 'is '//entry%withdrawn//', which is no longer there'
    end if
    if (.not. allocated(entry%instead)) return
    call scan_real(text, value, outcome)
    if (value /= entry%highest) return
    what = 'is '//text//', '//entry%reason
    remedy = 'less, such as '//entry%instead
  end subroutine range_fault

  pure function noun(kind)
    integer, intent(in) :: kind
    character(len=:), allocatable :: noun

    select case (kind)
    case (kind_integer)
      noun = 'a whole number'
    case (kind_real)
      noun = 'a real number'
    case (kind_components)
      noun = 'a list of directions'
    case default
      noun = 'a word'
    end select
  end function noun

  !> A real written without point, with it: `1E5` becomes `1.E5`.
  pure function with_point(text) result(real_text)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: real_text
    integer :: last

    last = 1
    do while (last < len(text))
      if (scan(text(last + 1:last + 1), '0123456789') == 0) exit
      last = last + 1
    end do
    real_text = text(:last)//'.'//text(last + 1:)
    if (last == len(text)) real_text = real_text//'0'
  end function with_point
end module epcont_deck_value
