!> Cholesky factor of F_g for a set of contacts that changes by blocks, and the solution that belongs to the set.
!>
!> Pairs that are likely to stay stand first. When the set changes, the factor is kept up to the first pair that has
!> gone, and only the rows below it are factored anew:
!>
!>     +------+
!>     | kept |         pairs of large force
!>     +------+------+
!>     |     new     |  pairs at the edges of the contact, and those that came
!>     +------+------+
module epcont_contact_block_factor
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_contact_basis, only: gaps_under, rank_tolerance, weight_of_motions
  use epcont_contact_scaling, only: scaled_problem
  use epcont_linalg_dense, only: add_product, cholesky_factor, cholesky_solve, extend_cholesky
  implicit none
  private
  public :: block_factor, new_block_factor, change_set, solve_set

  !> Part of a set from which on its factor is kept. With 1/2, where pairs that come as the candidates are doubled stand
  !! behind edges that go, block pivoting takes half as long again; without keeping anything it does so too.
  real(wp), parameter :: worth_keeping = 0.75_wp
  !> Firmness is told apart to this part of the largest.
  real(wp), parameter :: firmness_steps = 1.0e6_wp

  type :: block_factor
    integer, allocatable :: pairs(:)          !! the set, in the order of the factor [s]
    real(wp), allocatable :: lower(:, :)      !! its leading rows: Cholesky factor of F_g [n, n]
    real(wp) :: gamma = 0.0_wp                !! weight of A A' in F_g
    logical :: sound = .false.                !! F_g is definite on the set
  end type block_factor

contains

  !> The factor of no pairs.
  pure subroutine new_block_factor(problem, factor)
    type(scaled_problem), intent(in) :: problem
    type(block_factor), intent(out) :: factor

    allocate (factor%pairs(0))
    allocate (factor%lower(size(problem%gap), size(problem%gap)))
    factor%gamma = weight_of_motions(problem)
    factor%sound = .true.
  end subroutine new_block_factor

  !> Go over to another set.
  pure subroutine change_set(factor, problem, closed, firmness)
    type(block_factor), intent(inout) :: factor
    type(scaled_problem), intent(in) :: problem
    logical, intent(in) :: closed(:)      !! the set [n]
    real(wp), intent(in) :: firmness(:)   !! how likely pairs are to stay, largest first [n]
    integer, allocatable :: added(:)
    logical, allocatable :: missing(:)
    integer :: info, k, kept, n

    n = count(closed)
    kept = 0
    if (factor%sound) kept = leading_pairs(factor%pairs, closed)
    ! Where much is new, all are put into order, so that the next sets keep most of it.
    if (kept < worth_keeping*n) kept = 0
    missing = closed
    missing(factor%pairs(:kept)) = .false.
    added = pack([(k, k=1, size(closed))], missing)
    added = added(sorted_order(nint(-firmness_steps*firmness(added))))
    factor%pairs = [factor%pairs(:kept), added]
    call fill_rows(factor, problem, kept)
    call extend_cholesky(size(factor%lower, 1), factor%lower, kept, n, info)
    factor%sound = info == 0
    if (.not. factor%sound) return
    factor%sound = all([(factor%lower(k, k)**2, k=1, n)] > rank_tolerance(problem))
  end subroutine change_set

  !> Number of pairs before the first that is not in the set.
  pure function leading_pairs(pairs, closed) result(leading)
    integer, intent(in) :: pairs(:)
    logical, intent(in) :: closed(:)
    integer :: leading

    do leading = 0, size(pairs) - 1
      if (.not. closed(pairs(leading + 1))) return
    end do
    leading = size(pairs)
  end function leading_pairs

  !> The rows of F_g = F + gamma A A' after the first `kept`.
  pure subroutine fill_rows(factor, problem, kept)
    type(block_factor), intent(inout) :: factor
    type(scaled_problem), intent(in) :: problem
    integer, intent(in) :: kept
    real(wp), allocatable :: motion(:, :)
    real(wp) :: weight
    integer :: first, i, j, k, n

    n = size(factor%pairs)
    motion = problem%motion(factor%pairs, :)
    do j = 1, n
      first = max(j, kept + 1)
      do i = first, n
        factor%lower(i, j) = problem%flexibility(factor%pairs(i), factor%pairs(j))
      end do
      do k = 1, size(motion, 2)
        weight = factor%gamma*motion(j, k)
        factor%lower(first:n, j) = factor%lower(first:n, j) + weight*motion(first:n, k)
      end do
    end do
  end subroutine fill_rows

  !> Forces and gaps with the pairs of the set closed; `sound` tells whether the set holds every motion.
  pure subroutine solve_set(factor, problem, force, gap, sound)
    type(block_factor), intent(in) :: factor
    type(scaled_problem), intent(in) :: problem
    real(wp), intent(inout) :: force(:), gap(:)   !! [n]
    logical, intent(out) :: sound
    real(wp), allocatable :: answer(:, :)         !! F_g^-1 [A_S, g_S] [s, m + 1]
    real(wp), allocatable :: approach(:, :), carried(:, :), resistance(:, :), transposed(:, :)
    integer :: info, m

    m = size(problem%resultant)
    allocate (answer(size(factor%pairs), m + 1))
    answer(:, :m) = problem%motion(factor%pairs, :)
    answer(:, m + 1) = problem%gap(factor%pairs)
    transposed = transpose(answer(:, :m))
    call cholesky_solve(factor%lower, answer)
    allocate (carried(m, m + 1), source=0.0_wp)
    call add_product(1.0_wp, transposed, answer, carried)
    resistance = carried(:, :m)
    approach = reshape(problem%resultant + carried(:, m + 1), [m, 1])
    call cholesky_factor(resistance, info)
    sound = info == 0
    if (.not. sound) return
    call cholesky_solve(resistance, approach)
    force = 0.0_wp
    force(factor%pairs) = matmul(answer(:, :m), approach(:, 1)) - answer(:, m + 1)
    gap = gaps_under(problem, problem%gap, force, approach(:, 1) - factor%gamma*problem%resultant)
  end subroutine solve_set
end module epcont_contact_block_factor
