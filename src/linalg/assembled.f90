!> What bodies ask of their stiffness matrices, however these are stored: filled element by element, factored,
!> solved with, and seen by the pairs. How one begins, by its panels or by its fronts, is the affair of each
!> kind.
!>
!> A matrix is filled part by part. A band is one; of fronts each is: it is opened when all below it are
!> closed, is given its elements (`front_layout`), and factored when it is closed, while it is at hand. That
!> does most of the work, `factor` the rest.
module epcont_linalg_assembled
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_linalg_dense, only: cholesky_inverse
  use epcont_linalg_staircase, only: multiply_staircase, solve_staircase
  implicit none
  private
  public :: assembled_matrix, sparse_rows, find_compliance, order_rows, probes

  !> Rows of a sparse matrix N: entries start(k) to start(k+1)-1 of row k are equations and weights. Equations
  !! that are not positive count for nothing.
  type :: sparse_rows
    integer, allocatable :: start(:)       !! [rows + 1]
    integer, allocatable :: equation(:)    !! [entries]
    real(wp), allocatable :: weight(:)     !! [entries]
  end type sparse_rows

  type, abstract :: assembled_matrix
    integer :: order = 0
    integer :: trailing = 0   !! last equations, the only ones that `find_compliance` is asked for; 0: any
    real(wp) :: norm = 0.0_wp           !! 1-norm of the matrix when it was factored, or a bound of it
    logical :: lacks_memory = .false.   !! there was not enough to begin it
    real(wp), allocatable :: pivot_ratio(:)   !! pivot**2 over the diagonal entry [order]
  contains
    procedure(clear_entries), deferred :: clear
    procedure :: open
    procedure(add_element), deferred :: add
    procedure :: close
    procedure(eliminate_rest), deferred :: eliminate
    procedure :: factor
    procedure(first_half), deferred :: solve_lower
    procedure(second_half), deferred :: solve_upper
    procedure(last_of_factor), deferred :: get_trailing_factor
    procedure :: solve
    procedure :: find_compliance
  end type assembled_matrix

  abstract interface
    !> Make ready to be filled anew where only the columns of these equations have changed: stale columns
    !! begin with zeros, the others remain as they are, even factored.
    pure subroutine clear_entries(self, stale)
      import :: assembled_matrix
      class(assembled_matrix), intent(inout) :: self
      !> On return with those that have to be filled anew on their account [order]
      logical, intent(inout) :: stale(:)
    end subroutine clear_entries

    !> Add the matrix of an element to its part; rows and columns of number 0 and less are left out, and
    !! columns that are not stale.
    pure subroutine add_element(self, n, number, k)
      import :: assembled_matrix, wp
      class(assembled_matrix), intent(inout) :: self
      integer, intent(in) :: n               !! rows of it
      integer, intent(in) :: number(n)       !! equations
      real(wp), intent(in) :: k(n, n)        !! symmetric
    end subroutine add_element

    !> Eliminate what has not been eliminated yet, and find the norm.
    subroutine eliminate_rest(self, failed)
      import :: assembled_matrix
      class(assembled_matrix), intent(inout) :: self
      integer, intent(out) :: failed         !! equation that has no pivot; 0: none, the matrix is definite
    end subroutine eliminate_rest

    !> The first half of a solve, L^-1 x: right-hand sides that have it behind them may still be added to each
    !! other.
    subroutine first_half(self, x)
      import :: assembled_matrix, wp
      class(assembled_matrix), intent(in) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)  !! [order, any]
    end subroutine first_half

    !> The second half, L'^-1 x. Rows before `first` are not wanted, and may be left unfinished.
    subroutine second_half(self, x, first)
      import :: assembled_matrix, wp
      class(assembled_matrix), intent(in) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)  !! [order, any]
      integer, intent(in) :: first
    end subroutine second_half

    !> L22, the last rows and columns of the factor. (A function would hand back a copy.)
    pure subroutine last_of_factor(self, x)
      import :: assembled_matrix, wp
      class(assembled_matrix), intent(in) :: self
      real(wp), allocatable, intent(out) :: x(:, :)   !! lower triangle, zeros above it [trailing, trailing]
    end subroutine last_of_factor
  end interface

contains

  !> Make a part ready for its elements. A band is.
  subroutine open(self, p)
    class(assembled_matrix), intent(inout) :: self
    integer, intent(in) :: p   !! the part; one behind the last: elements that have no equations

  end subroutine open

  !> A part has all its elements. A band waits for `factor`.
  subroutine close(self, p)
    class(assembled_matrix), intent(inout) :: self
    integer, intent(in) :: p   !! the part

  end subroutine close

  !> End with the Cholesky factor of the matrix. Many singular matrices pass for definite, so the ratio of the
  !! smallest pivot to its diagonal entry is returned as well.
  subroutine factor(self, smallest_ratio, at)
    class(assembled_matrix), intent(inout) :: self
    real(wp), intent(out) :: smallest_ratio  !! 0 where the matrix is not definite
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

  !> Columns that an estimate of the condition begins with, of 1-norm 1: equal parts, and the alternating
  !! column that finds what they cancel (Higham's).
  pure function probes(order) result(x)
    integer, intent(in) :: order   !! of the matrix
    real(wp) :: x(order, 2)
    integer :: i

    x(:, 1) = 1.0_wp/max(1, order)
    x(:, 2) = [((1 - 2*modulo(i - 1, 2))*(1.0_wp + real(i - 1, wp)/max(1, order - 1)), i=1, order)]
    x(:, 2) = x(:, 2)/sum(abs(x(:, 2)))
  end function probes

  !> N K^-1 N' from the factor, by its trailing block L22, since all that stands before has been eliminated
  !! from it: the inverse (L22 L22')^-1 in place, where each row of N is a trailing equation in turn; else
  !! X'X with X = L22^-1 N'.
  pure subroutine find_compliance(self, rows, compliance)
    class(assembled_matrix), intent(in) :: self
    type(sparse_rows), intent(in) :: rows       !! N; equations before the trailing ones count for nothing
    real(wp), allocatable, intent(out) :: compliance(:, :)   !! lower triangle [rows, rows]
    real(wp), allocatable :: factor(:, :), x(:, :)
    integer :: at(size(rows%equation)), begins(size(rows%start) - 1), column(size(rows%equation)), &
        order(size(rows%start) - 1)
    integer :: i, k

    at = max(0, rows%equation - (self%order - self%trailing))
    if (size(at) == self%trailing .and. size(order) == self%trailing) then
      if (all(at == [(k, k=1, size(at))]) .and. all(rows%start == [(k, k=1, size(rows%start))])) then
        call self%get_trailing_factor(compliance)
        call cholesky_inverse(compliance)
        do k = 1, size(order)
          compliance(k:, k) = rows%weight(k)*rows%weight(k:)*compliance(k:, k)
        end do
        return
      end if
    end if
    call order_rows(sparse_rows(rows%start, at, rows%weight), self%trailing, order, column, begins)
    allocate (x(self%trailing, size(order)), source=0.0_wp)
    do i = 1, size(at)
      if (at(i) > 0) x(at(i), column(i)) = x(at(i), column(i)) + rows%weight(i)
    end do
    call self%get_trailing_factor(factor)
    call solve_staircase(self%trailing, factor, begins, x)
    deallocate (factor)
    allocate (compliance(size(order), size(order)))
    call multiply_staircase(self%trailing, x, begins, order, compliance)
  end subroutine find_compliance

  !> The rows in the order of their first equations, and which of these has each entry.
  pure subroutine order_rows(rows, equations, order, column, begins)
    type(sparse_rows), intent(in) :: rows   !! equations that are not positive count for nothing
    integer, intent(in) :: equations        !! how many there are
    integer, intent(out) :: order(:)        !! [rows]
    integer, intent(out) :: column(:)       !! [entries]
    !> The first equation of each row in that order; behind the last: none
    integer, intent(out) :: begins(:)
    integer :: i, k

    begins = equations + 1
    do k = 1, size(order)
      do i = rows%start(k), rows%start(k + 1) - 1
        if (rows%equation(i) > 0) begins(k) = min(begins(k), rows%equation(i))
      end do
    end do
    order = sorted_order(begins)
    begins = begins(order)
    do k = 1, size(order)
      column(rows%start(order(k)):rows%start(order(k) + 1) - 1) = k
    end do
  end subroutine order_rows
end module epcont_linalg_assembled
