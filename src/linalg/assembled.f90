!> Symmetric positive definite matrices in blocks of columns, panels or fronts: filled element by element,
!> factored, and used for solutions and compliances.
!>
!> A matrix is filled part by part. A band has one part. Each front is a part: it is opened when its children
!> are closed, filled with its elements (`front_layout`), and factored when it is closed, while it is in the
!> cache. `factor` does the rest.
module epcont_linalg_assembled
  use epcont_base_kinds, only: i8, wp
  use epcont_linalg_lapack, only: dgemm, dsyrk, dtrsm
  implicit none
  private
  public :: assembled_matrix, sparse_rows
  public :: backward, begin_blocks, diagonal, forward, probes

  !> Rows of a sparse matrix N: entries start(k) to start(k+1)-1 of row k are equations and weights. Equations
  !! that are not positive are ignored.
  type :: sparse_rows
    integer, allocatable :: start(:)       !! [rows + 1]
    integer, allocatable :: equation(:)    !! [entries]
    real(wp), allocatable :: weight(:)     !! [entries]
  end type sparse_rows

  !> Block p has the columns first(p) to first(p+1)-1, stored full, beginning at entries(start(p)): the rows
  !! of these equations, and below them the rows of the equations coupled with them.
  type, abstract :: assembled_matrix
    integer :: order = 0
    integer :: trailing = 0   !! number of last equations that `find_compliance` may use
    real(wp) :: norm = 0.0_wp           !! 1-norm of the matrix before factorization, or a bound of it
    logical :: lacks_memory = .false.   !! the memory was too small
    real(wp), allocatable :: pivot_ratio(:)   !! pivot**2 over the diagonal entry [order]
    integer, allocatable :: first(:)       !! column of each block [blocks + 1]
    integer, allocatable :: columns(:)     !! columns of each block [blocks]
    integer, allocatable :: height(:)      !! rows of each block [blocks]
    integer(i8), allocatable :: start(:)   !! position of each block in `entries` [blocks + 1]
    real(wp), allocatable :: entries(:)
  contains
    procedure(clear_entries), deferred :: clear
    procedure :: open
    procedure(add_element), deferred :: add
    procedure :: close
    procedure(eliminate_rest), deferred :: eliminate
    procedure :: factor
    procedure(first_half), deferred :: solve_lower
    procedure(second_half), deferred :: solve_upper
    procedure :: solve
    procedure :: find_compliance
  end type assembled_matrix

  abstract interface
    !> Prepare to fill the matrix again, if only the columns of these equations have changed. Stale columns
    !! are set to zero. The other columns stay, even factored.
    pure subroutine clear_entries(self, stale)
      import :: assembled_matrix
      class(assembled_matrix), intent(inout) :: self
      !> On return, with all equations that depend on these [order]
      logical, intent(inout) :: stale(:)
    end subroutine clear_entries

    !> Add the matrix of an element to its part, without rows and columns of number 0 and less, and without
    !! columns that are not stale.
    pure subroutine add_element(self, n, number, k)
      import :: assembled_matrix, wp
      class(assembled_matrix), intent(inout) :: self
      integer, intent(in) :: n               !! its rows
      integer, intent(in) :: number(n)       !! equations
      real(wp), intent(in) :: k(n, n)        !! symmetric
    end subroutine add_element

    !> Eliminate all remaining columns, and find the norm.
    subroutine eliminate_rest(self, failed)
      import :: assembled_matrix
      class(assembled_matrix), intent(inout) :: self
      integer, intent(out) :: failed         !! equation without a pivot; 0 if the matrix is definite
    end subroutine eliminate_rest

    !> Forward substitution, L^-1 x. Its results may be added.
    subroutine first_half(self, x)
      import :: assembled_matrix, wp
      class(assembled_matrix), intent(in) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)  !! [order, any]
    end subroutine first_half

    !> Backward substitution, L'^-1 x. Rows before `first` are not needed, and may stay unfinished.
    subroutine second_half(self, x, first)
      import :: assembled_matrix, wp
      class(assembled_matrix), intent(in) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)  !! [order, any]
      integer, intent(in) :: first
    end subroutine second_half
  end interface

contains

  !> Make a part ready for its elements. A band is always ready.
  subroutine open(self, p)
    class(assembled_matrix), intent(inout) :: self
    integer, intent(in) :: p   !! the part; the last part + 1 has the elements without equations

  end subroutine open

  !> Accept that a part has all its elements. A band waits for `factor`.
  subroutine close(self, p)
    class(assembled_matrix), intent(inout) :: self
    integer, intent(in) :: p   !! the part

  end subroutine close

  !> Complete the Cholesky factor. Many singular matrices seem definite, so the smallest ratio of a pivot to
  !! its diagonal entry is returned too.
  subroutine factor(self, smallest_ratio, at)
    class(assembled_matrix), intent(inout) :: self
    real(wp), intent(out) :: smallest_ratio  !! 0 if the matrix is not definite
    integer, intent(out) :: at               !! its equation

    smallest_ratio = 1.0_wp
    at = 0
    if (self%order == 0) return
    smallest_ratio = 0.0_wp
    call self%eliminate(at)
    if (at > 0) return
    at = minloc(self%pivot_ratio, dim=1)
    smallest_ratio = self%pivot_ratio(at)
  end subroutine factor

  !> Solve with the factor, in place.
  subroutine solve(self, x)
    class(assembled_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)  !! right-hand sides, then solutions [order, any]

    call self%solve_lower(x)
    call self%solve_upper(x, 1)
  end subroutine solve

  !> Start columns of an estimate of the condition, with 1-norm 1: a constant column, and Higham's alternating
  !! column.
  pure function probes(order) result(x)
    integer, intent(in) :: order   !! of the matrix
    real(wp) :: x(order, 2)
    integer :: i

    x(:, 1) = 1.0_wp/max(1, order)
    x(:, 2) = [((1 - 2*modulo(i - 1, 2))*(1.0_wp + real(i - 1, wp)/max(1, order - 1)), i=1, order)]
    x(:, 2) = x(:, 2)/sum(abs(x(:, 2)))
  end function probes

  !> Compute N K^-1 N' = X'X with X = L22^-1 N', from the trailing block L22 of the factor, from which all
  !! other equations have been eliminated.
  pure subroutine find_compliance(self, rows, compliance)
    class(assembled_matrix), intent(in) :: self
    type(sparse_rows), intent(in) :: rows       !! N, of trailing equations
    real(wp), allocatable, intent(out) :: compliance(:, :)   !! lower triangle [rows, rows]
    real(wp), allocatable :: factor(:, :), x(:, :)
    integer :: i, k

    associate (n => size(rows%start) - 1, last => self%trailing, before => self%order - self%trailing)
      allocate (x(last, n), compliance(n, n), source=0.0_wp)
      do k = 1, n
        do i = rows%start(k), rows%start(k + 1) - 1
          associate (entry => x(rows%equation(i) - before, k))
            entry = entry + rows%weight(i)
          end associate
        end do
      end do
      call get_trailing_factor(self, factor)
      call dtrsm('L', 'L', 'N', 'N', last, n, 1.0_wp, factor, last, x, last)
      call dsyrk('L', 'T', n, last, 1.0_wp, x, last, 0.0_wp, compliance, n)
    end associate
  end subroutine find_compliance

  !> Begin a matrix of zeros, or set `lacks_memory`. (A function would return a copy of the whole matrix.)
  subroutine begin_blocks(self, first, height, trailing)
    class(assembled_matrix), intent(inout) :: self
    integer, intent(in) :: first(:)         !! [blocks + 1]
    integer, intent(in) :: height(:)        !! [blocks]
    integer, intent(in) :: trailing         !! as in the type
    logical :: stale(first(size(first)) - 1)
    integer :: p, status

    self%trailing = trailing
    self%order = size(stale)
    self%first = first
    self%height = height
    self%columns = first(2:) - first(:size(height))
    allocate (self%start(size(first)), source=1_i8)
    do p = 1, size(height)
      self%start(p + 1) = self%start(p) + int(height(p), i8)*self%columns(p)
    end do
    allocate (self%pivot_ratio(self%order))
    allocate (self%entries(self%start(size(first))), stat=status)   ! one more: rows below the last column
    self%lacks_memory = status /= 0
    if (self%lacks_memory) return
    stale = .true.
    call self%clear(stale)
  end subroutine begin_blocks

  !> Gather L22, the last rows and columns of the factor. (A function would return a copy.)
  pure subroutine get_trailing_factor(self, x)
    class(assembled_matrix), intent(in) :: self
    real(wp), allocatable, intent(out) :: x(:, :)   !! lower triangle, zeros above it [trailing, trailing]
    integer :: before, i, j, p
    integer(i8) :: at

    allocate (x(self%trailing, self%trailing), source=0.0_wp)
    before = self%order - self%trailing
    do p = 1, size(self%height)
      do j = max(self%first(p), before + 1), self%first(p + 1) - 1
        at = self%start(p) + int(j - self%first(p), i8)*(self%height(p) + 1)
        do i = j, self%first(p) + self%height(p) - 1
          x(i - before, j - before) = self%entries(at + i - j)
        end do
      end do
    end do
  end subroutine get_trailing_factor

  !> Diagonal of full columns.
  pure function diagonal(height, columns, k)
    integer, intent(in) :: height, columns
    real(wp), intent(in) :: k(height, columns)
    real(wp) :: diagonal(columns)
    integer :: j

    diagonal = [(k(j, j), j=1, columns)]
  end function diagonal

  !> Forward substitution with full columns of a factor, and subtraction from the rows below.
  pure subroutine forward(height, columns, l, sides, leading, y)
    integer, intent(in) :: height, columns
    real(wp), intent(in) :: l(height, columns)
    integer, intent(in) :: sides                      !! right-hand sides
    integer, intent(in) :: leading                    !! dimension of y
    real(wp), intent(inout) :: y(leading, sides)      !! [height, sides]

    call dtrsm('L', 'L', 'N', 'N', columns, sides, 1.0_wp, l, height, y, leading)
    if (height > columns) call dgemm('N', 'N', height - columns, sides, columns, -1.0_wp, l(columns + 1, 1), &
                                     height, y, leading, 1.0_wp, y(columns + 1, 1), leading)
  end subroutine forward

  !> Backward substitution, with the transpose.
  pure subroutine backward(height, columns, l, sides, leading, y)
    integer, intent(in) :: height, columns, sides, leading
    real(wp), intent(in) :: l(height, columns)
    real(wp), intent(inout) :: y(leading, sides)

    if (height > columns) call dgemm('T', 'N', columns, sides, height - columns, -1.0_wp, l(columns + 1, 1), &
                                     height, y(columns + 1, 1), leading, 1.0_wp, y, leading)
    call dtrsm('L', 'L', 'T', 'N', columns, sides, 1.0_wp, l, height, y, leading)
  end subroutine backward
end module epcont_linalg_assembled
