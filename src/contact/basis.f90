!> The contact equations for a given set S of pairs in contact, factored afresh from F and A.
!>
!>     F_SS R_S - A_S q = -h,   A_S' R_S = p
!>
!> F_SS may be singular though the forces are unique (a pair between held nodes is a row of zeros).
!> F_g = F + gamma A A' is definite whenever they are unique, and since A'R = p it changes only the
!> motion: q comes out larger by gamma p.
module epcont_contact_basis
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits, negligible
  use epcont_contact_scaling, only: scaled_problem
  use epcont_linalg_dense, only: add_product, cholesky_factor, cholesky_solve, pivoted_cholesky
  implicit none
  private
  public :: contact_basis, new_basis, hold_motions, respond
  public :: regular_flexibility, rank_tolerance, weight_of_motions

  !> A set of pairs in contact whose forces are unique, and the factors that give them.
  type :: contact_basis
    logical :: sound = .false.                !! the forces are unique, and the pairs hold every motion
    integer, allocatable :: pairs(:)          !! S, in the order of the factor [s]
    real(wp) :: gamma = 0.0_wp                !! weight of A A' in F_g
    real(wp), allocatable :: factor(:, :)     !! its leading rows: Cholesky factor of F_g,SS [>= s, >= s]
    !> Forces that hold S closed under unit motions, F_g,SS^-1 A_S [s, m]
    real(wp), allocatable :: carried(:, :)
    real(wp), allocatable :: resistance(:, :) !! Cholesky factor of A_S' F_g,SS^-1 A_S [m, m]
  end type contact_basis

contains

  !> Factor the equations of the chosen pairs. Pairs whose force depends on that of others are left out.
  pure type(contact_basis) function new_basis(problem, chosen) result(basis)
    type(scaled_problem), intent(in) :: problem   !! in its own units
    logical, intent(in) :: chosen(:)   !! [n]
    integer, allocatable :: order(:)
    integer :: info, k, rank

    basis%pairs = pack([(k, k=1, size(chosen))], chosen)
    basis%gamma = weight_of_motions(problem)
    basis%factor = regular_flexibility(problem, basis%gamma, basis%pairs, basis%pairs)
    call cholesky_factor(basis%factor, info)
    if (info == 0) then
      associate (pivots => [(basis%factor(k, k)**2, k=1, size(basis%pairs))])
        if (any(pivots < lost_digits*largest_flexibility(problem))) info = 1
      end associate
    end if
    if (info /= 0) then   ! the order of pivots, which takes longer, tells who depends on whom
      basis%factor = regular_flexibility(problem, basis%gamma, basis%pairs, basis%pairs)
      call pivoted_cholesky(basis%factor, rank_tolerance(problem), order, rank)
      basis%pairs = basis%pairs(order(:rank))
      basis%factor = basis%factor(:rank, :rank)
    end if
    call hold_motions(basis, problem)
  end function new_basis

  !> What the motions do to a set whose F_g is factored; it is sound if it holds all of them.
  pure subroutine hold_motions(basis, problem)
    type(contact_basis), intent(inout) :: basis   !! its pairs and the factor of F_g; the rest is found
    type(scaled_problem), intent(in) :: problem   !! in its own units
    real(wp) :: resistance(size(problem%resultant), size(problem%resultant))
    real(wp), allocatable :: transposed(:, :)
    integer :: info

    basis%carried = problem%motion(basis%pairs, :)
    transposed = transpose(basis%carried)
    call cholesky_solve(basis%factor, basis%carried)
    resistance = 0.0_wp
    call add_product(1.0_wp, transposed, basis%carried, resistance)
    call cholesky_factor(resistance, info)
    basis%resistance = resistance
    basis%sound = info == 0
  end subroutine hold_motions

  !> Forces and motions for right-hand sides h and p; call only if the basis is sound.
  pure subroutine respond(basis, opening, load, force, approach)
    type(contact_basis), intent(in) :: basis   !! a sound one
    real(wp), contiguous, intent(in) :: opening(:, :)      !! h, gaps of the pairs without forces [s, k]
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

  !> A block of F_g = F + gamma A A'.
  pure function regular_flexibility(problem, gamma, rows, columns) result(block)
    type(scaled_problem), intent(in) :: problem   !! in its own units
    real(wp), intent(in) :: gamma                  !! from `weight_of_motions`
    integer, intent(in) :: rows(:), columns(:)     !! pairs
    real(wp), allocatable :: block(:, :)
    real(wp), allocatable :: left(:, :), right(:, :)

    block = problem%flexibility(rows, columns)
    left = problem%motion(rows, :)
    right = transpose(problem%motion(columns, :))
    call add_product(gamma, left, right, block)
  end function regular_flexibility

  !> gamma, such that F and gamma A A' are of one size.
  pure real(wp) function weight_of_motions(problem) result(gamma)
    type(scaled_problem), intent(in) :: problem   !! in its own units
    real(wp) :: largest

    largest = maxval([sum(problem%motion**2, dim=2), 0.0_wp])
    gamma = largest_flexibility(problem)
    if (largest > 0.0_wp) gamma = gamma/largest
  end function weight_of_motions

  !> A pivot of F_g up to this is rounding: a hundredth of a negligible flexibility, or that of n sums.
  pure real(wp) function rank_tolerance(problem)
    type(scaled_problem), intent(in) :: problem   !! in its own units

    rank_tolerance = max(negligible/100, 4*size(problem%gap)*epsilon(1.0_wp))*largest_flexibility(problem)
  end function rank_tolerance

  !> max F_kk; 1 if nothing is flexible.
  pure real(wp) function largest_flexibility(problem) result(largest)
    type(scaled_problem), intent(in) :: problem
    integer :: k

    largest = maxval([(problem%flexibility(k, k), k=1, size(problem%gap)), 0.0_wp])
    if (largest <= 0.0_wp) largest = 1.0_wp
  end function largest_flexibility
end module epcont_contact_basis
