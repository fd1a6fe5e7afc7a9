!> Simplex along the load: follow the contact as the load factor t grows from 0 to 1.
!>
!> The tableau has each basic variable as a linear function of the nonbasic ones:
!>
!>     basic(i) = value(i) + sum over j of entry(i, j) nonbasic(j)
!>
!> A variable is an integer: k is the force R_k, -k the gap w_k, 0 the load factor t; so -v is the partner
!> of v. Nonbasic variables are zero, so `value` is the current solution. Rigid-body modes q are free
!> in sign: they are always basic, never block, and no other row depends on theirs; so they have no rows.
!>
!>            partners 1..n      t                         n columns + 1
!>          +---------------+--------+
!>     R, w |     entry     |  x - c |  row k: the basic one of R_k, w_k, at first
!>          +---------------+--------+
!>
!> A pivot adds a column times a row to the entries. These are kept separate until there are `panel` of them,
!> and then added by one dgemm; a column or a row of the tableau is computed when needed: entry =
!> settled + pivot_columns pivot_rows.
module epcont_contact_loading
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: negligible, solved_to
  use epcont_contact_basis, only: respond
  use epcont_contact_problem, only: contact_solution
  use epcont_contact_scaling, only: scaled_problem
  use epcont_contact_state, only: basic_values, contact_state
  use epcont_linalg_dense, only: add_product
  implicit none
  private
  public :: follow_load

  !> Pivots for each unknown after which rounding is assumed to have broken the path; sound paths took
  !! up to 2.
  integer, parameter :: pivots_per_unknown = 4
  !> Variable that carries the load from 0 to 1.
  integer, parameter :: load_factor = 0
  !> Number of pivots whose products are added together.
  integer, parameter :: panel = 16

  type :: load_tableau
    integer :: n = 0                                    !! pairs
    real(wp), allocatable :: settled(:, :)              !! entries without the last pivots [n, n + 1]
    integer :: pending = 0                              !! number of these
    real(wp), allocatable :: pivot_columns(:, :), pivot_rows(:, :)   !! [n, panel], [panel, n + 1]
    real(wp), allocatable :: value(:)                   !! basic variables [n]
    !> Variable of each row, now and at the start; the first ones are perturbed against ties [n]
    integer, allocatable :: basic(:), first_basic(:)
    !> Position of each variable: its row, or minus its column [-n:n]
    integer, allocatable :: place(:)
    integer :: entering = load_factor                   !! variable
    integer :: column = 0                               !! its column
    real(wp), allocatable :: slope(:)                   !! change of the basic variables with it [n]
    real(wp) :: load_rate = 1.0_wp                      !! and of the load factor
    real(wp) :: ratio = 0.0_wp                          !! its increase up to the next event
    integer :: row = 0                                  !! row of the variable that leaves then; 0 if absent
  contains
    procedure :: begin
    procedure :: test_ratios
    procedure :: least_row
    procedure :: entries_of_rows
    procedure :: is_complete
    procedure :: exchange
    procedure :: pivot
  end type load_tableau

contains

  !> Pivot until the load is complete. Each pivot is an event of growing load: a pair closes or opens. The
  !! partner of the variable that left enters next (Conry and Seireg 1971).
  subroutine follow_load(scaled, state, start, solution, complete, closed, ray)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    type(contact_state), intent(in) :: state     !! sound set at t = 1: its forces are basic first
    real(wp), intent(in) :: start(:)             !! basic variable of each pair at t = 0, all >= 0 [n]
    type(contact_solution), intent(inout) :: solution   !! pivots are counted and recorded here
    !> All of the load is carried; else there is a ray, or rounding has broken the order of ties
    logical, intent(out) :: complete
    logical, allocatable, intent(out) :: closed(:)      !! pairs in contact: with a basic force at the end [n]
    !> Growth of the forces if the load cannot grow and nothing deforms; else not allocated [n]
    real(wp), allocatable, intent(out) :: ray(:)
    type(load_tableau) :: tableau
    integer :: count, i

    call tableau%begin(scaled, state, start)
    do count = 0, pivots_per_unknown*(tableau%n + size(scaled%resultant))
      if (count > 0) call tableau%pivot(solution)
      tableau%column = -tableau%place(tableau%entering)
      tableau%slope = tableau%entries_of_rows([(i, i=1, tableau%n)], tableau%column)
      call tableau%test_ratios()
      complete = tableau%is_complete()
      if (complete .or. tableau%ratio >= huge(1.0_wp)) exit
    end do
    associate (basic => tableau%basic, entering => tableau%entering)
      if (.not. complete .and. tableau%ratio >= huge(1.0_wp)) then
        allocate (ray(tableau%n), source=0.0_wp)
        ray(pack(basic, basic > 0)) = pack(tableau%slope, basic > 0)
        if (entering > 0) ray(entering) = 1.0_wp
      end if
      closed = tableau%place(1:) > 0
      ! The force that enters at full load is positive, unless it carried no load.
      if (entering > 0 .and. tableau%load_rate > 0.0_wp) closed(entering) = .true.
    end associate
  end subroutine follow_load

  !> Make the tableau of the set, with the responses of the basic variables to unit nonbasic ones: gaps of
  !! pairs in contact, forces of the others.
  subroutine begin(self, scaled, state, start)
    class(load_tableau), intent(inout) :: self
    type(scaled_problem), intent(in) :: scaled
    type(contact_state), intent(in) :: state
    real(wp), intent(in) :: start(:)
    real(wp), allocatable, dimension(:, :) :: opening, load, force, approach, motion, responding
    integer :: i, n

    n = size(start)
    self%n = n
    allocate (self%pivot_columns(n, panel), self%pivot_rows(panel, n + 1), self%settled(n, n + 1))
    allocate (self%place(-n:n))
    self%value = start
    associate (pairs => state%pairs)
      self%basic = [(-i, i=1, n)]
      self%basic(pairs) = pairs
      self%first_basic = self%basic
      self%place(self%basic) = [(i, i=1, n)]
      self%place([-self%basic, load_factor]) = [(-i, i=1, n + 1)]
      motion = scaled%motion%dense()
      self%settled(:, :n) = scaled%flexibility_scale*scaled%flexibility
      opening = self%settled(pairs, :n)
      responding = self%settled(:, pairs)
      load = -transpose(motion)
      do i = 1, size(pairs)
        opening(:, pairs(i)) = 0.0_wp
        opening(i, pairs(i)) = -1.0_wp
      end do
      load(:, pairs) = 0.0_wp
      self%settled(:, pairs) = 0.0_wp
      call respond(state%contact_basis, opening, load, force, approach)
      call add_product(1.0_wp, responding, force, self%settled(:, :n))
      call add_product(-1.0_wp, motion, approach, self%settled(:, :n))
      self%settled(pairs, :n) = force
    end associate
    self%settled(:, n + 1) = basic_values(state) - start
  end subroutine begin

  !> Find the largest growth of the entering variable, and the row of the basic one that becomes zero first; 0
  !! if none does (then the ratio is huge).
  subroutine test_ratios(self)
    class(load_tableau), intent(inout) :: self
    logical :: blocking(self%n)
    real(wp) :: ratios(self%n)

    associate (load_row => self%place(load_factor))
      self%load_rate = merge(1.0_wp, 0.0_wp, self%entering == load_factor)
      if (load_row > 0) &
        self%load_rate = merge(self%slope(load_row), 0.0_wp, self%slope(load_row) > negligible)
    end associate
    self%row = 0
    self%ratio = huge(1.0_wp)
    blocking = self%slope < -negligible .and. self%basic /= load_factor
    if (.not. any(blocking)) return
    ratios = huge(1.0_wp)
    where (blocking) ratios = max(self%value, 0.0_wp)/(-self%slope)
    self%ratio = minval(ratios)
    self%row = self%least_row(ratios <= self%ratio + negligible*max(self%ratio, 1.0_wp))
    self%ratio = ratios(self%row)
  end subroutine test_ratios

  !> Find the tied row that would block first if the basic variables of the start were larger by e,
  !! e^2, ... (lexicographic order). Otherwise, ties could make the simplex cycle. Row i
  !! changes with such a variable by 1 if it is basic in it, by 0 if it is basic elsewhere, and else
  !! by minus the entry of its column.
  pure integer function least_row(self, tied) result(row)
    class(load_tableau), intent(in) :: self
    logical, intent(in) :: tied(:)     !! [n]
    logical :: left(size(tied))
    integer, allocatable :: rows(:)
    real(wp), allocatable :: ratio(:)
    real(wp) :: least
    integer :: i, j

    left = tied
    rows = pack([(i, i=1, self%n)], left)
    do j = 1, self%n
      if (size(rows) == 1) exit
      row = self%place(self%first_basic(j))
      if (row > 0) then
        if (.not. left(row)) cycle
        if (negligible*abs(self%slope(row)) >= 1.0_wp) cycle
        left(row) = .false.
      else
        ratio = self%entries_of_rows(rows, -row)/self%slope(rows)
        least = minval(ratio)
        left(rows) = ratio <= least + negligible*max(abs(least), 1.0_wp)
      end if
      rows = pack(rows, left(rows))
    end do
    row = rows(1)
  end function least_row

  !> Entries of some rows in a column.
  pure function entries_of_rows(self, rows, column) result(entry)
    class(load_tableau), intent(in) :: self
    integer, intent(in) :: rows(:), column
    real(wp) :: entry(size(rows))
    integer :: i

    entry = self%settled(rows, column)
    do i = 1, self%pending
      entry = entry + self%pivot_rows(i, column)*self%pivot_columns(rows, i)
    end do
  end function entries_of_rows

  !> Is all of the load carried before another variable blocks, or together with it?
  pure logical function is_complete(self) result(complete)
    class(load_tableau), intent(in) :: self
    real(wp) :: carried   ! so far

    carried = 0.0_wp
    if (self%place(load_factor) > 0) carried = self%value(self%place(load_factor))
    complete = carried >= 1.0_wp - solved_to
    if (self%load_rate > 0.0_wp) complete = complete .or. &
      max(1.0_wp - carried, 0.0_wp)/self%load_rate*(1.0_wp - solved_to) <= self%ratio
  end function is_complete

  !> Exchange the variable that leaves. Its partner enters next.
  subroutine pivot(self, solution)
    class(load_tableau), intent(inout) :: self
    type(contact_solution), intent(inout) :: solution
    integer :: leaving

    leaving = self%basic(self%row)
    call self%exchange()
    solution%pivots = solution%pivots + 1
    ! (3-4), the contact entry rule: R_k for w_k and w_k for R_k, so that they are never both basic
    self%entering = -leaving
  end subroutine pivot

  !> Exchange the basic variable of `row` with the entering one.
  subroutine exchange(self)
    class(load_tableau), intent(inout) :: self
    integer :: j, leaving

    if (self%pending == panel) then
      call add_product(1.0_wp, self%pivot_columns, self%pivot_rows, self%settled)
      self%pending = 0
    end if
    ! The entering row and the leaving column are replaced as a whole by the product; it changes
    ! the others.
    associate (p => self%pending + 1, row => self%row, column => self%column)
      do j = 1, self%n + 1
        self%pivot_rows(p, j) = -(self%settled(row, j) &
          + dot_product(self%pivot_columns(row, :p - 1), self%pivot_rows(:p - 1, j)))/self%slope(row)
        self%settled(row, j) = 0.0_wp
      end do
      self%pivot_rows(:p - 1, column) = 0.0_wp
      self%pivot_rows(p, column) = 1.0_wp/self%slope(row)
      self%settled(:, column) = 0.0_wp
      self%pivot_columns(row, :p - 1) = 0.0_wp
      self%pivot_columns(:, p) = self%slope
      self%pivot_columns(row, p) = 1.0_wp
    end associate
    self%pending = self%pending + 1
    self%value = self%value + self%ratio*self%slope
    self%value(self%row) = self%ratio
    leaving = self%basic(self%row)
    self%basic(self%row) = self%entering
    self%place(self%entering) = self%row
    self%place(leaving) = -self%column
  end subroutine exchange
end module epcont_contact_loading
