!> Symmetric positive definite matrices in fronts, factored by the multifrontal method, for large systems.
!>
!> The columns of front p have the rows of its own equations, and below them the rows of the equations that it
!> reaches:
!>
!>     x .        own equations: x: stored, .: stored but above the diagonal, never read
!>     x x
!>     x x        later equations that it reaches, stored together
!>     x x
!>
!> After elimination the update matrix remains, a full matrix of the reached equations, stored from the
!> diagonal down in blocks of columns. It is added to the parent. With nested dissection there are few
!> operations, all of them on full matrices.
module epcont_linalg_fronts
  use epcont_base_kinds, only: i8, wp
  use epcont_linalg_assembled, only: begin_blocks, diagonal
  use epcont_linalg_front_layout, only: columns_along, front_layout
  use epcont_linalg_front_solve, only: front_factor
  use epcont_linalg_full_columns, only: factor_columns, lay_out, take_update_off, update_matrix
  !$ use omp_lib, only: omp_get_num_threads
  implicit none
  private
  public :: front_matrix

  type, extends(front_factor) :: front_matrix
    logical :: once = .false.                   !! factored only once; otherwise filled again in parts
    type(update_matrix), allocatable :: update(:)   !! [fronts]
    logical, allocatable :: stale(:)           !! fronts to be filled and factored again, whole units [fronts]
    !> Equation that failed in each front or its descendants; 0 if no equation failed [fronts]
    integer, allocatable :: failed(:)
    !> Largest sum of magnitudes of its own rows [fronts]
    real(wp), allocatable :: largest_sum(:)
  contains
    procedure :: begin => begin_fronts
    procedure :: clear => clear_fronts
    procedure :: open => open_front
    procedure :: add => add_to_fronts
    procedure :: close => close_front
    procedure :: eliminate => eliminate_fronts
  end type front_matrix

contains

  !> Begin a matrix of zeros.
  subroutine begin_fronts(self, layout, once, trailing)
    class(front_matrix), intent(inout) :: self
    type(front_layout), intent(in) :: layout   !! its fronts
    logical, intent(in) :: once          !! as in the type
    !> Number of equations of the last front, for `find_compliance`; 0 if it is not called
    integer, intent(in) :: trailing

    self%layout = layout
    self%once = once
    !$ self%threads = omp_get_num_threads()
    associate (fronts => size(layout%own))
      allocate (self%update(fronts), self%failed(fronts), self%stale(fronts), self%largest_sum(fronts))
    end associate
    call begin_blocks(self, layout%first, layout%own + layout%reached, trailing)
  end subroutine begin_fronts

  !> Mark all ancestors of stale fronts as stale.
  pure subroutine clear_fronts(self, stale)
    class(front_matrix), intent(inout) :: self
    logical, intent(inout) :: stale(:)   !! as in `assembled_matrix`
    integer :: p

    self%stale = self%once
    associate (unit => self%layout%unit, above => self%layout%parent)
      do p = 1, size(unit)
        if (any(stale(self%first(p):self%first(p + 1) - 1))) self%stale(unit(p)) = .true.
      end do
      do p = 1, size(unit)
        if (self%stale(p) .and. above(p) > 0) self%stale(unit(above(p))) = .true.
      end do
      do p = 1, size(unit)
        self%stale(p) = self%stale(unit(p))
        stale(self%first(p):self%first(p + 1) - 1) = self%stale(p)
      end do
    end associate
  end subroutine clear_fronts

  !> Set a front to zero and add the update matrices of its children; its elements follow.
  subroutine open_front(self, p)
    class(front_matrix), intent(inout) :: self
    integer, intent(in) :: p   !! its children are closed
    integer, allocatable :: below(:)
    integer :: i

    if (p > size(self%stale)) return
    if (.not. self%stale(p)) return
    below = self%layout%below%of(p)
    self%failed(p) = maxval([self%failed(below), 0])
    associate (h => self%height(p), n => self%columns(p), m => self%layout%reached(p), f => self%first(p), &
               update => self%update(p))
      self%entries(self%start(p):self%start(p + 1) - 1) = 0.0_wp
      if (.not. allocated(update%entries)) call lay_out(n, m, update)
      update%entries = 0.0_wp
    end associate
    do i = 1, size(below)
      call pass_on(self, below(i), p)
      if (self%once .or. self%layout%unit(below(i)) /= below(i)) self%update(below(i)) = update_matrix()
    end do
  end subroutine open_front

  !> Add the update matrix of a front to its parent: to the columns that are eliminated there, to the parent's
  !! update matrix, and to the columns along.
  pure subroutine pass_on(self, p, above)
    class(front_matrix), intent(inout) :: self
    integer, intent(in) :: p, above
    !> Places of its rows in the parent, and last row of each run of rows that are consecutive there
    integer, dimension(self%layout%reached(p)) :: place, last
    integer :: j, m
    integer(i8) :: from, into

    m = self%layout%reached(p)
    associate (start => self%layout%rows%start, row => self%layout%rows%group)
      call find_places(m, row(start(p):start(p + 1) - 1), self%first(above), self%columns(above), &
                       self%layout%reached(above), row(start(above):start(above + 1) - 1), place)
    end associate
    do j = m, 1, -1
      last(j) = j
      if (j < m) last(j) = merge(last(min(j + 1, m)), j, place(min(j + 1, m)) == place(j) + 1)
    end do
    associate (left => self%update(p), taken => self%update(above), h => self%height(above), &
               n => self%columns(above))
      from = left%along + self%columns(p)
      into = taken%along
      do j = 1, columns_along
        call add_rows(1, m, place, last, 0, left%entries(from + 1), taken%entries(into + 1))
        from = from + self%height(p)
        into = into + h
      end do
      do j = 1, m
        from = left%row_zero(j) + j
        if (place(j) <= n) then
          into = self%start(above) + int(place(j) - 1, i8)*h
          call add_rows(j, m, place, last, 0, left%entries(from), self%entries(into))
        else
          into = taken%row_zero(place(j) - n) + 1
          call add_rows(j, m, place, last, n, left%entries(from), taken%entries(into))
        end if
      end do
    end associate
  end subroutine pass_on

  !> Add rows of a column to a column of the parent, run by run.
  pure subroutine add_rows(first, rows, place, last, less, column, above)
    integer, intent(in) :: first, rows, place(rows)
    integer, intent(in) :: last(rows)      !! last row of each row's run
    integer, intent(in) :: less            !! rows of the front that its column does not have
    real(wp), intent(in) :: column(first:rows)
    real(wp), intent(inout) :: above(*)
    integer :: i, k

    i = first
    do while (i <= rows)
      associate (shift => place(i) - less - i)
        !GCC$ unroll 1
        do k = i, last(i)
          above(k + shift) = above(k + shift) + column(k)
        end do
      end associate
      i = last(i) + 1
    end do
  end subroutine add_rows

  !> Add an element to the first front that has equations of it. (An automatic array would be allocated on the
  !! heap each time, which takes as long as adding a small element.)
  pure subroutine add_to_fronts(self, n, number, k)
    class(front_matrix), intent(inout) :: self
    integer, intent(in) :: n   !! rows of the element
    integer, intent(in) :: number(n)   !! its equations
    real(wp), intent(in) :: k(n, n)   !! its stiffness
    integer, parameter :: usual = 32
    integer :: at(usual), lowest
    integer, allocatable :: many_at(:)

    lowest = minval(number, mask=number > 0)
    if (lowest > self%order) return   ! it has no equations
    associate (p => self%layout%front_of(lowest))
      if (.not. self%stale(p)) return
      if (n <= usual) then
        call add_to_front(self, p, n, number, k, at)
      else
        allocate (many_at(n))
        call add_to_front(self, p, n, number, k, many_at)
      end if
    end associate
  end subroutine add_to_fronts

  !> Add an element. Entries above the diagonal of own columns are added too, which is faster than skipping
  !! them.
  pure subroutine add_to_front(self, p, n, number, k, at)
    class(front_matrix), intent(inout) :: self
    integer, intent(in) :: p   !! the front
    integer, intent(in) :: n, number(n)
    real(wp), intent(in) :: k(n, n)
    integer, intent(out) :: at(n)   !! places in the front; 0 if the row has none
    integer :: j
    integer(i8) :: into

    associate (from => self%layout%rows%start(p), m => self%layout%reached(p), own => self%columns(p), &
               h => self%height(p), update => self%update(p))
      call find_places(n, number, self%first(p), own, m, self%layout%rows%group(from:from + m - 1), at)
      do j = 1, n
        if (at(j) == 0) cycle
        if (at(j) <= own) then
          into = self%start(p) + int(at(j) - 1, i8)*h
          call add_column(n, at, 1, 0, k(1, j), self%entries(into))
        else
          into = update%row_zero(at(j) - own) + 1
          call add_column(n, at, at(j), own, k(1, j), update%entries(into))
        end if
      end do
      call add_along(n, at, k, h, update%entries(update%along + 1))
    end associate
  end subroutine add_to_front

  !> Find the places of equations in a front, in any order; consecutive equations are found fastest. Equations
  !! of number 0 and less get 0.
  pure subroutine find_places(n, number, first, own, reached, row, at)
    integer, intent(in) :: n, number(n), first, own
    integer, intent(in) :: reached, row(reached)   !! equations, ascending
    integer, intent(out) :: at(n)
    integer :: i, k

    k = 0
    do i = 1, n
      at(i) = max(0, number(i) - first + 1)
      if (at(i) <= own) cycle
      k = min(k + 1, reached)
      if (row(k) /= number(i)) k = place_of(number(i), reached, row)
      at(i) = own + k
    end do
  end subroutine find_places

  !> Find the place of an equation in an ascending list that has it.
  pure integer function place_of(equation, equations, row) result(k)
    integer, intent(in) :: equation, equations, row(equations)
    integer :: half, left

    k = 1
    left = equations
    do while (left > 1)
      half = left/2
      k = k + merge(half, 0, row(k + half) <= equation)   ! without a branch, which could not be predicted
      left = left - half
    end do
  end function place_of

  !> Add rows of an element's column to one of a front.
  pure subroutine add_column(n, at, from, less, k, column)
    integer, intent(in) :: n, at(n)
    integer, intent(in) :: from   !! the first row of the front that is needed
    integer, intent(in) :: less   !! rows of the front that its column does not have
    real(wp), intent(in) :: k(n)
    real(wp), intent(inout) :: column(*)
    integer :: i

    do i = 1, n
      if (at(i) >= from) column(at(i) - less) = column(at(i) - less) + k(i)
    end do
  end subroutine add_column

  !> Add to the columns along: the diagonal of an element (rows may share a place), and the sums of the
  !! magnitudes of its columns. They bound the sums of the matrix, in which entries may cancel.
  pure subroutine add_along(n, at, k, h, along)
    integer, intent(in) :: n, at(n), h
    real(wp), intent(in) :: k(n, n)
    real(wp), intent(inout) :: along(h, 2)
    real(wp) :: total
    integer :: i, j

    do j = 1, n
      if (at(j) == 0) cycle
      total = 0.0_wp
      do i = 1, n
        if (at(i) > 0) total = total + abs(k(i, j))
        if (at(i) == at(j)) along(at(j), 1) = along(at(j), 1) + k(i, j)
      end do
      along(at(j), 2) = along(at(j), 2) + total
    end do
  end subroutine add_along

  !> Factor the own columns of a front, and subtract the part that they eliminate from its update matrix.
  subroutine close_front(self, p)
    class(front_matrix), intent(inout) :: self
    integer, intent(in) :: p   !! which is filled

    if (p > size(self%stale)) return
    if (.not. self%stale(p) .or. self%failed(p) > 0) return
    associate (n => self%columns(p), h => self%height(p), m => self%layout%reached(p), f => self%first(p), &
               own => self%entries(self%start(p):self%start(p + 1) - 1), update => self%update(p))
      call factor_columns(h, n, h, own, self%failed(p))
      if (self%failed(p) > 0) then
        self%failed(p) = f - 1 + self%failed(p)
        return
      end if
      if (m > 0) call take_update_off(m, n, h, own(n + 1), update)
      associate (along => update%entries(update%along + 1:))
        call close_along(h, n, own, along, self%pivot_ratio(f:f + n - 1), self%largest_sum(p))
      end associate
    end associate
  end subroutine close_front

  !> Compute pivot ratios and the largest sum of the own rows from the columns along.
  pure subroutine close_along(h, n, own, along, ratio, largest_sum)
    integer, intent(in) :: h, n
    real(wp), intent(in) :: own(h, n), along(h, 2)
    real(wp), intent(out) :: ratio(n), largest_sum

    ratio = diagonal(h, n, own)**2/along(:n, 1)
    largest_sum = maxval(along(:n, 2))
  end subroutine close_along

  !> Find the first failed equation, and the norm. All fronts are factored when they are closed.
  subroutine eliminate_fronts(self, failed)
    class(front_matrix), intent(inout) :: self
    integer, intent(out) :: failed   !! equation without a pivot; 0 if none failed

    failed = 0
    if (any(self%failed > 0)) failed = minval(self%failed, mask=self%failed > 0)
    self%norm = maxval(self%largest_sum)
  end subroutine eliminate_fronts
end module epcont_linalg_fronts
