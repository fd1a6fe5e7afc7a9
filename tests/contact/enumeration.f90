!> Reference for small problems: try every state of the pairs. A pair is closed, or its force is at one of its bounds.
module enumeration
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_problem
  use epcont_linalg_dense, only: lu_solve
  implicit none
  private
  public :: all_answers

  !> Sign errors and pivots up to this are rounding; the test problems have entries of about one.
  real(wp), parameter :: tolerance = 1.0e-8_wp
  integer, parameter :: at_lower = 0, is_closed = 1, at_upper = 2

contains

  !> Forces of all basic solutions [n, answers]; empty if the problem has none. A has full column rank.
  function all_answers(problem) result(answers)
    type(contact_problem), intent(in) :: problem
    real(wp), allocatable :: answers(:, :)
    real(wp), allocatable :: force(:), lower(:), upper(:)
    integer, allocatable :: state(:), states(:)
    integer :: code, k, n

    n = size(problem%initial_gap)
    lower = spread(0.0_wp, 1, n)
    upper = spread(huge(1.0_wp), 1, n)
    if (allocated(problem%lower)) lower = problem%lower
    if (allocated(problem%upper)) upper = problem%upper
    states = merge(3, 2, upper < huge(1.0_wp))
    allocate (answers(n, 0))
    do code = 0, product(states) - 1
      state = [(mod(code/product(states(:k - 1)), states(k)), k=1, n)]
      force = answer_of_state(problem, state, lower, upper)
      if (size(force) == n) answers = reshape([answers, force], [n, size(answers, 2) + 1])
    end do
  end function all_answers

  !> Forces if the pairs are in these states; of size 0 (or unlike n) if they are not a solution.
  function answer_of_state(problem, state, lower, upper) result(force)
    type(contact_problem), intent(in) :: problem
    integer, intent(in) :: state(:)
    real(wp), intent(in) :: lower(:), upper(:)
    real(wp), allocatable :: force(:)
    real(wp), allocatable :: matrix(:, :), right(:, :), gap(:), given(:), copy(:, :)
    integer, allocatable :: closed(:)
    integer :: info, k, m, n, s

    n = size(state)
    closed = pack([(k, k=1, n)], state == is_closed)
    m = size(problem%resultant)
    s = size(closed)
    given = merge(upper, lower, state == at_upper)
    given(closed) = 0.0_wp
    allocate (matrix(s + m, s + m), right(s + m, 1), source=0.0_wp)
    matrix(:s, :s) = problem%flexibility(closed, closed)
    matrix(:s, s + 1:) = -problem%motion%rows(closed)
    matrix(s + 1:, :s) = transpose(problem%motion%rows(closed))
    gap = problem%initial_gap + problem%load_gap + matmul(problem%flexibility, given)
    right(:s, 1) = -gap(closed)
    right(s + 1:, 1) = problem%resultant - problem%motion%carried(given)
    copy = matrix
    call lu_solve(copy, right, info)
    allocate (force(n + 1), source=0.0_wp)
    if (info /= 0) return
    if (maxval([abs(right), 0.0_wp]) > 1.0e8_wp) return   ! singular within rounding
    if (any(right(:s, 1) < lower(closed) - tolerance) .or. any(right(:s, 1) > upper(closed) + tolerance)) return
    force(:n) = given
    force(closed) = right(:s, 1)
    gap = gap + matmul(problem%flexibility, force(:n) - given) - problem%motion%times(right(s + 1:, 1))
    if (all(merge(-gap, gap, state == at_upper) >= -tolerance .or. state == is_closed)) force = force(:n)
  end function answer_of_state
end module enumeration
