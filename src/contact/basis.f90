!> The contact equations for a given set S of pairs in contact, factored from F and A, and their solution.
!>
!>     F_SS R_S - A_S q = -h,   A_S' R_S = p
!>
!> F_SS may be singular though the forces are unique (a pair between held nodes is a row of zeros).
!> F_g = F + A gamma A' is definite whenever they are unique, and since A'R = p it changes only the
!> motion: q comes out larger by gamma p, gamma a diagonal matrix. So what is factored is
!>
!>     [ F_g,SS  -A_S ]
!>     [ -A_S'    0   ]
!>
!> level by level (`contact/flexibility_matrix`), in each the pairs first, then the motions that close no gaps
!> of later levels; their pivots are negative where the pairs hold them.
!>
!> A set is factored afresh, or, where sets change by blocks and all pairs are one level, from the one before:
!> pairs that are likely to stay stand first, the factor is kept up to the first pair that has gone, and only
!> the rows below it are factored anew:
!>
!>     +------+
!>     | kept |         pairs of large force
!>     +------+------+
!>     |     new     |  pairs at the edges of the contact, and those that came; motions
!>     +------+------+
module epcont_contact_basis
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_base_tolerances, only: lost_digits
  use epcont_contact_level_factor, only: factor_levels, level_factor, motions_of, solve_levels
  use epcont_contact_scaling, only: scaled_problem
  implicit none
  private
  public :: contact_basis, new_basis, renew_basis, move_basis, are_independent, change_set, factor_all, &
    respond

  !> Part of a set from which on its factor is kept. With 1/2, where pairs that come as the candidates are
  !! doubled stand behind edges that go, block pivoting takes half as long again; without keeping anything it
  !! does so too.
  real(wp), parameter :: worth_keeping = 0.75_wp
  !> Firmness is told apart to this part of the largest.
  real(wp), parameter :: firmness_steps = 1.0e6_wp

  !> A set of pairs in contact whose forces are unique, and the factor that gives them.
  type :: contact_basis
    logical :: sound = .false.           !! the forces are unique, and the pairs hold every motion
    integer, allocatable :: pairs(:)     !! S, level by level [s]
    integer :: motions = 0               !! m
    integer, allocatable :: pair_row(:), motion_row(:)   !! of them in the factor [s], [m]
    integer, allocatable :: kept(:)      !! which of the given motions these are [m]
    real(wp), allocatable :: gamma(:)    !! weight of each motion in F_g [m]
    real(wp) :: scale = 0.0_wp           !! of F
    type(level_factor), allocatable :: level(:)
  end type contact_basis

contains

  !> Factor the equations of the chosen pairs. Pairs whose force depends on that of others are left out.
  type(contact_basis) function new_basis(scaled, chosen, held) result(basis)
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: chosen(:)             !! [n]
    logical, intent(in), optional :: held        !! all motions, at zero: F_g alone is factored
    logical :: definite

    call choose_pairs(basis, scaled, chosen, held)
    call factor_levels(basis%level, scaled, 0, lost_digits, definite, basis%sound)
    if (.not. definite) then
      ! The order of pivots, which takes longer, tells who depends on whom.
      call choose_pairs(basis, scaled, chosen, held)
      call factor_levels(basis%level, scaled, 0, 0.0_wp, definite, basis%sound, scaled%rank_tolerance)
    end if
    call gather_pairs(basis)
  end function new_basis

  !> Factor the equations of the chosen pairs, if that is not what the basis has: then F must be the same.
  subroutine renew_basis(basis, scaled, chosen)
    type(contact_basis), intent(inout) :: basis   !! none, or of any set
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: chosen(:)             !! [n]
    logical :: same

    same = basis%sound .and. allocated(basis%level)
    if (same) same = size(basis%pairs) == count(chosen) .and. size(basis%kept) == size(scaled%kept)
    if (same) same = all(chosen(basis%pairs)) .and. all(basis%kept == scaled%kept) .and. &
                     all(abs(basis%gamma - scaled%gamma) <= 0.0_wp) .and. &
                     abs(basis%scale - scaled%flexibility_scale) <= 0.0_wp
    if (same) return
    if (allocated(basis%level)) deallocate (basis%level)
    basis = new_basis(scaled, chosen)
  end subroutine renew_basis

  !> Hand a basis over; none is left.
  subroutine move_basis(from, to)
    type(contact_basis), intent(inout) :: from   !! may be none
    type(contact_basis), intent(out) :: to       !! the same
    type(level_factor), allocatable :: level(:)

    call move_alloc(from%level, level)
    to = from
    call move_alloc(level, to%level)
  end subroutine move_basis

  !> Does clearly no force of the chosen pairs depend on others, whatever the motions are?
  logical function are_independent(scaled, chosen) result(independent)
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: chosen(:)             !! [n]
    type(contact_basis) :: basis

    call choose_pairs(basis, scaled, chosen, held=.true.)
    call factor_levels(basis%level, scaled, 0, lost_digits, independent, basis%sound)
  end function are_independent

  !> Factor the equations of all pairs, each with a flexibility of its own that makes its force unique.
  subroutine factor_all(basis, scaled)
    type(contact_basis), intent(inout) :: basis   !! none yet, or that of all pairs
    type(scaled_problem), intent(in) :: scaled    !! in its own units
    logical :: definite

    if (.not. allocated(basis%level)) then
      call choose_pairs(basis, scaled, spread(.true., 1, size(scaled%gap)))
      call gather_pairs(basis)
    end if
    call factor_levels(basis%level, scaled, 0, 0.0_wp, definite, basis%sound)
  end subroutine factor_all

  !> Levels with the chosen pairs.
  subroutine choose_pairs(basis, scaled, chosen, held)
    type(contact_basis), intent(inout) :: basis
    type(scaled_problem), intent(in) :: scaled
    logical, intent(in) :: chosen(:)
    logical, intent(in), optional :: held   !! true: without motions
    integer, allocatable :: own(:)
    integer :: l

    call begin_levels(basis, scaled)
    do l = 1, size(basis%level)
      own = scaled%flexibility%level(l)%pair
      basis%level(l)%pair = pack(own, chosen(own))
      if (present(held)) basis%level(l)%motion = pack(basis%level(l)%motion, .not. held)
    end do
    if (.not. present(held)) return
    basis%gamma = pack(basis%gamma, .not. held)
    basis%motions = size(basis%gamma)
  end subroutine choose_pairs

  !> Go over to another set. Without unique forces the basis is not sound, and nothing is kept of its factor.
  subroutine change_set(basis, scaled, closed, firmness)
    type(contact_basis), intent(inout) :: basis   !! none yet, or that of the set before
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: closed(:)      !! the set [n]
    real(wp), intent(in) :: firmness(:)   !! how likely pairs are to stay, largest first [n]
    logical :: definite
    integer :: kept, l, room

    if (.not. allocated(basis%level)) then
      call begin_levels(basis, scaled)
      if (size(basis%level) == 1) then   ! room for all pairs
        room = size(closed) + size(basis%level(1)%motion)
        allocate (basis%level(1)%factor(room, room))
      end if
    end if
    do l = 1, size(basis%level)
      call change_level(basis%level(l), scaled%flexibility%level(l)%pair)
    end do
    if (size(basis%level) > 1) kept = 0
    call factor_levels(basis%level, scaled, kept, scaled%rank_tolerance, definite, basis%sound)
    if (.not. definite) then
      basis%sound = .false.
      do l = 1, size(basis%level)
        basis%level(l)%pair = [integer ::]
      end do
    end if
    call gather_pairs(basis)

  contains

    !> The set in one level; `kept` rows of its factor remain.
    subroutine change_level(level, own)
      type(level_factor), intent(inout) :: level
      integer, intent(in) :: own(:)   !! all its pairs
      integer, allocatable :: added(:)
      logical :: missing(size(closed))

      kept = findloc([closed(level%pair), .false.], .false., dim=1) - 1
      ! Where much is new, all are put into order, so that the next sets keep most of it.
      if (kept < worth_keeping*count(closed(own))) kept = 0
      missing = closed
      missing(level%pair(:kept)) = .false.
      added = pack(own, missing(own))
      added = added(sorted_order(nint(-firmness_steps*firmness(added))))
      level%pair = [level%pair(:kept), added]
    end subroutine change_level
  end subroutine change_set

  !> Levels without pairs, with their motions.
  pure subroutine begin_levels(basis, scaled)
    type(contact_basis), intent(inout) :: basis
    type(scaled_problem), intent(in) :: scaled
    integer :: l

    basis%gamma = scaled%gamma
    basis%scale = scaled%flexibility_scale
    basis%kept = scaled%kept
    basis%motions = size(scaled%motion_level)
    if (allocated(basis%level)) deallocate (basis%level)
    allocate (basis%level(size(scaled%flexibility%level)))
    do l = 1, size(basis%level)
      basis%level(l)%pair = [integer ::]
      basis%level(l)%motion = motions_of(scaled, l)
    end do
  end subroutine begin_levels

  !> The pairs of all levels, and the rows that pairs and motions have in the factor.
  pure subroutine gather_pairs(basis)
    type(contact_basis), intent(inout) :: basis
    integer, allocatable :: motion(:)
    integer :: k, l, n, pairs, rows

    pairs = sum([(size(basis%level(l)%pair), l=1, size(basis%level))])
    if (allocated(basis%pairs)) deallocate (basis%pairs, basis%pair_row, basis%motion_row)
    allocate (basis%pairs(pairs), basis%pair_row(pairs), basis%motion_row(basis%motions))
    pairs = 0
    rows = 0
    do l = 1, size(basis%level)
      n = size(basis%level(l)%pair)
      basis%pairs(pairs + 1:pairs + n) = basis%level(l)%pair
      basis%pair_row(pairs + 1:pairs + n) = [(rows + k, k=1, n)]
      motion = basis%level(l)%motion
      basis%motion_row(motion) = [(rows + n + k, k=1, size(motion))]
      pairs = pairs + n
      rows = rows + n + size(motion)
    end do
  end subroutine gather_pairs

  !> Forces and motions for right-hand sides h and p; call only if the basis is sound.
  pure subroutine respond(basis, opening, load, force, approach)
    type(contact_basis), intent(in) :: basis   !! a sound one
    real(wp), intent(in) :: opening(:, :)      !! h, gaps of the pairs without forces [s, k]
    real(wp), intent(in) :: load(:, :)         !! p [m, k]
    real(wp), allocatable, intent(out) :: force(:, :)      !! R_S [s, k]
    real(wp), allocatable, intent(out) :: approach(:, :)   !! q [m, k]
    real(wp), allocatable :: x(:, :)     ! forces and motions

    allocate (x(size(basis%pairs) + basis%motions, size(opening, 2)))
    x(basis%pair_row, :) = -opening
    x(basis%motion_row, :) = -load
    call solve_levels(basis%level, x)
    force = x(basis%pair_row, :)
    approach = x(basis%motion_row, :) - spread(basis%gamma, 2, size(load, 2))*load
  end subroutine respond

end module epcont_contact_basis
