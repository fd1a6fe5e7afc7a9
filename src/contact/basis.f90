!> The contact equations for a given set S of pairs in contact, factored from F and A, their solution, and the
!> test of its signs.
!>
!>     F_SS R_S - A_S q = -h,   A_S' R_S = p
!>
!> F_SS may be singular though the forces are unique (a pair between held nodes is a row of zeros).
!> F_g = F + gamma A A' is definite whenever they are unique, and since A'R = p it changes only the
!> motion: q comes out larger by gamma p.
!>
!> A set is factored afresh, or, where sets change by blocks, from the one before: pairs that are likely to
!> stay stand first, the factor is kept up to the first pair that has gone, and only the rows below it are
!> factored anew:
!>
!>     +------+
!>     | kept |         pairs of large force
!>     +------+------+
!>     |     new     |  pairs at the edges of the contact, and those that came
!>     +------+------+
module epcont_contact_basis
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_base_tolerances, only: cancelled, lost_digits
  use epcont_contact_scaling, only: scaled_problem
  use epcont_linalg_dense, only: add_product, cholesky_factor, cholesky_solve, extend_cholesky, &
    pivoted_cholesky
  implicit none
  private
  public :: contact_basis, new_basis, change_set, respond, regular_flexibility
  public :: contact_state, fresh_state, solve_set, basic_values, gaps_under, has_right_signs, terms_of_gaps

  !> Part of the largest force by which forces and gaps may have the wrong sign, in scaled units: all that can
  !! be asked where the flexibility is badly conditioned (1e10: tests/contact/hard_problem), and what is asked
  !! of a guess, from which better sets may be found.
  real(wp), parameter, public :: guess_tolerance = 1.0e-12_wp
  !> Part of a set from which on its factor is kept. With 1/2, where pairs that come as the candidates are
  !! doubled stand behind edges that go, block pivoting takes half as long again; without keeping anything it
  !! does so too.
  real(wp), parameter :: worth_keeping = 0.75_wp
  !> Firmness is told apart to this part of the largest.
  real(wp), parameter :: firmness_steps = 1.0e6_wp

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

  !> A set with its solution at full load; without forces where the basis is not sound.
  type, extends(contact_basis) :: contact_state
    real(wp), allocatable :: force(:)           !! zero outside the basis [n]
    real(wp), allocatable :: gap(:)             !! zero up to rounding in the basis [n]
    real(wp), allocatable :: approach(:)        !! [m]
  end type contact_state

contains

  !> Factor the equations of the chosen pairs. Pairs whose force depends on that of others are left out.
  pure type(contact_basis) function new_basis(scaled, chosen) result(basis)
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: chosen(:)   !! [n]
    integer, allocatable :: order(:)
    integer :: info, k, rank

    basis%pairs = pack([(k, k=1, size(chosen))], chosen)
    basis%factor = regular_flexibility(scaled, basis%pairs, basis%pairs)
    call cholesky_factor(basis%factor, info)
    if (.not. has_pivots(basis, info, lost_digits*scaled%softest)) then
      ! The order of pivots, which takes longer, tells who depends on whom.
      basis%factor = regular_flexibility(scaled, basis%pairs, basis%pairs)
      call pivoted_cholesky(basis%factor, scaled%rank_tolerance, order, rank)
      basis%pairs = basis%pairs(order(:rank))
      basis%factor = basis%factor(:rank, :rank)
    end if
    call hold_motions(basis, scaled)
  end function new_basis

  !> Go over to another set. Without unique forces the basis is not sound, and nothing is kept of its factor.
  pure subroutine change_set(basis, scaled, closed, firmness)
    type(contact_basis), intent(inout) :: basis   !! none yet, or that of the set before
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: closed(:)      !! the set [n]
    real(wp), intent(in) :: firmness(:)   !! how likely pairs are to stay, largest first [n]
    integer, allocatable :: added(:)
    logical :: missing(size(closed))
    integer :: info, k, kept, n

    n = count(closed)
    if (.not. allocated(basis%factor)) then   ! room for all pairs
      allocate (basis%pairs(0), basis%factor(size(closed), size(closed)))
    end if
    kept = findloc([closed(basis%pairs), .false.], .false., dim=1) - 1
    ! Where much is new, all are put into order, so that the next sets keep most of it.
    if (kept < worth_keeping*n) kept = 0
    missing = closed
    missing(basis%pairs(:kept)) = .false.
    added = pack([(k, k=1, size(closed))], missing)
    added = added(sorted_order(nint(-firmness_steps*firmness(added))))
    basis%pairs = [basis%pairs(:kept), added]
    basis%factor(kept + 1:n, :n) = regular_flexibility(scaled, added, basis%pairs)
    call extend_cholesky(size(closed), basis%factor, kept, n, info)
    if (has_pivots(basis, info, scaled%rank_tolerance)) then
      call hold_motions(basis, scaled)
    else
      basis%sound = .false.
      basis%pairs = [integer ::]
    end if
  end subroutine change_set

  !> Has a factorization come to its end, and no pivot below a limit?
  pure logical function has_pivots(basis, info, least) result(has)
    type(contact_basis), intent(in) :: basis
    integer, intent(in) :: info     !! of the factorization
    real(wp), intent(in) :: least
    integer :: k

    has = info == 0
    if (has) has = all([(basis%factor(k, k)**2, k=1, size(basis%pairs))] >= least)
  end function has_pivots

  !> What the motions do to a set whose F_g is factored; it is sound if it holds all of them.
  pure subroutine hold_motions(basis, scaled)
    type(contact_basis), intent(inout) :: basis
    type(scaled_problem), intent(in) :: scaled
    real(wp) :: resistance(size(scaled%resultant), size(scaled%resultant))
    integer :: info

    basis%gamma = scaled%gamma
    basis%carried = scaled%motion(basis%pairs, :)
    call cholesky_solve(basis%factor, basis%carried)
    resistance = 0.0_wp
    call add_product(1.0_wp, transpose(scaled%motion(basis%pairs, :)), basis%carried, resistance)
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

    approach = load
    call add_product(1.0_wp, transpose(basis%carried), opening, approach)
    call cholesky_solve(basis%resistance, approach)
    force = -opening
    call cholesky_solve(basis%factor, force)
    call add_product(1.0_wp, basis%carried, approach, force)
    approach = approach - basis%gamma*load
  end subroutine respond

  !> A block of F_g = F + gamma A A'.
  pure function regular_flexibility(scaled, rows, columns) result(block)
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    integer, intent(in) :: rows(:), columns(:)     !! pairs
    real(wp), allocatable :: block(:, :)

    block = scaled%flexibility(rows, columns)
    call add_product(scaled%gamma, scaled%motion(rows, :), transpose(scaled%motion(columns, :)), block)
  end function regular_flexibility

  !> Forces, gaps and motions of a set of contacts, with the pairs that touch first should they not hold every
  !! motion.
  pure type(contact_state) function fresh_state(scaled, closed) result(state)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    logical, intent(in) :: closed(:)   !! [n]

    state%contact_basis = new_basis(scaled, closed)
    if (.not. state%sound) state%contact_basis = new_basis(scaled, closed .or. scaled%first_touching)
    call solve_set(state, scaled, scaled%gap, scaled%resultant, refinements=1)
  end function fresh_state

  !> Forces, gaps and motions with the pairs of the basis closed and the others free of force.
  pure subroutine solve_set(state, scaled, opening, load, refinements)
    type(contact_state), intent(inout) :: state   !! its basis is solved with
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    real(wp), intent(in) :: opening(:)            !! gaps without forces [n]
    real(wp), intent(in) :: load(:)               !! [m]
    integer, intent(in) :: refinements            !! steps that follow the solution
    real(wp), allocatable :: force(:, :), approach(:, :)
    real(wp) :: unbalanced(size(load), 1)         ! what is not carried yet
    integer :: step

    state%gap = opening
    state%force = spread(0.0_wp, 1, size(opening))
    state%approach = spread(0.0_wp, 1, size(load))
    if (.not. state%sound) return
    unbalanced(:, 1) = load
    associate (pairs => state%pairs)
      do step = 0, refinements
        call respond(state%contact_basis, reshape(state%gap(pairs), [size(pairs), 1]), unbalanced, &
                     force, approach)
        state%force(pairs) = state%force(pairs) + force(:, 1)
        state%approach = state%approach + approach(:, 1)
        state%gap = gaps_under(scaled, opening, state%force, state%approach)
        unbalanced(:, 1) = load - matmul(state%force, scaled%motion)
      end do
    end associate
  end subroutine solve_set

  !> w = g + F R - A q.
  pure function gaps_under(scaled, opening, force, approach) result(gap)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    real(wp), intent(in) :: opening(:)            !! g [n]
    real(wp), intent(in) :: force(:)              !! R [n]
    real(wp), intent(in) :: approach(:)           !! q [m]
    real(wp), allocatable :: gap(:)
    integer :: k

    gap = opening - matmul(scaled%motion, approach)
    do k = 1, size(force)
      if (force(k) /= 0.0_wp) gap = gap + force(k)*scaled%flexibility(:, k)
    end do
  end function gaps_under

  !> The basic variable of each pair: force where it is in the basis, gap elsewhere.
  pure function basic_values(state) result(values)
    type(contact_state), intent(in) :: state   !! set and solution
    real(wp), allocatable :: values(:)

    values = state%gap
    values(state%pairs) = state%force(state%pairs)
  end function basic_values

  !> The test of the fresh solution: its pairs hold every motion; R >= 0 and w >= 0, to the rounding of the
  !! largest force and gap.
  pure logical function has_right_signs(scaled, state, tolerance) result(right)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    type(contact_state), intent(in) :: state   !! set and solution
    real(wp), intent(in) :: tolerance   !! one of the above
    real(wp) :: force_tolerance, gap_noise

    force_tolerance = tolerance*maxval([abs(state%force), 1.0_wp])
    gap_noise = cancelled*maxval([abs(scaled%gap), 0.0_wp])
    right = state%sound .and. all(state%force >= -force_tolerance) .and. &
        all(state%gap >= -(force_tolerance + gap_noise))
    if (.not. right .or. maxval([state%force, 0.0_wp]) <= 1.0_wp) return
    ! The largest force, at a stop that hardly gives way, says nothing of gaps that it has no part in.
    right = all(state%gap >= -(tolerance*max(terms_of_gaps(scaled, state), 1.0_wp) + gap_noise))
  end function has_right_signs

  !> The sum of the magnitudes that each gap is the sum of.
  pure function terms_of_gaps(scaled, state) result(terms)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    type(contact_state), intent(in) :: state   !! set and solution
    real(wp), allocatable :: terms(:)
    integer :: k

    terms = scaled%gap_terms + matmul(abs(scaled%motion), abs(state%approach))
    do k = 1, size(state%force)
      if (state%force(k) /= 0.0_wp) terms = terms + abs(state%force(k)*scaled%flexibility(:, k))
    end do
  end function terms_of_gaps
end module epcont_contact_basis
