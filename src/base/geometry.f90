!> Geometry of the plane.
module epcont_base_geometry
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: triangle_area

contains

  !> Signed area: positive where the corners turn counter-clockwise [length**2].
  pure function triangle_area(x) result(area)
    real(wp), intent(in) :: x(2, 3)  !! corners
    real(wp) :: area

    area = 0.5_wp*((x(1, 2) - x(1, 1))*(x(2, 3) - x(2, 1)) - (x(1, 3) - x(1, 1))*(x(2, 2) - x(2, 1)))
  end function triangle_area
end module epcont_base_geometry
