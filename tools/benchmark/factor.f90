!> Operations a second of dgemm at n = 1000, and of epcont's factorization: factor REPEATS N1 W1 [N2 W2 ...]
!>
!> N, W: equations and half-bandwidth, as `epcont --plan` reports them. Each repeat takes all in turn. Prints for dgemm and for
!> each matrix: N, W, processor seconds (median), operations, operations per second, and the fraction of dgemm's rate.
program bench_factor
  use epcont_base_kinds, only: wp
  use epcont_linalg_lapack, only: dgemm
  use epcont_linalg_panels, only: panel_matrix
  use epcont_linalg_panel_layout, only: new_panel_layout
  use statistics, only: median
  implicit none
  integer, parameter :: dense = 1000
  real(wp), parameter :: least = 0.05_wp   !! shortest time to measure [s]
  integer, allocatable :: order(:), width(:)
  real(wp), allocatable :: seconds(:, :)   !! [sizes + 1, repeats]
  real(wp) :: fastest, operations, taken
  integer :: k, r, repeats, sizes

  repeats = number(1)
  sizes = (command_argument_count() - 1)/2
  order = [(number(2*k), k=1, sizes)]
  width = [(number(2*k + 1), k=1, sizes)]
  allocate (seconds(sizes + 1, repeats))
  do r = 1, repeats
    seconds(1, r) = dgemm_time()
    do k = 1, sizes
      seconds(k + 1, r) = factor_time(order(k), width(k))
    end do
  end do
  taken = median(seconds(1, :))
  fastest = 2.0_wp*dense**3/taken
  print '(2i9,4es12.4)', dense, dense, taken, 2.0_wp*dense**3, fastest, 1.0_wp
  do k = 1, sizes
    operations = real(order(k), wp)*real(width(k), wp)**2
    taken = median(seconds(k + 1, :))
    print '(2i9,4es12.4)', order(k), width(k), taken, operations, operations/taken, operations/taken/fastest
  end do

contains

  integer function number(k)
    integer, intent(in) :: k
    character(20) :: text

    call get_command_argument(k, text)
    read (text, *) number
  end function number

  real(wp) function dgemm_time()
    real(wp), allocatable :: a(:, :), b(:, :), c(:, :)
    real(wp) :: begun, ended
    integer :: k

    allocate (a(dense, dense), b(dense, dense), c(dense, dense), source=1.0_wp)
    call cpu_time(begun)
    do k = 1, 3
      call dgemm('N', 'N', dense, dense, dense, 1.0_wp, a, dense, b, dense, 0.0_wp, c, dense)
    end do
    call cpu_time(ended)
    dgemm_time = (ended - begun)/3
  end function dgemm_time

  !> Factor a band matrix as often as needed for a measurable time.
  real(wp) function factor_time(n, w)
    integer, intent(in) :: n, w
    type(panel_matrix) :: matrix
    real(wp) :: begun, ended, ratio, spent
    logical :: stale(n)
    integer :: at, k, times

    call matrix%begin(new_panel_layout([(min(n, k + w), k=1, n)]), 0)
    spent = 0
    times = 0
    do while (spent < least)
      stale = .true.
      call matrix%clear(stale)
      do k = 1, n
        call matrix%add(1, [k], reshape([1.0_wp], [1, 1]))
      end do
      call cpu_time(begun)
      call matrix%factor(ratio, at)
      call cpu_time(ended)
      if (ratio <= 0) error stop 'not definite'
      spent = spent + ended - begun
      times = times + 1
    end do
    factor_time = spent/times
  end function factor_time
end program bench_factor
