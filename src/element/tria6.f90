!> Six-node triangle, quadratic: corners in turn at (0, 0), (1, 0), (0, 1), then the middles of the sides behind each.
module epcont_element_tria6
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: tria6_values, tria6_slopes

  !> Integration points and weights: exact for quadratics, that is for the stiffness of a straight-sided element.
  real(wp), parameter, public :: tria6_point(2, 3) = &
    reshape([1.0_wp, 1.0_wp, 4.0_wp, 1.0_wp, 1.0_wp, 4.0_wp]/6.0_wp, [2, 3])
  real(wp), parameter, public :: tria6_weight(3) = 1.0_wp/6.0_wp

contains

  !> Shape functions at a local place [6].
  pure function tria6_values(place) result(n)
    real(wp), intent(in) :: place(2)
    real(wp) :: n(6)
    real(wp) :: l(3)

    l = [1.0_wp - place(1) - place(2), place(1), place(2)]
    n = [l*(2.0_wp*l - 1.0_wp), 4.0_wp*l*cshift(l, 1)]
  end function tria6_values

  !> Their derivatives by the local coordinates [2, 6].
  pure function tria6_slopes(place) result(slope)
    real(wp), intent(in) :: place(2)
    real(wp) :: slope(2, 6)
    integer, parameter :: next(3) = [2, 3, 1]
    real(wp), parameter :: l_slope(2, 3) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 3])
    real(wp) :: l(3)
    integer :: i

    l = [1.0_wp - place(1) - place(2), place(1), place(2)]
    do i = 1, 3
      slope(:, i) = (4.0_wp*l(i) - 1.0_wp)*l_slope(:, i)
      slope(:, 3 + i) = 4.0_wp*(l(next(i))*l_slope(:, i) + l(i)*l_slope(:, next(i)))
    end do
  end function tria6_slopes
end module epcont_element_tria6
