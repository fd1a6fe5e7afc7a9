!> Reference for small problems: try every set of closed pairs.
module enumeration
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_problem
  use epcont_linalg_dense, only: lu_solve
  implicit none
  private
  public :: all_answers

  !> Sign errors and pivots up to this are rounding; the test problems have entries of about one.
  real(wp), parameter :: tolerance = 1.0e-8_wp

contains

  !> Forces of all basic solutions [n, answers]; empty if the problem has none. A has full column rank.
  function all_answers(problem) result(answers)
    type(contact_problem), intent(in) :: problem
    real(wp), allocatable :: answers(:, :)
    real(wp), allocatable :: force(:)
    integer :: code, k, n

    n = size(problem%initial_gap)
    allocate (answers(n, 0))
    do code = 0, 2**n - 1
      force = answer_of_set(problem, [(btest(code, k - 1), k=1, n)])
      if (size(force) == n) answers = reshape([answers, force], [n, size(answers, 2) + 1])
    end do
  end function all_answers

  !> Forces if these pairs are closed; of size unlike n if they are not a solution.
  function answer_of_set(problem, closes) result(force)
    type(contact_problem), intent(in) :: problem
    logical, intent(in) :: closes(:)
    real(wp), allocatable :: force(:)
    real(wp), allocatable :: matrix(:, :), right(:, :), gap(:), copy(:, :)
    integer, allocatable :: closed(:)
    integer :: info, k, m, n, s

    n = size(closes)
    closed = pack([(k, k=1, n)], closes)
    m = size(problem%resultant)
    s = size(closed)
    allocate (matrix(s + m, s + m), right(s + m, 1), source=0.0_wp)
    matrix(:s, :s) = problem%flexibility(closed, closed)
    matrix(:s, s + 1:) = -problem%motion%rows(closed)
    matrix(s + 1:, :s) = transpose(problem%motion%rows(closed))
    gap = problem%initial_gap + problem%load_gap
    right(:s, 1) = -gap(closed)
    right(s + 1:, 1) = problem%resultant
    copy = matrix
    call lu_solve(copy, right, info)
    allocate (force(n + 1), source=0.0_wp)
    if (info /= 0) return
    if (maxval([abs(right), 0.0_wp]) > 1.0e8_wp) return   ! singular within rounding
    if (any(right(:s, 1) < -tolerance)) return
    force(closed) = right(:s, 1)
    gap = gap + matmul(problem%flexibility, force(:n)) - problem%motion%times(right(s + 1:, 1))
    if (all(gap >= -tolerance .or. closes)) force = force(:n)
  end function answer_of_set
end module enumeration
