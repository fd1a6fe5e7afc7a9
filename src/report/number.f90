!> Numbers as the listing and the tables print them.
module epcont_report_number
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: column_number, known_column, estimate_number, rounding_number, full_number, known_number

  !> A value below this part of its column's scale is rounding and prints as 0.0.
  real(wp), parameter :: noise = 1.0e-12_wp

contains

  !> A number of a listing's column, six digits in 13 characters.
  pure function column_number(value, scale) result(text)
    real(wp), intent(in) :: value
    real(wp), intent(in) :: scale  !! of the column: its largest magnitude
    character(len=13) :: text

    if (abs(value) <= noise*scale .or. value == 0.0_wp) then
      text = '          0.0'
    else if (abs(value) >= 0.999999e100_wp .or. abs(value) < 1.0e-99_wp) then
      write (text, '(es13.5e3)') value
    else
      write (text, '(es13.5e2)') value
    end if
  end function column_number

  !> The same of a figure that is never below zero; one that is not known is.
  pure function known_column(value, scale) result(text)
    real(wp), intent(in) :: value, scale
    character(len=13) :: text

    text = '            -'
    if (value >= 0.0_wp) text = column_number(value, scale)
  end function known_column

  !> A figure that is rounding in a valid answer, as the power of ten it is below, since rounding differs
  !! between builds: `< 1E-12` at the least. What is no rounding has two digits.
  pure function rounding_number(value) result(text)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: text
    real(wp), parameter :: rounding = 1.0e-9_wp
    character(len=12) :: buffer

    if (value < rounding) then
      write (buffer, '(a, i0)') '< 1E', ceiling(log10(max(value, 0.999_wp*noise)))
    else
      write (buffer, '(es9.1e3)') value
    end if
    text = trim(adjustl(buffer))
  end function rounding_number

  !> An estimate: two digits.
  pure function estimate_number(value) result(text)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: text
    character(len=12) :: buffer

    write (buffer, '(es9.1e2)') value
    if (value >= 0.94e100_wp .or. value < 1.0e-99_wp) write (buffer, '(es9.1e3)') value
    text = trim(adjustl(buffer))
  end function estimate_number

  !> A number in full precision: 17 digits.
  pure function full_number(value) result(text)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: text
    character(len=26) :: buffer

    write (buffer, '(es25.16e3)') merge(0.0_wp, value, value == 0.0_wp)  ! no negative zero
    text = trim(adjustl(buffer))
  end function full_number

  !> The same of a figure that is never below zero; empty where it is, since it is not known.
  pure function known_number(value) result(text)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: text

    text = ''
    if (value >= 0.0_wp) text = full_number(value)
  end function known_number
end module epcont_report_number
