!> Three-node triangle, linear: corners in turn at (0, 0), (1, 0), (0, 1).
module epcont_element_tria3
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: tria3_values, tria3_slopes

  !> Integration point and weight: exact for constant strain.
  real(wp), parameter, public :: tria3_point(2, 1) = reshape([1.0_wp, 1.0_wp]/3.0_wp, [2, 1])
  real(wp), parameter, public :: tria3_weight(1) = [0.5_wp]

contains

  !> Shape functions at a local place [3].
  pure function tria3_values(place) result(n)
    real(wp), intent(in) :: place(2)
    real(wp) :: n(3)

    n = [1.0_wp - place(1) - place(2), place(1), place(2)]
  end function tria3_values

  !> Their derivatives by the local coordinates [2, 3].
  pure function tria3_slopes(place) result(slope)
    real(wp), intent(in) :: place(2)
    real(wp) :: slope(2, 3)

    slope = reshape([-1.0_wp, -1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 3])
  end function tria3_slopes
end module epcont_element_tria3
