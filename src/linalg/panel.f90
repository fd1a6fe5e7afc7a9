!> Symmetric positive definite matrices in panels of columns, each with its own height: blocked variable-band Cholesky.
!>
!> The lower triangle is stored panel by panel: panel p has the columns first(p) to first(p+1)-1, and for all of them the
!> rows from first(p) to last(p), column by column from entries(start(p)) on. The last rows never go back where panels
!> overlap, so the factor fills what is stored and nothing else:
!>
!>     x .        x: stored, .: stored but above the diagonal, never read
!>     x x
!>     x x x .    Of a plain band all panels have the height of the highest; here that of their own:
!>         x x    about half the operations on graded meshes.
!>         x x
module epcont_linalg_panel
  use epcont_base_kinds, only: i8, wp
  use epcont_base_large_pages, only: use_large_pages
  use epcont_base_sorting, only: sorted_order
  use epcont_linalg_assembled, only: add_seen_through, assembled_matrix
  use epcont_linalg_dense, only: cholesky_inverse
  use epcont_linalg_lapack, only: dgemm, dgemv, dpotrf, dsyrk, dtrsm, dtrsv
  use epcont_linalg_panel_layout, only: find_panels
  implicit none
  private
  public :: panel_matrix

  type, extends(assembled_matrix) :: panel_matrix
    integer :: width = 1                   !! columns of a panel; the last may have fewer
    integer, allocatable :: first(:)       !! first column of each panel [panels + 1]
    integer, allocatable :: last(:)        !! last row of each panel [panels]
    integer(i8), allocatable :: start(:)   !! of each panel in `entries` [panels + 1]
    real(wp), allocatable :: entries(:)
    integer :: trailing = 0                !! last equations, the only ones that `add_gram` is asked for; 0: any
    integer :: kept = 0                    !! panels at the front whose factor stands: the others are filled and factored anew
    real(wp), allocatable :: pivot_ratio(:)   !! pivot**2 over the diagonal entry [order]
    real(wp), allocatable :: row_sum(:)       !! of magnitudes, what each panel adds to those of its rows [heights of all panels]
  contains
    procedure :: begin
    procedure :: clear
    procedure :: add
    procedure :: factor
    procedure :: solve
    procedure :: trailing_inverse
    procedure :: add_gram
    procedure, private :: height
    procedure, private :: columns
  end type panel_matrix

contains

  !> Begin a matrix of zeros. `reach` is the last row that each column is coupled with [order]. (A function would hand
  !! back a copy of the whole matrix.)
  subroutine begin(self, reach, trailing)
    class(panel_matrix), intent(inout) :: self
    integer, intent(in) :: reach(:)
    integer, intent(in) :: trailing        !! as above
    integer :: from, p, status

    self%order = size(reach)
    self%trailing = trailing
    call find_panels(reach, self%width, self%first, self%last)
    allocate (self%start(size(self%first)))
    self%start(1) = 1
    do p = 1, size(self%last)
      self%start(p + 1) = self%start(p) + int(self%height(p), i8)*self%columns(p)
    end do
    allocate (self%entries(self%start(size(self%start))), stat=status)   ! one more, behind the last
    self%lacks_memory = status /= 0
    if (self%lacks_memory) return
    call use_large_pages(self%entries)
    allocate (self%pivot_ratio(self%order), self%row_sum(sum(self%last - self%first(:size(self%last)) + 1)))
    from = 1
    call self%clear(from)
  end subroutine begin

  pure subroutine clear(self, from)
    class(panel_matrix), intent(inout) :: self
    integer, intent(inout) :: from

    self%kept = (from - 1)/self%width
    from = self%first(self%kept + 1)
    self%entries(self%start(self%kept + 1):) = 0.0_wp
  end subroutine clear

  pure integer function height(self, panel)
    class(panel_matrix), intent(in) :: self
    integer, intent(in) :: panel

    height = self%last(panel) - self%first(panel) + 1
  end function height

  pure integer function columns(self, panel)
    class(panel_matrix), intent(in) :: self
    integer, intent(in) :: panel

    columns = self%first(panel + 1) - self%first(panel)
  end function columns

  pure subroutine add(self, k, numbers)
    class(panel_matrix), intent(inout) :: self
    real(wp), intent(in) :: k(:, :)
    integer, intent(in) :: numbers(:)
    integer :: i, j, p
    integer(i8) :: above

    do j = 1, size(numbers)
      if (numbers(j) <= 0) cycle
      p = (numbers(j) - 1)/self%width + 1
      if (p <= self%kept) cycle
      associate (f => self%first(p))
        above = self%start(p) + int(numbers(j) - f, i8)*(self%last(p) - f + 1) - f   ! where row 0 of the column would be
      end associate
      do i = 1, size(numbers)
        if (numbers(i) >= numbers(j)) self%entries(above + numbers(i)) = self%entries(above + numbers(i)) + k(i, j)
      end do
    end do
  end subroutine add

  !> Panel by panel: measured, rid of what the panels before take off it, factored. Thus each is brought from memory once.
  pure subroutine factor(self, smallest_ratio, at)
    class(panel_matrix), intent(inout) :: self
    real(wp), intent(out) :: smallest_ratio
    integer, intent(out) :: at
    integer :: before, info, p, q

    smallest_ratio = 1.0_wp
    at = 0
    if (self%order == 0) return
    before = 1
    do p = self%kept + 1, size(self%last)
      call measure(self, p)
      do while (self%last(before) < self%first(p))
        before = before + 1
      end do
      do q = before, p - 1
        call take_off(self, q, p)
      end do
      associate (h => self%height(p), w => self%columns(p), s => self%start(p))
        call dpotrf('L', w, self%entries(s), h, info)
        if (info > 0) then
          smallest_ratio = 0.0_wp
          at = self%first(p) - 1 + info
          return
        end if
        if (h > w) call dtrsm('R', 'L', 'T', 'N', h - w, w, 1.0_wp, self%entries(s), h, self%entries(s + w), h)
      end associate
      call compare_pivots(self, p)
    end do
    self%norm = largest_row_sum(self)
    at = minloc(self%pivot_ratio, dim=1)
    smallest_ratio = self%pivot_ratio(at)
  end subroutine factor

  !> Diagonal of a panel, and its part of the sums of the rows.
  pure subroutine measure(self, p)
    class(panel_matrix), intent(inout) :: self
    integer, intent(in) :: p
    real(wp) :: total
    integer :: i, j
    integer(i8) :: at

    associate (f => self%first(p), row_sum => self%row_sum(rows_before(self, p) + 1:rows_before(self, p) + self%height(p)))
      row_sum = 0.0_wp
      do j = f, self%first(p + 1) - 1
        at = self%start(p) + int(j - f, i8)*(self%height(p) + 1)   ! of the diagonal entry
        self%pivot_ratio(j) = self%entries(at)
        total = abs(self%entries(at))
        do i = j + 1, self%last(p)
          associate (entry => abs(self%entries(at + i - j)))
            total = total + entry
            row_sum(i - f + 1) = row_sum(i - f + 1) + entry
          end associate
        end do
        row_sum(j - f + 1) = row_sum(j - f + 1) + total
      end do
    end associate
  end subroutine measure

  !> Rows of all panels before one, which all have the full width.
  pure integer function rows_before(self, p)
    type(panel_matrix), intent(in) :: self
    integer, intent(in) :: p

    rows_before = int((self%start(p) - 1)/self%width)
  end function rows_before

  !> The 1-norm of the symmetric matrix.
  pure real(wp) function largest_row_sum(self)
    type(panel_matrix), intent(in) :: self
    real(wp), allocatable :: total(:)
    integer :: p

    allocate (total(self%order), source=0.0_wp)
    do p = 1, size(self%last)
      associate (f => self%first(p), l => self%last(p), before => rows_before(self, p))
        total(f:l) = total(f:l) + self%row_sum(before + 1:before + l - f + 1)
      end associate
    end do
    largest_row_sum = maxval(total)
  end function largest_row_sum

  !> Compare the pivots of a factored panel with the diagonal that `measure` has put aside.
  pure subroutine compare_pivots(self, p)
    class(panel_matrix), intent(inout) :: self
    integer, intent(in) :: p
    integer :: j

    do j = self%first(p), self%first(p + 1) - 1
      self%pivot_ratio(j) = self%entries(self%start(p) + int(j - self%first(p), i8)*(self%height(p) + 1))**2 &
                            /self%pivot_ratio(j)
    end do
  end subroutine compare_pivots

  !> Take off a panel what a factored one before it, which reaches it, eliminates from it.
  pure subroutine take_off(self, factored, p)
    class(panel_matrix), intent(inout) :: self
    integer, intent(in) :: factored, p
    integer :: h, rows, w
    integer(i8) :: from

    h = self%height(factored)
    rows = self%last(factored) - self%first(p) + 1
    w = min(self%columns(p), rows)
    from = self%start(factored) + (self%first(p) - self%first(factored))
    call dsyrk('L', 'N', w, self%columns(factored), -1.0_wp, self%entries(from), h, 1.0_wp, &
               self%entries(self%start(p)), self%height(p))
    if (rows > w) call dgemm('N', 'T', rows - w, w, self%columns(factored), -1.0_wp, self%entries(from + w), h, &
                             self%entries(from), h, 1.0_wp, self%entries(self%start(p) + w), self%height(p))
  end subroutine take_off

  !> Solve with the factor, in place. Each panel is taken from memory once each way, for all right-hand sides.
  pure subroutine solve(self, x)
    class(panel_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)  !! right-hand sides, then solutions [order, any]
    integer :: k, p

    do p = 1, size(self%last)
      associate (h => self%height(p), w => self%columns(p), s => self%start(p), f => self%first(p))
        do k = 1, size(x, 2)
          call dtrsv('L', 'N', 'N', w, self%entries(s), h, x(f:, k), 1)
          if (h > w) call dgemv('N', h - w, w, -1.0_wp, self%entries(s + w), h, x(f:, k), 1, 1.0_wp, x(f + w:, k), 1)
        end do
      end associate
    end do
    do p = size(self%last), 1, -1
      associate (h => self%height(p), w => self%columns(p), s => self%start(p), f => self%first(p))
        do k = 1, size(x, 2)
          if (h > w) call dgemv('T', h - w, w, -1.0_wp, self%entries(s + w), h, x(f + w:, k), 1, 1.0_wp, x(f:, k), 1)
          call dtrsv('L', 'T', 'N', w, self%entries(s), h, x(f:, k), 1)
        end do
      end associate
    end do
  end subroutine solve

  !> Trailing block of the inverse, from the factor: with L22 the trailing block of the factor it is
  !! (L22 L22')^-1, since all that stands before has been eliminated from it.
  pure function trailing_inverse(self, count) result(inverse)
    class(panel_matrix), intent(in) :: self
    integer, intent(in) :: count              !! rows and columns wanted
    real(wp), allocatable :: inverse(:, :)    !! full symmetric [count, count]
    integer :: before, i, j, p
    integer(i8) :: at

    allocate (inverse(count, count), source=0.0_wp)
    if (count == 0) return
    before = self%order - count
    do p = before/self%width + 1, size(self%last)
      do j = max(self%first(p), before + 1), self%first(p + 1) - 1
        at = self%start(p) + int(j - self%first(p), i8)*(self%height(p) + 1)
        do i = j, self%last(p)
          inverse(i - before, j - before) = self%entries(at + i - j)
        end do
      end do
    end do
    call cholesky_inverse(inverse)
  end function trailing_inverse

  pure subroutine add_gram(self, start, equation, weight, gram)
    class(panel_matrix), intent(in) :: self
    integer, intent(in) :: start(:), equation(:)
    real(wp), intent(in) :: weight(:)
    real(wp), intent(inout) :: gram(:, :)

    if (self%trailing > 0) then
      call add_seen_through(self%trailing_inverse(self%trailing), start, equation - (self%order - self%trailing), weight, gram)
    else
      call substitute(self, start, equation, weight, gram)
    end if
  end subroutine add_gram

  !> The same for any equations. With X = L^-1 N', taken panel by panel through a window as high as the highest, it is
  !! X'X: no right-hand side is touched before its first equation, and none is ever stored whole.
  pure subroutine substitute(self, start, equation, weight, gram)
    class(panel_matrix), intent(in) :: self
    integer, intent(in) :: start(:), equation(:)
    real(wp), intent(in) :: weight(:)
    real(wp), intent(inout) :: gram(:, :)
    real(wp), allocatable :: product(:, :), window(:, :)
    integer, allocatable :: begins(:), column(:), entry(:), order(:), row_of(:)
    integer :: active, e, h, highest, k, n, p, w

    n = size(start) - 1
    allocate (begins(n), source=huge(1))
    allocate (row_of(start(n + 1) - 1))
    do k = 1, n
      row_of(start(k):start(k + 1) - 1) = k
      associate (own => equation(start(k):start(k + 1) - 1))
        if (any(own > 0)) begins(k) = minval(own, mask=own > 0)
      end associate
    end do
    order = sorted_order(begins)
    allocate (column(n))
    column(order) = [(k, k=1, n)]
    entry = sorted_order(equation(:size(row_of)))
    highest = maxval(self%last - self%first(:size(self%last))) + 1
    allocate (window(highest, n), product(n, n), source=0.0_wp)
    active = 0
    e = 1
    do p = 1, size(self%last)
      h = self%height(p)
      w = self%columns(p)
      do while (e <= size(entry))
        if (equation(entry(e)) >= self%first(p + 1)) exit
        associate (i => equation(entry(e)) - self%first(p) + 1)
          if (i > 0) then
            k = column(row_of(entry(e)))
            active = max(active, k)
            window(i, k) = window(i, k) + weight(entry(e))
          end if
        end associate
        e = e + 1
      end do
      if (active == 0) cycle
      call dtrsm('L', 'L', 'N', 'N', w, active, 1.0_wp, self%entries(self%start(p)), h, window, highest)
      call dsyrk('L', 'T', active, w, 1.0_wp, window, highest, 1.0_wp, product, n)
      if (h > w) call dgemm('N', 'N', h - w, active, w, -1.0_wp, self%entries(self%start(p) + w), h, window, highest, 1.0_wp, &
                            window(w + 1, 1), highest)
      do k = 1, active
        window(:h - w, k) = window(w + 1:h, k)
        window(h - w + 1:h, k) = 0.0_wp
      end do
    end do
    do k = 1, n
      gram(order(k:), order(k)) = gram(order(k:), order(k)) + product(k:, k)
      gram(order(k), order(k + 1:)) = gram(order(k), order(k + 1:)) + product(k + 1:, k)
    end do
  end subroutine substitute
end module epcont_linalg_panel
