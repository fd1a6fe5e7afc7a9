!> What the benchmark programs make of repeated times.
module statistics
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: median

contains

  !> The middle one, or the lower of the two.
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
