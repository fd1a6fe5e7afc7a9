!> Conversions between numbers and text.
module epcont_base_text
  use epcont_base_kinds, only: i8, wp
  implicit none
  private
  public :: upper, text_of, formatted, short_real, plural, shown

  character(len=1), parameter, public :: newline = new_line('a')

  !> The shortest decimal text of an integer.
  interface text_of
    module procedure :: text_of_integer, text_of_long
  end interface text_of

contains

  !> `string` in upper case.
  pure function upper(string) result(capital)
    character(len=*), intent(in) :: string   !! any
    character(len=len(string)) :: capital
    integer, parameter :: shift = iachar('a') - iachar('A')
    integer :: i

    capital = string
    do i = 1, len(string)
      if (string(i:i) >= 'a' .and. string(i:i) <= 'z') capital(i:i) = achar(iachar(string(i:i)) - shift)
    end do
  end function upper

  pure function text_of_integer(number) result(text)
    integer, intent(in) :: number
    character(len=:), allocatable :: text

    text = text_of_long(int(number, i8))
  end function text_of_integer

  pure function text_of_long(number) result(text)
    integer(i8), intent(in) :: number
    character(len=:), allocatable :: text
    character(len=20) :: buffer
    integer(i8) :: left
    integer :: k

    left = number
    do k = len(buffer), 1, -1
      buffer(k:k) = achar(iachar('0') + int(abs(mod(left, 10_i8))))
      left = left/10
      if (left == 0) exit
    end do
    text = buffer(k:)
    if (number < 0) text = '-'//text
  end function text_of_long

  !> A real in a given format, without leading and trailing blanks.
  pure function formatted(form, number) result(text)
    character(len=*), intent(in) :: form   !! the format, such as `(f20.3)`
    real(wp), intent(in) :: number         !! must fit the format
    character(len=:), allocatable :: text
    character(len=24) :: buffer

    write (buffer, form) number
    text = trim(adjustl(buffer))
  end function formatted

  !> A real with four significant digits, for messages: `0.01250`, `210.0`, `1.250E-07`.
  pure function short_real(number) result(text)
    real(wp), intent(in) :: number   !! any size
    character(len=:), allocatable :: text

    if (number == 0.0_wp) then
      text = '0.0'
    else if (abs(number) >= 1.0e-3_wp .and. abs(number) < 9999.5_wp) then
      text = formatted('(f20.'//text_of(max(1, 3 - floor(log10(abs(number)))))//')', number)
    else if (abs(number) >= 1.0e100_wp .or. abs(number) < 1.0e-99_wp) then
      text = formatted('(es12.3e3)', number)
    else
      text = formatted('(es12.3e2)', number)
    end if
  end function short_real

  !> A name for printing: control characters, which could move the cursor, change colours or imitate a line,
  !! become \x1B.
  pure function shown(name) result(text)
    character(len=*), intent(in) :: name   !! any bytes
    character(len=:), allocatable :: text
    !> In UTF-8 the controls from 128 to 159 begin with a byte of 194
    integer, parameter :: delete = 127, first_of_c1 = 194
    character(len=2) :: code
    integer :: byte(0:len(name) + 1), i

    byte = 255
    byte(1:len(name)) = [(iachar(name(i:i)), i=1, len(name))]
    text = ''
    do i = 1, len(name)
      if (byte(i) < 32 .or. byte(i) == delete .or. byte(i - 1) == first_of_c1 .and. byte(i) < 160 &
          .or. byte(i) == first_of_c1 .and. byte(i + 1) < 160) then
        write (code, '(z2.2)') byte(i)
        text = text//'\x'//code
      else
        text = text//name(i:i)
      end if
    end do
  end function shown

  !> `1 pair`, `2 pairs`.
  pure function plural(count, noun) result(text)
    integer, intent(in) :: count
    character(len=*), intent(in) :: noun   !! in the singular
    character(len=:), allocatable :: text

    text = text_of(count)//' '//noun
    if (count /= 1) text = text//'s'
  end function plural
end module epcont_base_text
