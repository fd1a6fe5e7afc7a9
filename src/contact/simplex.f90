!> RULE CONRY: simplex with a contact entry rule, from rigid bodies to the tested active set.
!>
!> The resulting set is always tested: forces and gaps are computed again from F and A, and if one of them
!> has the wrong sign, the simplex continues from there. A guessed set is treated in the same way.
!>
!> On smooth, badly conditioned flexibilities (1e10), pairs close and open many times while the load
!> grows: the path takes some n**2/20 pivots, and the tableau's entries, which grow to the condition number
!> and fall again, lose as many digits. Such a path is abandoned: block pivoting decides, which solves each
!> set with its own factor (Kostreva 1978; Judice and Pires 1994).
module epcont_contact_simplex
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, negligible, null_component, solved_to
  use epcont_contact_friction_attempts, only: exchange
  use epcont_contact_friction_state, only: friction_bounds, friction_problem, friction_state, pair_states
  use epcont_contact_loading, only: follow_load
  use epcont_contact_problem, only: contact_overlap, contact_solution, contact_solved, contact_stalled
  use epcont_contact_scaling, only: gaps_by_forces, scaled_problem
  use epcont_contact_state, only: basic_values, contact_state, guess_tolerance, has_right_signs, &
    renew_state, solve_set
  implicit none
  private
  public :: find_contacts

  !> Maximum number of fresh starts.
  integer, parameter :: restart_limit = 10

contains

  !> Follow the load from one active set to the next until a fresh solution passes the sign test.
  subroutine find_contacts(scaled, solution, state, ray)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    type(contact_solution), intent(inout) :: solution   !! state, and the record of the pivots
    type(contact_state), intent(inout) :: state   !! with any basis; then the set found, solved again
    real(wp), allocatable, intent(out) :: ray(:)        !! if the state is overlap [n]
    real(wp), allocatable :: lifted(:)   ! basic variable of each pair at t = 0 [n]
    logical, allocatable :: closed(:)    ! the set [n]
    integer :: attempt, k
    logical :: complete, found

    closed = scaled%first
    if (allocated(scaled%guess)) closed = closed .or. scaled%guess
    call take_set(closed)
    if (state%sound .and. .not. allocated(scaled%guess)) lifted = unloaded_values()
    do attempt = 0, restart_limit
      if (.not. state%sound) exit   ! the modes are too badly restrained
      solution%state = contact_solved
      if (has_right_signs(scaled, state, merge(guess_tolerance, solved_to, attempt == 0))) return
      solution%restarts = attempt
      call follow_load(scaled, state, lifted, solution, complete, closed, ray)
      if (allocated(ray)) then
        if (is_overlap(ray)) then
          solution%state = contact_overlap
          return
        end if
      end if
      if (complete .and. mod(attempt, 2) == 0) then
        call take_set(closed)
        if (has_right_signs(scaled, state, solved_to)) return
      else
        call take_set(scaled%first)
        ! Use distinct values, against ties that rounding decides wrongly.
        lifted = lifted + [(1.0_wp + real(k, wp)/size(lifted), k=1, size(lifted))]/2.0_wp**attempt
      end if
      if (attempt > 0) cycle
      call exchange_afresh(found)
      if (found) return
    end do
    if (.not. has_right_signs(scaled, state, solved_to)) solution%state = contact_stalled

  contains

    !> Continue from a set, with the negative variables of its solution lifted to zero.
    subroutine take_set(set)
      logical, intent(in) :: set(:)

      call renew_state(state, scaled, set)
      lifted = max(basic_values(state), 0.0_wp)
    end subroutine take_set

    !> Basic variables before the load: rigid bodies in contact without force, with gaps g^.
    pure function unloaded_values() result(values)
      real(wp) :: values(size(scaled%gap))
      type(contact_state) :: rest

      rest%contact_basis = state%contact_basis
      call solve_set(rest, scaled, scaled%unloaded_gap + gaps_by_forces(scaled, scaled%known_force), &
                     0.0_wp*scaled%resultant, refinements=1)
      values = max(basic_values(rest), 0.0_wp)
    end function unloaded_values

    !> Run block pivoting from the first set.
    subroutine exchange_afresh(found)
      logical, intent(out) :: found
      type(contact_state) :: better
      type(friction_problem) :: smooth
      type(friction_bounds) :: without
      type(friction_state) :: trial
      integer, dimension(size(scaled%gap)) :: none
      integer :: sets

      none = 0
      sets = 0
      smooth = friction_problem(scaled, size(none), tangent=none, mu=0.0_wp*none, inert=none)
      without = friction_bounds(coulomb=.false., given=0.0_wp*none)
      call exchange(smooth, without, pair_states(scaled%first, none), trial, sets, found)
      call renew_state(better, scaled, trial%states%closed .or. scaled%first)
      found = has_right_signs(scaled, better, solved_to)
      if (.not. found) return
      solution%state = contact_solved
      state = better
    end subroutine exchange_afresh

    !> Does z prove that there is no solution: F z = 0, A'z = 0, z >= 0 and g'z < 0?
    pure logical function is_overlap(z) result(overlap)
      real(wp), intent(in) :: z(:)
      real(wp) :: nothing(size(z))   !! rounding of F z [n]
      real(wp) :: largest

      largest = maxval([abs(z), 0.0_wp])
      overlap = largest > 0.0_wp .and. all(z >= -null_component*largest)
      if (.not. overlap) return
      ! A small flexibility counts, too, if it is above rounding.
      nothing = max(null_component*gaps_by_forces(scaled, z, magnitudes=.true.), cancelled*largest)
      overlap = all(abs(gaps_by_forces(scaled, z)) <= nothing) &
                .and. all(abs(scaled%motion%carried(z)) <= null_component*largest) &
                .and. dot_product(scaled%gap, z) < -negligible*largest
    end function is_overlap
  end subroutine find_contacts
end module epcont_contact_simplex
