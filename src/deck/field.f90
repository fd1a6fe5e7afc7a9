!> Convert the characters of a field to a number or a word. They are scanned strictly first, because READ
!> would accept `12 34`, `/`, `1e400`, `nan` or ten digits.
module epcont_deck_field
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: text_of, upper
  implicit none
  private
  public :: scan_integer, scan_real, scan_components, scan_word

  !> Outcomes of a scan.
  integer, parameter, public :: &
    scan_sound = 0, &      !! a value
    scan_malformed = 1, &  !! not of the requested kind
    scan_no_point = 2, &   !! a real without its decimal point
    scan_too_far = 3, &    !! a real beyond the range of numbers
    scan_too_long = 4      !! a word of more than eight characters

  !> Above this number another decimal digit might not fit an integer of eight bytes; 18 digits always fit.
  integer(i8), parameter :: full = 10_i8**17
  !> Integers of at most this size are exact as reals.
  integer(i8), parameter :: exact_mantissa = 2_i8**53
  !> Powers of ten that are exact as reals: one product or quotient of two exact reals is rounded correctly.
  integer, parameter :: exact_power = 22
  !> Powers of ten with which 18 digits neither overflow nor lose digits near zero.
  integer, parameter :: least_power = -307, largest_power = 290
  !> Exponents are not counted beyond this value.
  integer(i8), parameter :: endless_exponent = 100000

  !> Parts of a real: digits x 10**exponent.
  type :: decimal
    integer(i8) :: digits = 0      !! the first 18 significant digits
    integer :: dropped = 0         !! number of further significant digits
    integer :: point = 0           !! position of the decimal point; 0 if there is no point
    integer :: mantissa_last = 0   !! position of the last character of the mantissa
    integer :: exponent = 0        !! exponent as written
    logical :: negative = .false.
  end type decimal

contains

  !> Scan an integer: a sign, then digits.
  pure subroutine scan_integer(text, number, outcome)
    character(len=*), intent(in) :: text  !! without leading or trailing blanks
    integer(i8), intent(out) :: number   !! the largest integer if there are too many digits
    integer, intent(out) :: outcome       !! one of the outcomes above
    integer :: at, first
    integer(i8) :: digit

    number = 0
    outcome = scan_malformed
    first = 1
    if (len(text) > 0) first = merge(2, 1, is_sign(text(1:1)))
    if (first > len(text)) return
    do at = first, len(text)
      digit = iachar(text(at:at), i8) - iachar('0')
      if (digit < 0 .or. digit > 9) return
      number = merge(10*min(number, full) + digit, huge(number), number < full)
    end do
    if (text(1:1) == '-') number = -number
    outcome = scan_sound
  end subroutine scan_integer

  !> Scan a real: `7.0`, `.7E1`, `0.7+1`, `7.-2`, `7.D0`. It needs a decimal point, and is rounded correctly.
  pure subroutine scan_real(text, number, outcome)
    character(len=*), intent(in) :: text  !! without leading or trailing blanks
    real(wp), intent(out) :: number       !! set even if only the point is missing
    integer, intent(out) :: outcome       !! one of the outcomes above
    type(decimal) :: parts
    character(len=len(text) + 8) :: clean
    integer :: k, power
    real(wp), parameter :: power_of_ten(0:exact_power) = [(10.0_wp**k, k=0, exact_power)]

    number = 0.0_wp
    call take_apart(text, parts, outcome)
    if (all(outcome /= [scan_sound, scan_no_point]) .or. parts%digits == 0) return
    power = parts%exponent
    if (parts%point > 0) power = power - (parts%mantissa_last - parts%point)
    if (parts%digits <= exact_mantissa .and. abs(power) <= exact_power) then
      number = real(parts%digits, wp)
      if (power < 0) then
        number = number/power_of_ten(-power)
      else
        number = number*power_of_ten(power)
      end if
      if (parts%negative) number = -number
    else if (power + parts%dropped < least_power .or. power + parts%dropped > largest_power) then
      ! READ could trap or return infinity
      outcome = scan_too_far
    else   ! a mantissa with many digits, or a large exponent
      clean = text(:parts%mantissa_last)//'E'//text_of(parts%exponent)
      read (clean, *) number
    end if
  end subroutine scan_real

  !> Split a real into its parts; `outcome` says whether it is a real.
  pure subroutine take_apart(text, parts, outcome)
    character(len=*), intent(in) :: text
    type(decimal), intent(out) :: parts
    integer, intent(out) :: outcome
    integer :: at, first
    integer(i8) :: digit, exponent

    outcome = scan_malformed
    if (len(text) == 0) return
    parts%negative = text(1:1) == '-'
    first = merge(2, 1, is_sign(text(1:1)))
    do at = first, len(text)
      digit = iachar(text(at:at), i8) - iachar('0')
      if (digit >= 0 .and. digit <= 9) then
        if (parts%digits < full) then
          parts%digits = 10*parts%digits + digit
        else
          parts%dropped = parts%dropped + 1
        end if
      else if (text(at:at) == '.' .and. parts%point == 0) then
        parts%point = at
      else
        exit
      end if
    end do
    parts%mantissa_last = at - 1
    if (at - first == merge(1, 0, parts%point > 0)) return   ! no digit
    if (at <= len(text)) then
      first = at + merge(1, 0, scan(text(at:at), 'EeDd') == 1)
      if (first > at .or. is_sign(text(at:at))) call scan_integer(text(first:), exponent, outcome)
      if (outcome == scan_malformed) return
      parts%exponent = int(max(-endless_exponent, min(exponent, endless_exponent)))
    end if
    outcome = merge(scan_sound, scan_no_point, parts%point > 0)
  end subroutine take_apart

  !> Scan directions: digits from 1 to 6, each at most once, such as `12`.
  pure subroutine scan_components(text, number, outcome)
    character(len=*), intent(in) :: text  !! without leading or trailing blanks
    integer(i8), intent(out) :: number   !! the digits as a number
    integer, intent(out) :: outcome   !! one of the outcomes above
    integer :: at

    number = 0
    outcome = scan_malformed
    if (verify(text, '123456') > 0 .or. &
        any([(index(text(:at - 1), text(at:at)) > 0, at=2, len(text))])) return
    call scan_integer(text, number, outcome)
  end subroutine scan_components

  !> Scan a word: a letter, then other characters except blanks, at most eight in all.
  pure subroutine scan_word(text, word, outcome)
    character(len=*), intent(in) :: text  !! without leading or trailing blanks
    character(len=8), intent(out) :: word   !! in upper case, cut at eight characters
    integer, intent(out) :: outcome   !! one of the outcomes above

    outcome = scan_malformed
    word = upper(text(:min(8, len(text))))
    if (word(1:1) < 'A' .or. word(1:1) > 'Z' .or. index(text, ' ') > 0) return
    outcome = merge(scan_too_long, scan_sound, len(text) > 8)
  end subroutine scan_word

  elemental logical function is_sign(letter)
    character(len=1), intent(in) :: letter

    is_sign = letter == '+' .or. letter == '-'
  end function is_sign
end module epcont_deck_field
