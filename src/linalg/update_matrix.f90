!> The full matrix that a front leaves to those above it.
module epcont_linalg_update_matrix
  use epcont_base_kinds, only: i8, wp
  use epcont_linalg_full_columns, only: take_block_off
  use epcont_linalg_front_layout, only: block_width, update_size
  implicit none
  private
  public :: update_matrix, lay_out, take_update_off

  !> What a front leaves to those above it: a full matrix of the rows that it reaches, from the diagonal down
  !! in blocks of columns, then of all its rows the columns that go along.
  type :: update_matrix
    real(wp), allocatable :: entries(:)
    !> Where row 0 of each column would be: one is stored from the first column of its block on [reached rows]
    integer(i8), allocatable :: row_zero(:)
    integer(i8) :: along = 0   !! entries before those that go along
  end type update_matrix

contains

  !> Room for an update matrix and what goes along.
  pure subroutine lay_out(own, reached, update)
    integer, intent(in) :: own, reached   !! rows of the front
    type(update_matrix), intent(out) :: update
    integer :: first, j

    allocate (update%entries(update_size(own, reached)), update%row_zero(reached))
    associate (w => block_width(reached))
      do first = 1, reached, w
        do j = first, min(first + w - 1, reached)
          update%row_zero(j) = update%along - (first - 1)
          update%along = update%along + reached - (first - 1)
        end do
      end do
    end associate
  end subroutine lay_out

  !> Take off an update matrix what the front's own columns eliminate, block by block, which threads share.
  subroutine take_update_off(rows, factored, leading, l, update)
    integer, intent(in) :: rows, factored, leading        !! dimension of l
    real(wp), intent(in) :: l(leading, factored)          !! [rows, factored]
    type(update_matrix), intent(inout) :: update
    integer :: j

    associate (w => block_width(rows))
      !$omp taskloop default(shared) grainsize(1) if(rows > w)
      do j = 1, rows, w
        call take_block_off(rows - j + 1, min(w, rows - j + 1), factored, leading, l(j, 1), rows - j + 1, &
                            update%entries(update%row_zero(j) + j))
      end do
      !$omp end taskloop
    end associate
  end subroutine take_update_off
end module epcont_linalg_update_matrix
