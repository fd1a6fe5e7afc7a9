!> Which sides of a boundary line lie near a point, without looking at all of them.
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
  public :: side_boxes, new_side_boxes

  type :: side_boxes
    private
    integer :: first = 1                !! node of the first side
    real(wp), allocatable :: low(:, :)  !! corner of each box [length] [2, nodes]
    real(wp), allocatable :: high(:, :) !! the opposite one [length] [2, nodes]
  contains
    procedure :: near
  end type side_boxes

contains

  !> The boxes of a line. Each reaches beyond its side by half of the side's length, as the curve over it may do.
  pure function new_side_boxes(line) result(boxes)
    type(boundary_line), intent(in) :: line
    type(side_boxes) :: boxes
    real(wp) :: middle(2)
    integer :: i

    do while (boxes%first < size(line%element))
      boxes%first = 2*boxes%first
    end do
    allocate (boxes%low(2, 2*boxes%first - 1), source=huge(1.0_wp))
    allocate (boxes%high(2, 2*boxes%first - 1), source=-huge(1.0_wp))
    do i = 1, size(line%element)
      middle = 0.5_wp*(line%x(:, 1, i) + line%x(:, 2, i))
      boxes%low(:, boxes%first - 1 + i) = middle - line%chord_length(i)
      boxes%high(:, boxes%first - 1 + i) = middle + line%chord_length(i)
    end do
    do i = boxes%first - 1, 1, -1
      boxes%low(:, i) = min(boxes%low(:, 2*i), boxes%low(:, 2*i + 1))
      boxes%high(:, i) = max(boxes%high(:, 2*i), boxes%high(:, 2*i + 1))
    end do
  end function new_side_boxes

  !> The sides whose boxes are not farther from a point than `distance` in either direction, in their order.
  pure function near(self, point, distance) result(sides)
    class(side_boxes), intent(in) :: self
    real(wp), intent(in) :: point(2), distance
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
      if (any(point < self%low(:, i) - distance) .or. any(point > self%high(:, i) + distance)) cycle
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
  end function near
end module epcont_model_side_boxes
