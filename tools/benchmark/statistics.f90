!> Arguments of the benchmark programs, and statistics of repeated times.
module statistics
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: argument, median

contains

  function argument(k) result(text)
    integer, intent(in) :: k
    character(:), allocatable :: text
    integer :: length

    call get_command_argument(k, length=length)
    allocate (character(length) :: text)
    call get_command_argument(k, text)
  end function argument

  !> Median; of an even number of values the lower middle one.
  pure real(wp) function median(values)
    real(wp), intent(in) :: values(:)
    logical :: left(size(values))
    integer :: k

    left = .true.
    do k = 1, (size(values) - 1)/2
      left(minloc(values, mask=left, dim=1)) = .false.
    end do
    median = minval(values, mask=left)
  end function median
end module statistics
