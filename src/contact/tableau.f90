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
module epcont_contact_tableau
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: contact_basis, respond
  use epcont_contact_scaling, only: scaled_problem
  use epcont_linalg_dense, only: add_product
  implicit none
  private
  public :: contact_tableau, new_tableau, pivot, row_of, column_of

  !> The variable that carries the load from 0 to 1.
  integer, parameter, public :: load_factor = 0

  type :: contact_tableau
    real(wp), allocatable :: entry(:, :)   !! [n, n + 1]
    real(wp), allocatable :: value(:)      !! basic variables [n]
    integer, allocatable :: basic(:)       !! variable of each row [n]
    integer, allocatable :: nonbasic(:)    !! variable of each column [n + 1]
    integer, allocatable :: first_basic(:) !! basic variables of the start; they are perturbed against ties [n]
    integer, allocatable :: place(:)       !! of each variable: its row, or minus its column [-n:n]
  end type contact_tableau

contains

  !> The tableau of a sound basis, from `start` at t = 0 to `goal` at t = 1.
  pure function new_tableau(problem, basis, start, goal) result(tableau)
    type(scaled_problem), intent(in) :: problem
    type(contact_basis), intent(in) :: basis
    real(wp), intent(in) :: start(:)   !! basic variable of each pair at t = 0, all >= 0 [n]
    real(wp), intent(in) :: goal(:)    !! the same at t = 1 [n]
    type(contact_tableau) :: tableau
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
    allocate (tableau%entry(n, n + 1))
    call fill_entries(problem, basis, tableau%entry(:, :n))
    tableau%entry(:, n + 1) = goal - start
  end function new_tableau

  !> Response of the basic variables to unit nonbasic ones: gaps of the pairs in contact, forces of the others.
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

  !> Row of a variable; 0 while it is nonbasic.
  elemental function row_of(tableau, variable) result(row)
    type(contact_tableau), intent(in) :: tableau
    integer, intent(in) :: variable
    integer :: row

    row = max(tableau%place(variable), 0)
  end function row_of

  !> Column of a variable; 0 while it is basic.
  elemental function column_of(tableau, variable) result(column)
    type(contact_tableau), intent(in) :: tableau
    integer, intent(in) :: variable
    integer :: column

    column = max(-tableau%place(variable), 0)
  end function column_of

  !> Exchange the basic variable of `row` with the nonbasic one of `column`.
  pure subroutine pivot(tableau, row, column)
    type(contact_tableau), intent(inout) :: tableau
    integer, intent(in) :: row, column
    real(wp), allocatable :: slope(:)   !! change of each basic variable with the entering one [n]
    real(wp) :: coefficient, divisor, ratio
    integer :: entering, j, leaving

    slope = tableau%entry(:, column)
    divisor = slope(row)
    ratio = max(tableau%value(row), 0.0_wp)/(-divisor)
    do j = 1, size(tableau%nonbasic)
      coefficient = -tableau%entry(row, j)/divisor
      if (j == column .or. coefficient == 0.0_wp) cycle
      tableau%entry(:, j) = tableau%entry(:, j) + coefficient*slope
      tableau%entry(row, j) = coefficient
    end do
    tableau%entry(:, column) = slope/divisor
    tableau%entry(row, column) = 1.0_wp/divisor
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
