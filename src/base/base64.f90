!> Bytes as text: base64 (RFC 4648, section 4).
module epcont_base_base64
  use, intrinsic :: iso_fortran_env, only: int8
  implicit none
  private
  public :: base64

  character(len=64), parameter :: digits = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/'

contains

  !> Encode bytes: four characters for three bytes; `=` replaces the missing characters of the last group.
  pure function base64(bytes) result(text)
    integer(int8), intent(in) :: bytes(:)   !! [any]
    character(len=:), allocatable :: text
    integer(int8) :: last(3)
    integer :: group, whole, left

    whole = size(bytes)/3
    left = size(bytes) - 3*whole
    allocate (character(len=4*((size(bytes) + 2)/3)) :: text)
    do group = 1, whole
      text(4*group - 3:4*group) = encoded(bytes(3*group - 2:3*group))
    end do
    if (left == 0) return
    last = 0_int8
    last(:left) = bytes(3*whole + 1:)
    text(4*whole + 1:) = encoded(last)
    text(4*whole + left + 2:) = repeat('=', 3 - left)
  end function base64

  !> Encode three bytes as four digits of six bits.
  pure function encoded(three) result(text)
    integer(int8), intent(in) :: three(3)
    character(len=4) :: text
    integer :: bits, k, place

    bits = dot_product(iand(int(three), 255), [65536, 256, 1])
    do k = 1, 4
      place = ibits(bits, 24 - 6*k, 6) + 1
      text(k:k) = digits(place:place)
    end do
  end function encoded
end module epcont_base_base64
