!> The simplex on the load not carried yet: follow the contact as the load factor t grows from 0 to 1.
!>
!> The tableau has each basic variable as a linear function of the nonbasic ones:
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
!> settled + pivot_columns pivot_rows.
module epcont_contact_loading
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: negligible, solved_to
  use epcont_contact_basis, only: respond
  use epcont_contact_problem, only: contact_solution, history_limit, pivot_record
  use epcont_contact_scaling, only: scaled_problem
  use epcont_contact_state, only: basic_values, contact_state
  use epcont_linalg_dense, only: add_product
  implicit none
  private
  public :: follow_load

  !> Pivots allowed for each unknown before rounding is taken to have broken the path; sound ones were seen to
  !! take up to 2.
  integer, parameter :: pivots_per_unknown = 4
  !> The variable that carries the load from 0 to 1.
  integer, parameter :: load_factor = 0
  !> Pivots whose products are added together.
  integer, parameter :: panel = 16

contains

  !> Pivot until the load is complete. Each pivot is an event of growing load: a pair closes or opens. The
  !! partner of the variable that left enters next (Conry and Seireg 1971).
  subroutine follow_load(scaled, state, start, solution, complete, closed, ray)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    type(contact_state), intent(in) :: state     !! a sound set at t = 1: its forces are basic at first
    real(wp), intent(in) :: start(:)             !! basic variable of each pair at t = 0, all >= 0 [n]
    type(contact_solution), intent(inout) :: solution   !! pivots are counted and recorded here
    !> All of the load is carried; else there is a ray, or rounding has broken the order of ties.
    logical, intent(out) :: complete
    logical, allocatable, intent(out) :: closed(:)      !! pairs with a basic force at the end [n]
    !> Growth of the forces where the load cannot grow and nothing gives way; else not allocated [n]
    real(wp), allocatable, intent(out) :: ray(:)
    real(wp) :: settled(size(start), size(start) + 1)   ! the entries but for the last pivots
    integer :: pending                                  ! so many are these
    real(wp) :: pivot_columns(size(start), panel), pivot_rows(panel, size(start) + 1)
    real(wp) :: value(size(start))                      ! basic variables
    !> Variable of each row, now and at the start; those are perturbed against ties
    integer, dimension(size(start)) :: basic, first_basic
    integer :: place(-size(start):size(start))          ! of each variable: its row, or minus its column
    real(wp) :: slope(size(start))                      ! change of the basic variables with the entering one
    real(wp) :: load_rate                               ! and of the load factor
    integer :: column, count, entering, n, row
    real(wp) :: ratio                                   ! the entering variable grows by up to the next event

    n = size(start)
    call begin_tableau()
    entering = load_factor
    do count = 0, pivots_per_unknown*(n + size(scaled%resultant))
      if (count > 0) call pivot()
      column = -place(entering)
      slope = entries_of_rows([(row, row=1, n)], column)
      call test_ratios()
      complete = is_complete()
      if (complete .or. row == 0) exit
    end do
    if (.not. complete .and. row == 0) then
      allocate (ray(n), source=0.0_wp)
      ray(pack(basic, basic > 0)) = pack(slope, basic > 0)
      if (entering > 0) ray(entering) = 1.0_wp
    end if
    closed = place(1:) > 0
    ! The force on its way in at full load is positive; where it moved no load it stays out.
    if (entering > 0 .and. load_rate > 0.0_wp) closed(entering) = .true.

  contains

    !> The tableau of the set, with the responses of the basic variables to unit nonbasic ones: gaps of the
    !! pairs in contact, forces of the others.
    subroutine begin_tableau()
      real(wp), allocatable, dimension(:, :) :: opening, load, force, approach, motion, responding
      integer :: i

      associate (pairs => state%pairs)
        basic = [(-i, i=1, n)]
        basic(pairs) = pairs
        first_basic = basic
        place(basic) = [(i, i=1, n)]
        place([-basic, load_factor]) = [(-i, i=1, n + 1)]
        value = start
        pending = 0
        motion = scaled%motion%dense()
        settled(:, :n) = scaled%flexibility_scale*scaled%flexibility
        opening = settled(pairs, :n)
        responding = settled(:, pairs)
        load = -transpose(motion)
        do i = 1, size(pairs)
          opening(:, pairs(i)) = 0.0_wp
          opening(i, pairs(i)) = -1.0_wp
        end do
        load(:, pairs) = 0.0_wp
        settled(:, pairs) = 0.0_wp
        call respond(state%contact_basis, opening, load, force, approach)
        call add_product(1.0_wp, responding, force, settled(:, :n))
        call add_product(-1.0_wp, motion, approach, settled(:, :n))
        settled(pairs, :n) = force
        settled(:, n + 1) = basic_values(state) - start
      end associate
    end subroutine begin_tableau

    !> How far the entering variable can grow, and the row of the basic one that becomes zero first; 0: none.
    subroutine test_ratios()
      logical :: blocking(n)
      real(wp) :: ratios(n)

      associate (load_row => place(load_factor))
        load_rate = merge(1.0_wp, 0.0_wp, entering == load_factor)
        if (load_row > 0) load_rate = merge(slope(load_row), 0.0_wp, slope(load_row) > negligible)
      end associate
      row = 0
      ratio = huge(ratio)
      blocking = slope < -negligible .and. basic /= load_factor
      if (.not. any(blocking)) return
      ratios = huge(ratio)
      where (blocking) ratios = max(value, 0.0_wp)/(-slope)
      ratio = minval(ratios)
      row = least_row(ratios <= ratio + negligible*max(ratio, 1.0_wp))
      ratio = ratios(row)
    end subroutine test_ratios

    !> The one of the tied rows that would block first if the basic variables of the start were larger by e,
    !! e^2, ... (lexicographic order). Without it ties could make the simplex go round in circles. Row i
    !! changes with such a variable by 1 if it is basic in it, not at all if it is basic elsewhere, and else
    !! by minus the entry of its column.
    pure integer function least_row(tied) result(row)
      logical, intent(in) :: tied(:)     !! [n]
      logical :: left(size(tied))
      integer, allocatable :: rows(:)
      real(wp), allocatable :: ratio(:)
      real(wp) :: least
      integer :: i, j

      left = tied
      rows = pack([(i, i=1, n)], left)
      do j = 1, n
        if (size(rows) == 1) exit
        row = place(first_basic(j))
        if (row > 0) then
          if (.not. left(row) .or. -negligible*slope(row) >= 1.0_wp) cycle
          left(row) = .false.
        else
          ratio = entries_of_rows(rows, -row)/slope(rows)
          least = minval(ratio)
          left(rows) = ratio <= least + negligible*max(abs(least), 1.0_wp)
        end if
        rows = pack(rows, left(rows))
      end do
      row = rows(1)
    end function least_row

    !> Those of some rows in a column.
    pure function entries_of_rows(rows, column) result(entry)
      integer, intent(in) :: rows(:), column
      real(wp) :: entry(size(rows))
      integer :: i

      entry = settled(rows, column)
      do i = 1, pending
        entry = entry + pivot_rows(i, column)*pivot_columns(rows, i)
      end do
    end function entries_of_rows

    !> Is all of the load carried before another variable blocks, or together with it?
    pure logical function is_complete() result(complete)
      real(wp) :: carried   ! so far

      carried = 0.0_wp
      if (place(load_factor) > 0) carried = value(place(load_factor))
      complete = carried >= 1.0_wp - solved_to
      if (load_rate > 0.0_wp) &
        complete = complete .or. max(1.0_wp - carried, 0.0_wp)/load_rate*(1.0_wp - solved_to) <= ratio
    end function is_complete

    !> Exchange the basic variable of `row` with the entering one, whose partner enters next; of the first
    !! pivots, write down what happened.
    subroutine pivot()
      integer :: j, leaving

      if (pending == panel) then
        call add_product(1.0_wp, pivot_columns, pivot_rows, settled)
        pending = 0
      end if
      ! The entering row and the leaving column are replaced as a whole by the product; the others change by
      ! it.
      associate (p => pending + 1)
        do j = 1, n + 1
          pivot_rows(p, j) = -(settled(row, j) &
                               + dot_product(pivot_columns(row, :p - 1), pivot_rows(:p - 1, j)))/slope(row)
          settled(row, j) = 0.0_wp
        end do
        pivot_rows(:p - 1, column) = 0.0_wp
        pivot_rows(p, column) = 1.0_wp/slope(row)
        settled(:, column) = 0.0_wp
        pivot_columns(row, :p - 1) = 0.0_wp
        pivot_columns(:, p) = slope
        pivot_columns(row, p) = 1.0_wp
      end associate
      pending = pending + 1
      value = value + ratio*slope
      value(row) = ratio

      leaving = basic(row)
      basic(row) = entering
      place(entering) = row
      place(leaving) = -column
      solution%pivots = solution%pivots + 1
      if (solution%pivots <= history_limit) solution%history = &
        [solution%history, pivot_record(entering, leaving, value(place(load_factor)), ratio)]
      ! (3-4), the contact entry rule: R_k for w_k and w_k for R_k, so that never are both basic
      entering = -leaving
    end subroutine pivot
  end subroutine follow_load
end module epcont_contact_loading
