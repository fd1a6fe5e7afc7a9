!> Values of the rigid-body modes that contact leaves undetermined.
!>
!> The bodies move, with the pairs in contact closed, to the position without negative gaps and with the least
!> displacements (sum of squares), as equal springs would do. That is a contact problem of its own.
module epcont_contact_neutral_motions
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, negligible
  use epcont_contact_loose_motions, only: loose_motions
  use epcont_contact_problem, only: contact_problem, contact_solution, contact_solved
  use epcont_contact_solver, only: solve_contact
  use epcont_flexibility_motion_matrix, only: dense_motions, motion_matrix
  use epcont_linalg_dense, only: cholesky_factor, cholesky_solve
  implicit none
  private
  public :: choose_neutral

contains

  !> Choose the values of the undetermined modes of a solution. If this fails, the solution stays.
  subroutine choose_neutral(problem, solution)
    type(contact_problem), intent(in) :: problem        !! with displacements and body of each mode
    type(contact_solution), intent(inout) :: solution   !! its gaps and its approach are changed
    real(wp), allocatable :: loose(:, :), opening(:, :) ! undetermined modes, and the gaps that they open
    real(wp), allocatable :: moved(:, :), square(:, :)  ! displacements of these modes, and their products
    real(wp), allocatable :: change(:, :), given(:, :)  ! of the modes, in all and by a force at each gap
    integer, allocatable :: pair(:)                     ! pairs whose gaps they open
    real(wp), allocatable :: side(:)                    ! -1 if a slip must not be positive [these pairs]
    integer :: info

    call find_neutral(problem, problem%between(solution%force), loose, pair, opening)
    side = merge(-1.0_wp, 1.0_wp, solution%at_upper(pair))
    opening = opening*spread(side, 2, size(opening, 2))
    moved = displacements(problem, loose)
    square = matmul(transpose(moved), moved)
    call cholesky_factor(square, info)
    if (info /= 0) return
    associate (now => reshape(solution%approach, [size(solution%approach), 1]))
      change = -matmul(transpose(moved), displacements(problem, now))
    end associate
    given = transpose(opening)
    call cholesky_solve(square, change)
    call cholesky_solve(square, given)
    call keep_open(side*solution%gap(pair), opening, given, change(:, 1), info)
    if (info /= 0) return
    associate (approach => solution%approach, &
               before => abs(solution%approach) + matmul(abs(loose), abs(change(:, 1))))
      approach = approach + matmul(loose, change(:, 1))
      where (abs(approach) <= cancelled*before) approach = 0.0_wp
    end associate
    solution%gap(pair) = solution%gap(pair) + side*matmul(opening, change(:, 1))
  end subroutine choose_neutral

  !> Correct a change of the modes so that all gaps stay open. Few of them would close: only those that did
  !! are in the contact problem.
  subroutine keep_open(gap, opening, given, change, info)
    real(wp), intent(in) :: gap(:)           !! before the change [length] [pairs]
    real(wp), intent(in) :: opening(:, :)    !! by each mode [pairs, modes]
    real(wp), intent(in) :: given(:, :)      !! change of the modes by a force at each gap [modes, pairs]
    real(wp), intent(inout) :: change(:)     !! [modes]
    integer, intent(out) :: info             !! 0 if the gaps can be kept open
    real(wp), dimension(size(gap)) :: by_change, least, open
    real(wp) :: free(size(change))
    logical, dimension(size(gap)) :: closes, closed   ! now, and so far
    integer :: k

    free = change
    open = gap + matmul(opening, free)
    closed = .false.
    info = 0
    do
      by_change = matmul(opening, change)
      least = -negligible*(abs(gap) + matmul(abs(opening), abs(change)))
      closes = gap + by_change < least
      if (.not. any(closes .and. .not. closed)) return
      closed = closed .or. closes
      call hold(pack([(k, k=1, size(gap))], closed))
      if (info /= 0) return
    end do

  contains

    !> Solve the contact problem of some pairs.
    subroutine hold(pair)
      integer, intent(in) :: pair(:)
      type(contact_problem) :: springs
      type(contact_solution) :: held

      springs%flexibility = matmul(opening(pair, :), given(:, pair))
      springs%initial_gap = open(pair)
      springs%load_gap = 0.0_wp*open(pair)
      springs%motion = dense_motions(opening(pair, :0))
      springs%resultant = [real(wp) ::]
      call solve_contact(springs, held, any_forces=.true.)
      info = held%state - contact_solved
      if (info == 0) change = free + matmul(given(:, pair), held%force)
    end subroutine hold
  end subroutine keep_open

  !> Find modes that the pairs in contact do not restrain, and the gaps that they open. Whether a mode closes
  !! a gap is judged by the displacement of its body, not by the other gaps: for a body on a flat that is
  !! inclined slightly to the axes, one mode is almost along the flat.
  subroutine find_neutral(problem, pressed, loose, pair, opening)
    type(contact_problem), intent(in) :: problem
    logical, intent(in) :: pressed(:)                    !! [pairs]
    real(wp), allocatable, intent(out) :: loose(:, :)    !! [all modes, any]
    integer, allocatable, intent(out) :: pair(:)         !! pairs whose gaps they open
    real(wp), allocatable, intent(out) :: opening(:, :)  !! [these, any]
    type(motion_matrix) :: closing                       ! A, divided by displacements
    integer :: k

    associate (length => lengths(problem))
      closing = problem%motion%over(length)
      pair = [(k, k=1, size(pressed))]
      loose = loose_motions(closing, pack(pair, pressed), negligible)
      opening = -closing%of_each(loose, pair)
      where (abs(opening) <= negligible) opening = 0.0_wp
      pair = pack(pair, any(opening /= 0.0_wp, dim=2))
      opening = opening(pair, :)
      loose = loose/spread(length, 2, size(loose, 2))
    end associate
  end subroutine find_neutral

  !> Displacement of the body of each mode [length] [modes].
  pure function lengths(problem)
    type(contact_problem), intent(in) :: problem
    real(wp), allocatable :: lengths(:)

    lengths = problem%motion%units()
    if (allocated(problem%travel)) lengths = norm2(problem%travel, dim=1)
  end function lengths

  !> Displacements of the bodies by modes: the parts of all bodies, one below the other [length] [any, any].
  pure function displacements(problem, modes) result(moved)
    type(contact_problem), intent(in) :: problem
    real(wp), intent(in) :: modes(:, :)   !! [all modes, any]
    real(wp), allocatable :: moved(:, :)
    integer :: j, rows

    moved = spread(lengths(problem), 2, size(modes, 2))*modes
    if (.not. allocated(problem%travel)) return
    deallocate (moved)
    rows = size(problem%travel, 1)
    allocate (moved(rows*maxval([0, problem%body]), size(modes, 2)), source=0.0_wp)
    do j = 1, size(modes, 1)
      associate (own => moved(rows*(problem%body(j) - 1) + 1:rows*problem%body(j), :))
        own = own + matmul(problem%travel(:, j:j), modes(j:j, :))
      end associate
    end do
  end function displacements
end module epcont_contact_neutral_motions
