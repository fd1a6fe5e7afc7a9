!> The tableau of the contact problem: each basic variable as a linear function of the nonbasic ones.
!>
!>     basic(i) = value(i) + sum over j of entry(i, j) nonbasic(j)
!>
!> A variable is an integer: k is the force R_k, -k the gap w_k, 0 the load factor t; so -v is the partner
!> of v. Nonbasic variables are zero, hence `value` is where the simplex stands. The motions q are free
!> in sign: they are always basic, never block, and no other row needs theirs; so they have no rows.
!>
!>            partners 1..n      t                         n columns + 1
!>          +---------------+--------+
!>     R, w |     entry     |  x - c |  row k: the basic one of R_k, w_k, at first
!>          +---------------+--------+
!>
!> A pivot adds a column times a row to the entries. These are kept apart until there are `panel` of them, and
!> then added by one dgemm; a column or a row of the tableau is put together when it is asked for: entry =
!> settled + left right.
module epcont_contact_tableau
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: contact_basis, respond
  use epcont_contact_scaling, only: scaled_problem
  use epcont_linalg_dense, only: add_product
  implicit none
  private
  public :: contact_tableau, new_tableau, pivot, entries_of_column, entries_of_rows

  !> The variable that carries the load from 0 to 1.
  integer, parameter, public :: load_factor = 0

  !> Pivots whose products are added together.
  integer, parameter :: panel = 16

  type :: contact_tableau
    real(wp), allocatable :: settled(:, :) !! the entries but for the last pivots [n, n + 1]
    integer :: pending = 0                 !! of these there are so many
    real(wp), allocatable :: left(:, :)    !! [n, panel]
    real(wp), allocatable :: right(:, :)   !! [panel, n + 1]
    real(wp), allocatable :: value(:)      !! basic variables [n]
    integer, allocatable :: basic(:)       !! variable of each row [n]
    integer, allocatable :: nonbasic(:)    !! variable of each column [n + 1]
    !> Basic variables of the start; they are perturbed against ties [n]
    integer, allocatable :: first_basic(:)
    integer, allocatable :: place(:)       !! of each variable: its row, or minus its column [-n:n]
  end type contact_tableau

contains

  !> The tableau of a sound basis, from `start` at t = 0 to `goal` at t = 1.
  pure type(contact_tableau) function new_tableau(problem, basis, start, goal) result(tableau)
    type(scaled_problem), intent(in) :: problem   !! in its own units
    type(contact_basis), intent(in) :: basis   !! a sound one: its forces are basic
    real(wp), intent(in) :: start(:)   !! basic variable of each pair at t = 0, all >= 0 [n]
    real(wp), intent(in) :: goal(:)    !! the same at t = 1 [n]
    integer :: k, n

    n = size(start)
    tableau%basic = [(-k, k=1, n)]
    tableau%basic(basis%pairs) = basis%pairs
    tableau%first_basic = tableau%basic
    tableau%nonbasic = [-tableau%basic, load_factor]
    allocate (tableau%place(-n:n))
    do k = 1, n
      tableau%place(tableau%basic(k)) = k
      tableau%place(-tableau%basic(k)) = -k
    end do
    tableau%place(load_factor) = -(n + 1)
    tableau%value = start
    allocate (tableau%settled(n, n + 1), tableau%left(n, panel), tableau%right(panel, n + 1))
    call fill_entries(problem, basis, tableau%settled(:, :n))
    tableau%settled(:, n + 1) = goal - start
  end function new_tableau

  !> Response of the basic variables to unit nonbasic ones: gaps of the pairs in contact, forces of the
  !! others.
  pure subroutine fill_entries(problem, basis, entry)
    type(scaled_problem), intent(in) :: problem
    type(contact_basis), intent(in) :: basis
    real(wp), contiguous, intent(out) :: entry(:, :)   !! [n, n]
    real(wp), allocatable :: opening(:, :), load(:, :), force(:, :), approach(:, :), closed(:, :)
    integer :: i

    opening = problem%flexibility(basis%pairs, :)
    load = -transpose(problem%motion)
    entry = problem%flexibility
    do i = 1, size(basis%pairs)
      opening(:, basis%pairs(i)) = 0.0_wp
      opening(i, basis%pairs(i)) = -1.0_wp
      load(:, basis%pairs(i)) = 0.0_wp
      entry(:, basis%pairs(i)) = 0.0_wp
    end do
    call respond(basis, opening, load, force, approach)
    closed = problem%flexibility(:, basis%pairs)
    call add_product(1.0_wp, closed, force, entry)
    call add_product(-1.0_wp, problem%motion, approach, entry)
    entry(basis%pairs, :) = force
  end subroutine fill_entries

  !> The entries of a column.
  pure function entries_of_column(tableau, column) result(entry)
    type(contact_tableau), intent(in) :: tableau   !! as it stands
    integer, intent(in) :: column   !! its number
    real(wp), allocatable :: entry(:)
    integer :: i

    entry = tableau%settled(:, column)
    do i = 1, tableau%pending
      if (tableau%right(i, column) /= 0.0_wp) entry = entry + tableau%right(i, column)*tableau%left(:, i)
    end do
  end function entries_of_column

  !> Those of some rows in a column.
  pure function entries_of_rows(tableau, rows, column) result(entry)
    type(contact_tableau), intent(in) :: tableau   !! as it stands
    integer, intent(in) :: rows(:), column   !! their numbers
    real(wp) :: entry(size(rows))
    integer :: i

    entry = tableau%settled(rows, column)
    do i = 1, tableau%pending
      entry = entry + tableau%right(i, column)*tableau%left(rows, i)
    end do
  end function entries_of_rows

  !> Exchange the basic variable of `row` with the nonbasic one of `column`.
  pure subroutine pivot(tableau, row, column, slope)
    type(contact_tableau), intent(inout) :: tableau   !! moved on to the next event
    integer, intent(in) :: row, column   !! of the variable that leaves, and of that which enters
    !> Entries of the column: change of the basic variables with the entering one [n]
    real(wp), intent(in) :: slope(:)
    real(wp) :: ratio
    integer :: entering, j, leaving

    ratio = max(tableau%value(row), 0.0_wp)/(-slope(row))
    if (tableau%pending == panel) then
      call add_product(1.0_wp, tableau%left, tableau%right, tableau%settled)
      tableau%pending = 0
    end if
    ! The entering row and the leaving column are replaced as a whole by the product; the others change by it.
    associate (p => tableau%pending + 1)
      do j = 1, size(tableau%nonbasic)
        tableau%right(p, j) = -(tableau%settled(row, j) &
                                + dot_product(tableau%left(row, :p - 1), tableau%right(:p - 1, j))) &
                              /slope(row)
        tableau%settled(row, j) = 0.0_wp
      end do
      tableau%right(:p - 1, column) = 0.0_wp
      tableau%right(p, column) = 1.0_wp/slope(row)
      tableau%settled(:, column) = 0.0_wp
      tableau%left(row, :p - 1) = 0.0_wp
      tableau%left(:, p) = slope
      tableau%left(row, p) = 1.0_wp
    end associate
    tableau%pending = tableau%pending + 1
    tableau%value = tableau%value + ratio*slope
    tableau%value(row) = ratio

    entering = tableau%nonbasic(column)
    leaving = tableau%basic(row)
    tableau%basic(row) = entering
    tableau%nonbasic(column) = leaving
    tableau%place(entering) = row
    tableau%place(leaving) = -column
  end subroutine pivot
end module epcont_contact_tableau
