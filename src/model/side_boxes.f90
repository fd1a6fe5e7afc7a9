!> Which sides of a boundary lie near a point, without looking at all of them.
!>
!> Sides that follow each other lie together. So boxes round one side, round two, four, ... of them make a tree by their
!> numbers alone: node i has the children 2i and 2i+1, and the last level is the sides in their order. A long side widens
!> no boxes but those above it, however short the others are.
!>
!>              1
!>          2       3
!>        4   5   6   7        sides 1, 2, 3; 7 is empty
module epcont_model_side_boxes
  use epcont_base_kinds, only: wp
  use epcont_model_boundary_line, only: boundary_line
  implicit none
  private
  public :: boxed_line, new_boxed_line

  !> Sides of a boundary, and the boxes round them.
  type, extends(boundary_line) :: boxed_line
    integer, private :: first = 1                !! node of the first side
    real(wp), allocatable, private :: low(:, :)  !! corner of each box [length] [2, nodes]
    real(wp), allocatable, private :: high(:, :) !! the opposite one [length] [2, nodes]
  contains
    procedure :: near
    procedure :: in_box
  end type boxed_line

contains

  !> The boxes of a line. Each reaches beyond its side by half of the side's length, as the curve over it may do.
  pure function new_boxed_line(line) result(boxed)
    type(boundary_line), intent(in) :: line
    type(boxed_line) :: boxed
    real(wp) :: middle(2)
    integer :: i

    boxed%boundary_line = line
    do while (boxed%first < size(line%element))
      boxed%first = 2*boxed%first
    end do
    allocate (boxed%low(2, 2*boxed%first - 1), source=huge(1.0_wp))
    allocate (boxed%high(2, 2*boxed%first - 1), source=-huge(1.0_wp))
    do i = 1, size(line%element)
      middle = 0.5_wp*(line%x(:, 1, i) + line%x(:, 2, i))
      boxed%low(:, boxed%first - 1 + i) = middle - line%chord_length(i)
      boxed%high(:, boxed%first - 1 + i) = middle + line%chord_length(i)
    end do
    do i = boxed%first - 1, 1, -1
      boxed%low(:, i) = min(boxed%low(:, 2*i), boxed%low(:, 2*i + 1))
      boxed%high(:, i) = max(boxed%high(:, 2*i), boxed%high(:, 2*i + 1))
    end do
  end function new_boxed_line

  !> The sides whose boxes are not farther from a point than `distance` in either direction, in their order.
  pure function near(self, point, distance) result(sides)
    class(boxed_line), intent(in) :: self
    real(wp), intent(in) :: point(2), distance
    integer, allocatable :: sides(:)

    sides = self%in_box(point - distance, point + distance)
  end function near

  !> The sides whose boxes meet a box, in their order.
  pure function in_box(self, low, high) result(sides)
    class(boxed_line), intent(in) :: self
    real(wp), intent(in) :: low(2), high(2)   !! its opposite corners
    integer, allocatable :: sides(:)
    integer :: waiting(2*bit_size(1))   ! nodes still to be looked at, the next last
    integer :: count, i, n

    allocate (sides(16))
    n = 0
    waiting(1) = 1
    count = 1
    do while (count > 0)
      i = waiting(count)
      count = count - 1
      if (any(high < self%low(:, i)) .or. any(low > self%high(:, i))) cycle
      if (i < self%first) then
        waiting(count + 1:count + 2) = [2*i + 1, 2*i]
        count = count + 2
      else
        if (n == size(sides)) sides = [sides, spread(0, 1, n)]
        n = n + 1
        sides(n) = i - self%first + 1
      end if
    end do
    sides = sides(:n)
  end function in_box
end module epcont_model_side_boxes
