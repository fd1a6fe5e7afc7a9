!> Full columns of fronts: their Cholesky factor, in products as large as possible, and update matrices.
module epcont_linalg_full_columns
  use epcont_base_kinds, only: i8, wp
  use epcont_linalg_front_layout, only: block_width, update_size
  use epcont_linalg_lapack, only: dgemm, dpotrf, dsyrk, dtrsm
  implicit none
  private
  public :: factor_columns, lay_out, take_update_off, update_matrix

  !> Update matrix of a front: a full matrix of the rows that it reaches, in blocks of columns from the
  !! diagonal down, then the columns along (`columns_along`) of all its rows.
  type :: update_matrix
    real(wp), allocatable :: entries(:)
    !> Position of row 0 of each column, which is stored from the row of its block's first column on [reached
    !! rows]
    integer(i8), allocatable :: row_zero(:)
    integer(i8) :: along = 0   !! entries before the columns along
  end type update_matrix

contains

  !> Factor full columns. Recursive halving turns most of the work into products; the BLAS solves with a
  !! triangle at a third of their rate.
  recursive subroutine factor_columns(rows, columns, leading, a, failed)
    integer, intent(in) :: rows, columns
    integer, intent(in) :: leading                  !! dimension of a
    real(wp), intent(inout) :: a(leading, columns)  !! [rows, columns]
    integer, intent(out) :: failed                  !! column without a pivot; 0 if none failed
    integer, parameter :: few = 24, tall = 256
    integer :: half, i

    if (columns <= few) then
      call dpotrf('L', columns, a, leading, failed)
      if (failed > 0 .or. rows == columns) return
      if (rows <= tall) then
        call dtrsm('R', 'L', 'T', 'N', rows - columns, columns, 1.0_wp, a, leading, a(columns + 1, 1), &
                   leading)
        return
      end if
      !$omp taskloop default(shared) grainsize(1)
      do i = columns + 1, rows, tall
        call dtrsm('R', 'L', 'T', 'N', min(tall, rows - i + 1), columns, 1.0_wp, a, leading, a(i, 1), leading)
      end do
      !$omp end taskloop
      return
    end if
    half = (columns/2 + 7)/8*8
    call factor_columns(rows, half, leading, a, failed)
    if (failed > 0) return
    call take_columns_off(rows - half, columns - half, half, leading, a(half + 1, 1), &
                          a(half + 1, half + 1))
    call factor_columns(rows - half, columns - half, leading, a(half + 1, half + 1), failed)
    if (failed > 0) failed = half + failed
  end subroutine factor_columns

  !> Subtract from columns, from the diagonal down, their part that factored columns eliminate. Threads share
  !! the blocks.
  subroutine take_columns_off(rows, columns, factored, leading, l, c)
    integer, intent(in) :: rows, columns, factored
    integer, intent(in) :: leading                        !! dimension of l and c
    real(wp), intent(in) :: l(leading, factored)          !! [rows, factored]
    real(wp), intent(inout) :: c(leading, columns)        !! [rows, columns]
    integer :: j

    associate (w => block_width(rows))
      !$omp taskloop default(shared) grainsize(1) if(columns > w)
      do j = 1, columns, w
        call take_block_off(rows - j + 1, min(w, columns - j + 1), factored, leading, l(j, 1), leading, &
                            c(j, j))
      end do
      !$omp end taskloop
    end associate
  end subroutine take_columns_off

  !> Subtract from one block. Narrow blocks include the part above the diagonal, which is never read.
  subroutine take_block_off(rows, columns, factored, leading, l, leading_c, c)
    integer, intent(in) :: rows, columns, factored
    integer, intent(in) :: leading, leading_c             !! dimensions of l and c
    real(wp), intent(in) :: l(leading, factored)          !! [rows, factored]
    real(wp), intent(inout) :: c(leading_c, columns)      !! [rows, columns]
    integer, parameter :: narrow = 32
    integer :: w

    w = 0
    if (columns > narrow) then
      w = columns
      call dsyrk('L', 'N', w, factored, -1.0_wp, l, leading, 1.0_wp, c, leading_c)
    end if
    if (rows > w) call dgemm('N', 'T', rows - w, columns, factored, -1.0_wp, l(w + 1, 1), leading, l, &
                            leading, 1.0_wp, c(w + 1, 1), leading_c)
  end subroutine take_block_off

  !> Allocate an update matrix.
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

  !> Subtract from an update matrix the part that the front's own columns eliminate. Threads share the blocks.
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
end module epcont_linalg_full_columns
