!> Measure the time of epcont's contact solver alone: bench_contact PROBLEM FORCES RULE REPEATS
!>
!> PROBLEM is a stream: n, m, s (4-byte integers), then doubles: F [n, n], A [n, m], g0 [n], P [m], mu [s]. The first s rows may be pairs with
!> friction; then the last s rows are along their tangents. FORCES gets R [n], q [m].
!> RULE: CONRY, WARM (CONRY from the correct active set), or DGEMM, only one product of matrices as large as F.
!> Prints: processor seconds (median of the repeats, without the first), largest violation of the
!> conditions without friction, pairs exchanged, and state.
program bench_contact
  use, intrinsic :: iso_fortran_env, only: int32
  use epcont_base_kinds, only: wp
  use epcont_system_memory, only: prepare_heap
  use epcont_contact_problem, only: contact_problem, contact_solution
  use epcont_contact_solver, only: solve_contact
  use epcont_flexibility_motion_matrix, only: dense_motions
  use epcont_linalg_dense, only: add_product
  use statistics, only: argument, median
  implicit none
  type(contact_problem) :: problem
  type(contact_solution) :: solution
  character(:), allocatable :: rule
  logical, allocatable :: start(:)   !! initial active set, if any
  real(wp), allocatable :: product(:, :), seconds(:)
  real(wp) :: begun, ended
  integer :: k, repeats

  call prepare_heap()   ! as in the program
  call read_problem(argument(1), problem)
  rule = argument(3)
  repeats = number(argument(4))
  allocate (seconds(0:repeats), product(size(problem%initial_gap), size(problem%initial_gap)), source=0.0_wp)
  do k = 0, repeats
    call cpu_time(begun)
    if (rule == 'DGEMM') then
      call add_product(1.0_wp, problem%flexibility, problem%flexibility, product)
    else
      call solve_contact(problem, solution, start)
    end if
    call cpu_time(ended)
    seconds(k) = ended - begun
    if (rule == 'WARM') start = solution%touching
  end do
  if (rule == 'DGEMM') then
    print '(es12.4)', median(seconds(1:))
    stop
  end if
  call write_forces(argument(2), solution)
  print '(2es12.4,2i8)', median(seconds(1:)), violation(problem, solution), solution%pivots, solution%state

contains

  integer function number(text)
    character(*), intent(in) :: text

    read (text, *) number
  end function number

  subroutine read_problem(path, problem)
    character(*), intent(in) :: path
    type(contact_problem), intent(out) :: problem
    real(wp), allocatable :: flexibility(:, :), friction(:), motion(:, :)
    integer(int32) :: m, n, s
    integer :: k, unit

    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', action='read')
    read (unit) n, m, s
    allocate (flexibility(n, n), motion(n, m), problem%initial_gap(n), problem%resultant(m), friction(s))
    allocate (problem%load_gap(n), source=0.0_wp)
    read (unit) flexibility, motion, problem%initial_gap, problem%resultant, friction
    close (unit)
    problem%flexibility = flexibility
    problem%motion = dense_motions(motion)
    if (s == 0) return
    problem%friction = friction
    problem%pair_of = [(k, k=1, s)]
  end subroutine read_problem

  subroutine write_forces(path, solution)
    character(*), intent(in) :: path
    type(contact_solution), intent(in) :: solution
    integer :: unit

    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', action='write')
    write (unit) solution%force, solution%approach
    close (unit)
  end subroutine write_forces

  !> Violation of w = g0 + F R - A q >= 0, R >= 0, R.w = 0 and A'R = P: largest |min(R/rho, w/omega)| and |A'R - P|/|P|, with rho the
  !! largest force and omega = rho max|F|. As in contact.py, but with the solver's own q.
  real(wp) function violation(problem, solution)
    type(contact_problem), intent(in) :: problem
    type(contact_solution), intent(in) :: solution
    real(wp) :: rho, omega

    rho = maxval(abs(solution%force))
    omega = rho*maxval(abs(problem%flexibility))
    associate (gap => problem%initial_gap + matmul(problem%flexibility, solution%force) &
               - problem%motion%times(solution%approach))
      violation = maxval(abs(min(solution%force/rho, gap/omega)))
    end associate
    associate (carried => problem%motion%carried(solution%force))
      violation = max(violation, maxval(abs(carried - problem%resultant))/maxval(abs(problem%resultant)))
    end associate
  end function violation
end program bench_contact
