!> Large contact problems that are difficult for a solver, with a kernel like that of a half-plane.
module hard_problem
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_problem
  use epcont_flexibility_motion_matrix, only: dense_motions
  use random_problem, only: generator
  implicit none
  private
  public :: hard

  !> Types of problem, and their names.
  integer, parameter, public :: kinds = 13
  character(len=16), parameter, public :: kind_name(kinds) = [character(len=16) :: 'parabola', 'flat', 'ties', 'twice', &
                                                             'badly scaled', 'three motions', 'held', 'rough', 'overlaps', &
                                                             'flat, turning', 'smooth', 'very smooth', 'smooth twice']

contains

  !> Make a problem of one type with n pairs; `random` varies its other parameters.
  function hard(random, kind, n) result(problem)
    type(generator), intent(inout) :: random
    integer, intent(in) :: kind, n
    type(contact_problem) :: problem
    real(wp) :: place(n)
    integer :: i, k

    place = [((2*i - n - 1.0_wp)/n, i=1, n)]
    problem%flexibility = kernel(n)
    problem%motion = dense_motions(reshape([(1.0_wp, i=1, n)], [n, 1]))
    problem%initial_gap = place**2*(0.5_wp + random%uniform())
    allocate (problem%load_gap(n), source=0.0_wp)
    problem%resultant = [0.02_wp + 0.2_wp*random%uniform()]
    select case (kind_name(kind))
    case ('flat')
      problem%initial_gap = 0.0_wp
    case ('ties')
      problem%initial_gap = real(nint(8*abs(place)), wp)/64
    case ('twice')
      do k = 2, n, 3
        problem%flexibility(k, :) = problem%flexibility(k - 1, :)
        problem%flexibility(:, k) = problem%flexibility(:, k - 1)
        problem%initial_gap(k) = problem%initial_gap(k - 1)
      end do
    case ('badly scaled')   ! half of the pairs almost rigid, on a stiff body
      do k = 1, n, 2
        problem%flexibility(k, :) = problem%flexibility(k, :)*1.0e-3_wp
        problem%flexibility(:, k) = problem%flexibility(:, k)*1.0e-3_wp
      end do
    case ('three motions')   ! along the normal, a rotation, and half of the pairs on their own
      problem%motion = dense_motions(reshape([[(1.0_wp, i=1, n)], place, merge(1.0_wp, 0.0_wp, place > 0)], [n, 3]))
      problem%resultant = problem%motion%carried([(random%uniform()/n, i=1, n)])
    case ('held')
      problem%motion = dense_motions(reshape([real(wp) ::], [n, 0]))
      problem%resultant = [real(wp) ::]
      problem%initial_gap = problem%initial_gap - 0.3_wp
    case ('rough')
      problem%initial_gap = problem%initial_gap + [(0.05_wp*random%uniform(), i=1, n)]
    case ('flat, turning')   ! force and moment, all gaps zero
      problem%initial_gap = 0.0_wp
      problem%motion = dense_motions(reshape([[(1.0_wp, i=1, n)], place], [n, 2]))
      problem%resultant = [1.0_wp, 0.4_wp*(2*random%uniform() - 1)*maxval(place)]
    case ('smooth')
      call load_half(place, 3.0_wp, problem)
    case ('very smooth')
      call load_half(place, 6.0_wp, problem)
    case ('smooth twice')
      call load_half(place, 5.0_wp, problem)
      do k = 2, n, 5
        problem%flexibility(k, :) = problem%flexibility(k - 1, :)
        problem%flexibility(:, k) = problem%flexibility(:, k - 1)
        problem%initial_gap(k) = problem%initial_gap(k - 1)
      end do
    case ('overlaps')
      problem%load_gap = [(0.1_wp*(2*random%uniform() - 1), i=1, n)]
    end select
  end function hard

  !> Displacements some pair distances deep, where single forces have little effect: condition of F 1e6 at 3, 1e10 at 6.
  !> Half of the pairs are loaded, the others open.
  pure subroutine load_half(place, depth, problem)
    real(wp), intent(in) :: place(:), depth
    type(contact_problem), intent(inout) :: problem
    real(wp), parameter :: pi = acos(-1.0_wp)
    real(wp) :: force(size(place))
    integer :: j, n

    n = size(place)
    do j = 1, n
      problem%flexibility(:, j) = log(40.0_wp) - log(hypot(place - place(j), 2*depth/n))
    end do
    force = merge(1 + cos(2*pi*place), 0.0_wp, abs(place) < 0.5_wp)
    problem%initial_gap = merge(0.0_wp, sum(force)*1.0e-3_wp*(0.1_wp + abs(place)), abs(place) < 0.5_wp) &
                          - matmul(problem%flexibility, force)
    problem%initial_gap = problem%initial_gap - minval(problem%initial_gap)
    problem%resultant = [sum(force)]
  end subroutine load_half

  !> -log|x_i - x_j|, integrated over a segment for i = j; the bodies end at a distance of 20.
  pure function kernel(n) result(flexibility)
    integer, intent(in) :: n
    real(wp) :: flexibility(n, n)
    real(wp) :: h
    integer :: i, j

    h = 2.0_wp/n
    do j = 1, n
      do i = 1, n
        flexibility(i, j) = 1 - log(h/40)
        if (i /= j) flexibility(i, j) = -log(abs(i - j)*h/20)
      end do
    end do
  end function kernel
end module hard_problem
