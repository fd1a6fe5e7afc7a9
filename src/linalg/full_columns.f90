!> Full columns of a Cholesky factor, in products as large as possible: fronts consist of them.
module epcont_linalg_full_columns
  use epcont_base_kinds, only: wp
  use epcont_linalg_front_layout, only: block_width
  use epcont_linalg_lapack, only: dgemm, dpotrf, dsyrk, dtrsm
  implicit none
  private
  public :: factor_columns, take_block_off

contains

  !> Factor columns that are stored full. Halved again and again, most of the work is products; of solving
  !! with a triangle the BLAS makes a third of their rate.
  recursive subroutine factor_columns(rows, columns, leading, a, failed)
    integer, intent(in) :: rows, columns
    integer, intent(in) :: leading                  !! dimension of a
    real(wp), intent(inout) :: a(leading, columns)  !! [rows, columns]
    integer, intent(out) :: failed                  !! column that has no pivot; 0: none
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

  !> Take off columns, from the diagonal down, what others that are factored eliminate, block by block, which
  !! threads share.
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

  !> One block of them. Narrow ones take along what stands above the diagonal, which is never read.
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
end module epcont_linalg_full_columns
