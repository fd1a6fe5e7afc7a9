!> Contact with friction for given states of the pairs: equations, their solution, and its margins.
!>
!> The force T of a tangential row is between -(mu R + h) and mu R + h of its pair; its gap is the slip of B
!> relative to A. Three problems have this form: Coulomb friction (h = 0), given bounds (without mu R), and
!> the path between the two. A pair is closed or open; its tangential row sticks, or slips with T at the bound
!> that opposes it. The unknown forces x and modes q follow from
!>
!>     [  F - s mu F_t     -A ] [ x ]   [ -g ]
!>     [ -(A - s mu A_t)'  -k ] [ q ] = [ -P ]
!>
!> in which columns with s mu belong to pairs that slip with the sign s. The weak springs k restrain bodies
!> that the states do not restrain; iterative refinement removes their effect from all other bodies. A tiny
!> flexibility on the diagonal does the same for forces that are not unique.
module epcont_contact_friction_state
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, negligible, solved_to
  use epcont_contact_problem, only: contact_problem
  use epcont_contact_scaling, only: diagonal_of, scale_problem, scaled_problem
  use epcont_contact_state, only: gaps_under
  use epcont_linalg_dense, only: lu_factor, lu_substitute
  implicit none
  private
  public :: friction_problem, new_friction_problem, friction_bounds, pair_states, friction_equations, &
    friction_state, new_equations, solve_states, wrong_signs, flip

  !> Stiffness of the springs, and flexibility that is added to the diagonal of F, in scaled units.
  real(wp), parameter :: spring = 1.0e-9_wp, softening = 1.0e-13_wp
  !> Maximum number of steps of iterative refinement.
  integer, parameter :: refinements = 5

  !> Scaled problem. Its first rows are the pairs.
  type :: friction_problem
    type(scaled_problem) :: scaled
    integer :: pairs = 0                    !! n
    integer, allocatable :: tangent(:)      !! tangential row of each pair; 0 if it has no friction [n]
    real(wp), allocatable :: mu(:)          !! coefficient of friction of each pair [n]
    !> Tangential row of each pair whose slip is zero and depends on no force and no mode; else 0 [n]
    integer, allocatable :: inert(:)
  end type friction_problem

  !> Bounds of the tangential forces: mu R if `coulomb`, plus given ones.
  type :: friction_bounds
    logical :: coulomb = .true.
    real(wp), allocatable :: given(:)       !! h, in the force unit [n]
  end type friction_bounds

  type :: pair_states
    logical, allocatable :: closed(:)       !! [n]
    integer, allocatable :: slip(:)         !! sign of the slip; 0: sticks [n]
  end type pair_states

  !> Factored equations of given states.
  type :: friction_equations
    type(pair_states) :: states
    logical, allocatable :: bounded(:)      !! the tangential force may be other than zero [n]
    real(wp), allocatable :: coupling(:)    !! T/R of pairs that slip under Coulomb friction, else 0 [n]
    integer, allocatable :: rows(:)         !! rows whose force is unknown and whose gap is zero [s]
    real(wp), allocatable :: factor(:, :)   !! [s + m, s + m]
    integer, allocatable :: pivots(:)       !! [s + m]
  end type friction_equations

  !> Solution for given states.
  type :: friction_state
    type(pair_states) :: states
    real(wp), allocatable :: force(:), change(:), gap(:)   !! as in `contact_state` [rows]
    real(wp), allocatable :: approach(:)    !! q [m]
    logical :: balanced = .false.           !! forces carry the loads without the springs
    !> Variables that must not be negative: force or gap of the pair; distance of T from its lower bound, or
    !! the slip there; the same for the upper bound. Huge if it does not apply [n, 3]
    real(wp), allocatable :: margin(:, :)
  end type friction_state

contains

  !> Scale a problem with friction.
  type(friction_problem) function new_friction_problem(problem) result(new)
    type(contact_problem), intent(in), target :: problem   !! in the deck's units; it must remain
    real(wp) :: closing(size(problem%initial_gap))
    integer :: k

    new%scaled = scale_problem(problem)
    new%pairs = size(problem%initial_gap) - size(problem%friction)
    new%tangent = spread(0, 1, new%pairs)
    new%mu = spread(0.0_wp, 1, new%pairs)
    new%inert = new%tangent
    closing = new%scaled%motion%times(spread(1.0_wp, 1, size(problem%resultant)), magnitudes=.true.)
    do k = 1, size(problem%friction)
      associate (pair => problem%pair_of(k), row => new%pairs + k)
        if (max(problem%flexibility(row, row)*new%scaled%flexibility_scale, closing(row), &
                abs(new%scaled%gap(row))) <= negligible) then
          new%inert(pair) = row
        else
          new%tangent(pair) = row
          new%mu(pair) = problem%friction(k)
        end if
      end associate
    end do
  end function new_friction_problem

  !> Factor the equations of given states.
  type(friction_equations) function new_equations(problem, bounds, states) result(new)
    type(friction_problem), intent(in) :: problem
    type(friction_bounds), intent(in) :: bounds
    type(pair_states), intent(in) :: states
    integer :: info, k

    new%states = states
    new%bounded = problem%tangent > 0 .and. (bounds%given > 0.0_wp .or. bounds%coulomb .and. states%closed)
    new%coupling = merge(-problem%mu*states%slip, 0.0_wp, new%bounded .and. bounds%coulomb)
    associate (free => new%bounded .and. states%slip == 0)
      new%rows = [pack([(k, k=1, problem%pairs)], states%closed), pack(problem%tangent, free)]
    end associate
    call assemble(problem, new)
    allocate (new%pivots(size(new%factor, 1)))
    call lu_factor(new%factor, new%pivots, info)
    if (info == 0) return
    do k = info, size(new%pivots)   ! singular: the solution will not be balanced
      if (new%factor(k, k) == 0.0_wp) new%factor(k, k) = softening
    end do
  end function new_equations

  !> Assemble the matrix.
  pure subroutine assemble(problem, equations)
    type(friction_problem), intent(in) :: problem
    type(friction_equations), intent(inout) :: equations
    real(wp), allocatable :: closing(:, :)    ! A [all rows, m]
    integer :: j, k, m, s

    s = size(equations%rows)
    m = size(problem%scaled%resultant)
    closing = problem%scaled%motion%dense()
    allocate (equations%factor(s + m, s + m), source=0.0_wp)
    associate (rows => equations%rows, a => equations%factor, f => problem%scaled%flexibility, &
               unit => problem%scaled%flexibility_scale)
      do j = 1, s
        k = rows(j)
        a(:s, j) = unit*f(rows, k)
        a(s + 1:, j) = -closing(k, :)
        a(j, s + 1:) = -closing(k, :)
        if (k <= problem%pairs) then
          if (equations%coupling(k) /= 0.0_wp) then
            a(:s, j) = a(:s, j) + equations%coupling(k)*unit*f(rows, problem%tangent(k))
            a(s + 1:, j) = a(s + 1:, j) - equations%coupling(k)*closing(problem%tangent(k), :)
          end if
        end if
        a(j, j) = a(j, j) + softening
      end do
      do j = s + 1, s + m
        a(j, j) = -spring
      end do
    end associate
  end subroutine assemble

  !> Solve the equations of given states. If the states do not restrain the bodies, the springs do: then the
  !! solution is not balanced.
  pure subroutine solve_states(problem, equations, bounds, state, sprung)
    type(friction_problem), intent(in) :: problem
    type(friction_equations), intent(in) :: equations
    type(friction_bounds), intent(in) :: bounds   !! those of the equations; h may differ, if positive
    type(friction_state), intent(out) :: state
    logical, intent(in), optional :: sprung       !! true: keep the springs in any case
    real(wp) :: rest(2), before, force, gap, noise
    integer :: step

    state%states = equations%states
    call begin(problem, equations, bounds, state)
    if (.not. present(sprung)) then
      before = huge(before)
      do step = 0, refinements
        call correct(problem, equations, state, 0.0_wp, rest)
        if (maxval(rest) > 0.5_wp*before .and. step > 1) exit
        before = maxval(rest)
      end do
      call find_sizes(problem, state, force, gap, noise)
      state%balanced = rest(1) <= solved_to*gap + noise .and. rest(2) <= solved_to*force
    end if
    if (.not. state%balanced) then
      call begin(problem, equations, bounds, state)
      do step = 0, 1
        call correct(problem, equations, state, spring, rest)
      end do
    end if
    call find_margins(problem, equations, bounds, state)
  end subroutine solve_states

  !> Begin with the known forces, or bounds of the others.
  pure subroutine begin(problem, equations, bounds, state)
    type(friction_problem), intent(in) :: problem
    type(friction_equations), intent(in) :: equations
    type(friction_bounds), intent(in) :: bounds
    type(friction_state), intent(inout) :: state
    integer :: k

    associate (known => problem%scaled%known_force, slip => equations%states%slip)
      state%change = -known
      state%change(equations%rows) = 0.0_wp
      do k = 1, problem%pairs
        if (.not. equations%bounded(k) .or. slip(k) == 0) cycle
        associate (row => problem%tangent(k))
          state%change(row) = equations%coupling(k)*(known(k) + state%change(k)) - slip(k)*bounds%given(k) &
                              - known(row)
        end associate
      end do
      state%force = known + state%change
    end associate
    state%approach = 0.0_wp*problem%scaled%resultant
    state%gap = gaps_under(problem%scaled, problem%scaled%gap, state%change, state%approach)
  end subroutine begin

  !> Correct forces and modes by the residual of their equations, and find the largest residual of gaps and
  !! of loads before.
  pure subroutine correct(problem, equations, state, stiffness, rest)
    type(friction_problem), intent(in) :: problem
    type(friction_equations), intent(in) :: equations
    type(friction_state), intent(inout) :: state
    real(wp), intent(in) :: stiffness      !! of the springs in the residual
    real(wp), intent(out) :: rest(2)
    real(wp) :: x(size(equations%pivots), 1)
    integer :: k

    associate (rows => equations%rows, s => size(equations%rows), scaled => problem%scaled)
      x(:s, 1) = -state%gap(rows)
      x(s + 1:, 1) = scaled%motion%carried(state%force) + stiffness*state%approach - scaled%resultant
      rest = [maxval([abs(x(:s, 1)), 0.0_wp]), maxval([abs(x(s + 1:, 1)), 0.0_wp])]
      call lu_substitute(equations%factor, equations%pivots, x)
      state%change(rows) = state%change(rows) + x(:s, 1)
      do k = 1, count(equations%states%closed)
        associate (pair => rows(k))
          if (equations%coupling(pair) == 0.0_wp) cycle
          associate (row => problem%tangent(pair))
            state%change(row) = state%change(row) + equations%coupling(pair)*x(k, 1)
          end associate
        end associate
      end do
      state%force = scaled%known_force + state%change
      state%approach = state%approach + x(s + 1:, 1)
      state%gap = gaps_under(scaled, scaled%gap, state%change, state%approach)
    end associate
  end subroutine correct

  !> Largest force, and largest gap that one force causes, but at least one; and rounding of the gaps.
  pure subroutine find_sizes(problem, state, force, gap, noise)
    type(friction_problem), intent(in) :: problem
    type(friction_state), intent(in) :: state
    real(wp), intent(out) :: force, gap, noise

    associate (scaled => problem%scaled)
      force = maxval([abs(state%force), 1.0_wp])
      gap = maxval([scaled%flexibility_scale*diagonal_of(scaled%flexibility)*abs(state%force), 1.0_wp])
      noise = cancelled*maxval([abs(scaled%gap), abs(state%approach), 0.0_wp])
    end associate
  end subroutine find_sizes

  !> Find the margins of a solution.
  pure subroutine find_margins(problem, equations, bounds, state)
    type(friction_problem), intent(in) :: problem
    type(friction_equations), intent(in) :: equations
    type(friction_bounds), intent(in) :: bounds
    type(friction_state), intent(inout) :: state
    real(wp) :: bound
    integer :: k

    allocate (state%margin(problem%pairs, 3), source=huge(1.0_wp))
    do k = 1, problem%pairs
      state%margin(k, 1) = merge(state%force(k), state%gap(k), state%states%closed(k))
      if (.not. equations%bounded(k)) cycle
      associate (row => problem%tangent(k), slip => state%states%slip(k))
        bound = bounds%given(k)
        if (bounds%coulomb) bound = bound + problem%mu(k)*state%force(k)
        if (slip == 0) state%margin(k, 2:3) = bound + [state%force(row), -state%force(row)]
        if (slip > 0) state%margin(k, 2) = state%gap(row)
        if (slip < 0) state%margin(k, 3) = -state%gap(row)
      end associate
    end do
  end subroutine find_margins

  !> Find margins that are negative by more than rounding [n, 3].
  pure function wrong_signs(problem, state, tolerance) result(wrong)
    type(friction_problem), intent(in) :: problem
    type(friction_state), intent(in) :: state
    real(wp), intent(in) :: tolerance      !! fraction of the largest force
    logical, allocatable :: wrong(:, :)
    real(wp) :: force, gap      ! tolerances of forces and, in units of the softness, of gaps
    real(wp) :: noise, row
    integer :: k

    call find_sizes(problem, state, force, gap, noise)
    force = tolerance*force
    gap = tolerance*gap + noise
    associate (softness => problem%scaled%softness, closed => state%states%closed)
      allocate (wrong(problem%pairs, 3))
      do k = 1, problem%pairs
        wrong(k, 1) = state%margin(k, 1) < -merge(force, gap*softness(k), closed(k))
        row = gap*softness(max(problem%tangent(k), 1))
        wrong(k, 2:3) = state%margin(k, 2:3) < -merge(force, row, state%states%slip(k) == 0)
      end do
    end associate
  end function wrong_signs

  !> Exchange one of the three variables of a pair for its partner: open or close it, stick or slip.
  pure subroutine flip(states, pair, variable)
    type(pair_states), intent(inout) :: states
    integer, intent(in) :: pair, variable

    if (variable == 1) then
      states%closed(pair) = .not. states%closed(pair)
    else if (states%slip(pair) /= 0) then
      states%slip(pair) = 0
    else
      states%slip(pair) = merge(1, -1, variable == 2)
    end if
  end subroutine flip
end module epcont_contact_friction_state
