!> Time of the contact rules against the number of pairs, beside that of one dgemm of the same size (`tools/bench_rules`).
!>
!> The problem is Hertz': pairs at equal distance on a half-plane, F_ij the logarithmic kernel over segments of constant
!> pressure, a parabolic gap, one free motion, and a load that closes half of the pairs, or the part that is asked for.
program benchmark_contact
  use, intrinsic :: iso_fortran_env, only: int64
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_problem, contact_solution
  use epcont_contact_solver, only: solve_contact
  use epcont_linalg_dense, only: add_product
  implicit none

  integer, parameter :: sizes(*) = [25, 50, 100, 200, 350, 500, 1000, 2000, 3000]
  integer, parameter :: conry_limit = 2000   !! pairs beyond which CONRY is not waited for
  character(len=32) :: argument
  real(wp) :: touching
  integer :: i, chosen

  chosen = 0
  touching = 0.5_wp
  if (command_argument_count() > 0) then
    call get_command_argument(1, argument)
    read (argument, *) chosen
  end if
  if (command_argument_count() > 1) then
    call get_command_argument(2, argument)
    read (argument, *) touching
  end if
  write (*, '(a)') 'milliseconds, best of some; residual: largest failure of a condition, of |F||R|; T: without CONRY'
  write (*, '(a)') '   pairs  touching     dgemm     CONRY  pivots     BLOCK  steps  exchanged  residual      warm  difference'
  do i = 1, size(sizes)
    if (chosen == 0 .or. chosen == sizes(i)) call measure(sizes(i))
  end do

contains

  subroutine measure(n)
    integer, intent(in) :: n
    type(contact_problem) :: problem
    type(contact_solution) :: block, conry, warm
    real(wp) :: difference, time(4)
    integer :: repeats

    problem = half_plane(n, touching)
    repeats = max(3, min(200, 100000000/n**2/10))
    time(1) = time_of_product(n, max(3, repeats/10))
    time(2) = -0.001_wp
    if (n <= conry_limit) call run(problem, .false., merge(repeats, 1, n < 500), conry, time(2))
    call run(problem, .true., repeats, block, time(3))
    call run(problem, .true., repeats, warm, time(4), block%touching)
    difference = -1.0_wp
    if (n <= conry_limit) difference = maxval(abs(block%force - conry%force))/maxval(conry%force)
    write (*, '(i8,i10,2f10.3,i8,f10.3,i7,i11,es10.1,f10.3,es12.1,l3)') n, count(block%touching), 1000*time(1), 1000*time(2), &
      conry%pivots, 1000*time(3), block%block_steps, block%pivots, residual(problem, block), 1000*time(4), difference, &
      block%by_blocks
  end subroutine measure

  subroutine run(problem, by_blocks, repeats, solution, best, start)
    type(contact_problem), intent(in) :: problem
    logical, intent(in) :: by_blocks
    integer, intent(in) :: repeats
    type(contact_solution), intent(out) :: solution
    real(wp), intent(out) :: best
    logical, intent(in), optional :: start(:)
    integer(int64) :: began
    integer :: i

    best = huge(best)
    do i = 1, repeats
      call system_clock(began)
      call solve_contact(problem, solution, start, by_blocks)
      best = min(best, since(began))
    end do
  end subroutine run

  function time_of_product(n, repeats) result(best)
    integer, intent(in) :: n, repeats
    real(wp) :: best
    real(wp), allocatable :: a(:, :), b(:, :), c(:, :)
    integer(int64) :: began
    integer :: i

    allocate (a(n, n), b(n, n), c(n, n), source=0.5_wp)
    best = huge(best)
    do i = 1, repeats
      call system_clock(began)
      call add_product(1.0_wp, a, b, c)
      best = min(best, since(began))
    end do
  end function time_of_product

  function since(began) result(seconds)
    integer(int64), intent(in) :: began
    real(wp) :: seconds
    integer(int64) :: now, rate

    call system_clock(now, rate)
    seconds = real(now - began, wp)/real(rate, wp)
  end function since

  !> Width 2, unit modulus; the load is Hertz' for the half-width.
  pure function half_plane(n, half_width) result(problem)
    integer, intent(in) :: n
    real(wp), intent(in) :: half_width
    type(contact_problem) :: problem
    real(wp), parameter :: pi = acos(-1.0_wp)
    real(wp) :: column(0:n - 1), d, h
    integer :: i, j

    h = 2.0_wp/n
    do i = 0, n - 1
      d = i*h
      column(i) = -(term(d + h/2) - term(d - h/2))/(pi*h)
    end do
    allocate (problem%flexibility(n, n), problem%motion(n, 1), problem%initial_gap(n), problem%load_gap(n))
    do j = 1, n
      do i = 1, n
        problem%flexibility(i, j) = column(abs(i - j))
      end do
    end do
    problem%motion = 1.0_wp
    problem%initial_gap = [((-1.0_wp + (i - 0.5_wp)*h)**2/2, i=1, n)]
    problem%load_gap = 0.0_wp
    problem%resultant = [pi*half_width**2/2]
  end function half_plane

  !> The integral of log(|x|/20).
  pure function term(x)
    real(wp), intent(in) :: x
    real(wp) :: term

    term = x*(log(max(abs(x), tiny(x))/20.0_wp) - 1)
  end function term

  !> Largest wrong sign, gap under force and misfit, of |F||R|, the largest sum of a row and the largest force.
  function residual(problem, solution) result(largest)
    type(contact_problem), intent(in) :: problem
    type(contact_solution), intent(in) :: solution
    real(wp) :: largest
    real(wp), allocatable :: gap(:)

    gap = problem%initial_gap + matmul(problem%flexibility, solution%force) - matmul(problem%motion, solution%approach)
    largest = max(maxval(-gap), maxval(abs(gap), mask=solution%force > 0), maxval(abs(gap - solution%gap)))
    largest = largest/(maxval(sum(abs(problem%flexibility), dim=2))*maxval(solution%force))
    largest = max(largest, maxval(-solution%force)/maxval(solution%force), &
                  abs(sum(solution%force) - problem%resultant(1))/problem%resultant(1))
  end function residual
end program benchmark_contact
