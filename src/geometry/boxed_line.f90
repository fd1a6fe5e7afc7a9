!> Which sides of a boundary lie near a point, without looking at all of them.
module epcont_geometry_boxed_line
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_box_tree, only: box_tree, new_box_tree
  implicit none
  private
  public :: boxed_line, new_boxed_line

  !> Sides of a boundary, and the boxes round them.
  type, extends(boundary_line) :: boxed_line
    type(box_tree), private :: tree
  contains
    procedure :: in_box
  end type boxed_line

contains

  !> The boxes of a line. Each reaches beyond its side by half of the side's length, as the curve over it may
  !! do.
  pure function new_boxed_line(line) result(boxed)
    type(boundary_line), intent(in) :: line   !! its sides
    type(boxed_line) :: boxed
    real(wp), dimension(2, size(line%element)) :: low, high
    real(wp) :: middle(2)
    integer :: i

    boxed%boundary_line = line
    do i = 1, size(line%element)
      middle = 0.5_wp*(line%x(:, 1, i) + line%x(:, 2, i))
      low(:, i) = middle - line%chord_length(i)
      high(:, i) = middle + line%chord_length(i)
    end do
    boxed%tree = new_box_tree(low, high)
  end function new_boxed_line

  !> The sides whose boxes meet a box, in their order.
  pure function in_box(self, low, high) result(sides)
    class(boxed_line), intent(in) :: self
    real(wp), intent(in) :: low(2), high(2)   !! its opposite corners
    integer, allocatable :: sides(:)
    integer :: count

    allocate (sides(16))
    call self%tree%meeting(low, high, sides, count)
    sides = sides(:count)
    sides = sides(sorted_order(sides))   ! not by the tree's: of equal ones the first counts
  end function in_box
end module epcont_geometry_boxed_line
