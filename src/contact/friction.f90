!> Coulomb friction in two dimensions: a linear complementarity problem, solved exactly.
!>
!> Several solutions are possible if normal forces depend strongly on friction: the matrix mu |dR/dT| of all
!> pairs, all closed, then has a spectral radius of at least one (measured for three pairs or more, not
!> proved). Then other solutions are sought from states that differ from the solution in one pair, and from
!> random states. A few pairs are always searched.
module epcont_contact_friction
  use epcont_base_kinds, only: i8, wp
  use epcont_base_tolerances, only: cancelled, negligible, no_effect
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_friction_attempts, only: exchange, find_states, random_limit, &
    random_states, sticking
  use epcont_contact_friction_state, only: friction_bounds, friction_equations, friction_problem, &
    friction_state, new_equations, new_friction_problem, pair_states
  use epcont_contact_problem, only: contact_no_equilibrium, contact_overlap, contact_problem, &
    contact_solution, contact_solved, contact_stalled, new_solution
  use epcont_contact_uniqueness, only: find_undetermined_motions
  use epcont_flexibility_motion_matrix, only: dense_motions, motion_matrix
  use epcont_linalg_dense, only: lu_substitute
  implicit none
  private
  public :: forces_in_cones, solve_friction

  !> Displacement, in scaled units, of a body that only the springs restrain.
  real(wp), parameter :: escaped = 1.0e4_wp
  !> Force, in scaled units, of a pair that overlaps and cannot deform.
  real(wp), parameter :: crushed = 1.0e8_wp
  !> With more pairs, no other solutions are sought: the time grows with the fourth power of their number.
  integer, parameter :: search_limit = 100
  !> With at most this number of pairs, other solutions are always sought.
  integer, parameter :: few_pairs = 10
  !> Number of steps of the power iteration.
  integer, parameter :: power_steps = 30

contains

  !> Find forces, gaps and modes of a problem with friction, or the mode that nothing restrains.
  subroutine solve_friction(problem, solution, start, any_forces)
    type(contact_problem), intent(in), target :: problem   !! in the deck's units
    type(contact_solution), intent(out) :: solution   !! its state says if there is a solution
    logical, intent(in), optional :: start(:)   !! guess of the pairs in contact [pairs or rows]
    logical, intent(in), optional :: any_forces   !! true: do not search for other solutions
    type(friction_problem) :: own
    type(friction_state) :: state
    type(rigid_start) :: rigid
    logical :: found

    own = new_friction_problem(problem)
    solution = new_solution(size(own%scaled%gap), size(own%scaled%resultant))
    solution%gap = own%scaled%gap*own%scaled%gap_unit
    rigid = forces_in_cones(own%scaled%motion, own%scaled%resultant, problem%pair_of, problem%friction)
    if (rigid%balanced) then
      call find_states(own, first_states(problem, own, start), state, solution%sets, found)
      if (found) then
        call take_state(own, state, solution)
        if (.not. present(any_forces)) call find_others(own, state, solution)
        return
      end if
      solution%overlapping(:own%pairs) = state%force(:own%pairs) > crushed
      solution%state = merge(contact_overlap, contact_stalled, any(solution%overlapping))
      if (maxval([abs(state%approach), 0.0_wp]) < escaped) return
      rigid%escape = state%approach
    end if
    solution%state = contact_no_equilibrium
    solution%escape = rigid%escape/maxval(abs(rigid%escape))/own%scaled%motion_size
  end subroutine solve_friction

  !> Find forces in the friction cones that carry the load, or a mode that they cannot resist.
  type(rigid_start) function forces_in_cones(motion, resultant, pair_of, friction) result(rigid)
    type(motion_matrix), intent(in) :: motion   !! A, largest entry about one; the last rows are tangential
    real(wp), intent(in) :: resultant(:)        !! P [m]
    integer, intent(in) :: pair_of(:)           !! pair of each tangential row
    real(wp), intent(in) :: friction(:)         !! its coefficient of friction
    real(wp), allocatable :: closing(:, :), edge(:, :)   ! A, and closing of the edges of the cones
    integer :: k

    closing = motion%dense()
    associate (n => motion%pairs - size(pair_of))
      edge = closing([(k, k, k=1, n)], :)
      do k = 1, size(pair_of)
        associate (first => 2*pair_of(k) - 1, by_friction => friction(k)*closing(n + k, :))
          edge(first, :) = edge(first, :) + by_friction
          edge(first + 1, :) = edge(first + 1, :) - by_friction
        end associate
      end do
    end associate
    call find_rigid_start(dense_motions(edge), resultant, spread(0.0_wp, 1, size(edge, 1)), rigid)
  end function forces_in_cones

  !> Find the states to begin with: those of the known forces or of a guess, or all pairs stick.
  pure type(pair_states) function first_states(problem, own, start) result(states)
    type(contact_problem), intent(in) :: problem
    type(friction_problem), intent(in) :: own
    logical, intent(in), optional :: start(:)
    real(wp), allocatable :: force(:)
    integer :: k

    states = sticking(own)
    if (present(start)) states%closed = start(:own%pairs)
    if (allocated(problem%guess_force)) force = problem%guess_force
    if (allocated(problem%known_force)) force = problem%known_force
    if (.not. allocated(force)) return
    if (.not. present(start)) states%closed = force(:own%pairs) > 0.0_wp
    do k = 1, own%pairs
      if (own%tangent(k) == 0) cycle
      associate (bound => own%mu(k)*force(k), friction => force(own%tangent(k)))
        if (abs(friction) >= bound*(1.0_wp - negligible)) states%slip(k) = merge(-1, 1, friction > 0.0_wp)
        if (abs(friction) <= 0.0_wp) states%slip(k) = 0
      end associate
    end do
  end function first_states

  !> Copy a solution, in the deck's units and without rounding. T of inert rows is zero.
  subroutine take_state(problem, state, solution)
    type(friction_problem), intent(in) :: problem
    type(friction_state), intent(in) :: state
    type(contact_solution), intent(inout) :: solution
    integer :: k

    solution%state = contact_solved
    associate (scaled => problem%scaled, slip => state%states%slip, n => problem%pairs)
      solution%touching(:n) = state%states%closed
      solution%force = state%force*scaled%force_unit
      solution%change = state%change*scaled%force_unit
      solution%gap = state%gap*scaled%gap_unit
      where (state%force(:n) <= cancelled) solution%force(:n) = 0.0_wp
      do k = 1, n
        associate (row => problem%tangent(k) + problem%inert(k), bound => problem%mu(k)*solution%force(k), &
                   closed => state%states%closed(k))
          if (row == 0) cycle
          solution%touching(row) = closed .and. slip(k) == 0
          solution%at_upper(row) = closed .and. slip(k) < 0
          solution%indeterminate(row) = closed .and. problem%inert(k) > 0
          if (solution%touching(row)) then
            solution%force(row) = max(-bound, min(bound, solution%force(row)))
          else
            solution%force(row) = -slip(k)*bound
          end if
        end associate
      end do
      where (solution%touching) solution%gap = 0.0_wp
      solution%approach = state%approach*scaled%gap_unit/scaled%motion_size
      solution%motion_free = find_undetermined_motions(scaled%motion, solution%touching, solution%touching)
    end associate
  end subroutine take_state

  !> Search for other solutions, and mark the pairs whose states differ.
  subroutine find_others(problem, state, solution)
    type(friction_problem), intent(in) :: problem
    type(friction_state), intent(in) :: state           !! the solution
    type(contact_solution), intent(inout) :: solution
    type(pair_states) :: first
    integer(i8) :: seed
    integer :: code, from, k, to

    solution%several = spread(.false., 1, problem%pairs)
    if (problem%pairs > few_pairs) then
      if (coupling_radius(problem) < 1.0_wp) return
    end if
    solution%searched = problem%pairs <= search_limit
    if (.not. solution%searched) return
    do k = 0, problem%pairs   ! 0: all pairs
      from = max(k, 1)
      to = merge(k, problem%pairs, k > 0)
      do code = -1, 2         ! the slip; 2: open
        first = state%states
        first%closed(from:to) = code < 2
        first%slip(from:to) = mod(code, 2)
        call compare_from(problem, state, first, solution%several)
      end do
    end do
    seed = 1
    do k = 1, random_limit
      first = random_states(problem%pairs, seed)
      call compare_from(problem, state, first, solution%several)
    end do
  end subroutine find_others

  !> Find the solution from given states; if it differs, mark the pairs whose states differ.
  subroutine compare_from(problem, state, first, several)
    type(friction_problem), intent(in) :: problem
    type(friction_state), intent(in) :: state
    type(pair_states), intent(in) :: first
    logical, intent(inout) :: several(:)      !! [n]
    type(friction_bounds) :: coulomb
    type(friction_state) :: other
    integer :: sets
    logical :: found

    coulomb%given = 0*problem%mu
    sets = 0
    call exchange(problem, coulomb, first, other, sets, found)
    if (.not. found) return
    if (all(abs(other%force - state%force) <= no_effect*maxval(abs(state%force)))) return
    several = several .or. (other%states%closed .neqv. state%states%closed) .or. &
              state%states%closed .and. other%states%slip /= state%states%slip
  end subroutine compare_from

  !> Compute the spectral radius of mu |dR/dT|, with all pairs closed.
  real(wp) function coupling_radius(problem) result(radius)
    type(friction_problem), intent(in) :: problem
    type(friction_bounds) :: without
    type(friction_equations) :: equations
    real(wp), allocatable :: closing(:, :), response(:, :), vector(:)
    integer, allocatable :: pair(:)      ! pairs with friction
    integer :: k, step

    pair = pack([(k, k=1, problem%pairs)], problem%tangent > 0)
    closing = problem%scaled%motion%dense()
    without%coulomb = .false.
    without%given = 0*problem%mu
    equations = new_equations(problem, without, sticking(problem))
    allocate (response(size(equations%pivots), size(pair)))
    associate (n => problem%pairs, row => problem%tangent(pair))
      response(:n, :) = problem%scaled%flexibility_scale*problem%scaled%flexibility(:n, row)
      response(n + 1:, :) = -transpose(closing(row, :))
    end associate
    call lu_substitute(equations%factor, equations%pivots, response)
    response = abs(response(pair, :))*spread(problem%mu(pair), 2, size(pair))
    radius = 0.0_wp
    vector = spread(1.0_wp, 1, size(pair))
    do step = 1, power_steps
      vector = matmul(response, vector)
      radius = norm2(vector)
      if (radius <= 0.0_wp) return
      vector = vector/radius
    end do
  end function coupling_radius
end module epcont_contact_friction
