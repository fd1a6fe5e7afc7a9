!> Symmetric matrices from their lower triangle.
module lower_triangles
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: whole

contains

  !> Both triangles.
  pure function whole(lower)
    real(wp), intent(in) :: lower(:, :)   !! entries above the diagonal are ignored
    real(wp) :: whole(size(lower, 1), size(lower, 2))
    integer :: k

    whole = lower
    do k = 2, size(lower, 2)
      whole(:k - 1, k) = lower(k, :k - 1)
    end do
  end function whole
end module lower_triangles
