!> Four-node quadrilateral, bilinear: corners in turn at (-1, -1), (1, -1), (1, 1), (-1, 1).
module epcont_element_quad4
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: quad4_values, quad4_slopes

  real(wp), parameter :: corner(2, 4) = &
    reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
  !> Integration points and weights of Gauss, two by two.
  real(wp), parameter, public :: quad4_point(2, 4) = corner/sqrt(3.0_wp)
  real(wp), parameter, public :: quad4_weight(4) = 1.0_wp

contains

  !> Shape functions at a local place [4].
  pure function quad4_values(place) result(n)
    real(wp), intent(in) :: place(2)
    real(wp) :: n(4)

    n = 0.25_wp*(1.0_wp + place(1)*corner(1, :))*(1.0_wp + place(2)*corner(2, :))
  end function quad4_values

  !> Their derivatives by the local coordinates [2, 4].
  pure function quad4_slopes(place) result(slope)
    real(wp), intent(in) :: place(2)
    real(wp) :: slope(2, 4)

    slope(1, :) = 0.25_wp*corner(1, :)*(1.0_wp + place(2)*corner(2, :))
    slope(2, :) = 0.25_wp*corner(2, :)*(1.0_wp + place(1)*corner(1, :))
  end function quad4_slopes
end module epcont_element_quad4
