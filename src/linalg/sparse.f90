!> Symmetric positive definite sparse matrices: what `panel_matrix` does, for large systems, by MUMPS.
!>
!> The lower triangle is stored by columns: entries start(j) to start(j + 1) - 1 are those of column j, their rows
!> ascending, the diagonal first. `begin` finds the pattern and analyses it; then, as often as one likes, `clear`, `add` and
!> `factor`. Where there is no MUMPS (`sparse_fault`), `begin` fails.
module epcont_linalg_sparse
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, c_null_ptr, c_ptr
  use epcont_base_kinds, only: i8, wp
  use epcont_linalg_assembled, only: add_seen_through, assembled_matrix
  use epcont_linalg_sparse_pattern, only: find_blocks, find_pattern
  implicit none
  private
  public :: sparse_matrix, sparse_fault

  !> What hangs on `solver` belongs to the matrix that was analysed; in a copy of it, which stands elsewhere, it is nothing, so that
  !! it is given back once, and a copy has the entries but cannot be factored. (Defined assignment would do it, but gfortran 12
  !! fails on types with such a component.) `release` a matrix before something is assigned to it: gfortran 12 does not finalize it.
  type, extends(assembled_matrix) :: sparse_matrix
    integer, allocatable :: start(:)        !! [order + 1]
    integer, allocatable :: row(:)          !! of each entry
    real(wp), allocatable :: entries(:)
    integer(i8) :: bytes = 0                !! that factoring will take, from the analysis; 0: not analysed
    type(c_ptr), private :: solver = c_null_ptr
    type(c_ptr), private :: home = c_null_ptr   !! where the matrix stood when it was analysed
    logical, private :: factored = .false.
  contains
    procedure :: begin
    procedure :: clear
    procedure :: add
    procedure :: factor
    procedure :: solve_upper
    procedure :: add_gram
    procedure :: inverse_at
    procedure :: release
    procedure, private :: at_home
    final :: finalize
  end type sparse_matrix

  !> A ratio below this is worth two solves to find out where.
  real(wp), parameter :: suspect_ratio = 1.0e-10_wp
  !> Relative to the diagonal: well above the rounding of large systems, well below the ratios of sound ones.
  real(wp), parameter :: raising = 1.0e-8_wp

  ! mumps.f90 or mumps_none.f90
  interface
    function mumps_fault() result(fault) bind(c, name='epcont_mumps_fault')
      import :: c_ptr
      type(c_ptr) :: fault
    end function mumps_fault

    pure subroutine mumps_analyse(solver, order, start, row, blocks, first, megabytes) bind(c, name='epcont_mumps_analyse')
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: solver
      integer(c_int), value, intent(in) :: order
      integer(c_int), intent(in) :: start(order + 1), row(*)
      integer(c_int), value, intent(in) :: blocks
      integer(c_int), intent(in) :: first(blocks + 1)
      integer(c_int), intent(out) :: megabytes
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

    pure subroutine mumps_inverse_entries(solver, order, count, equation, packed) bind(c, name='epcont_mumps_inverse_entries')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value, intent(in) :: solver
      integer(c_int), value, intent(in) :: order, count
      integer(c_int), intent(in) :: equation(count)
      real(c_double), intent(out) :: packed(count*(count + 1)/2)
    end subroutine mumps_inverse_entries

    pure subroutine mumps_release(solver) bind(c, name='epcont_mumps_release')
      import :: c_ptr
      type(c_ptr), intent(inout) :: solver
    end subroutine mumps_release
  end interface

contains

  !> Why there is no MUMPS; empty: there is.
  function sparse_fault() result(text)
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: letter(:)
    type(c_ptr) :: fault
    integer :: i

    text = ''
    fault = mumps_fault()
    if (.not. c_associated(fault)) return
    call c_f_pointer(fault, letter, [huge(i)])
    i = 1
    do while (letter(i) /= c_null_char)
      text = text//letter(i)
      i = i + 1
    end do
  end function sparse_fault

  !> Begin a matrix of zeros: find its pattern from the equations of each element, and choose the order of elimination for
  !! all factorizations to come.
  pure subroutine begin(self, order, numbers)
    class(sparse_matrix), intent(inout), target :: self
    integer, intent(in) :: order
    integer, intent(in) :: numbers(:, :)   !! x and y of the nodes in turn; 0 and less: none [any, elements]
    integer, allocatable :: first(:)
    integer :: megabytes

    call self%release()
    self%order = order
    first = find_blocks(order, numbers)
    call find_pattern(numbers, first, self%start, self%row)
    allocate (self%entries(size(self%row)), source=0.0_wp)
    if (order == 0) return
    self%home = c_loc(self%order)
    call mumps_analyse(self%solver, order, self%start, self%row, size(first) - 1, first, megabytes)
    self%bytes = 1000000_i8*megabytes
    self%lacks_memory = megabytes == 0
  end subroutine begin

  !> All of it: MUMPS factors the whole.
  pure subroutine clear(self, stale)
    class(sparse_matrix), intent(inout) :: self
    logical, intent(inout) :: stale(:)

    stale = .true.
    self%entries = 0.0_wp
  end subroutine clear

  pure subroutine add(self, n, number, k)
    class(sparse_matrix), intent(inout) :: self
    integer, intent(in) :: n
    integer, intent(in) :: number(n)      !! as they were when the pattern was found
    real(wp), intent(in) :: k(n, n)
    integer :: at, i, j

    do j = 1, n
      if (number(j) <= 0) cycle
      at = 0
      do i = 1, n
        if (number(i) < number(j)) cycle
        at = position(self, number(i), number(j), at + 1)
        self%entries(at) = self%entries(at) + k(i, j)
      end do
    end do
  end subroutine add

  !> Where entry (i, j), j <= i, stands, which must be in the pattern; `likely` is looked at first.
  pure integer function position(self, i, j, likely) result(low)
    class(sparse_matrix), intent(in) :: self
    integer, intent(in) :: i, j, likely
    integer :: high, middle

    low = self%start(j)
    high = self%start(j + 1) - 1
    if (likely >= low .and. likely <= high) then
      if (self%row(likely) == i) then
        low = likely
        return
      end if
    end if
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

  !> Factor; the entries stay. MUMPS gives the smallest pivot but not its equation: where it is suspect, the equation that
  !! moves most in the weakest motion is named, and else none.
  pure subroutine factor(self, smallest_ratio, at)
    class(sparse_matrix), intent(inout) :: self
    real(wp), intent(out) :: smallest_ratio
    integer, intent(out) :: at               !! equation of a suspect pivot; else 0
    integer :: info

    smallest_ratio = 1.0_wp
    at = 0
    if (self%order == 0) return
    self%factored = .false.
    smallest_ratio = 0.0_wp
    if (.not. self%at_home()) return
    call mumps_factor(self%solver, size(self%entries), self%entries, smallest_ratio, info)
    self%lacks_memory = info < 0
    if (self%lacks_memory) return
    self%factored = info == 0
    if (smallest_ratio < suspect_ratio) call find_weakest(self, at)
  end subroutine factor

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

  !> Both halves of a solve.
  pure subroutine solve_upper(self, x, first)
    class(sparse_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)  !! right-hand sides, then solutions [order, any]
    integer, intent(in) :: first                    !! all rows are solved for

    if (size(x) == 0 .or. .not. (self%factored .and. self%at_home())) return
    call mumps_solve(self%solver, self%order, size(x, 2), x)
  end subroutine solve_upper

  pure subroutine add_gram(self, start, equation, weight, gram)
    class(sparse_matrix), intent(in) :: self
    integer, intent(in) :: start(:), equation(:)
    real(wp), intent(in) :: weight(:)
    real(wp), intent(inout) :: gram(:, :)
    integer, allocatable :: place(:), wanted(:)
    integer :: k

    associate (used => equation(:start(size(start)) - 1))
      allocate (place(self%order), source=0)
      place(pack(used, used > 0)) = 1
      wanted = pack([(k, k=1, self%order)], place > 0)
      place(wanted) = [(k, k=1, size(wanted))]
      call add_seen_through(self%inverse_at(wanted), start, [(merge(place(max(1, used(k))), 0, used(k) > 0), k=1, size(used))], &
                            weight, gram)
    end associate
  end subroutine add_gram

  !> Rows and columns of the inverse, by the entries of the inverse that MUMPS offers (ICNTL(30)). Measured against it for 50 to
  !! 600 rows of 6 000 to 170 000: solutions for sparse unit vectors took 6 to 30 times as long; the Schur complement with
  !! its inversion and the factorization about as long together, but it allows no ordering but AMD, and makes two of every solve.
  pure function inverse_at(self, equation) result(inverse)
    class(sparse_matrix), intent(in) :: self
    integer, intent(in) :: equation(:)        !! which, ascending
    real(wp), allocatable :: inverse(:, :)    !! full symmetric [size(equation), size(equation)]
    real(wp), allocatable :: column(:)
    integer :: j, k, n

    n = size(equation)
    allocate (inverse(n, n), source=0.0_wp)
    if (n == 0 .or. .not. (self%factored .and. self%at_home())) return
    allocate (column(n*(n + 1)/2))
    call mumps_inverse_entries(self%solver, self%order, n, equation, column)
    k = 0
    do j = 1, n
      inverse(j:, j) = column(k + 1:k + n - j + 1)
      inverse(j, j:) = inverse(j:, j)
      k = k + n - j + 1
    end do
  end function inverse_at

  !> Give back analysis, factor and storage; the matrix is then as new.
  elemental subroutine release(self)
    class(sparse_matrix), intent(inout) :: self

    if (self%at_home()) call mumps_release(self%solver)
    self%solver = c_null_ptr
    self%order = 0
    self%bytes = 0
    self%norm = 0.0_wp
    self%lacks_memory = .false.
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
