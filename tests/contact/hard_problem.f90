!> Large contact problems of the kinds that make a solver stumble, with a kernel like that of a half-plane.
module hard_problem
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_problem
  use random_problem, only: generator
  implicit none
  private
  public :: hard

  !> Kinds of problem, and what they are called.
  integer, parameter, public :: kinds = 9
  character(len=16), parameter, public :: kind_name(kinds) = [character(len=16) :: 'parabola', 'flat', 'ties', 'duplicated', &
                                                             'badly scaled', 'three motions', 'held', 'rough', 'overlaps']

contains

  !> A problem of one kind with n pairs; `random` varies what the kind leaves open.
  function hard(random, kind, n) result(problem)
    type(generator), intent(inout) :: random
    integer, intent(in) :: kind, n
    type(contact_problem) :: problem
    real(wp) :: place(n)
    integer :: i, k

    place = [((2*i - n - 1.0_wp)/n, i=1, n)]
    problem%flexibility = kernel(n)
    problem%motion = reshape([(1.0_wp, i=1, n)], [n, 1])
    problem%initial_gap = place**2*(0.5_wp + random%uniform())
    allocate (problem%load_gap(n), source=0.0_wp)
    problem%resultant = [0.02_wp + 0.2_wp*random%uniform()]
    select case (kind_name(kind))
    case ('flat')
      problem%initial_gap = 0.0_wp
    case ('ties')
      problem%initial_gap = real(nint(8*abs(place)), wp)/64
    case ('duplicated')
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
    case ('three motions')   ! along the normal, a rotation, and half of the pairs by themselves
      problem%motion = reshape([[(1.0_wp, i=1, n)], place, merge(1.0_wp, 0.0_wp, place > 0)], [n, 3])
      problem%resultant = matmul(transpose(problem%motion), [(random%uniform()/n, i=1, n)])
    case ('held')
      problem%motion = reshape([real(wp) ::], [n, 0])
      problem%resultant = [real(wp) ::]
      problem%initial_gap = problem%initial_gap - 0.3_wp
    case ('rough')
      problem%initial_gap = problem%initial_gap + [(0.05_wp*random%uniform(), i=1, n)]
    case ('overlaps')
      problem%load_gap = [(0.1_wp*(2*random%uniform() - 1), i=1, n)]
    end select
  end function hard

  !> -log|x_i - x_j|, over a segment of its own for i = j; the bodies end at a distance of 20.
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
