!> Reals as decimals, in the digits that formats give and a tenth of their time: tables have a million.
!>
!> A real is m 2**e, and 10**p of it m 5**p 2**(e + p): a whole number of 128 bits for all of usual size,
!> whose last digit is rounded exactly, ties to even. Others are written by a format.
module epcont_base_decimal
  use epcont_base_kinds, only: i8, i16, wp
  implicit none
  private
  public :: full_decimal, short_decimal

  !> With 5 to a higher power m may be beyond the largest whole number.
  integer, parameter :: most = 27
  integer, parameter :: digits_of_real = digits(1.0_wp)

contains

  !> 17 digits, as the format es25.16e3 has them, blanks behind them.
  pure function full_decimal(value) result(text)
    real(wp), intent(in) :: value   !! any
    character(len=25) :: text
    integer(i8) :: number
    integer :: exponent
    logical :: exact

    call find_digits(value, 17, number, exponent, exact)
    if (exact) then
      call put_together(value < 0.0_wp, number, 17, exponent, 3, text)
    else
      write (text, '(es25.16e3)') value
      text = adjustl(text)
    end if
  end function full_decimal

  !> Six digits, as the format es13.5e2 has them, blanks behind them.
  pure function short_decimal(value) result(text)
    real(wp), intent(in) :: value   !! its exponent has two digits
    character(len=13) :: text
    integer(i8) :: number
    integer :: exponent
    logical :: exact

    call find_digits(value, 6, number, exponent, exact)
    if (exact) then
      call put_together(value < 0.0_wp, number, 6, exponent, 2, text)
    else
      write (text, '(es13.5e2)') value
      text = adjustl(text)
    end if
  end function short_decimal

  !> The first digits of the size of a number, as a whole number, and the power of ten of the first of them.
  pure subroutine find_digits(value, digits, number, power, exact)
    real(wp), intent(in) :: value
    integer, intent(in) :: digits          !! how many
    integer(i8), intent(out) :: number
    integer, intent(out) :: power
    logical, intent(out) :: exact          !! else nothing is found
    integer(i16) :: product, rest
    integer :: behind, p   ! bits behind the point; tens that are multiplied with

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
        rest = 2*(product - shiftl(int(number, i16), behind)) - shiftl(1_i16, behind)   ! less a half, twice
        if (rest > 0 .or. rest == 0 .and. btest(number, 0)) number = number + 1
      end if
      if (number < 10_i8**digits) return
      power = power + 1
    end do
  end subroutine find_digits

  !> Write digits with a point after the first one, and the power of ten of the first one.
  pure subroutine put_together(negative, number, digits, power, places, text)
    logical, intent(in) :: negative
    integer(i8), intent(in) :: number       !! the digits
    integer, intent(in) :: digits           !! how many
    integer, intent(in) :: power, places    !! of ten, and how many digits that has
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

  !> A whole number, with zeros before it.
  pure subroutine put_digits(number, text)
    integer(i8), intent(in) :: number
    character(len=*), intent(out) :: text   !! filled
    integer(i8) :: left
    integer :: k

    left = number
    do k = len(text), 1, -1
      text(k:k) = achar(iachar('0') + int(mod(left, 10_i8)))
      left = left/10
    end do
  end subroutine put_digits
end module epcont_base_decimal
