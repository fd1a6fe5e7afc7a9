!> Three-node triangle of constant strain. Corners turn counter-clockwise.
module epcont_element_tria3
  use epcont_base_geometry, only: triangle_area
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: tria3_strain_matrix, tria3_stiffness

contains

  !> B of strain = B u: strain xx, yy, xy; u = (ux, uy) of each corner in turn [1/length] [3, 6].
  pure function tria3_strain_matrix(x) result(b)
    real(wp), intent(in) :: x(2, 3)
    real(wp) :: b(3, 6)
    integer, parameter :: next(3) = [2, 3, 1], last(3) = [3, 1, 2]
    real(wp) :: slope_x, slope_y, twice_area
    integer :: i

    twice_area = 2.0_wp*triangle_area(x)
    b = 0.0_wp
    do i = 1, 3
      slope_x = (x(2, next(i)) - x(2, last(i)))/twice_area
      slope_y = (x(1, last(i)) - x(1, next(i)))/twice_area
      b(1, 2*i - 1) = slope_x
      b(2, 2*i) = slope_y
      b(3, 2*i - 1) = slope_y
      b(3, 2*i) = slope_x
    end do
  end function tria3_strain_matrix

  !> Stiffness matrix B' D B times volume [force/length] [6, 6].
  pure function tria3_stiffness(x, d, thickness) result(k)
    real(wp), intent(in) :: x(2, 3)
    real(wp), intent(in) :: d(3, 3)     !! material matrix
    real(wp), intent(in) :: thickness
    real(wp) :: k(6, 6)
    real(wp) :: b(3, 6)

    b = tria3_strain_matrix(x)
    k = thickness*triangle_area(x)*matmul(transpose(b), matmul(d, b))
  end function tria3_stiffness
end module epcont_element_tria3
