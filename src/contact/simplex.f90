!> RULE CONRY: the simplex with a contact entry rule, from rigid bodies to the certified set of contacts.
!>
!> The set found is never trusted: forces and gaps are solved afresh from F and A, and if one of them
!> has the wrong sign the simplex goes on from there. A guessed set is treated in the same way.
module epcont_contact_simplex
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: basic_solution
  use epcont_contact_loading, only: follow_load, path_complete, path_ray
  use epcont_contact_problem, only: contact_overlap, contact_solution, contact_solved, contact_stalled
  use epcont_contact_scaling, only: negligible, scaled_problem
  use epcont_contact_state, only: basic_values, contact_state, fresh_state, has_right_signs
  use epcont_contact_tableau, only: contact_tableau, new_tableau
  implicit none
  private
  public :: find_contacts

  !> Part of its forces by which a ray may miss F z = 0 and A'z = 0.
  real(wp), parameter, public :: ray_tolerance = 1.0e-7_wp
  !> Pivots allowed for each unknown before the order of ties is given up for broken.
  integer, parameter :: pivots_per_unknown = 10
  !> Fresh starts before the problem is given up.
  integer, parameter :: restart_limit = 10

contains

  !> Follow the load from one set of contacts to the next until a fresh solution passes the test of signs.
  pure subroutine find_contacts(scaled, first_touching, guess, solution, state, ray)
    type(scaled_problem), intent(in) :: scaled
    logical, intent(in) :: first_touching(:)            !! pairs that hold every motion [n]
    logical, allocatable, intent(in) :: guess(:)        !! of the pairs in contact, if allocated [n]
    type(contact_solution), intent(inout) :: solution   !! state, and the record of the pivots
    type(contact_state), intent(out) :: state
    real(wp), allocatable, intent(out) :: ray(:)        !! if the state is overlap [n]
    real(wp), allocatable :: lifted(:)
    logical, allocatable :: closed(:)
    integer :: attempt, outcome

    closed = first_touching
    if (allocated(guess)) closed = closed .or. guess
    state = fresh_state(scaled, closed, first_touching)
    lifted = unloaded_values(scaled, state)
    if (allocated(guess)) lifted = max(basic_values(state), 0.0_wp)
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
end module epcont_contact_simplex
