!> Write reals as decimals, with the digits of a format but in a tenth of its time: tables have a million
!> numbers.
!>
!> A real is m 2**e; times 10**p it is m 5**p 2**(e + p). For usual sizes this is an integer of 128 bits,
!> whose last digit is rounded exactly, ties to even. Other reals are written with a format.
module epcont_base_decimal
  use epcont_base_kinds, only: i8, i16, wp
  implicit none
  private
  public :: decimal_text

  !> With a higher power of 5 the product may exceed the largest integer.
  integer, parameter :: most = 27
  integer, parameter :: digits_of_real = digits(1.0_wp)

contains

  !> Write a real with these digits as the format `es` does, with trailing blanks.
  pure function decimal_text(value, digits, places) result(text)
    real(wp), intent(in) :: value    !! any; its exponent must fit its digits
    integer, intent(in) :: digits, places   !! significant digits, and digits of the exponent
    character(len=digits + places + 5) :: text
    character(len=20) :: form
    integer(i8) :: number
    integer :: exponent
    logical :: exact

    call find_digits(value, digits, number, exponent, exact)
    if (exact) then
      call put_together(value < 0.0_wp, number, digits, exponent, places, text)
    else
      write (form, '("(es", i0, ".", i0, "e", i0, ")")') len(text), digits - 1, places
      write (text, form) value
      text = adjustl(text)
    end if
  end function decimal_text

  !> Find the first digits of a magnitude, as an integer, and the power of ten of the first digit.
  pure subroutine find_digits(value, digits, number, power, exact)
    real(wp), intent(in) :: value
    integer, intent(in) :: digits          !! number of digits
    integer(i8), intent(out) :: number
    integer, intent(out) :: power
    logical, intent(out) :: exact          !! otherwise the result is undefined
    integer(i16) :: product, rest
    integer :: behind, p   ! bits after the binary point; power of ten of the factor

    number = 0
    power = 0
    exact = value == 0.0_wp
    if (exact .or. .not. abs(value) < 10.0_wp**digits) return
    power = floor((exponent(value) - 1)*log10(2.0_wp))   ! or one more
    do
      p = digits - 1 - power
      exact = p >= 0 .and. p <= most
      if (.not. exact) return
      product = int(scale(fraction(abs(value)), digits_of_real), i16)*5_i16**p
      behind = digits_of_real - exponent(value) - p
      if (behind <= 0) then
        number = int(shiftl(product, -behind), i8)
      else
        number = int(shiftr(product, behind), i8)
        rest = 2*(product - shiftl(int(number, i16), behind)) - shiftl(1_i16, behind)   ! 2 (rest - 1/2)
        if (rest > 0 .or. rest == 0 .and. btest(number, 0)) number = number + 1
      end if
      if (number < 10_i8**digits) return
      power = power + 1
    end do
  end subroutine find_digits

  !> Write digits with a point after the first one, and its power of ten.
  pure subroutine put_together(negative, number, digits, power, places, text)
    logical, intent(in) :: negative
    integer(i8), intent(in) :: number       !! the digits
    integer, intent(in) :: digits           !! number of digits
    integer, intent(in) :: power, places    !! power of ten, and its number of digits
    character(len=*), intent(out) :: text
    integer :: first

    text = ''
    first = merge(2, 1, negative)
    if (negative) text(1:1) = '-'
    call put_digits(number, text(first + 1:first + digits))
    text(first:first + 1) = text(first + 1:first + 1)//'.'
    associate (behind => text(first + digits + 1:first + digits + 2 + places))
      behind(:2) = merge('E-', 'E+', power < 0)
      call put_digits(int(abs(power), i8), behind(3:))
    end associate
  end subroutine put_together

  !> Write an integer with leading zeros.
  pure subroutine put_digits(number, text)
    integer(i8), intent(in) :: number
    character(len=*), intent(out) :: text   !! filled completely
    integer(i8) :: left
    integer :: k

    left = number
    do k = len(text), 1, -1
      text(k:k) = achar(iachar('0') + int(mod(left, 10_i8)))
      left = left/10
    end do
  end subroutine put_digits
end module epcont_base_decimal
