!> Geometry of the plane.
module epcont_base_geometry
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: polygon_area, cross_product

contains

  !> Signed area: positive where the corners turn counter-clockwise [length**2].
  pure function polygon_area(x) result(area)
    real(wp), intent(in) :: x(:, :)  !! corners [2, any]
    real(wp) :: area
    integer :: k

    area = 0.0_wp
    do k = 2, size(x, 2) - 1
      area = area + 0.5_wp*cross_product(x(:2, k) - x(:2, 1), x(:2, k + 1) - x(:2, 1))
    end do
  end function polygon_area

  !> The part of a x b across the plane: positive where b lies to the left of a.
  pure real(wp) function cross_product(a, b)
    real(wp), intent(in) :: a(2), b(2)

    cross_product = a(1)*b(2) - a(2)*b(1)
  end function cross_product
end module epcont_base_geometry
