!> Attempts to find the states of pairs with friction. First, all wrong pairs are exchanged. Then problems
!> with given bounds are solved, which are mu R of the problem before. Then paths lead from sticking pairs to
!> Coulomb friction. Each answer is solved again with the equations of Coulomb friction, and its signs are
!> tested.
module epcont_contact_friction_attempts
  use epcont_base_kinds, only: i8, wp
  use epcont_base_tolerances, only: negligible, solved_to
  use epcont_contact_friction_state, only: flip, friction_bounds, friction_equations, friction_problem, &
    friction_state, new_equations, pair_states, solve_states, wrong_signs
  use epcont_contact_state, only: guess_tolerance
  implicit none
  private
  public :: find_states, exchange, sticking, random_states

  !> Maximum number of sets of states in an exchange.
  integer, parameter :: set_limit = 60
  !> Maximum number of problems with given bounds.
  integer, parameter :: bounds_limit = 40
  !> Number of sets without fewer wrong variables after which an exchange is given up.
  integer, parameter :: patience_limit = 5
  !> Number of problems with given bounds after which the bounds are averaged with those before.
  integer, parameter :: plain_bounds = 5
  !> Number of exchanges from random states.
  integer, parameter, public :: random_limit = 40
  !> Number of further paths; they and random states are tried for at most this number of pairs.
  integer, parameter :: path_limit = 10, few_pairs = 50
  !> With more pairs, no path is followed: the time grows with the fourth power of their number.
  integer, parameter :: many_pairs = 400
  !> Bound of the forces of sticking pairs, far above all forces in scaled units.
  real(wp), parameter :: unbounded = 1.0e30_wp
  !> Events on a path after which it is given up; paths took up to 2.
  integer, parameter :: events_per_pair = 10

contains

  !> Make the attempts in turn.
  subroutine find_states(problem, first, state, sets, found)
    type(friction_problem), intent(in) :: problem
    type(pair_states), intent(in) :: first
    type(friction_state), intent(out) :: state   !! the solution, else that at the end of the first path
    integer, intent(inout) :: sets               !! number of sets of states tried
    logical, intent(out) :: found
    type(friction_state) :: trial
    type(friction_bounds) :: coulomb
    type(pair_states) :: states
    integer(i8) :: seed
    integer :: attempt

    coulomb%given = spread(0.0_wp, 1, problem%pairs)
    call exchange(problem, coulomb, first, state, sets, found)
    if (.not. found) call update_bounds(problem, state, sets, found)
    seed = 1
    do attempt = 0, merge(path_limit, 0, problem%pairs <= few_pairs)
      if (found .or. problem%pairs > many_pairs) return
      call follow_path(problem, seed, trial, sets, found)
      if (attempt == 0 .or. found) state = trial
    end do
    do attempt = 1, merge(random_limit, 0, problem%pairs <= few_pairs)
      if (found) return
      states = random_states(problem%pairs, seed)
      call exchange(problem, coulomb, states, trial, sets, found)
      if (found) state = trial
    end do
  end subroutine find_states

  !> Exchange all wrong variables at once until no variable is wrong, or there is no progress. With given
  !! bounds, the first wrong one is exchanged after a repetition, which cannot cycle (Murty).
  subroutine exchange(problem, bounds, first, state, sets, found, limit)
    type(friction_problem), intent(in) :: problem
    type(friction_bounds), intent(in) :: bounds
    type(pair_states), intent(in) :: first
    type(friction_state), intent(out) :: state    !! of the last set
    integer, intent(inout) :: sets
    logical, intent(out) :: found                 !! no variable is wrong; Coulomb friction: balanced
    integer, intent(in), optional :: limit        !! maximum number of sets; absent: `set_limit`
    type(pair_states) :: states
    logical, allocatable :: wrong(:, :)
    integer, allocatable :: seen(:, :)   ! code of the states of each set
    integer :: fewest     ! least number of wrong variables
    integer :: last       ! maximum number of sets
    integer :: patience   ! sets left to find fewer
    integer :: k, step
    logical :: repeats

    last = set_limit
    if (present(limit)) last = limit
    allocate (seen(problem%pairs, last))
    states = first
    repeats = .false.
    fewest = huge(fewest)
    patience = patience_limit
    do step = 1, last
      sets = sets + 1
      call solve_states(problem, new_equations(problem, bounds, states), bounds, state)
      seen(:, step) = states%slip + merge(10, 0, states%closed)
      repeats = repeats .or. any([(all(seen(:, k) == seen(:, step)), k=1, step - 1)])
      wrong = wrong_signs(problem, state, merge(solved_to, guess_tolerance, repeats))
      found = .not. any(wrong)
      patience = merge(patience_limit, patience - 1, count(wrong) < fewest)
      fewest = min(fewest, count(wrong))
      if (found .or. bounds%coulomb .and. (repeats .or. patience < 0)) exit
      call exchange_wrong(wrong, repeats, states)
    end do
    if (bounds%coulomb) found = found .and. state%balanced
  end subroutine exchange

  !> Exchange the wrong variables, or the first one.
  pure subroutine exchange_wrong(wrong, one, states)
    logical, intent(in) :: wrong(:, :)          !! [n, 3]
    logical, intent(in) :: one                  !! only the first
    type(pair_states), intent(inout) :: states
    integer :: k, variable

    do k = 1, size(wrong, 1)
      variable = findloc(wrong(k, :), .true., dim=1)
      if (variable == 0) cycle
      call flip(states, k, variable)
      if (one) return
    end do
  end subroutine exchange_wrong

  !> Solve problems with given bounds, which are mu R of the problem before.
  subroutine update_bounds(problem, state, sets, found)
    type(friction_problem), intent(in) :: problem
    type(friction_state), intent(inout) :: state   !! of any states; then the last with Coulomb friction
    integer, intent(inout) :: sets
    logical, intent(out) :: found
    type(friction_bounds) :: bounds, coulomb
    type(friction_state) :: given
    type(pair_states) :: states
    real(wp) :: bound(problem%pairs)
    integer :: step

    bounds%coulomb = .false.
    coulomb%given = 0*problem%mu
    given = state
    do step = 1, bounds_limit
      bound = problem%mu*max(given%force(:problem%pairs), 0.0_wp)
      if (step > plain_bounds) bound = 0.5_wp*(bounds%given + bound)
      bounds%given = bound
      states = given%states
      call exchange(problem, bounds, states, given, sets, found)
      call exchange(problem, coulomb, given%states, state, sets, found, limit=1)
      if (found) return
    end do
  end subroutine update_bounds

  !> Follow the solution with the bounds mu R + z h from sticking pairs to z = 0. At each event one variable
  !! becomes zero and its partner replaces it; z grows if the partner would decrease otherwise.
  subroutine follow_path(problem, seed, state, sets, found)
    type(friction_problem), intent(in) :: problem
    integer(i8), intent(inout) :: seed           !! of the random numbers
    type(friction_state), intent(out) :: state   !! the solution, or that with springs at the end of the path
    integer, intent(inout) :: sets
    logical, intent(out) :: found
    type(friction_bounds) :: coulomb
    type(friction_state) :: trial
    type(pair_states) :: states
    real(wp), dimension(problem%pairs, 3) :: length, rate
    real(wp) :: h(problem%pairs), way, z
    integer :: event(2), k, step

    h = [(0.5_wp + uniform(seed), k=1, size(h))]
    call begin_path(problem, h, state, z, sets)
    states = state%states
    way = -1.0_wp
    do step = 0, events_per_pair*problem%pairs
      if (z <= 0.0_wp) exit
      sets = sets + 1
      call solve_at(problem, states, z, h, state, rate)
      if (step > 0) way = sign(1.0_wp, rate(event(1), event(2)))
      length = huge(1.0_wp)
      where (way*rate < -negligible*maxval(abs(rate))) length = max(state%margin, 0.0_wp)/abs(rate)
      if (way > 0.0_wp .and. all(length >= huge(1.0_wp))) exit
      z = z + way*minval(length)
      event = minloc(length)
      if (z > 0.0_wp) call flip(states, event(1), event(2))
    end do
    coulomb%given = 0*h
    call exchange(problem, coulomb, states, trial, sets, found)
    if (found) state = trial
  end subroutine follow_path

  !> Find the solution if all pairs stick, and the least z at which it satisfies the bounds mu R + z h.
  subroutine begin_path(problem, h, state, z, sets)
    type(friction_problem), intent(in) :: problem
    real(wp), intent(in) :: h(:)                 !! [n]
    type(friction_state), intent(out) :: state
    real(wp), intent(out) :: z
    integer, intent(inout) :: sets
    type(friction_bounds) :: bounds
    logical :: found
    integer :: k

    bounds%coulomb = .false.
    bounds%given = spread(unbounded, 1, size(h))
    call exchange(problem, bounds, sticking(problem), state, sets, found)
    z = 0.0_wp
    do k = 1, size(h)
      if (problem%tangent(k) == 0) cycle
      z = max(z, (abs(state%force(problem%tangent(k))) - problem%mu(k)*state%force(k))/h(k))
    end do
  end subroutine begin_path

  !> Solve with the bounds mu R + z h and the springs, and find the change of the margins with z.
  subroutine solve_at(problem, states, z, h, state, rate)
    type(friction_problem), intent(in) :: problem
    type(pair_states), intent(in) :: states
    real(wp), intent(in) :: z, h(:)
    type(friction_state), intent(out) :: state
    real(wp), intent(out) :: rate(:, :)          !! [n, 3]
    type(friction_bounds) :: bounds
    type(friction_equations) :: equations
    type(friction_state) :: other

    bounds%given = z*h
    equations = new_equations(problem, bounds, states)
    call solve_states(problem, equations, bounds, state, sprung=.true.)
    bounds%given = 0.5_wp*bounds%given
    call solve_states(problem, equations, bounds, other, sprung=.true.)
    rate = (state%margin - other%margin)/(0.5_wp*z)
  end subroutine solve_at

  !> All pairs closed and sticking.
  pure type(pair_states) function sticking(problem) result(states)
    type(friction_problem), intent(in) :: problem

    states%closed = spread(.true., 1, problem%pairs)
    states%slip = spread(0, 1, problem%pairs)
  end function sticking

  !> Random states.
  type(pair_states) function random_states(pairs, seed) result(states)
    integer, intent(in) :: pairs
    integer(i8), intent(inout) :: seed
    integer :: k

    states%closed = [(uniform(seed) < 0.75_wp, k=1, pairs)]
    states%slip = [(int(3*uniform(seed)) - 1, k=1, pairs)]
  end function random_states

  !> Random number between 0 and 1, the same in every run (Lehmer, 48271 modulo 2**31 - 1).
  real(wp) function uniform(seed) result(number)
    integer(i8), intent(inout) :: seed

    seed = mod(48271_i8*seed, 2147483647_i8)
    number = real(seed, wp)/2147483647.0_wp
  end function uniform
end module epcont_contact_friction_attempts
