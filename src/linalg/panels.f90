!> Symmetric positive definite matrices in panels of columns, each with its own height: blocked variable-band
!> Cholesky.
!>
!> The lower triangle is stored panel by panel. Panel p has the columns first(p) to first(p+1)-1, with the
!> rows from first(p) to last(p), column by column from entries(start(p)) on. If panels overlap, their last
!> rows never decrease, so the factor fills exactly the stored part:
!>
!>     x .        x: stored, .: stored but above the diagonal, never read
!>     x x
!>     x x x .    In a plain band all panels have the height of the highest. With own heights, graded
!>         x x    meshes take about half the operations.
!>         x x
module epcont_linalg_panels
  use epcont_base_kinds, only: i8, wp
  use epcont_linalg_assembled, only: assembled_matrix, backward, begin_blocks, diagonal, forward
  use epcont_linalg_lapack, only: dgemm, dpotrf, dsyrk, dtrsm
  use epcont_linalg_panel_layout, only: panel_layout
  implicit none
  private
  public :: panel_matrix

  type, extends(assembled_matrix) :: panel_matrix
    integer :: width = 1     !! columns of a panel; the last may have fewer
    integer :: kept = 0   !! first panels that stay factored; the others are filled and factored again
    real(wp), allocatable :: row_sum(:)   !! sums of magnitudes, element by element [order]
  contains
    procedure :: begin => begin_panels
    procedure :: clear => clear_panels
    procedure :: add => add_to_panels
    procedure :: eliminate => eliminate_panels
    procedure :: solve_lower
    procedure :: solve_upper
  end type panel_matrix

contains

  !> Begin a matrix of zeros.
  subroutine begin_panels(self, layout, trailing)
    class(panel_matrix), intent(inout) :: self
    type(panel_layout), intent(in) :: layout   !! its panels
    !> Number of last equations that `find_compliance` may use
    integer, intent(in) :: trailing

    self%width = layout%width
    allocate (self%row_sum(layout%first(size(layout%first)) - 1))
    call begin_blocks(self, layout%first, layout%height, trailing)
  end subroutine begin_panels

  !> Mark all columns after the first stale one as stale.
  pure subroutine clear_panels(self, stale)
    class(panel_matrix), intent(inout) :: self
    logical, intent(inout) :: stale(:)   !! as in `assembled_matrix`

    self%kept = (findloc([stale, .true.], .true., dim=1) - 1)/self%width
    stale(self%first(self%kept + 1):) = .true.
    self%entries(self%start(self%kept + 1):) = 0.0_wp
    self%row_sum(self%first(self%kept + 1):) = 0.0_wp
  end subroutine clear_panels

  !> Add entries to the panel of their column, unless the panel is kept.
  pure subroutine add_to_panels(self, n, number, k)
    class(panel_matrix), intent(inout) :: self
    integer, intent(in) :: n   !! rows of the element
    integer, intent(in) :: number(n)   !! its equations
    real(wp), intent(in) :: k(n, n)   !! its stiffness
    integer :: i, j, p
    integer(i8) :: above

    do j = 1, n
      if (number(j) <= 0) cycle
      p = (number(j) - 1)/self%width + 1
      if (p <= self%kept) cycle
      ! Position of row 0 of the column
      above = self%start(p) + int(number(j) - self%first(p), i8)*self%height(p) - self%first(p)
      do i = 1, n
        if (number(i) >= number(j)) then
          self%entries(above + number(i)) = self%entries(above + number(i)) + k(i, j)
        end if
      end do
      self%row_sum(number(j)) = self%row_sum(number(j)) + sum(abs(k(:, j)), mask=number > 0)
    end do
  end subroutine add_to_panels

  !> Factor panel by panel, after subtracting the part that earlier panels eliminate. So each is read once.
  subroutine eliminate_panels(self, failed)
    class(panel_matrix), intent(inout) :: self
    integer, intent(out) :: failed   !! equation without a pivot; 0 if none failed
    real(wp), allocatable :: given(:)
    integer :: before, p, q

    failed = 0
    before = 1
    do p = self%kept + 1, size(self%height)
      do while (self%first(before) + self%height(before) <= self%first(p))
        before = before + 1
      end do
      given = diagonal(self%height(p), self%columns(p), self%entries(self%start(p)))
      do q = before, p - 1
        call take_off(self, q, p)
      end do
      call factor_panel(self, p, given, failed)
      if (failed > 0) return
    end do
    self%norm = maxval(self%row_sum)
  end subroutine eliminate_panels

  !> Factor a panel after all subtractions.
  pure subroutine factor_panel(self, p, given, failed)
    class(panel_matrix), intent(inout) :: self
    integer, intent(in) :: p
    real(wp), intent(in) :: given(:)    !! diagonal of the matrix in these columns
    integer, intent(out) :: failed      !! equation without a pivot; 0 if none failed

    associate (h => self%height(p), w => self%columns(p), s => self%start(p), f => self%first(p))
      call dpotrf('L', w, self%entries(s), h, failed)
      if (failed > 0) then
        failed = f - 1 + failed
        return
      end if
      if (h > w) call dtrsm('R', 'L', 'T', 'N', h - w, w, 1.0_wp, self%entries(s), h, self%entries(s + w), h)
      self%pivot_ratio(f:f + w - 1) = diagonal(h, w, self%entries(s))**2/given
    end associate
  end subroutine factor_panel

  !> Subtract from a panel the part that a factored panel, which reaches it, eliminates.
  pure subroutine take_off(self, factored, p)
    class(panel_matrix), intent(inout) :: self
    integer, intent(in) :: factored, p
    integer :: rows, w
    integer(i8) :: from

    associate (k => self%columns(factored), h => self%height(factored), &
               before => self%first(p) - self%first(factored))
      from = self%start(factored) + before
      rows = h - before
      w = min(self%columns(p), rows)
      call dsyrk('L', 'N', w, k, -1.0_wp, self%entries(from), h, 1.0_wp, self%entries(self%start(p)), &
                self%height(p))
      if (rows == w) return
      call dgemm('N', 'T', rows - w, w, k, -1.0_wp, self%entries(from + w), h, self%entries(from), h, &
                1.0_wp, self%entries(self%start(p) + w), self%height(p))
    end associate
  end subroutine take_off

  !> Forward substitution. Each panel is read once, for all right-hand sides.
  subroutine solve_lower(self, x)
    class(panel_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)
    integer :: p

    do p = 1, size(self%height)
      if (any(x(self%first(p):self%first(p + 1) - 1, :) /= 0.0_wp)) &
        call take_panel(self, p, .true., size(x, 2), x)
    end do
  end subroutine solve_lower

  !> Backward substitution.
  subroutine solve_upper(self, x, first)
    class(panel_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)
    integer, intent(in) :: first
    integer :: p

    do p = size(self%height), 1, -1
      if (self%first(p + 1) <= first) exit
      call take_panel(self, p, .false., size(x, 2), x)
    end do
  end subroutine solve_upper

  !> Substitute with one panel, whose rows are consecutive in the right-hand sides too.
  pure subroutine take_panel(self, p, forwards, sides, x)
    class(panel_matrix), intent(in) :: self
    integer, intent(in) :: p   !! the panel
    logical, intent(in) :: forwards   !! with L, otherwise with its transpose
    integer, intent(in) :: sides   !! right-hand sides
    real(wp), intent(inout) :: x(self%order, sides)   !! right-hand sides, then results [order, sides]

    associate (h => self%height(p), w => self%columns(p), s => self%start(p), f => self%first(p))
      if (forwards) then
        call forward(h, w, self%entries(s), sides, self%order, x(f, 1))
      else
        call backward(h, w, self%entries(s), sides, self%order, x(f, 1))
      end if
    end associate
  end subroutine take_panel
end module epcont_linalg_panels
