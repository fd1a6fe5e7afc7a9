!> Solution of the contact equations for a given set S of pairs in contact, fresh from F and A.
!>
!>     F_SS R_S - A_S q = -h,   A_S' R_S = p
!>
!> F_SS may be singular though the forces are unique (a pair between held nodes is a row of zeros).
!> F_g = F + gamma A A' is definite whenever they are unique, and since A'R = p it changes only the
!> motion: q comes out larger by gamma p.
module epcont_contact_basis
  use epcont_base_kinds, only: wp
  use epcont_contact_scaling, only: negligible, scaled_problem
  use epcont_linalg_dense, only: add_product, cholesky_factor, cholesky_solve, pivoted_cholesky
  implicit none
  private
  public :: contact_basis, new_basis, respond, basic_solution, gaps_under
  public :: regular_flexibility, rank_tolerance, weight_of_motions

  !> Pivots of F_g, parts of the largest flexibility, from which on no force depends on the others whatever the order.
  real(wp), parameter :: clearly_definite = 1.0e-8_wp

  !> A set of pairs in contact whose forces are unique, and the factors that give them.
  type :: contact_basis
    logical :: sound = .false.                !! the pairs hold every motion
    integer, allocatable :: pairs(:)          !! S [s]
    real(wp) :: gamma = 0.0_wp                !! weight of A A' in F_g
    real(wp), allocatable :: factor(:, :)     !! Cholesky factor of F_g,SS [s, s]
    real(wp), allocatable :: carried(:, :)    !! forces that hold S closed under unit motions, F_g,SS^-1 A_S [s, m]
    real(wp), allocatable :: resistance(:, :) !! Cholesky factor of A_S' F_g,SS^-1 A_S [m, m]
  end type contact_basis

contains

  !> Factor the equations of the chosen pairs. Pairs whose force depends on that of others are left out.
  pure function new_basis(problem, chosen) result(basis)
    type(scaled_problem), intent(in) :: problem
    logical, intent(in) :: chosen(:)   !! [n]
    type(contact_basis) :: basis
    integer, allocatable :: order(:)
    real(wp), allocatable :: transposed(:, :)
    integer :: info, k, m, rank

    m = size(problem%resultant)
    basis%pairs = pack([(k, k=1, size(chosen))], chosen)
    basis%gamma = weight_of_motions(problem)
    basis%factor = regular_flexibility(problem, basis%gamma, basis%pairs, basis%pairs)
    call cholesky_factor(basis%factor, info)
    if (info == 0) then
      if (any([(basis%factor(k, k)**2, k=1, size(basis%pairs))] < clearly_definite*largest_flexibility(problem))) info = 1
    end if
    if (info /= 0) then   ! the order of pivots, which takes longer, tells who depends on whom
      basis%factor = regular_flexibility(problem, basis%gamma, basis%pairs, basis%pairs)
      call pivoted_cholesky(basis%factor, rank_tolerance(problem), order, rank)
      basis%pairs = basis%pairs(order(:rank))
      basis%factor = basis%factor(:rank, :rank)
    end if

    basis%carried = problem%motion(basis%pairs, :)
    transposed = transpose(basis%carried)
    call cholesky_solve(basis%factor, basis%carried)
    allocate (basis%resistance(m, m), source=0.0_wp)
    call add_product(1.0_wp, transposed, basis%carried, basis%resistance)
    call cholesky_factor(basis%resistance, info)
    basis%sound = info == 0
  end function new_basis

  !> Forces and motions for right-hand sides h and p; call only if the basis is sound.
  pure subroutine respond(basis, opening, load, force, approach)
    type(contact_basis), intent(in) :: basis
    real(wp), contiguous, intent(in) :: opening(:, :)                  !! h, gaps of the pairs without forces [s, k]
    real(wp), intent(in) :: load(:, :)                     !! p [m, k]
    real(wp), allocatable, intent(out) :: force(:, :)      !! R_S [s, k]
    real(wp), allocatable, intent(out) :: approach(:, :)   !! q [m, k]
    real(wp), allocatable :: transposed(:, :)

    approach = load
    transposed = transpose(basis%carried)
    call add_product(1.0_wp, transposed, opening, approach)
    call cholesky_solve(basis%resistance, approach)
    force = -opening
    call cholesky_solve(basis%factor, force)
    call add_product(1.0_wp, basis%carried, approach, force)
    approach = approach - basis%gamma*load
  end subroutine respond

  !> Forces, gaps and motions with the pairs of the basis closed and the others free of force.
  pure subroutine basic_solution(basis, problem, opening, load, force, gap, approach)
    type(contact_basis), intent(in) :: basis
    type(scaled_problem), intent(in) :: problem
    real(wp), intent(in) :: opening(:)                  !! gaps without forces [n]
    real(wp), intent(in) :: load(:)                     !! [m]
    real(wp), allocatable, intent(out) :: force(:)      !! zero outside the basis [n]
    real(wp), allocatable, intent(out) :: gap(:)        !! zero up to rounding in the basis [n]
    real(wp), allocatable, intent(out) :: approach(:)   !! [m]
    real(wp), allocatable :: force_change(:, :), approach_change(:, :)
    real(wp), allocatable :: excess(:, :), unbalanced(:, :)   !! what is not closed or carried yet [s, 1], [m, 1]
    integer :: step

    allocate (force(size(opening)), source=0.0_wp)
    allocate (approach(size(load)), source=0.0_wp)
    gap = opening
    allocate (excess(size(basis%pairs), 1), unbalanced(size(load), 1))
    unbalanced(:, 1) = load
    do step = 1, 2   ! the solution, then one step of iterative refinement
      excess(:, 1) = gap(basis%pairs)
      call respond(basis, excess, unbalanced, force_change, approach_change)
      force(basis%pairs) = force(basis%pairs) + force_change(:, 1)
      approach = approach + approach_change(:, 1)
      gap = gaps_under(problem, opening, force, approach)
      unbalanced(:, 1) = load - matmul(force, problem%motion)
    end do
  end subroutine basic_solution

  !> w = g + F R - A q.
  pure function gaps_under(problem, opening, force, approach) result(gap)
    type(scaled_problem), intent(in) :: problem
    real(wp), intent(in) :: opening(:), force(:), approach(:)
    real(wp), allocatable :: gap(:)
    integer :: k

    gap = opening - matmul(problem%motion, approach)
    do k = 1, size(force)
      if (force(k) /= 0.0_wp) gap = gap + force(k)*problem%flexibility(:, k)
    end do
  end function gaps_under

  !> A block of F_g = F + gamma A A'.
  pure function regular_flexibility(problem, gamma, rows, columns) result(block)
    type(scaled_problem), intent(in) :: problem
    real(wp), intent(in) :: gamma
    integer, intent(in) :: rows(:), columns(:)
    real(wp), allocatable :: block(:, :)
    real(wp), allocatable :: left(:, :), right(:, :)

    block = problem%flexibility(rows, columns)
    left = problem%motion(rows, :)
    right = transpose(problem%motion(columns, :))
    call add_product(gamma, left, right, block)
  end function regular_flexibility

  !> gamma, such that F and gamma A A' are of one size.
  pure function weight_of_motions(problem) result(gamma)
    type(scaled_problem), intent(in) :: problem
    real(wp) :: gamma
    real(wp) :: largest

    largest = maxval([sum(problem%motion**2, dim=2), 0.0_wp])
    gamma = largest_flexibility(problem)
    if (largest > 0.0_wp) gamma = gamma/largest
  end function weight_of_motions

  !> A pivot of F_g up to this is rounding.
  pure function rank_tolerance(problem) result(tolerance)
    type(scaled_problem), intent(in) :: problem
    real(wp) :: tolerance

    tolerance = max(negligible/100, 4*size(problem%gap)*epsilon(1.0_wp))*largest_flexibility(problem)
  end function rank_tolerance

  !> max F_kk; 1 if nothing is flexible.
  pure function largest_flexibility(problem) result(largest)
    type(scaled_problem), intent(in) :: problem
    real(wp) :: largest
    integer :: k

    largest = maxval([(problem%flexibility(k, k), k=1, size(problem%gap)), 0.0_wp])
    if (largest <= 0.0_wp) largest = 1.0_wp
  end function largest_flexibility
end module epcont_contact_basis
