!> Symmetric positive definite sparse matrices: what `band_matrix` does, for large systems, by MUMPS.
!>
!> The lower triangle is stored by columns: entries start(j) to start(j + 1) - 1 are those of column j, their rows
!> ascending, the diagonal first. The pattern is set and analysed once; then, as often as one likes, `clear`, `add` and
!> `factor`. Where the program is built without MUMPS (`sparse_available`), `analyse` fails.
module epcont_linalg_sparse
  use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_double, c_int, c_loc, c_null_ptr, c_ptr
  use epcont_base_kinds, only: i8, wp
  use epcont_linalg_lapack, only: dlacn2
  use epcont_linalg_sparse_pattern, only: find_pattern
  implicit none
  private
  public :: sparse_matrix, sparse_available

  !> What hangs on `solver` belongs to the matrix that was analysed; in a copy of it, which stands elsewhere, it is nothing, so that
  !! it is given back once, and a copy has the entries but must be analysed. (Defined assignment would do it, but gfortran 12
  !! fails on types with such a component.) `release` a matrix before something is assigned to it: gfortran 12 does not finalize it.
  type :: sparse_matrix
    integer :: order = 0
    integer, allocatable :: start(:)        !! [order + 1]
    integer, allocatable :: row(:)          !! of each entry
    real(wp), allocatable :: entries(:)
    real(wp) :: norm = 0.0_wp               !! 1-norm of the matrix last factored
    integer(i8) :: bytes = 0                !! that factoring will take, from the analysis; 0: not analysed
    type(c_ptr), private :: solver = c_null_ptr
    type(c_ptr), private :: home = c_null_ptr   !! where the matrix stood when it was analysed
    logical, private :: factored = .false.
  contains
    procedure :: set_pattern
    procedure :: clear
    procedure :: add
    procedure :: analyse
    procedure :: factor
    procedure :: solve
    procedure :: condition
    procedure :: trailing_inverse
    procedure :: release
    procedure, private :: at_home
    final :: finalize
  end type sparse_matrix

  !> ICNTL(7) of MUMPS. Of AMD, AMF, SCOTCH and PORD (Debian's has no METIS) AMF orders fastest and leaves no more to do than AMD.
  !! PORD takes four times as long to order; on graded meshes from 100 000 unknowns on it saves a quarter of each factorization
  !! and half of the inverse, on a regular grid it lost a tenth. SCOTCH is level with PORD, but its smallest pivots, and so
  !! its order, were seen to change from run to run.
  integer, parameter :: amf = 2, pord = 4
  integer, parameter :: pord_from = 100000
  !> A ratio below this is worth two solves to find out where.
  real(wp), parameter :: suspect_ratio = 1.0e-10_wp
  !> Relative to the diagonal: well above the rounding of large systems, well below the ratios of sound ones.
  real(wp), parameter :: raising = 1.0e-8_wp

  ! mumps.f90 or mumps_none.f90
  interface
    pure function mumps_available() result(available) bind(c, name='epcont_mumps_available')
      import :: c_bool
      logical(c_bool) :: available
    end function mumps_available

    pure subroutine mumps_analyse(solver, order, start, row, ordering, megabytes, operations) bind(c, name='epcont_mumps_analyse')
      import :: c_double, c_int, c_ptr
      type(c_ptr), intent(inout) :: solver
      integer(c_int), value, intent(in) :: order
      integer(c_int), intent(in) :: start(order + 1), row(*)
      integer(c_int), value, intent(in) :: ordering
      integer(c_int), intent(out) :: megabytes
      real(c_double), intent(out) :: operations
    end subroutine mumps_analyse

    pure subroutine mumps_factor(solver, entries, a, smallest_ratio, info) bind(c, name='epcont_mumps_factor')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value, intent(in) :: solver
      integer(c_int), value, intent(in) :: entries
      real(c_double), intent(in) :: a(entries)
      real(c_double), intent(out) :: smallest_ratio
      integer(c_int), intent(out) :: info
    end subroutine mumps_factor

    pure subroutine mumps_solve(solver, order, columns, x) bind(c, name='epcont_mumps_solve')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value, intent(in) :: solver
      integer(c_int), value, intent(in) :: order, columns
      real(c_double), intent(inout) :: x(order*columns)
    end subroutine mumps_solve

    pure subroutine mumps_inverse_entries(solver, order, count, packed) bind(c, name='epcont_mumps_inverse_entries')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value, intent(in) :: solver
      integer(c_int), value, intent(in) :: order, count
      real(c_double), intent(out) :: packed(count*(count + 1)/2)
    end subroutine mumps_inverse_entries

    pure subroutine mumps_release(solver) bind(c, name='epcont_mumps_release')
      import :: c_ptr
      type(c_ptr), intent(inout) :: solver
    end subroutine mumps_release
  end interface

contains

  !> Whether MUMPS is built in.
  pure logical function sparse_available()

    sparse_available = mumps_available()
  end function sparse_available

  !> Set the pattern from the equations of each element, and all entries to zero.
  pure subroutine set_pattern(self, order, numbers)
    class(sparse_matrix), intent(inout) :: self
    integer, intent(in) :: order
    integer, intent(in) :: numbers(:, :)   !! equations of each element; 0 and less: none [any, elements]

    call self%release()
    self%order = order
    call find_pattern(order, numbers, self%start, self%row)
    allocate (self%entries(size(self%row)), source=0.0_wp)
  end subroutine set_pattern

  !> Set all entries to zero.
  pure subroutine clear(self)
    class(sparse_matrix), intent(inout) :: self

    self%entries = 0.0_wp
  end subroutine clear

  !> Add an element matrix; equations of number 0 and less are left out.
  pure subroutine add(self, k, numbers)
    class(sparse_matrix), intent(inout) :: self
    real(wp), intent(in) :: k(:, :)        !! both triangles
    integer, intent(in) :: numbers(:)      !! as they were when the pattern was set
    integer :: at, i, j

    do j = 1, size(numbers)
      if (numbers(j) <= 0) cycle
      do i = 1, size(numbers)
        if (numbers(i) < numbers(j)) cycle
        at = position(self, numbers(i), numbers(j))
        self%entries(at) = self%entries(at) + k(i, j)
      end do
    end do
  end subroutine add

  !> Where entry (i, j), j <= i, stands; it must be in the pattern.
  pure integer function position(self, i, j) result(low)
    class(sparse_matrix), intent(in) :: self
    integer, intent(in) :: i, j
    integer :: high, middle

    low = self%start(j)
    high = self%start(j + 1) - 1
    do while (low < high)
      middle = (low + high)/2
      if (self%row(middle) < i) then
        low = middle + 1
      else
        high = middle
      end if
    end do
  end function position

  !> Whether there is an analysis, and it is of this matrix.
  pure logical function at_home(self)
    class(sparse_matrix), intent(in), target :: self

    at_home = c_associated(self%solver)
    if (at_home) at_home = c_associated(self%home, c_loc(self%order))
  end function at_home

  !> Choose the order of elimination for all factorizations to come; `self%bytes` then says what they will take.
  pure subroutine analyse(self, reused)
    class(sparse_matrix), intent(inout), target :: self
    logical, intent(in) :: reused    !! there will be several factorizations
    type(c_ptr) :: other
    real(wp) :: operations, fewer
    integer :: megabytes, other_megabytes

    self%factored = .false.
    self%bytes = 0
    if (self%order == 0) return
    if (.not. self%at_home()) self%solver = c_null_ptr
    self%home = c_loc(self%order)
    call mumps_analyse(self%solver, self%order, self%start, self%row, amf, megabytes, operations)
    if (reused .and. self%order >= pord_from .and. megabytes > 0) then
      other = c_null_ptr
      call mumps_analyse(other, self%order, self%start, self%row, pord, other_megabytes, fewer)
      if (other_megabytes > 0 .and. fewer < operations) then
        call mumps_release(self%solver)
        self%solver = other
        megabytes = other_megabytes
      else
        call mumps_release(other)
      end if
    end if
    self%bytes = 1000000_i8*megabytes
  end subroutine analyse

  !> Factor; the entries stay. MUMPS gives the smallest pivot but not its equation: where it is suspect, the equation that
  !! moves most in the weakest motion is named, and else none.
  pure subroutine factor(self, smallest_ratio, at)
    class(sparse_matrix), intent(inout) :: self
    real(wp), intent(out) :: smallest_ratio  !! smallest pivot / diagonal; 0 where the matrix is not definite, or not analysed
    integer, intent(out) :: at               !! equation of a suspect pivot; 0: none, or (ratio 0) memory did not suffice
    integer :: info

    smallest_ratio = 1.0_wp
    at = 0
    if (self%order == 0) return
    self%norm = norm_of(self)
    self%factored = .false.
    smallest_ratio = 0.0_wp
    if (.not. self%at_home()) return
    call mumps_factor(self%solver, size(self%entries), self%entries, smallest_ratio, info)
    if (info < 0) return
    self%factored = info == 0
    if (smallest_ratio < suspect_ratio) call find_weakest(self, at)
  end subroutine factor

  !> 1-norm, from the lower triangle.
  pure real(wp) function norm_of(self)
    class(sparse_matrix), intent(in) :: self
    real(wp), allocatable :: row_sum(:)
    integer :: j, k

    allocate (row_sum(self%order), source=0.0_wp)
    do j = 1, self%order
      row_sum(j) = row_sum(j) + sum(abs(self%entries(self%start(j):self%start(j + 1) - 1)))
      do k = self%start(j) + 1, self%start(j + 1) - 1
        row_sum(self%row(k)) = row_sum(self%row(k)) + abs(self%entries(k))
      end do
    end do
    norm_of = maxval(row_sum)
  end function norm_of

  !> The equation that moves most in the weakest motion: two steps of inverse iteration on the matrix scaled to a
  !! diagonal of ones, with its diagonal raised a little where it cannot be factored as it is.
  pure subroutine find_weakest(self, at)
    class(sparse_matrix), intent(inout) :: self
    integer, intent(out) :: at
    real(wp), allocatable :: raised(:), scale(:), x(:, :)
    real(wp) :: ratio
    integer :: i, info, step

    associate (diagonal => self%entries(self%start(:self%order)))
      at = minloc(diagonal, dim=1)
      if (diagonal(at) <= 0.0_wp) return
      scale = sqrt(diagonal)
    end associate
    info = 0
    if (.not. self%factored) then
      raised = self%entries
      raised(self%start(:self%order)) = (1.0_wp + raising)*raised(self%start(:self%order))
      call mumps_factor(self%solver, size(raised), raised, ratio, info)
    end if
    at = 0
    if (info < 0) return
    allocate (x(self%order, 1))
    x(:, 1) = [(1.0_wp + 0.5_wp*sin(real(i, wp)**2), i=1, self%order)]
    do step = 1, 2
      x(:, 1) = scale*x(:, 1)
      call mumps_solve(self%solver, self%order, 1, x)
      x(:, 1) = scale*x(:, 1)
      x = x/max(maxval(abs(x)), tiny(1.0_wp))
    end do
    at = maxloc(abs(x(:, 1)), dim=1)
  end subroutine find_weakest

  !> Solve with the factor, in place.
  pure subroutine solve(self, x)
    class(sparse_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)  !! right-hand sides, then solutions [order, any]

    if (size(x) == 0 .or. .not. (self%factored .and. self%at_home())) return
    call mumps_solve(self%solver, self%order, size(x, 2), x)
  end subroutine solve

  !> Estimate of the condition in the 1-norm, from the factor, as that of `band_matrix`.
  pure function condition(self) result(number)
    class(sparse_matrix), intent(in) :: self
    real(wp) :: number
    real(wp), allocatable :: v(:), x(:, :)
    real(wp) :: inverse_norm
    integer, allocatable :: signs(:)
    integer :: asked, state(3)

    number = 1.0_wp
    if (self%order == 0) return
    allocate (v(self%order), x(self%order, 1), source=0.0_wp)
    allocate (signs(self%order), source=0)
    asked = 0
    state = 0
    inverse_norm = 0.0_wp
    do
      call dlacn2(self%order, v, x, signs, inverse_norm, asked, state)
      if (asked == 0) exit
      call self%solve(x)
    end do
    number = self%norm*inverse_norm
  end function condition

  !> Trailing block of the inverse, by the entries of the inverse that MUMPS offers (ICNTL(30)). Measured against it for 50 to
  !! 600 rows of 6 000 to 170 000: solutions for sparse unit vectors took 6 to 30 times as long; the Schur complement with
  !! its inversion and the factorization about as long together, but it allows no ordering but AMD, and makes two of every solve.
  pure function trailing_inverse(self, count) result(inverse)
    class(sparse_matrix), intent(in) :: self
    integer, intent(in) :: count              !! rows and columns wanted
    real(wp), allocatable :: inverse(:, :)    !! full symmetric [count, count]
    real(wp), allocatable :: column(:)
    integer :: j, k

    allocate (inverse(count, count), source=0.0_wp)
    if (count == 0 .or. .not. (self%factored .and. self%at_home())) return
    allocate (column(count*(count + 1)/2))
    call mumps_inverse_entries(self%solver, self%order, count, column)
    k = 0
    do j = 1, count
      inverse(j:, j) = column(k + 1:k + count - j + 1)
      inverse(j, j:) = inverse(j:, j)
      k = k + count - j + 1
    end do
  end function trailing_inverse

  !> Give back analysis, factor and storage; the matrix is then as new.
  elemental subroutine release(self)
    class(sparse_matrix), intent(inout) :: self

    if (self%at_home()) call mumps_release(self%solver)
    self%solver = c_null_ptr
    self%order = 0
    self%bytes = 0
    self%norm = 0.0_wp
    self%factored = .false.
    if (allocated(self%start)) deallocate (self%start)
    if (allocated(self%row)) deallocate (self%row)
    if (allocated(self%entries)) deallocate (self%entries)
  end subroutine release

  elemental subroutine finalize(self)
    type(sparse_matrix), intent(inout) :: self

    if (self%at_home()) call mumps_release(self%solver)
  end subroutine finalize
end module epcont_linalg_sparse
