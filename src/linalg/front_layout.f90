!> Fronts: equations that are eliminated together, and the later equations with which they are then coupled.
!>
!> Front p has the own equations first(p) to first(p+1)-1, and reaches the equations rows%of(p). Its parent,
!> the front with the first of these, has or reaches all of them.
module epcont_linalg_front_layout
  use epcont_base_incidence, only: add_new, incidence, new_incidence
  use epcont_base_kinds, only: i8, wp
  use epcont_base_sorting, only: sorted_order
  implicit none
  private
  public :: front_layout, new_front_layout, block_width, update_size

  !> Least operations of a unit: 0.3 ms, hundreds of times the time of a task, and little to repeat if
  !! something in it has changed. (With 1E6 operations, bodies that yield take 10 % more memory.)
  real(wp), parameter :: least_work = 4.0e6_wp
  !> Columns along: the diagonal of the matrix, and sums of magnitudes, for each row of a front.
  integer, parameter, public :: columns_along = 2

  type :: front_layout
    integer, allocatable :: first(:)       !! equation of each front [fronts + 1]
    integer, allocatable :: front_of(:)    !! each equation
    integer, allocatable :: parent(:)      !! a later front; 0 if it reaches nothing [fronts]
    type(incidence) :: rows                !! equations that each front reaches, ascending
    integer, allocatable :: own(:)         !! number of own equations [fronts]
    integer, allocatable :: reached(:)     !! number of reached equations [fronts]
    !> Children of each front; fronts without a parent are children of one more [fronts + 1]
    type(incidence) :: below
    !> A unit is a front with some of its descendants, which are filled and factored together. Its number is
    !! that of this front. [fronts]
    integer, allocatable :: unit(:)
    type(incidence) :: of_unit             !! fronts of each unit [fronts]
    !> Elements in the order of the first front that has equations of them, those without equations last;
    !! position of the first element of each front [fronts + 2]
    integer, allocatable :: element(:), first_element(:)
  contains
    procedure :: entries
    procedure :: entries_of_factor
    procedure :: operations
  end type front_layout

contains

  !> Lay out the fronts that begin at these equations.
  pure function new_front_layout(first, equations) result(layout)
    integer, intent(in) :: first(:)         !! [fronts + 1]
    type(incidence), intent(in) :: equations   !! of each element, in any order; 0 and less are left out
    type(front_layout) :: layout
    type(incidence) :: at                   !! elements of each front
    integer :: home(1, size(equations%start) - 1)   !! first front with equations of each element, or 0
    integer, allocatable :: above(:, :)
    integer :: e, lowest, p

    layout%first = first
    layout%own = first(2:) - first(:size(first) - 1)
    allocate (layout%front_of(first(size(first)) - 1))
    do p = 1, size(layout%own)
      layout%front_of(first(p):first(p + 1) - 1) = p
    end do
    home = 0
    do e = 1, size(home, 2)
      associate (own => equations%group(equations%start(e):equations%start(e + 1) - 1))
        lowest = minval(own, mask=own > 0)
      end associate
      if (lowest <= size(layout%front_of)) home(1, e) = layout%front_of(lowest)
    end do
    at = new_incidence(home, size(layout%own))
    layout%element = [at%group, pack([(e, e=1, size(home))], home(1, :) == 0)]
    layout%first_element = [at%start, size(layout%element) + 1]
    call find_rows(layout, at, equations)
    layout%reached = layout%rows%start(2:) - layout%rows%start(:size(layout%own))
    above = reshape(merge(layout%parent, size(first), layout%parent > 0), [1, size(layout%own)])
    layout%below = new_incidence(above, size(first))
    call find_units(layout)
  end function new_front_layout

  !> Find the rows of each front, and its parent. A front reaches all later equations that elements couple
  !! with its own equations, and those that its children reach.
  pure subroutine find_rows(layout, at, equations)
    type(front_layout), intent(inout) :: layout
    type(incidence), intent(in) :: at, equations
    logical :: seen(size(layout%front_of))
    integer :: found(size(layout%front_of))
    !> Last child of each front, and the child before each front
    integer, dimension(size(layout%own)) :: child, next
    integer, allocatable :: row(:)
    integer :: start(size(layout%first)), above, c, count, k, p

    child = 0
    next = 0
    allocate (layout%parent(size(layout%own)), source=0)
    start = 1
    allocate (row(size(found)))
    seen = .false.
    do p = 1, size(layout%own)
      count = 0
      do k = at%start(p), at%start(p + 1) - 1
        associate (from => equations%start(at%group(k)), to => equations%start(at%group(k) + 1) - 1)
          call add_new(equations%group(from:to), layout%first(p + 1), seen, found, count)
        end associate
      end do
      c = child(p)
      do while (c > 0)
        call add_new(row(start(c):start(c + 1) - 1), layout%first(p + 1), seen, found, count)
        c = next(c)
      end do
      start(p + 1) = start(p) + count
      if (count == 0) cycle
      if (start(p + 1) - 1 > size(row)) row = [row, row]
      row(start(p):start(p + 1) - 1) = found(sorted_order(found(:count)))
      seen(found(:count)) = .false.
      above = layout%front_of(row(start(p)))
      layout%parent(p) = above
      next(p) = child(above)
      child(above) = p
    end do
    layout%rows = incidence(start, row(:start(size(start)) - 1))
  end subroutine find_rows

  !> Find the units: fronts that have enough operations together with their descendants, and fronts without a
  !! parent.
  pure subroutine find_units(layout)
    type(front_layout), intent(inout) :: layout
    real(wp) :: work(size(layout%own))
    integer :: p

    work = work_of(layout%own, layout%reached)
    do p = 1, size(work)
      associate (q => layout%parent(p))
        if (q > 0) work(q) = work(q) + work(p)
      end associate
    end do
    allocate (layout%unit(size(work)))
    do p = size(work), 1, -1
      layout%unit(p) = p
      if (layout%parent(p) > 0 .and. work(p) < least_work) layout%unit(p) = layout%unit(layout%parent(p))
    end do
    layout%of_unit = new_incidence(reshape(layout%unit, [1, size(work)]), size(work))
  end subroutine find_units

  !> Entries of the factor, and the most entries of update matrices at once: each exists until its parent has
  !! it.
  pure integer(i8) function entries(self, kept)
    class(front_layout), intent(in) :: self
    logical, intent(in) :: kept          !! update matrices of units are kept
    integer(i8) :: left, most, own(size(self%own))
    integer :: i, p

    own = update_size(self%own, self%reached)
    left = 0
    most = 0
    do p = 1, size(own)
      left = left + own(p)
      most = max(most, left)
      do i = self%below%start(p), self%below%start(p + 1) - 1
        associate (q => self%below%group(i))
          if (.not. (kept .and. self%unit(q) == q)) left = left - own(q)
        end associate
      end do
    end do
    entries = self%entries_of_factor() + most
  end function entries

  !> Entries of the factor alone.
  pure integer(i8) function entries_of_factor(self)
    class(front_layout), intent(in) :: self

    entries_of_factor = sum(int(self%own, i8)*(self%own + self%reached))
  end function entries_of_factor

  !> Entries of the update matrix of a front, and of the columns along.
  elemental integer(i8) function update_size(own, reached)
    integer, intent(in) :: own       !! equations of the front
    integer, intent(in) :: reached   !! later ones

    update_size = triangle_size(reached) + int(columns_along, i8)*(own + reached)
  end function update_size

  !> Entries of the update matrix alone: blocks of columns, each from the row of its first column down.
  elemental integer(i8) function triangle_size(rows)
    integer, intent(in) :: rows
    integer :: full   ! columns of the blocks with full width

    full = rows - modulo(rows, block_width(rows))
    triangle_size = int(full, i8)*(rows + rows - full + block_width(rows))/2 + int(rows - full, i8)**2
  end function triangle_size

  !> Columns of a block of an update matrix: GEMM has kernels for small products, and large products are
  !! faster if they are wide.
  elemental integer function block_width(rows)
    integer, intent(in) :: rows
    integer, parameter :: small = 160, narrow = 32, wide = 192

    block_width = merge(narrow, wide, rows <= small)
  end function block_width

  !> Operations of the factorization.
  pure real(wp) function operations(self)
    class(front_layout), intent(in) :: self

    operations = sum(work_of(self%own, self%reached))
  end function operations

  !> Operations of one front.
  elemental real(wp) function work_of(own, reached)
    integer, intent(in) :: own, reached

    associate (n => real(own, wp), m => real(reached, wp))
      work_of = n*(n**2/3.0_wp + m*(n + m))
    end associate
  end function work_of
end module epcont_linalg_front_layout
