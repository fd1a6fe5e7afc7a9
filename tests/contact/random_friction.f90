!> Random contact problems with friction, all of their answers, and the test of an answer.
module random_friction
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_problem, contact_solution
  use epcont_flexibility_motion_matrix, only: dense_motions
  use epcont_linalg_dense, only: lu_solve
  use random_problem, only: generator
  implicit none
  private
  public :: all_answers, new_friction_problem, residual_of

  !> Sign errors up to this are rounding; the test problems have entries of about one.
  real(wp), parameter :: tolerance = 1.0e-8_wp
  integer, parameter :: open = 0, stick = 1, positive = 2, negative = 3

contains

  !> n pairs with friction. Without modes, the gaps under load are random; with one mode, a stamp is pressed; with three, a
  !! body is touched at n points. The load is balanced by some forces in the friction cones in nine of ten problems.
  function new_friction_problem(random, n, m, mu) result(problem)
    type(generator), intent(inout) :: random
    integer, intent(in) :: n, m
    real(wp), intent(in) :: mu
    type(contact_problem) :: problem
    real(wp) :: force(2*n), motion(2*n, m), angle, at(2), normal(2), tangent(2)
    real(wp), allocatable :: g(:, :)
    integer :: k

    g = reshape([(2*random%uniform() - 1, k=1, 2*n*(2*n + 1))], [2*n, 2*n + 1])
    problem%flexibility = matmul(g, transpose(g))
    problem%flexibility = (problem%flexibility + transpose(problem%flexibility))/2
    problem%friction = [(mu, k=1, n)]
    problem%pair_of = [(k, k=1, n)]
    do k = 1, n
      angle = 6.28_wp*random%uniform()
      normal = [cos(angle), sin(angle)]
      tangent = [-normal(2), normal(1)]
      at = [2*random%uniform() - 1, 2*random%uniform() - 1]
      if (m == 1) motion(k, 1) = 1.0_wp
      if (m == 1) motion(n + k, 1) = 2*random%uniform() - 1
      if (m == 3) motion(k, :) = [normal, at(1)*normal(2) - at(2)*normal(1)]
      if (m == 3) motion(n + k, :) = [tangent, at(1)*tangent(2) - at(2)*tangent(1)]
      force(k) = random%uniform()
      force(n + k) = mu*force(k)*(2*random%uniform() - 1)
    end do
    problem%motion = dense_motions(motion)
    problem%resultant = matmul(force, motion)
    if (random%chance(0.1_wp)) problem%resultant = [(2*random%uniform() - 1, k=1, m)]
    problem%initial_gap = [(0.3_wp*random%uniform(), k=1, n), (0.0_wp, k=1, n)]
    problem%load_gap = [(2*random%uniform() - merge(1.5_wp, 1.0_wp, m == 0), k=1, 2*n)]
    if (m > 0 .and. random%chance(0.5_wp)) problem%load_gap = 0.1_wp*problem%load_gap
  end function new_friction_problem

  !> Forces of all answers: every state of every pair is tried [2 n, answers].
  function all_answers(problem) result(answers)
    type(contact_problem), intent(in) :: problem
    real(wp), allocatable :: answers(:, :)
    real(wp), allocatable :: force(:)
    integer :: code, k, n

    n = size(problem%friction)
    allocate (answers(2*n, 0))
    do code = 0, 4**n - 1
      force = answer_of_states(problem, [(mod(code/4**(k - 1), 4), k=1, n)])
      if (size(force) == 2*n) answers = reshape([answers, force], [2*n, size(answers, 2) + 1])
    end do
  end function all_answers

  !> Forces if the pairs are in these states; empty if they are no answer.
  function answer_of_states(problem, state) result(force)
    type(contact_problem), intent(in) :: problem
    integer, intent(in) :: state(:)
    real(wp), allocatable :: force(:)
    real(wp), allocatable :: a(:, :), b(:, :), closing(:, :), gap(:), of_unknown(:, :)
    integer, allocatable :: row(:)
    integer :: info, k, m, n, s

    n = size(state)
    m = size(problem%resultant)
    row = [pack([(k, k=1, n)], state /= open), pack([(n + k, k=1, n)], state == stick)]
    s = size(row)
    allocate (of_unknown(2*n, s), a(s + m, s + m), b(s + m, 1), source=0.0_wp)
    do k = 1, s
      of_unknown(row(k), k) = 1.0_wp
      if (row(k) > n) cycle
      if (state(row(k)) == positive) of_unknown(n + row(k), k) = -problem%friction(row(k))
      if (state(row(k)) == negative) of_unknown(n + row(k), k) = problem%friction(row(k))
    end do
    closing = problem%motion%dense()
    a(:s, :s) = matmul(problem%flexibility(row, :), of_unknown)
    a(:s, s + 1:) = -closing(row, :)
    a(s + 1:, :s) = matmul(transpose(closing), of_unknown)
    gap = problem%initial_gap + problem%load_gap
    b(:s, 1) = -gap(row)
    b(s + 1:, 1) = problem%resultant
    call lu_solve(a, b, info)
    allocate (force(0))
    if (info /= 0) return
    if (maxval([abs(b), 0.0_wp]) > 1.0e8_wp) return   ! singular within rounding
    gap = gap + matmul(problem%flexibility, matmul(of_unknown, b(:s, 1))) - problem%motion%times(b(s + 1:, 1))
    associate (all => matmul(of_unknown, b(:s, 1)))
      if (are_right(all(:n), all(n + 1:), gap(:n), gap(n + 1:))) force = all
    end associate

  contains

    logical function are_right(r, t, w, slip) result(right)
      real(wp), intent(in), dimension(:) :: r, t, w, slip

      right = all(r >= -tolerance) .and. all(w >= -tolerance .or. state /= open) .and. &
              all(abs(t) <= problem%friction*r + tolerance .or. state /= stick) .and. &
              all(slip >= -tolerance .or. state /= positive) .and. all(slip <= tolerance .or. state /= negative)
    end function are_right
  end function answer_of_states

  !> Largest violation of a condition, relative to the largest force or gap.
  function residual_of(problem, solution) result(residual)
    type(contact_problem), intent(in) :: problem
    type(contact_solution), intent(in) :: solution
    real(wp) :: residual
    real(wp), allocatable :: gap(:), load(:)
    real(wp) :: force_unit, gap_unit, largest
    integer :: n

    n = size(problem%initial_gap) - size(problem%friction)
    largest = maxval(abs(problem%flexibility))
    force_unit = maxval([abs(solution%force), tiny(1.0_wp)])
    if (largest > 0.0_wp) &
      force_unit = max(force_unit, maxval(abs(problem%load_gap) + abs(problem%initial_gap))/largest)
    gap_unit = maxval([force_unit*largest, abs(problem%load_gap), abs(problem%initial_gap), &
                       abs(problem%motion%times(solution%approach, magnitudes=.true.))])
    ! All lengths are zero: no gap, no flexibility. Then rounding has no scale.
    if (largest <= 0.0_wp .and. all(abs(problem%load_gap) + abs(problem%initial_gap) <= 0.0_wp)) gap_unit = huge(1.0_wp)
    gap = problem%initial_gap + problem%load_gap + matmul(problem%flexibility, solution%force) - &
          problem%motion%times(solution%approach)
    load = problem%motion%carried(solution%force) - problem%resultant
    residual = maxval([abs(gap - solution%gap)/gap_unit, 0.0_wp])
    residual = maxval([residual, abs(load)/(force_unit*maxval([abs(problem%motion%closing), tiny(1.0_wp)]))])
    associate (r => solution%force(:n)/force_unit, w => solution%gap(:n)/gap_unit, slip => solution%gap(n + 1:)/gap_unit, &
               t => solution%force(n + 1:)/force_unit)
      associate (bound => problem%friction*r(problem%pair_of))
        residual = maxval([residual, -r, -w, min(r, w), abs(t) - bound, &
                           min(abs(slip), bound + sign(1.0_wp, slip)*t)])
      end associate
    end associate
  end function residual_of
end module random_friction
