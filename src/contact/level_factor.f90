!> The factor of the contact equations of a set, level by level (`contact/flexibility_matrix`), in each the
!> pairs first, then the motions that close no gaps of later levels.
module epcont_contact_level_factor
  use epcont_base_kinds, only: wp
  use epcont_contact_scaling, only: scaled_problem
  use epcont_linalg_dense, only: pivoted_cholesky
  use epcont_linalg_saddle, only: factor_saddle, pass_on, substitute, substitute_back
  implicit none
  private
  public :: level_factor, factor_levels, motions_of, solve_levels

  !> Pairs and motions of one level, and their columns of the factor.
  type :: level_factor
    integer, allocatable :: pair(:)      !! of S, in the order of the factor
    integer, allocatable :: motion(:)    !! none, where they are held
    real(wp), allocatable :: factor(:, :)   !! own rows and those of the next level [>= own + next, >= own]
  end type level_factor

contains

  !> The motions of a level.
  pure function motions_of(scaled, l) result(motions)
    type(scaled_problem), intent(in) :: scaled  !! the problem in its own units
    integer, intent(in) :: l                    !! the level
    integer, allocatable :: motions(:)
    integer :: j

    motions = pack([(j, j=1, size(scaled%motion_level))], scaled%motion_level == l)
  end function motions_of

  !> Factor the equations, level by level. Not all are, where forces are not unique or motions not held.
  subroutine factor_levels(level, scaled, kept, least, definite, sound, rank_tolerance)
    type(level_factor), intent(inout) :: level(:)   !! with their pairs and motions
    type(scaled_problem), intent(in) :: scaled  !! the problem in its own units
    integer, intent(in) :: kept                 !! rows of the first level that are factored already
    real(wp), intent(in) :: least               !! of pivots of forces that are unique, over their softness
    logical, intent(out) :: definite            !! all are
    logical, intent(out) :: sound               !! and the pairs hold all motions
    real(wp), intent(in), optional :: rank_tolerance   !! pairs with pivots up to this are left out
    integer :: info, k, l

    definite = .true.
    sound = .true.
    do l = 1, size(level)
      call assemble_level()
      if (present(rank_tolerance)) then
        call leave_out_dependent()
        call assemble_level()
      end if
      associate (factor => level(l)%factor, n => size(level(l)%pair), m => size(level(l)%motion))
        call factor_saddle(size(factor, 1), factor, kept, n, m, rows_below(), info)
        definite = (info == 0 .or. info > n) .and. &
                   all(pivots(factor, n) >= least*scaled%softness(level(l)%pair))
      end associate
      ! Fewer pairs than motions do not hold these, whatever rounding makes of the last pivot.
      sound = definite .and. info == 0 .and. sum([(size(level(k)%pair) - size(level(k)%motion), k=1, l)]) >= 0
      if (.not. sound) return
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
      if (l < size(level)) rows = size(level(l + 1)%pair) + size(level(l + 1)%motion)
    end function rows_below

    !> The rows of a level that are not kept, less what is due to the level before.
    subroutine assemble_level()
      integer :: m, n, rows

      if (l < size(level)) then
        call assemble(level(l), level(l + 1)%pair, size(level(l + 1)%motion), &
                      scaled, l, kept)
      else
        call assemble(level(l), [integer ::], 0, scaled, l, kept)
      end if
      if (l == 1) return
      n = size(level(l - 1)%pair)
      m = size(level(l - 1)%motion)
      rows = size(level(l)%pair) + size(level(l)%motion)
      if (n + m == 0 .or. rows == 0) return
      associate (before => level(l - 1)%factor, own => level(l)%factor)
        call pass_on(size(before, 1), before(n + m + 1, 1), n, m, rows, size(own, 1), own)
      end associate
    end subroutine assemble_level

    !> Pairs in the order of their pivots, but for those whose pivots are none.
    subroutine leave_out_dependent()
      real(wp), allocatable :: copy(:, :)
      real(wp) :: unit(size(level(l)%pair))
      integer, allocatable :: order(:), row(:)
      integer :: k, n, own, rank

      n = size(level(l)%pair)
      unit = sqrt(scaled%softness(level(l)%pair))
      allocate (copy(n, n), source=0.0_wp)
      do k = 1, n
        copy(k:, k) = level(l)%factor(k:n, k)/(unit(k:)*unit(k))
      end do
      call pivoted_cholesky(copy, rank_tolerance, order, rank)
      level(l)%pair = level(l)%pair(order(:rank))
      if (l == 1) return
      associate (before => level(l - 1))
        own = size(before%pair) + size(before%motion)
        row = [order(:rank), (n + k, k=1, size(level(l)%motion))]
        before%factor(own + 1:own + size(row), :) = before%factor(own + row, :)
      end associate
    end subroutine leave_out_dependent
  end subroutine factor_levels

  !> Entries of a level's columns, lower triangle, from the row behind the kept ones on.
  pure subroutine assemble(level, next_pair, next_m, scaled, l, kept)
    type(level_factor), intent(inout) :: level
    integer, intent(in) :: next_pair(:), next_m   !! of the next level, and its motions
    type(scaled_problem), intent(in) :: scaled
    integer, intent(in) :: l, kept   !! the level's number, and its rows that are kept
    integer, allocatable :: motion(:)        ! own and next ones
    real(wp), allocatable :: closing(:, :)   ! A of own and next pairs, by these
    integer :: at(size(level%pair)), next_at(size(next_pair))   ! places in their levels
    integer :: below, j, m, n, t, top

    n = size(level%pair)
    m = size(level%motion)
    below = n + m + size(next_pair)
    call make_room(level%factor, below + next_m, n + m)
    motion = [motions_of(scaled, l), motions_of(scaled, l + 1)]
    closing = scaled%motion%rows([level%pair, next_pair], motion)
    at = scaled%flexibility%place(level%pair)
    next_at = scaled%flexibility%place(next_pair)
    associate (f => level%factor, given => scaled%flexibility%level(l), scale => scaled%flexibility_scale)
      do j = 1, n
        top = max(j, kept + 1)
        f(top:n, j) = scale*given%within(at(top:n), at(j))
        if (j == top) f(j, j) = f(j, j) + scaled%own_flexibility(level%pair(j))
        f(n + m + 1:below, j) = scale*given%beyond(next_at, at(j))
        do t = 1, size(closing, 2)
          if (closing(j, t) == 0.0_wp) cycle
          associate (gamma => scaled%gamma(motion(t)))
            f(top:n, j) = f(top:n, j) + gamma*closing(j, t)*closing(top:n, t)
            f(n + m + 1:below, j) = f(n + m + 1:below, j) + gamma*closing(j, t)*closing(n + 1:, t)
          end associate
        end do
        f(n + 1:n + m, j) = -closing(j, :m)
        f(below + 1:below + next_m, j) = -closing(j, m + 1:m + next_m)
      end do
      f(n + 1:below + next_m, n + 1:n + m) = 0.0_wp
      do j = 1, m
        f(n + j, n + j) = -scaled%own_stiffness(motion(j))
      end do
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

  !> Forward through the levels, and back.
  pure subroutine solve_levels(level, x)
    type(level_factor), intent(in) :: level(:)        !! factored
    real(wp), allocatable, intent(inout) :: x(:, :)   !! right-hand sides, then the solution [rows, any]
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
end module epcont_contact_level_factor
