!> How fast this machine multiplies matrices.
module epcont_linalg_rate
  use epcont_base_kinds, only: wp
  use epcont_linalg_dense, only: add_product
  implicit none
  private
  public :: measured_rate

  !> Rows of the matrices, as of fronts of middle size, and products of which the fastest counts: 2 to 3 ms in
  !! all on one core with AVX2.
  integer, parameter :: rows = 200, products = 6

contains

  !> Operations in a second of the processor, on one thread, of products of matrices.
  real(wp) function measured_rate() result(rate)
    real(wp), allocatable :: a(:, :), c(:, :)   ! too large for a small stack
    real(wp) :: begun, ended, least
    integer :: k

    allocate (a(rows, rows), source=1.0_wp/rows)
    allocate (c(rows, rows), source=0.0_wp)
    least = huge(least)
    do k = 1, products
      call cpu_time(begun)
      call add_product(1.0_wp, a, a, c)
      call cpu_time(ended)
      if (ended > begun) least = min(least, ended - begun)
    end do
    rate = 2.0_wp*real(rows, wp)**3/least
  end function measured_rate
end module epcont_linalg_rate
