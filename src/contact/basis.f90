!> The contact equations for a given set S of pairs in contact, factored from F and A, and their solution.
!>
!>     F_SS R_S - A_S q = -h,   A_S' R_S = p
!>
!> F_SS may be singular though the forces are unique (a pair between held nodes is a row of zeros).
!> F_g = F + gamma A A' is definite whenever they are unique, and since A'R = p it changes only the
!> motion: q comes out larger by gamma p. So what is factored is
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
  use epcont_contact_scaling, only: scaled_problem
  use epcont_linalg_dense, only: pivoted_cholesky
  use epcont_linalg_saddle, only: factor_saddle, pass_on, substitute, substitute_back
  implicit none
  private
  public :: contact_basis, new_basis, renew_basis, move_basis, are_independent, change_set, respond

  !> Part of a set from which on its factor is kept. With 1/2, where pairs that come as the candidates are
  !! doubled stand behind edges that go, block pivoting takes half as long again; without keeping anything it
  !! does so too.
  real(wp), parameter :: worth_keeping = 0.75_wp
  !> Firmness is told apart to this part of the largest.
  real(wp), parameter :: firmness_steps = 1.0e6_wp

  !> Pairs and motions of one level, and their columns of the factor.
  type :: basis_level
    integer, allocatable :: pair(:)      !! of S, in the order of the factor
    integer, allocatable :: motion(:)    !! none, where they are held
    real(wp), allocatable :: factor(:, :)   !! own rows and those of the next level [>= own + next, >= own]
  end type basis_level

  !> A set of pairs in contact whose forces are unique, and the factor that gives them.
  type :: contact_basis
    logical :: sound = .false.           !! the forces are unique, and the pairs hold every motion
    integer, allocatable :: pairs(:)     !! S, level by level [s]
    integer :: motions = 0               !! m
    integer, allocatable :: pair_row(:), motion_row(:)   !! of them in the factor [s], [m]
    integer, allocatable :: kept(:)      !! which of the given motions these are [m]
    real(wp) :: gamma = 0.0_wp           !! weight of A A' in F_g
    real(wp) :: scale = 0.0_wp           !! of F
    type(basis_level), allocatable :: level(:)
  end type contact_basis

contains

  !> Factor the equations of the chosen pairs. Pairs whose force depends on that of others are left out.
  type(contact_basis) function new_basis(scaled, chosen, held) result(basis)
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: chosen(:)             !! [n]
    logical, intent(in), optional :: held        !! all motions, at zero: F_g alone is factored
    logical :: definite

    call choose_pairs(basis, scaled, chosen, held)
    call factor_levels(basis, scaled, 0, lost_digits*scaled%softest, definite)
    if (.not. definite) then
      ! The order of pivots, which takes longer, tells who depends on whom.
      call choose_pairs(basis, scaled, chosen, held)
      call factor_levels(basis, scaled, 0, 0.0_wp, definite, scaled%rank_tolerance)
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
                     abs(basis%gamma - scaled%gamma) <= 0.0_wp .and. &
                     abs(basis%scale - scaled%flexibility_scale) <= 0.0_wp
    if (same) return
    if (allocated(basis%level)) deallocate (basis%level)
    basis = new_basis(scaled, chosen)
  end subroutine renew_basis

  !> Hand a basis over; none is left.
  subroutine move_basis(from, to)
    type(contact_basis), intent(inout) :: from   !! may be none
    type(contact_basis), intent(out) :: to       !! the same
    type(basis_level), allocatable :: level(:)

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
    call factor_levels(basis, scaled, 0, lost_digits*scaled%softest, independent)
  end function are_independent

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
      if (.not. present(held)) cycle
      if (held) basis%level(l)%motion = [integer ::]
    end do
    if (present(held)) basis%motions = merge(0, basis%motions, held)
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
    call factor_levels(basis, scaled, kept, scaled%rank_tolerance, definite)
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
      type(basis_level), intent(inout) :: level
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

  !> The motions of a level.
  pure function motions_of(scaled, l) result(motions)
    type(scaled_problem), intent(in) :: scaled
    integer, intent(in) :: l
    integer, allocatable :: motions(:)
    integer :: j

    motions = pack([(j, j=1, size(scaled%motion_level))], scaled%motion_level == l)
  end function motions_of

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

  !> Factor the equations, level by level; sound: the pairs hold all motions.
  subroutine factor_levels(basis, scaled, kept, least, definite, rank_tolerance)
    type(contact_basis), intent(inout) :: basis
    type(scaled_problem), intent(in) :: scaled
    integer, intent(in) :: kept                 !! rows of the first level that are factored already
    real(wp), intent(in) :: least               !! of pivots of forces that are unique
    logical, intent(out) :: definite            !! all are
    real(wp), intent(in), optional :: rank_tolerance   !! pairs with pivots up to this are left out
    integer :: info, l

    basis%sound = .true.
    do l = 1, size(basis%level)
      call assemble_level()
      if (present(rank_tolerance)) then
        call leave_out_dependent()
        call assemble_level()
      end if
      associate (level => basis%level(l), n => size(basis%level(l)%pair), m => size(basis%level(l)%motion))
        call factor_saddle(size(level%factor, 1), level%factor, kept, n, m, rows_below(), info)
        definite = (info == 0 .or. info > n) .and. all(pivots(level%factor, n) >= least)
      end associate
      if (.not. definite) return
      basis%sound = basis%sound .and. info == 0
      if (info > 0) exit
    end do

  contains

    pure function pivots(factor, n)
      real(wp), intent(in) :: factor(:, :)
      integer, intent(in) :: n
      real(wp) :: pivots(n)
      integer :: k

      pivots = [(factor(k, k)**2, k=1, n)]
    end function pivots

    !> Rows of the next level.
    pure integer function rows_below() result(rows)
      rows = 0
      if (l < size(basis%level)) rows = size(basis%level(l + 1)%pair) + size(basis%level(l + 1)%motion)
    end function rows_below

    !> The rows of a level that are not kept, less what is due to the level before.
    subroutine assemble_level()
      integer :: m, n, rows

      if (l < size(basis%level)) then
        call assemble(basis%level(l), basis%level(l + 1)%pair, size(basis%level(l + 1)%motion), &
                      scaled, l, kept)
      else
        call assemble(basis%level(l), [integer ::], 0, scaled, l, kept)
      end if
      if (l == 1) return
      n = size(basis%level(l - 1)%pair)
      m = size(basis%level(l - 1)%motion)
      rows = size(basis%level(l)%pair) + size(basis%level(l)%motion)
      if (n + m == 0 .or. rows == 0) return
      associate (before => basis%level(l - 1)%factor, own => basis%level(l)%factor)
        call pass_on(size(before, 1), before(n + m + 1, 1), n, m, rows, size(own, 1), own)
      end associate
    end subroutine assemble_level

    !> Pairs in the order of their pivots, but for those whose pivots are none.
    subroutine leave_out_dependent()
      real(wp), allocatable :: copy(:, :)
      integer, allocatable :: order(:), row(:)
      integer :: k, n, own, rank

      n = size(basis%level(l)%pair)
      copy = basis%level(l)%factor(:n, :n)
      call pivoted_cholesky(copy, rank_tolerance, order, rank)
      basis%level(l)%pair = basis%level(l)%pair(order(:rank))
      if (l == 1) return
      associate (before => basis%level(l - 1))
        own = size(before%pair) + size(before%motion)
        row = [order(:rank), (n + k, k=1, size(basis%level(l)%motion))]
        before%factor(own + 1:own + size(row), :) = before%factor(own + row, :)
      end associate
    end subroutine leave_out_dependent
  end subroutine factor_levels

  !> Entries of a level's columns, lower triangle, from the row behind the kept ones on.
  pure subroutine assemble(level, next_pair, next_m, scaled, l, kept)
    type(basis_level), intent(inout) :: level
    integer, intent(in) :: next_pair(:), next_m   !! of the next level, and its motions
    type(scaled_problem), intent(in) :: scaled
    integer, intent(in) :: l, kept   !! the level's number, and its rows that are kept
    real(wp), allocatable :: closing(:, :)   ! A of own and next pairs, by own and next motions
    integer :: at(size(level%pair)), next_at(size(next_pair))   ! places in their levels
    integer :: below, j, m, n, t, top

    n = size(level%pair)
    m = size(level%motion)
    below = n + m + size(next_pair)
    call make_room(level%factor, below + next_m, n + m)
    closing = scaled%motion%rows([level%pair, next_pair], [motions_of(scaled, l), motions_of(scaled, l + 1)])
    at = scaled%flexibility%place(level%pair)
    next_at = scaled%flexibility%place(next_pair)
    associate (f => level%factor, given => scaled%flexibility%level(l), scale => scaled%flexibility_scale)
      do j = 1, n
        top = max(j, kept + 1)
        f(top:n, j) = scale*given%within(at(top:n), at(j))
        if (j == top) f(j, j) = f(j, j) + scaled%own_flexibility
        f(n + m + 1:below, j) = scale*given%beyond(next_at, at(j))
        do t = 1, size(closing, 2)
          if (closing(j, t) == 0.0_wp) cycle
          f(top:n, j) = f(top:n, j) + scaled%gamma*closing(j, t)*closing(top:n, t)
          f(n + m + 1:below, j) = f(n + m + 1:below, j) + scaled%gamma*closing(j, t)*closing(n + 1:, t)
        end do
        f(n + 1:n + m, j) = -closing(j, :m)
        f(below + 1:below + next_m, j) = -closing(j, m + 1:m + next_m)
      end do
      f(n + 1:below + next_m, n + 1:n + m) = 0.0_wp
    end associate
  end subroutine assemble

  !> An array of this size at least.
  pure subroutine make_room(array, rows, columns)
    real(wp), allocatable, intent(inout) :: array(:, :)
    integer, intent(in) :: rows, columns

    if (allocated(array)) then
      if (size(array, 1) >= rows .and. size(array, 2) >= columns) return
      deallocate (array)
    end if
    allocate (array(rows, columns))
  end subroutine make_room

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
    approach = x(basis%motion_row, :) - basis%gamma*load
  end subroutine respond

  !> Forward through the levels, and back.
  pure subroutine solve_levels(level, x)
    type(basis_level), intent(in) :: level(:)
    real(wp), allocatable, intent(inout) :: x(:, :)   !! [rows, any]
    integer, dimension(size(level)) :: n, m, before   ! pairs, motions, rows before
    integer :: below(size(level))                     ! rows of the next
    integer :: l

    n = [(size(level(l)%pair), l=1, size(level))]
    m = [(size(level(l)%motion), l=1, size(level))]
    before = [(sum(n(:l - 1)) + sum(m(:l - 1)), l=1, size(level))]
    below = [n(2:) + m(2:), 0]
    do l = 1, size(level)
      if (n(l) + m(l) == 0) cycle
      call substitute(size(level(l)%factor, 1), level(l)%factor, n(l) + m(l), below(l), size(x, 2), &
                      size(x, 1), x(before(l) + 1, 1))
    end do
    do l = size(level), 1, -1
      if (n(l) + m(l) == 0) cycle
      call substitute_back(size(level(l)%factor, 1), level(l)%factor, [n(l), m(l)], below(l), size(x, 2), &
                           size(x, 1), x(before(l) + 1, 1))
    end do
  end subroutine solve_levels
end module epcont_contact_basis
