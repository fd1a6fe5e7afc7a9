!> Geometry of the plane.
module epcont_geometry_plane
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: cross_product, turned

contains

  !> The part of a x b across the plane: positive where b lies to the left of a.
  pure real(wp) function cross_product(a, b)
    real(wp), intent(in) :: a(2), b(2)   !! any unit

    cross_product = a(1)*b(2) - a(2)*b(1)
  end function cross_product

  !> A vector turned counter-clockwise: exactly by quarter turns, and as well after any number of full ones.
  pure function turned(vector, angle)
    real(wp), intent(in) :: vector(2)   !! any length
    real(wp), intent(in) :: angle       !! [degree]
    real(wp) :: turned(2)
    real(wp), parameter :: quarter = 90.0_wp, degree = acos(-1.0_wp)/180.0_wp
    real(wp) :: rest
    integer :: k, quarters

    rest = modulo(angle, 4.0_wp*quarter)
    quarters = nint(rest/quarter)
    rest = (rest - quarters*quarter)*degree
    turned = vector
    do k = 1, quarters
      turned = [-turned(2), turned(1)]
    end do
    turned = [cos(rest)*turned(1) - sin(rest)*turned(2), sin(rest)*turned(1) + cos(rest)*turned(2)]
  end function turned
end module epcont_geometry_plane
