!> What the contact conditions leave open: forces that can be shared in many ways, motions that nothing holds.
module epcont_contact_uniqueness
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: contact_basis, new_basis, rank_tolerance, regular_flexibility
  use epcont_contact_scaling, only: negligible, scaled_problem
  use epcont_linalg_dense, only: add_product, cholesky_solve, null_space, pivoted_cholesky
  implicit none
  private
  public :: find_indeterminate_forces, share_equally, find_free_motions

  !> Components of a null vector (largest about 1) up to this are zero.
  real(wp), parameter :: null_tolerance = 1.0e-7_wp

contains

  !> Pairs whose force can change without any gap or resultant changing: z with F z = 0, A'z = 0, and z >= 0
  !> where the force is zero. Such z come from the touching pairs that pivoted Cholesky of F_g leaves out,
  !> after the pressed ones.
  pure function find_indeterminate_forces(problem, touching, pressed) result(indeterminate)
    type(scaled_problem), intent(in) :: problem
    logical, intent(in) :: touching(:)      !! gap zero [n]
    logical, intent(in) :: pressed(:)       !! force beyond rounding; a basis, so their own forces are unique [n]
    logical, allocatable :: indeterminate(:)
    type(contact_basis) :: basis
    real(wp), allocatable :: null(:, :), opposing(:, :), reduced(:, :), dependent(:, :)
    integer, allocatable :: idle(:), order(:)
    integer :: j, k, rank

    allocate (indeterminate(size(touching)), source=.false.)
    idle = pack([(k, k=1, size(touching))], touching .and. .not. pressed)
    if (size(idle) == 0) return
    ! F_g of the idle pairs with the gaps of the pressed ones held closed (Schur complement).
    basis = new_basis(problem, pressed)
    reduced = regular_flexibility(problem, basis%gamma, idle, idle)
    null = regular_flexibility(problem, basis%gamma, basis%pairs, idle)
    opposing = transpose(null)
    call cholesky_solve(basis%factor, null)
    call add_product(-1.0_wp, opposing, null, reduced)
    dependent = reduced
    call pivoted_cholesky(reduced, rank_tolerance(problem), order, rank)
    dependent = dependent(order(:rank), order(rank + 1:))
    reduced = reduced(:rank, :rank)
    call cholesky_solve(reduced, dependent)
    do j = 1, size(idle) - rank
      if (any(dependent(:, j) > null_tolerance)) cycle   ! some idle force would have to pull
      indeterminate(idle(order(rank + j))) = .true.
      where (abs(dependent(:, j)) > null_tolerance) indeterminate(idle(order(:rank))) = .true.
    end do
    call mark_opposing(indeterminate)

  contains

    !> The pressed pairs that give way to the idle ones marked so far.
    pure subroutine mark_opposing(marked)
      logical, intent(inout) :: marked(:)
      real(wp), allocatable :: change(:)
      integer :: i, j

      do j = rank + 1, size(idle)
        if (.not. marked(idle(order(j)))) cycle
        change = null(:, order(j)) - matmul(null(:, order(:rank)), dependent(:, j - rank))
        do i = 1, size(change)
          if (abs(change(i)) > null_tolerance) marked(basis%pairs(i)) = .true.
        end do
      end do
    end subroutine mark_opposing
  end function find_indeterminate_forces

  !> Pairs with equal rows in F and A share their force equally.
  pure subroutine share_equally(problem, indeterminate, force)
    type(scaled_problem), intent(in) :: problem
    logical, intent(in) :: indeterminate(:)    !! [n]
    real(wp), intent(inout) :: force(:)        !! [n]
    integer, allocatable :: alike(:), pairs(:)
    integer :: i, k
    logical, allocatable :: shared(:)

    pairs = pack([(k, k=1, size(force))], indeterminate)
    allocate (shared(size(pairs)), source=.false.)
    do i = 1, size(pairs)
      if (shared(i)) cycle
      alike = pack([(k, k=i, size(pairs))], [(are_alike(problem, pairs(i), pairs(k)), k=i, size(pairs))])
      force(pairs(alike)) = sum(force(pairs(alike)))/size(alike)
      shared(alike) = .true.
    end do
  end subroutine share_equally

  !> Have two pairs the same flexibility and the same motion?
  pure function are_alike(problem, i, k) result(alike)
    type(scaled_problem), intent(in) :: problem
    integer, intent(in) :: i, k
    logical :: alike
    real(wp) :: zero

    zero = negligible*max(problem%flexibility(i, i), problem%flexibility(k, k))
    alike = all(abs(problem%motion(i, :) - problem%motion(k, :)) <= negligible)
    if (alike) alike = all(abs(problem%flexibility(:, i) - problem%flexibility(:, k)) <= zero)
  end function are_alike

  !> Motions that the pressed pairs do not hold and that no idle touching pair blocks in both directions.
  pure function find_free_motions(problem, touching, pressed) result(free)
    type(scaled_problem), intent(in) :: problem
    logical, intent(in) :: touching(:), pressed(:)   !! [n]
    logical, allocatable :: free(:)                  !! [m]
    real(wp), allocatable :: closing(:, :), loose(:, :)
    integer, allocatable :: holding(:), idle(:)
    integer :: j, k

    allocate (free(size(problem%resultant)), source=.false.)
    holding = pack([(k, k=1, size(pressed))], pressed)
    idle = pack([(k, k=1, size(pressed))], touching .and. .not. pressed)
    loose = null_space(problem%motion(holding, :), null_tolerance)
    closing = matmul(problem%motion(idle, :), loose)
    do j = 1, size(loose, 2)
      if (any(closing(:, j) > null_tolerance) .and. any(closing(:, j) < -null_tolerance)) cycle
      free = free .or. abs(loose(:, j)) > null_tolerance
    end do
  end function find_free_motions
end module epcont_contact_uniqueness
