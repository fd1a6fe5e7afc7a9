!> Random contact problems for the tests, the same in every run, and the conditions for their solutions.
module random_problem
  use epcont_base_kinds, only: i8, wp
  use epcont_contact_problem, only: contact_problem, contact_solution
  use epcont_flexibility_motion_matrix, only: dense_motions
  implicit none
  private
  public :: generator, new_problem, residual_of, is_escape, rescaled

  !> A small linear congruential generator; its state is its only memory.
  type :: generator
    integer(i8) :: state = 12345_i8
  contains
    procedure :: uniform
    procedure :: below
    procedure :: chance
  end type generator

contains

  !> Uniform from 0 to 1 (Lehmer, 48271 modulo 2**31 - 1).
  function uniform(self) result(number)
    class(generator), intent(inout) :: self
    real(wp) :: number

    self%state = mod(48271_i8*self%state, 2147483647_i8)
    number = real(self%state, wp)/2147483647.0_wp
  end function uniform

  !> An integer from 0 to limit - 1.
  function below(self, limit) result(number)
    class(generator), intent(inout) :: self
    integer, intent(in) :: limit
    integer :: number

    number = min(int(self%uniform()*limit), limit - 1)
  end function below

  !> True with the given probability.
  function chance(self, probability) result(yes)
    class(generator), intent(inout) :: self
    real(wp), intent(in) :: probability
    logical :: yes

    yes = self%uniform() < probability
  end function chance

  !> n pairs and m modes with random difficulties: singular F, repeated and zero rows, ties,
  !> gaps all zero, overlaps, loads in the gaps, loads without equilibrium or no load at all.
  function new_problem(random, n, m) result(problem)
    type(generator), intent(inout) :: random
    integer, intent(in) :: n, m
    type(contact_problem) :: problem
    real(wp), allocatable :: motion(:, :)
    logical :: whole

    whole = random%chance(0.4_wp)   ! small integers make ties
    motion = matrix(random, n, m, whole)
    if (random%chance(0.5_wp)) motion = abs(motion)
    if (m > 0 .and. random%chance(0.5_wp)) motion(:, 1) = 1.0_wp
    problem%motion = dense_motions(motion)
    problem%flexibility = semidefinite(random, n, whole)
    problem%initial_gap = gaps(random, n, whole)
    allocate (problem%load_gap(n), source=0.0_wp)
    if (random%chance(0.3_wp)) problem%load_gap = pack(matrix(random, n, 1, whole), .true.)
    problem%resultant = resultant(random, motion, whole)
    call spoil(random, problem)
  end function new_problem

  !> Entries from -1 to 1, or integers from -2 to 2.
  function matrix(random, n, m, whole) result(entry)
    type(generator), intent(inout) :: random
    integer, intent(in) :: n, m
    logical, intent(in) :: whole
    real(wp), allocatable :: entry(:, :)
    integer :: i, j

    allocate (entry(n, m))
    do j = 1, m
      do i = 1, n
        entry(i, j) = 2*random%uniform() - 1
        if (whole) entry(i, j) = real(nint(2*entry(i, j)), wp)
      end do
    end do
  end function matrix

  !> GG', with G of few columns in a third of the cases.
  function semidefinite(random, n, whole) result(flexibility)
    type(generator), intent(inout) :: random
    integer, intent(in) :: n
    logical, intent(in) :: whole
    real(wp), allocatable :: flexibility(:, :)
    real(wp), allocatable :: g(:, :)
    integer :: columns

    columns = n + 1
    if (random%chance(0.35_wp)) columns = random%below(n + 1)
    g = matrix(random, n, columns, whole)
    flexibility = matmul(g, transpose(g))
    flexibility = (flexibility + transpose(flexibility))/2
  end function semidefinite

  !> Gaps all positive, of both signs, or all zero.
  function gaps(random, n, whole) result(gap)
    type(generator), intent(inout) :: random
    integer, intent(in) :: n
    logical, intent(in) :: whole
    real(wp), allocatable :: gap(:)

    gap = pack(matrix(random, n, 1, whole), .true.)
    if (random%chance(0.6_wp)) gap = abs(gap)
    if (random%chance(0.15_wp)) gap = 0.0_wp
  end function gaps

  !> A load that some forces R >= 0 balance, any load, or none.
  function resultant(random, motion, whole) result(load)
    type(generator), intent(inout) :: random
    real(wp), intent(in) :: motion(:, :)
    logical, intent(in) :: whole
    real(wp), allocatable :: load(:)

    load = matmul(abs(pack(matrix(random, size(motion, 1), 1, whole), .true.)), motion)
    if (random%chance(0.15_wp)) load = pack(matrix(random, size(motion, 2), 1, whole), .true.)
    if (random%chance(0.05_wp)) load = 0.0_wp
  end function resultant

  !> Repeat a pair, or make one rigid.
  subroutine spoil(random, problem)
    type(generator), intent(inout) :: random
    type(contact_problem), intent(inout) :: problem
    real(wp), allocatable :: motion(:, :)
    integer :: from, n, to

    n = size(problem%initial_gap)
    if (n < 2) return
    from = 1 + random%below(n)
    to = 1 + random%below(n)
    if (random%chance(0.2_wp)) then
      problem%flexibility(to, :) = problem%flexibility(from, :)
      problem%flexibility(:, to) = problem%flexibility(:, from)
      motion = problem%motion%dense()
      motion(to, :) = motion(from, :)
      problem%motion = dense_motions(motion)
      problem%load_gap(to) = problem%load_gap(from)
      if (random%chance(0.7_wp)) problem%initial_gap(to) = problem%initial_gap(from)
    else if (random%chance(0.1_wp)) then
      problem%flexibility(to, :) = 0.0_wp
      problem%flexibility(:, to) = 0.0_wp
    end if
  end subroutine spoil

  !> Largest violation of the conditions (3-2)..(3-5), relative to the largest quantity of its type. For a
  !> semidefinite F they are sufficient: a solution that satisfies them is correct.
  function residual_of(problem, solution) result(residual)
    type(contact_problem), intent(in) :: problem
    type(contact_solution), intent(in) :: solution
    real(wp) :: residual
    real(wp), allocatable :: gap_error(:), inside(:), load_error(:)
    real(wp) :: gap_size, force_size, load_size

    gap_error = problem%initial_gap + problem%load_gap + matmul(problem%flexibility, solution%force) &
                - problem%motion%times(solution%approach) - solution%gap
    load_error = problem%motion%carried(solution%force) - problem%resultant
    force_size = largest(solution%force)
    gap_size = maxval([largest(problem%initial_gap), largest(problem%load_gap), tiny(1.0_wp), &
                       largest(pack(problem%flexibility, .true.))*force_size, &
                       largest(problem%motion%closing)*largest(solution%approach)])
    ! All lengths are zero: no gap, no flexibility. Then rounding has no scale.
    if (max(largest(problem%initial_gap), largest(problem%load_gap), &
            largest(pack(problem%flexibility, .true.))) <= 0.0_wp) gap_size = huge(1.0_wp)
    if (any(problem%flexibility /= 0.0_wp)) then
      force_size = max(force_size, gap_size/largest(pack(problem%flexibility, .true.)))
    end if
    force_size = max(force_size, tiny(1.0_wp))
    load_size = max(largest(problem%resultant), force_size*largest(problem%motion%closing), tiny(1.0_wp))
    inside = min(solution%force, force_size)/force_size
    residual = maxval([abs(gap_error)/gap_size, -inside, max(solution%gap, 0.0_wp)/gap_size*inside, &
                       max(-solution%gap, 0.0_wp)/gap_size, abs(load_error)/load_size, 0.0_wp])
  end function residual_of

  !> Largest absolute value; 0 if empty.
  pure function largest(values)
    real(wp), intent(in) :: values(:)
    real(wp) :: largest

    largest = 0.0_wp
    if (size(values) > 0) largest = maxval(abs(values))
  end function largest

  !> Does the load drive mode y, and can no forces resist it: P'y > 0 and A y <= 0?
  function is_escape(problem, motion) result(escape)
    type(contact_problem), intent(in) :: problem
    real(wp), intent(in) :: motion(:)
    logical :: escape
    real(wp), allocatable :: closing(:)

    closing = problem%motion%times(motion)
    escape = dot_product(problem%resultant, motion) > 0.0_wp .and. all(closing <= 1.0e-9_wp*maxval(abs(motion)))
  end function is_escape

  !> The same problem with forces and lengths in other units.
  function rescaled(problem, force_factor, gap_factor) result(other)
    type(contact_problem), intent(in) :: problem
    real(wp), intent(in) :: force_factor   !! number of new units in one old unit of force
    real(wp), intent(in) :: gap_factor     !! the same for lengths
    type(contact_problem) :: other

    other = problem
    other%flexibility = problem%flexibility*(gap_factor/force_factor)
    other%initial_gap = problem%initial_gap*gap_factor
    other%load_gap = problem%load_gap*gap_factor
    other%resultant = problem%resultant*force_factor
  end function rescaled
end module random_problem
