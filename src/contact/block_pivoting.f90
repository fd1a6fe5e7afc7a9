!> RULE BLOCK: block principal pivoting. All pairs of wrong sign change sides at once.
!>
!> A set of contacts is solved with a Cholesky factor; of its pairs those that pull open, of the others those
!> that overlap close (Kostreva 1978; Judice and Pires 1994). Without an earlier set it begins with few
!> candidates, every 2**k-th pair, and makes them twice as many whenever none of them is wrong: so the large
!> sets are nearly right when they are met. This may run in circles, and of many bodies it opens all pairs of
!> one: where the number of wrong pairs has not fallen in `patience` steps, or sets do not hold the motions,
!> the interior path leads to a set, from which it goes on.
!>
!> Only what is definite is solved here. Where forces of a set are not unique, or that is not enough, it says
!> so, and RULE CONRY has the problem.
module epcont_contact_block_pivoting
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: solved_to
  use epcont_contact_basis, only: change_set
  use epcont_contact_interior_path, only: follow_interior_path
  use epcont_contact_problem, only: contact_solution, contact_solved
  use epcont_contact_scaling, only: scaled_problem
  use epcont_contact_state, only: contact_state, guess_tolerance, has_right_signs, renew_state, solve_set
  implicit none
  private
  public :: find_by_blocks

  !> Part of the largest force by which forces and gaps may have the wrong sign while there is something to
  !! gain. Where rounding is larger the steps end without progress, and the test of the fresh solution
  !! decides. With 1e-11 sets are left that it refuses (tests/contact/test_block_pivoting, test_answers);
  !! 1e-15 does as well.
  real(wp), parameter :: exchange_tolerance = 1.0e-13_wp
  !> Steps without fewer wrong pairs before exchanges are given up.
  integer, parameter :: patience_limit = 10
  !> Steps from a guess, and from nothing where that fails. A full step costs less than 1/50 of what RULE
  !! CONRY takes.
  integer, parameter :: step_limit = 100
  !> Sets that do not hold the motions before exchanges are given up.
  integer, parameter :: repair_limit = 3
  !> Candidates of the first sets, at least.
  integer, parameter :: fewest_candidates = 32

contains

  !> Look for the set of contacts. `found`: its fresh solution passes the test of signs and its forces are
  !! unique.
  subroutine find_by_blocks(scaled, solution, state, found)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    type(contact_solution), intent(inout) :: solution   !! steps, and pairs exchanged
    type(contact_state), intent(inout) :: state   !! with any basis; the set found, fresh
    logical, intent(out) :: found   !! else `state` is of no use
    logical, dimension(size(scaled%gap)) :: closed, wrong   ! the set; pairs of it and others of wrong sign
    integer :: stride     ! of the candidates
    integer :: fewest     ! wrong pairs among these, at best
    integer :: patience   ! steps left to come below it

    found = .false.
    stride = 1
    if (allocated(scaled%guess)) then
      closed = scaled%guess .or. scaled%first_touching
      solution%block_steps = solution%block_steps + 1
      call test_afresh(guess_tolerance)
      if (.not. found) call look_for_set(guess_tolerance)
    end if
    if (.not. found) then
      closed = scaled%first_touching
      do while (size(closed)/(2*stride) >= fewest_candidates)
        stride = 2*stride
      end do
      call look_for_set(solved_to)
    end if
    if (.not. found) then
      stride = 1
      if (allocated(state%level)) deallocate (state%level)
      call follow_interior_path(scaled, closed, solution%block_steps)
      call test_afresh(solved_to)
      if (.not. found) call look_for_set(solved_to)
    end if
    if (found) solution%state = contact_solved

  contains

    !> The fresh solution of the set: are its forces unique and its signs right?
    subroutine test_afresh(tolerance)
      real(wp), intent(in) :: tolerance

      call renew_state(state, scaled, closed)
      found = size(state%pairs) == count(closed)
      if (found) found = has_right_signs(scaled, state, tolerance)
    end subroutine test_afresh

    !> Exchange, and test the set that this ends with; by then no other factor is there.
    subroutine look_for_set(tolerance)
      real(wp), intent(in) :: tolerance   !! of the test
      logical :: ended

      if (allocated(state%level)) deallocate (state%level)
      call exchange_blocks(ended)
      if (ended) call test_afresh(tolerance)
    end subroutine look_for_set

    !> Exchange until no pair is wrong, or that leads nowhere. Not `ended` if there were sets without an own
    !! solution: more pairs may hold the motions, but do not mend forces that depend on each other.
    subroutine exchange_blocks(ended)
      logical, intent(out) :: ended
      type(contact_state) :: trial
      real(wp) :: firmness(size(closed))
      integer :: repairs, step

      ended = .false.
      fewest = huge(fewest)
      firmness = 0.0_wp
      repairs = 0
      do step = 1, step_limit
        solution%block_steps = solution%block_steps + 1
        call change_set(trial%contact_basis, scaled, closed, firmness)
        if (trial%sound) then
          call solve_set(trial, scaled, scaled%gap, scaled%resultant, refinements=0)
          call find_wrong(trial)
          patience = merge(patience_limit, patience - 1, count(wrong) < fewest)
          if (patience < 0 .or. .not. any(wrong)) exit
          fewest = min(fewest, count(wrong))
          solution%pivots = solution%pivots + count(wrong)
          firmness = part_of_largest(trial%force) + part_of_largest(-trial%gap)
          closed = closed .neqv. wrong
        else
          if (repairs == repair_limit .or. all(closed .or. .not. scaled%first_touching)) return
          repairs = repairs + 1
          closed = closed .or. scaled%first_touching
        end if
      end do
      ended = .true.
    end subroutine exchange_blocks

    !> The wrong pairs among the candidates; where there is none, among more of them.
    subroutine find_wrong(trial)
      type(contact_state), intent(in) :: trial
      logical :: all_wrong(size(closed))
      real(wp) :: force_tolerance, gap_tolerance
      integer :: k

      force_tolerance = exchange_tolerance*maxval([abs(trial%force), 1.0_wp])
      gap_tolerance = force_tolerance + exchange_tolerance*maxval([abs(scaled%gap), 0.0_wp])
      all_wrong = merge(trial%force < -force_tolerance, trial%gap < -gap_tolerance, closed)
      do
        wrong = all_wrong .and. (closed .or. scaled%first_touching .or. &
                                 [(mod(k - 1, stride) == 0, k=1, size(closed))])
        if (any(wrong) .or. stride == 1) exit
        stride = stride/2
        fewest = huge(fewest)
      end do
    end subroutine find_wrong
  end subroutine find_by_blocks

  !> Positive values as parts of the largest.
  pure function part_of_largest(values) result(part)
    real(wp), intent(in) :: values(:)
    real(wp) :: part(size(values))

    part = max(values, 0.0_wp)/maxval([values, tiny(1.0_wp)])
  end function part_of_largest
end module epcont_contact_block_pivoting
