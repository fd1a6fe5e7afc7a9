!> From a contact problem to its answer: scaling, rigid start, the set of contacts by one rule or the other,
!> units.
module epcont_contact_solver
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, lost_digits, negligible, null_component, &
    solved_to
  use epcont_contact_basis, only: contact_basis, move_basis, new_basis, respond
  use epcont_contact_block_pivoting, only: find_by_blocks
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_flexibility_matrix, only: dense_flexibility
  use epcont_contact_loose_motions, only: loose_motions
  use epcont_contact_problem, only: contact_no_equilibrium, contact_overlap, contact_problem, &
    contact_solution, contact_solved, contact_stalled, new_solution
  use epcont_contact_scaling, only: drop_motions, scale_problem, scaled_problem
  use epcont_contact_simplex, only: find_contacts
  use epcont_contact_state, only: contact_state, gaps_under, solve_set, terms_of_gaps
  use epcont_contact_uniqueness, only: find_undetermined_motions, find_indeterminate_forces, share_equally
  use epcont_flexibility_motion_matrix, only: dense_motions, motion_matrix
  use epcont_linalg_dense, only: cholesky_factor, cholesky_solve
  implicit none
  private
  public :: solve_contact

contains

  !> Find forces, gaps and motions of a contact problem, or why there are none. Where motions are neutral, so
  !! that nothing tells their values, they are those nearest to zero that leave no gap below it.
  recursive subroutine solve_contact(problem, solution, start, by_blocks, basis, any_forces)
    type(contact_problem), intent(in), target :: problem   !! in the deck's units
    type(contact_solution), intent(out) :: solution   !! its state says whether there is one
    logical, intent(in), optional :: start(:)   !! guess of the pairs in contact [n]
    logical, intent(in), optional :: by_blocks  !! RULE BLOCK; not given: CONRY
    !> Of the last answer with this F, or none; then of this one
    type(contact_basis), intent(inout), optional :: basis
    logical, intent(in), optional :: any_forces   !! true: it is not asked whether there are other forces
    type(scaled_problem) :: scaled
    type(rigid_start) :: rigid
    type(motion_matrix) :: motion   ! A of all motions, scaled [n, m]
    logical :: blocks_first

    scaled = scale_problem(problem)
    motion = scaled%motion
    if (present(start)) scaled%guess = start
    solution = new_solution(size(scaled%gap), size(scaled%resultant))
    solution%gap = scaled%gap*scaled%gap_unit
    call find_rigid_start(motion, scaled%resultant, scaled%unloaded_gap, rigid)
    if (.not. rigid%balanced) then
      solution%state = contact_no_equilibrium
      solution%escape = rigid%escape/scaled%motion_size
      return
    end if
    scaled%first_touching = rigid%touching
    call drop_motions(scaled, rigid%redundant)
    blocks_first = .false.
    if (present(by_blocks)) blocks_first = by_blocks
    if (blocks_first) call solve_by_blocks()
    if (.not. solution%by_blocks) call solve_by_simplex()
    ! Rounding of a long path may hide a set that another way finds.
    if (solution%state == contact_stalled .and. .not. blocks_first) call solve_by_blocks()

  contains

    !> RULE BLOCK, where it finds forces that are the only ones; else nothing but the count of steps is left
    !! of it.
    subroutine solve_by_blocks()
      type(contact_solution) :: trial
      type(contact_state) :: state

      trial = solution
      if (present(basis)) call move_basis(basis, state%contact_basis)
      call find_by_blocks(scaled, trial, state, trial%by_blocks)
      solution%block_steps = trial%block_steps
      if (.not. trial%by_blocks) return
      call settle(state, trial)
      if (.not. any(trial%indeterminate)) solution = trial
    end subroutine solve_by_blocks

    !> RULE CONRY. Of no answer the cause may be that pairs hold a motion by so little that rounding of the
    !! loads along it is too large a force.
    subroutine solve_by_simplex()
      type(contact_state) :: state
      real(wp), allocatable :: loose(:, :), ray(:)
      integer :: k

      if (present(basis)) call move_basis(basis, state%contact_basis)
      call find_contacts(scaled, solution, state, ray)
      select case (solution%state)
      case (contact_overlap)
        solution%overlapping = ray > null_component*maxval(ray)
      case (contact_stalled)
        loose = loose_motions(motion, [(k, k=1, motion%pairs)], cancelled/solved_to)
        if (size(loose, 2) == 0) return
        solution%escape = loose(:, 1)/scaled%motion_size
        ray = abs(motion%times(loose(:, 1)))
        solution%overlapping = ray > 0.5_wp*maxval(ray)
      case default
        call settle(state, solution)
      end select
    end subroutine solve_by_simplex

    !> The answer in the deck's units, and what the conditions leave open in it.
    subroutine settle(state, solution)
      type(contact_state), intent(inout) :: state
      type(contact_solution), intent(inout) :: solution
      !> What gaps are the sum of; the motions have the rounding of those that hold them [n]
      real(wp), allocatable :: terms(:)
      real(wp) :: zero                    !! force that rounding leaves of none

      zero = negligible*maxval([state%force, 1.0_wp])
      call cut_rounding(state, terms)
      solution%approach(scaled%kept) = state%approach
      call find_touching(state, terms, solution%touching)
      solution%motion_free = find_undetermined_motions(motion, solution%touching, &
          state%force > lost_digits*maxval([state%force, 1.0_wp]))
      if (any(solution%motion_free)) then
        call open_pairs(state, state%force <= zero)
        call close_by_motions(state)
        solution%approach(scaled%kept) = state%approach
        call choose_neutral(state, solution%approach)
        call find_touching(state, terms, solution%touching)
      end if
      if (.not. present(any_forces)) then
        solution%indeterminate = find_indeterminate_forces(scaled, solution%touching, state%force > zero)
        call share_equally(scaled, solution%indeterminate, state%force)
        where (solution%indeterminate) state%change = state%force - scaled%known_force
      end if
      if (present(basis)) call move_basis(state%contact_basis, basis)
      ! In the deck's units.
      solution%force = state%force*scaled%force_unit
      solution%change = state%change*scaled%force_unit
      solution%gap = state%gap*scaled%gap_unit
      solution%approach = solution%approach*scaled%gap_unit/scaled%motion_size
    end subroutine settle

    !> Take their force from some pairs.
    pure subroutine open_pairs(state, chosen)
      type(contact_state), intent(inout) :: state
      logical, intent(in) :: chosen(:)        !! [n]

      where (chosen) state%force = 0.0_wp
      where (chosen) state%change = -scaled%known_force
    end subroutine open_pairs

    !> Close what forces that were taken from pairs leave of the gaps of others: in a slender body that is
    !! much. Pairs of the basis hold the motions, those without force as well.
    pure subroutine close_by_motions(state)
      type(contact_state), intent(inout) :: state
      real(wp), allocatable :: approach(:, :), change(:, :), gap(:), before(:)

      if (.not. state%sound) return
      before = gaps_under(scaled, scaled%gap, state%change, state%approach)
      call respond(state%contact_basis, reshape(before(state%pairs), [size(state%pairs), 1]), &
                   reshape(0*state%approach, [size(state%approach), 1]), change, approach)
      gap = gaps_under(scaled, scaled%gap, state%change, state%approach + approach(:, 1))
      associate (pressed => state%force > 0.0_wp)
        if (maxval([abs(gap), 0.0_wp], mask=[pressed, .true.]) >= &
            maxval([abs(before), 0.0_wp], mask=[pressed, .true.])) return
      end associate
      state%approach = state%approach + approach(:, 1)
      where (abs(state%gap) > 0.0_wp) state%gap = gap
    end subroutine close_by_motions

    !> Which pairs touch: no gap is left of theirs.
    pure subroutine find_touching(state, terms, touching)
      type(contact_state), intent(inout) :: state
      real(wp), intent(in) :: terms(:)        !! what gaps are the sum of [n]
      logical, intent(out) :: touching(:)     !! [n]

      where (state%force > 0.0_wp) state%gap = 0.0_wp
      touching = state%gap <= negligible*max(terms, maxval([terms(state%pairs), 0.0_wp]))
      where (touching) state%gap = 0.0_wp
    end subroutine find_touching

    !> Move the bodies, with the pressed pairs closed, to where no gap is below none and their travels are
    !! least (squares): where springs, all alike, would hold them. That is a contact problem.
    subroutine choose_neutral(state, approach)
      type(contact_state), intent(inout) :: state
      real(wp), intent(inout) :: approach(:)   !! scaled [m]
      type(contact_problem) :: springs
      type(contact_solution) :: held
      real(wp), allocatable :: loose(:, :), opening(:, :)   ! neutral motions, and the gaps that they open
      real(wp), allocatable :: square(:, :), travel(:, :)   ! of these motions
      real(wp), allocatable :: change(:, :), given(:, :)    ! of them, in all and by a force at each gap
      integer, allocatable :: pair(:)                       ! those whose gaps they open
      integer :: info

      call find_neutral(state%force > 0.0_wp, loose, pair, opening)
      travel = travels(loose)
      square = matmul(transpose(travel), travel)
      change = -matmul(transpose(travel), travels(reshape(approach, [size(approach), 1])))
      given = transpose(opening)
      call cholesky_factor(square, info)
      if (info /= 0) return
      call cholesky_solve(square, change)
      call cholesky_solve(square, given)
      springs%flexibility = dense_flexibility(matmul(opening, given))
      springs%initial_gap = state%gap(pair) + matmul(opening, change(:, 1))
      springs%load_gap = 0*springs%initial_gap
      springs%motion = dense_motions(opening(:, :0))
      allocate (springs%resultant(0))
      call solve_contact(springs, held, any_forces=.true.)
      if (held%state /= contact_solved) return
      change(:, 1) = change(:, 1) + matmul(given, held%force)
      associate (before => abs(approach) + matmul(abs(loose), abs(change(:, 1))))
        approach = approach + matmul(loose, change(:, 1))
        where (abs(approach) <= cancelled*before) approach = 0.0_wp
      end associate
      state%gap(pair) = state%gap(pair) + matmul(opening, change(:, 1))
    end subroutine choose_neutral

    !> Motions that pressed pairs do not hold, and the gaps that they open. Whether a motion closes a gap is
    !! told by how far it takes the body, not by what else it closes: of a body on a flat that leans by little
    !! against the axes, one motion is almost along it.
    subroutine find_neutral(pressed, loose, pair, opening)
      logical, intent(in) :: pressed(:)                          !! [n]
      real(wp), allocatable, intent(out) :: loose(:, :)          !! [m, any]
      integer, allocatable, intent(out) :: pair(:)               !! those whose gaps they open
      real(wp), allocatable, intent(out) :: opening(:, :)        !! [these, any]
      type(motion_matrix) :: closing                             ! A, by travels
      real(wp) :: length(size(scaled%motion_size))               ! of each motion, over the scaled unit
      integer :: k

      length = 1.0_wp
      if (allocated(problem%travel)) length = norm2(problem%travel, dim=1)/scaled%motion_size
      closing = problem%motion%over(length*scaled%motion_size)
      pair = [(k, k=1, size(pressed))]
      loose = loose_motions(closing, pack(pair, pressed), negligible)
      opening = -closing%of_each(loose, pair)
      where (abs(opening) <= negligible) opening = 0.0_wp
      pair = pack(pair, any(opening /= 0.0_wp, dim=2))
      opening = opening(pair, :)
      loose = loose/spread(length, 2, size(loose, 2))
    end subroutine find_neutral

    !> How far motions take the bodies: each body's part below that of the body before [any, motions].
    pure function travels(motions) result(travel)
      real(wp), intent(in) :: motions(:, :)   !! scaled [m, any]
      real(wp), allocatable :: travel(:, :)
      integer :: j, rows

      if (.not. allocated(problem%travel)) then
        travel = motions
        return
      end if
      rows = size(problem%travel, 1)
      allocate (travel(rows*maxval([0, problem%body]), size(motions, 2)), source=0.0_wp)
      do j = 1, size(motions, 1)
        associate (own => travel(rows*(problem%body(j) - 1) + 1:rows*problem%body(j), :))
          own = own + matmul(problem%travel(:, j:j)/scaled%motion_size(j), motions(j:j, :))
        end associate
      end do
    end function travels

    !> Forces and motions without what rounding has left of none. A force that is cut off may have been less
    !! than none: its pair need not be closed. Where rigid stops take the load, gaps may be far below the size
    !! that they are measured in, and that force may have held other pairs closed: those are solved for again.
    subroutine cut_rounding(state, terms)
      type(contact_state), intent(inout) :: state
      real(wp), allocatable, intent(out) :: terms(:)   !! what gaps are the sum of [n]
      type(contact_state) :: fewer
      logical, allocatable :: moving(:), pressed(:)

      do
        pressed = state%force > cancelled
        call open_pairs(state, .not. pressed)
        terms = terms_of_gaps(scaled, state)
        moving = abs(state%approach) > cancelled*maxval([terms(state%pairs), cancelled])
        if (all(moving) .and. all(pressed(state%pairs))) return
        where (.not. moving) state%approach = 0.0_wp
        terms = terms_of_gaps(scaled, state)
        state%gap = gaps_under(scaled, scaled%gap, state%change, state%approach)
        if (all(abs(state%gap) <= negligible*terms .or. .not. pressed) .or. &
            all(pressed(state%pairs))) return
        fewer%contact_basis = new_basis(scaled, pressed)
        if (.not. fewer%sound) return   ! a motion is held by rounding
        call solve_set(fewer, scaled, scaled%gap, scaled%resultant, refinements=1)
        call move_basis(fewer%contact_basis, state%contact_basis)
        state%force = fewer%force
        state%change = fewer%change
        state%gap = fewer%gap
        state%approach = fewer%approach
      end do
    end subroutine cut_rounding
  end subroutine solve_contact
end module epcont_contact_solver
