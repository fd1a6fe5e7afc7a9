!> Numbers as the listing and the tables print them.
module epcont_report_number
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_base_tolerances, only: least_difference, rounded_off
  use epcont_report_layout, only: right
  implicit none
  private
  public :: listed_number, full_numbers, estimate_number, rounding_number, percent

  !> What a number is, which says how it is written: in a file in full, in the listing in the digits that
  !! tell.
  integer, parameter, public :: number = 1     !! six digits
  integer, parameter, public :: known = 2      !! the same; not known where it is negative
  integer, parameter, public :: estimate = 3   !! two digits; not known where it is negative
  integer, parameter, public :: size_of = 4    !! four digits
  integer, parameter, public :: rounding = 5   !! the power of ten that it is below, where it is rounding
  integer, parameter, public :: off_curve = 6  !! the same: a stress's distance from its curve over the latter
  integer, parameter, public :: factor = 7     !! of errors: two digits; not known where it is negative
  integer, parameter, public :: part = 8       !! per cent
  integer, parameter, public :: no_number = 9  !! there is none in this scene

  !> Beyond these rounding has a say in the number itself.
  real(wp), parameter :: largest_off_curve = 10.0_wp, largest_factor = 1.0e6_wp

contains

  !> A number of one of the kinds above in the listing.
  pure function listed_number(kind, value, scale) result(text)
    integer, intent(in) :: kind   !! one of the kinds above
    real(wp), intent(in) :: value   !! the number
    real(wp), intent(in) :: scale   !! largest magnitude of its column; of an estimate: what it is an error of
    character(len=:), allocatable :: text

    text = '-'
    select case (kind)
    case (number)
      text = column_number(value, scale)
    case (known)
      if (value >= 0.0_wp) text = column_number(value, scale)
    case (estimate)
      if (value >= 0.0_wp) text = '0.0'
      if (value > least_difference*scale) text = estimate_number(value)
    case (size_of)
      text = short_real(value)
    case (rounding)
      text = 'unknown'
      if (value >= 0.0_wp) text = rounding_number(value)
    case (off_curve)
      text = '> '//text_of(nint(largest_off_curve))
      if (value <= largest_off_curve) text = rounding_number(value)
    case (factor)
      text = estimate_number(value)
      if (value > largest_factor) text = '> '//estimate_number(largest_factor)
    case (part)
      text = right(percent(value, 1.0_wp), 15)   ! the sign stands behind the column
    end select
  end function listed_number

  !> Numbers in a file: 17 digits, and blanks behind them; of errors, pressures and the like that are negative
  !! nothing is known. They are written at once, since a format takes longer than a number.
  pure function full_numbers(kinds, values) result(text)
    integer, intent(in) :: kinds(:)     !! of each, one of those above
    real(wp), intent(in) :: values(:)   !! at least one
    character(len=25) :: text(size(values))
    integer :: k

    write (text, '(es25.16e3)') merge(0.0_wp, values, values == 0.0_wp)   ! no negative zero
    text = adjustl(text)
    do k = 1, size(values)
      if (any(kinds(k) == [known, estimate, factor, part]) .and. .not. values(k) >= 0.0_wp .or. &
          kinds(k) == no_number) text(k) = ''
    end do
  end function full_numbers

  !> A number of a listing's column, six digits in 13 characters.
  pure function column_number(value, scale) result(text)
    real(wp), intent(in) :: value
    real(wp), intent(in) :: scale  !! of the column: its largest magnitude
    character(len=13) :: text

    if (abs(value) <= rounded_off*scale .or. value == 0.0_wp) then
      text = '          0.0'
    else if (abs(value) >= 0.999999e100_wp .or. abs(value) < 1.0e-99_wp) then
      write (text, '(es13.5e3)') value
    else
      write (text, '(es13.5e2)') value
    end if
  end function column_number

  !> A figure that is rounding in a valid answer, as the power of ten it is below, since rounding differs
  !! between builds: `< 1E-12` at the least. What is no rounding has two digits.
  pure function rounding_number(value) result(text)
    real(wp), intent(in) :: value   !! the number
    character(len=:), allocatable :: text
    character(len=12) :: buffer

    if (value < least_difference) then
      write (buffer, '(a, i0)') '< 1E', ceiling(log10(max(value, 0.999_wp*rounded_off)))
    else
      write (buffer, '(es9.1e3)') value
    end if
    text = trim(adjustl(buffer))
  end function rounding_number

  !> An estimate: two digits.
  pure function estimate_number(value) result(text)
    real(wp), intent(in) :: value   !! the number
    character(len=:), allocatable :: text
    character(len=12) :: buffer

    write (buffer, '(es9.1e2)') value
    if (value >= 0.94e100_wp .or. value < 1.0e-99_wp) write (buffer, '(es9.1e3)') value
    text = trim(adjustl(buffer))
  end function estimate_number

  !> A part in per cent, two digits of it; empty where it is a hundred times the whole.
  pure function percent(value, of) result(text)
    real(wp), intent(in) :: value   !! the number
    real(wp), intent(in) :: of      !! the whole
    character(len=:), allocatable :: text
    character(len=12) :: buffer
    real(wp) :: hundredths

    text = ''
    if (of <= 0.0_wp .or. value >= 100.0_wp*of) return
    hundredths = 100.0_wp*value/of
    buffer = '< 0.001'
    if (hundredths >= 0.00095_wp) &
      write (buffer, '(f12.'//text_of(max(0, 1 - floor(log10(1.05_wp*hundredths))))//')') hundredths
    text = trim(adjustl(buffer))
    if (text(len(text):) == '.') text = text(:len(text) - 1)
    text = text//' %'
  end function percent
end module epcont_report_number
