!> RULE CONRY: the simplex with a contact entry rule, from rigid bodies to the certified set of contacts.
!>
!> The set found is never trusted: forces and gaps are solved afresh from F and A, and if one of them
!> has the wrong sign the simplex goes on from there. A guessed set is treated in the same way.
module epcont_contact_simplex
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: basic_solution, contact_basis, new_basis
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_loading, only: follow_load, path_complete, path_ray
  use epcont_contact_problem, only: contact_no_equilibrium, contact_overlap, contact_problem, &
                                    contact_solution, contact_solved, contact_stalled
  use epcont_contact_scaling, only: drop_motions, negligible, restore_units, scale_problem, scaled_problem
  use epcont_contact_tableau, only: contact_tableau, new_tableau
  use epcont_contact_uniqueness, only: find_free_motions, find_indeterminate_forces, share_equally
  implicit none
  private
  public :: solve_contact

  !> Part of the largest force by which forces and gaps may have the wrong sign, in scaled units.
  real(wp), parameter :: sign_tolerance = 1.0e-10_wp
  !> Part of its forces by which a ray may miss F z = 0 and A'z = 0.
  real(wp), parameter :: ray_tolerance = 1.0e-7_wp
  !> Pivots allowed for each unknown before the order of ties is given up for broken.
  integer, parameter :: pivots_per_unknown = 10
  !> Part of a quantity that rounding leaves where it should cancel.
  real(wp), parameter :: noise = 100*epsilon(1.0_wp)
  !> Fresh starts before the problem is given up.
  integer, parameter :: restart_limit = 10

  !> A set of contacts with its fresh solution at full load.
  type :: contact_state
    type(contact_basis) :: basis
    real(wp), allocatable :: force(:), gap(:)   !! [n]
    real(wp), allocatable :: approach(:)        !! [m]
  end type contact_state

contains

  !> Find forces, gaps and motions of a contact problem, or why there are none.
  pure subroutine solve_contact(problem, solution, start)
    type(contact_problem), intent(in) :: problem
    type(contact_solution), intent(out) :: solution
    logical, intent(in), optional :: start(:)   !! guess of the pairs in contact [n]
    type(scaled_problem) :: scaled
    type(rigid_start) :: rigid
    type(contact_state) :: state
    real(wp), allocatable :: ray(:)

    scaled = scale_problem(problem)
    call clear(scaled, solution)
    call find_rigid_start(scaled, rigid)
    if (.not. rigid%balanced) then
      solution%state = contact_no_equilibrium
      solution%escape = rigid%escape/scaled%motion_size
      return
    end if
    call drop_motions(scaled, rigid%redundant)
    solution%motion_free = rigid%redundant

    call find_contacts(scaled, rigid%touching, solution, state, ray, start)
    if (solution%state == contact_overlap) then
      solution%overlapping = ray > ray_tolerance*maxval(ray)
    else
      call settle(scaled, state, solution)
    end if
  end subroutine solve_contact

  !> An answer of no contact at all, to be filled in.
  pure subroutine clear(scaled, solution)
    type(scaled_problem), intent(in) :: scaled
    type(contact_solution), intent(inout) :: solution
    integer :: m, n

    n = size(scaled%gap)
    m = size(scaled%resultant)
    allocate (solution%force(n), solution%approach(m), solution%escape(m), source=0.0_wp)
    solution%gap = scaled%gap*scaled%gap_unit
    allocate (solution%touching(n), solution%overlapping(n), solution%indeterminate(n), source=.false.)
    allocate (solution%motion_free(m), source=.false.)
    allocate (solution%history(0))
  end subroutine clear

  !> Follow the load from one set of contacts to the next until a fresh solution passes the test of signs.
  pure subroutine find_contacts(scaled, first_touching, solution, state, ray, start)
    type(scaled_problem), intent(in) :: scaled
    logical, intent(in) :: first_touching(:)            !! pairs that hold every motion [n]
    type(contact_solution), intent(inout) :: solution   !! state, and the record of the pivots
    type(contact_state), intent(out) :: state
    real(wp), allocatable, intent(out) :: ray(:)        !! if the state is overlap [n]
    logical, intent(in), optional :: start(:)
    real(wp), allocatable :: lifted(:)
    logical, allocatable :: closed(:)
    integer :: attempt, outcome

    closed = first_touching
    if (present(start)) closed = closed .or. start
    state = fresh_state(scaled, closed, first_touching)
    lifted = unloaded_values(scaled, state)
    if (present(start)) lifted = max(basic_values(state), 0.0_wp)
    do attempt = 0, restart_limit
      solution%state = contact_solved
      if (has_right_signs(scaled, state)) return
      solution%restarts = attempt
      call follow_load_from(scaled, state, lifted, solution, outcome, closed, ray)
      if (outcome == path_ray .and. is_overlap(scaled, ray)) then
        solution%state = contact_overlap
        return
      else if (outcome == path_complete .and. mod(attempt, 2) == 0) then
        state = fresh_state(scaled, closed, first_touching)
        lifted = max(basic_values(state), 0.0_wp)
      else
        state = fresh_state(scaled, first_touching, first_touching)
        lifted = lifted_apart(state, attempt)
      end if
    end do
    if (.not. has_right_signs(scaled, state)) solution%state = contact_stalled
  end subroutine find_contacts

  !> Forces, gaps and motions of a set of contacts, from F and A.
  pure function fresh_state(scaled, closed, first_touching) result(state)
    type(scaled_problem), intent(in) :: scaled
    logical, intent(in) :: closed(:)
    logical, intent(in) :: first_touching(:)   !! pairs that hold every motion, should `closed` not do so
    type(contact_state) :: state

    state%basis = new_basis(scaled, closed)
    if (.not. state%basis%sound) state%basis = new_basis(scaled, closed .or. first_touching)
    call basic_solution(state%basis, scaled, scaled%gap, scaled%resultant, state%force, state%gap, state%approach)
  end function fresh_state

  !> One run of the simplex from `lifted` at no load to the state at full load.
  pure subroutine follow_load_from(scaled, state, lifted, solution, outcome, closed, ray)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(in) :: state
    real(wp), intent(in) :: lifted(:)                   !! basic variable of each pair at t = 0 [n]
    type(contact_solution), intent(inout) :: solution
    integer, intent(out) :: outcome
    logical, allocatable, intent(out) :: closed(:)
    real(wp), allocatable, intent(out) :: ray(:)
    type(contact_tableau) :: tableau
    integer :: pivot_limit

    pivot_limit = pivots_per_unknown*(size(scaled%gap) + size(scaled%resultant))
    tableau = new_tableau(scaled, state%basis, lifted, basic_values(state))
    call follow_load(tableau, pivot_limit, solution, outcome, closed, ray)
  end subroutine follow_load_from

  !> The basic variable of each pair: force where it is in the basis, gap elsewhere.
  pure function basic_values(state) result(values)
    type(contact_state), intent(in) :: state
    real(wp), allocatable :: values(:)

    values = state%gap
    values(state%basis%pairs) = state%force(state%basis%pairs)
  end function basic_values

  !> The same before the load: rigid bodies that just touch, with gaps g^.
  pure function unloaded_values(scaled, state) result(values)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(in) :: state
    real(wp), allocatable :: values(:)
    type(contact_state) :: rest

    rest%basis = state%basis
    call basic_solution(rest%basis, scaled, scaled%unloaded_gap, 0.0_wp*scaled%resultant, &
                        rest%force, rest%gap, rest%approach)
    values = max(basic_values(rest), 0.0_wp)
  end function unloaded_values

  !> Start values all apart from each other, against ties that rounding decides wrongly.
  pure function lifted_apart(state, attempt) result(values)
    type(contact_state), intent(in) :: state
    integer, intent(in) :: attempt
    real(wp), allocatable :: values(:)
    integer :: k, n

    values = basic_values(state)
    n = size(values)
    values = max(values, 0.0_wp) + [(1.0_wp + real(k, wp)/n, k=1, n)]/2.0_wp**attempt
  end function lifted_apart

  !> The test of the fresh solution: R >= 0 and w >= 0, to the rounding of the largest force and gap.
  pure function has_right_signs(scaled, state) result(right)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(in) :: state
    logical :: right
    real(wp) :: force_tolerance, gap_tolerance

    force_tolerance = sign_tolerance*maxval([abs(state%force), 1.0_wp])
    gap_tolerance = force_tolerance + noise*maxval([abs(scaled%gap), 0.0_wp])
    right = all(state%force >= -force_tolerance) .and. all(state%gap >= -gap_tolerance)
  end function has_right_signs

  !> Is z = `ray` really a proof that no solution exists: F z = 0, A'z = 0, z >= 0 and g'z < 0?
  pure function is_overlap(scaled, ray) result(overlap)
    type(scaled_problem), intent(in) :: scaled
    real(wp), intent(in) :: ray(:)
    logical :: overlap
    real(wp) :: largest

    largest = maxval([abs(ray), 0.0_wp])
    overlap = largest > 0.0_wp .and. all(ray >= -ray_tolerance*largest)
    if (.not. overlap) return
    overlap = all(abs(matmul(scaled%flexibility, ray)) <= ray_tolerance*largest) &
              .and. all(abs(matmul(ray, scaled%motion)) <= ray_tolerance*largest) &
              .and. dot_product(scaled%gap, ray) < -negligible*largest
  end function is_overlap

  !> The answer in the deck's units, and what the conditions leave open in it.
  pure subroutine settle(scaled, state, solution)
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(inout) :: state
    type(contact_solution), intent(inout) :: solution
    logical, allocatable :: pressed(:)
    real(wp) :: zero   !! force or gap that rounding leaves of none

    zero = negligible*maxval([state%force, 1.0_wp])
    state%gap(state%basis%pairs) = 0.0_wp
    solution%touching = state%gap <= zero
    where (solution%touching) state%gap = 0.0_wp
    where (state%force <= noise) state%force = 0.0_wp
    where (abs(state%approach) <= noise) state%approach = 0.0_wp
    pressed = state%force > zero
    solution%indeterminate = find_indeterminate_forces(scaled, solution%touching, pressed)
    call share_equally(scaled, solution%indeterminate, state%force)
    solution%motion_free(scaled%kept) = find_free_motions(scaled, solution%touching, pressed)
    call restore_units(scaled, state%force, state%gap, state%approach, solution)
  end subroutine settle
end module epcont_contact_simplex
