!> A plane grid of springs, as elements of four points: a stiffness matrix with a choice of elimination orders; and columns
!> of unequal heights.
module spring_grid
  use epcont_base_incidence, only: incidence
  use epcont_base_kinds, only: wp
  use epcont_linalg_assembled, only: assembled_matrix
  implicit none
  private
  public :: add_columns, grid, heights, of_elements

contains

  !> Equations of each element, from a table.
  pure type(incidence) function of_elements(numbers) result(equations)
    integer, intent(in) :: numbers(:, :)   !! [of an element, elements]
    integer :: e

    equations = incidence([(1 + e*size(numbers, 1), e=0, size(numbers, 2))], [numbers])
  end function of_elements

  !> Heights that rise and fall along the diagonal: the last row of each column.
  pure function heights(n, w) result(reach)
    integer, intent(in) :: n, w
    integer :: reach(n)
    integer :: j

    reach = [(min(n, j + nint(0.5_wp*w*(1.0_wp + sin(0.07_wp*j)))), j=1, n)]
  end function heights

  !> Add a full matrix column by column.
  subroutine add_columns(full, reach, matrix)
    real(wp), intent(in) :: full(:, :)
    integer, intent(in) :: reach(:)
    class(assembled_matrix), intent(inout) :: matrix
    integer :: i, j

    do j = 1, size(reach)
      call matrix%add(1, [j], full(j:j, j:j))
      do i = j + 1, reach(j)
        call matrix%add(2, [i, j], reshape([0.0_wp, full(i, j), full(i, j), 0.0_wp], [2, 2]))
      end do
    end do
  end subroutine add_columns

  !> Springs in the plane between the points of a grid, along its edges and diagonals, fixed at the first row; `weight`
  !! varies their stiffness. Equations run along the rows, so that the last row comes last.
  subroutine grid(columns, rows, weight, numbers, stiffness)
    integer, intent(in) :: columns, rows
    real(wp), intent(in) :: weight
    integer, allocatable, intent(out) :: numbers(:, :)          !! [8, cells]
    real(wp), allocatable, intent(out) :: stiffness(:, :, :)    !! [8, 8, cells]
    real(wp), parameter :: x(2, 4) = reshape([real(wp) :: 0, 0, 1, 0, 1, 1, 0, 1], [2, 4])
    real(wp) :: along(2), spring(8), modulus
    integer :: c, cell, i, j, point(4), r

    allocate (numbers(8, (columns - 1)*(rows - 1)), stiffness(8, 8, (columns - 1)*(rows - 1)))
    stiffness = 0.0_wp
    cell = 0
    do r = 1, rows - 1
      do c = 1, columns - 1
        cell = cell + 1
        point = [(r - 2)*columns + c, (r - 2)*columns + c + 1, (r - 1)*columns + c + 1, (r - 1)*columns + c]
        if (r == 1) point(:2) = 0
        numbers(1::2, cell) = max(0, 2*point - 1)
        numbers(2::2, cell) = max(0, 2*point)
        do i = 1, 4
          do j = i + 1, 4
            along = (x(:, j) - x(:, i))/norm2(x(:, j) - x(:, i))
            spring = 0.0_wp
            spring(2*i - 1:2*i) = -along
            spring(2*j - 1:2*j) = along
            modulus = 1.0_wp + weight*sin(real(cell + 3*i + 5*j, wp))
            stiffness(:, :, cell) = stiffness(:, :, cell) &
              + modulus*matmul(reshape(spring, [8, 1]), reshape(spring, [1, 8]))
          end do
        end do
      end do
    end do
  end subroutine grid
end module spring_grid
