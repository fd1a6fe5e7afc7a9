!> Fronts: which equations are eliminated together, and which of the later ones they are then coupled with.
!>
!> Front p has the equations first(p) to first(p+1)-1 of its own, and reaches the equations rows%of(p). All
!> these stand in its parent, the front that the first of them belongs to, or are reached by it.
module epcont_linalg_front_layout
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: i8, wp
  use epcont_base_sorting, only: sorted_order
  implicit none
  private
  public :: front_layout, new_front_layout, update_size

  !> What goes along with a front, one number a row: diagonal of the matrix, sums of magnitudes, two probes.
  integer, parameter, public :: columns_along = 4

  type :: front_layout
    integer, allocatable :: first(:)       !! equation of each front [fronts + 1]
    integer, allocatable :: front_of(:)    !! each equation
    integer, allocatable :: parent(:)      !! always a later one; 0: it reaches nothing [fronts]
    type(incidence) :: rows                !! equations that each front reaches, ascending
    integer, allocatable :: own(:)         !! how many equations are a front's own [fronts]
    integer, allocatable :: reached(:)     !! and how many it reaches [fronts]
    !> Right below each front, and those that are below none as if below one more [fronts + 1]
    type(incidence) :: below
    !> The elements in the order of the first fronts that they have equations of, and where those of each
    !! begin; of none, behind all others [fronts + 2]
    integer, allocatable :: element(:), first_element(:)
  contains
    procedure :: entries
    procedure :: entries_of_factor
    procedure :: update_starts
    procedure :: operations
  end type front_layout

contains

  !> The layout of the fronts that begin at these equations, for elements with these equations.
  pure function new_front_layout(first, numbers) result(layout)
    integer, intent(in) :: first(:)         !! [fronts + 1]
    integer, intent(in) :: numbers(:, :)    !! equations of each element; 0 and less: none [any, elements]
    type(front_layout) :: layout
    type(incidence) :: at                   !! elements of each front
    integer :: home(1, size(numbers, 2))    !! the first front that each element has equations of, or 0
    integer, allocatable :: above(:, :)
    integer :: e, lowest, p

    layout%first = first
    layout%own = first(2:) - first(:size(first) - 1)
    allocate (layout%front_of(first(size(first)) - 1))
    do p = 1, size(layout%own)
      layout%front_of(first(p):first(p + 1) - 1) = p
    end do
    home = 0
    do e = 1, size(numbers, 2)
      lowest = minval(numbers(:, e), mask=numbers(:, e) > 0)
      if (lowest <= size(layout%front_of)) home(1, e) = layout%front_of(lowest)
    end do
    at = new_incidence(home, size(layout%own))
    layout%element = [at%group, pack([(e, e=1, size(home))], home(1, :) == 0)]
    layout%first_element = [at%start, size(layout%element) + 1]
    call find_rows(layout, at, numbers)
    layout%reached = layout%rows%start(2:) - layout%rows%start(:size(layout%own))
    associate (fronts => size(layout%own))
      above = reshape(merge(layout%parent, fronts + 1, layout%parent > 0), [1, fronts])
      layout%below = new_incidence(above, fronts + 1)
    end associate
  end function new_front_layout

  !> The rows of each front, and its parent. A front reaches what elements join to its equations and what the
  !! fronts below it reach, as far as that comes later.
  pure subroutine find_rows(layout, at, numbers)
    type(front_layout), intent(inout) :: layout
    type(incidence), intent(in) :: at
    integer, intent(in) :: numbers(:, :)
    logical :: seen(size(layout%front_of))
    integer :: found(size(layout%front_of))
    !> The last front below each, and the one before that
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
        call add_new(numbers(:, at%group(k)), layout%first(p + 1), seen, found, count)
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

  !> Put equations from `from` on that are not in the list yet at its end.
  pure subroutine add_new(number, from, seen, list, length)
    integer, intent(in) :: number(:), from
    logical, intent(inout) :: seen(:)   !! those that are in it [order]
    integer, intent(inout) :: list(:), length
    integer :: i

    do i = 1, size(number)
      if (number(i) < from) cycle
      if (seen(number(i))) cycle
      seen(number(i)) = .true.
      length = length + 1
      list(length) = number(i)
    end do
  end subroutine add_new

  !> Entries of the factor, and of what is kept with it.
  pure integer(i8) function entries(self, kept)
    class(front_layout), intent(in) :: self
    logical, intent(in) :: kept          !! all update matrices are kept
    integer(i8) :: start(size(self%first))

    start = self%update_starts(kept)
    entries = start(size(start)) - 1
  end function entries

  !> Entries of the factor alone.
  pure integer(i8) function entries_of_factor(self)
    class(front_layout), intent(in) :: self

    entries_of_factor = sum(int(self%own, i8)*(self%own + self%reached))
  end function entries_of_factor

  !> Entries of the update matrix of a front, and of the columns that go along.
  elemental integer(i8) function update_size(own, reached)
    integer, intent(in) :: own       !! equations of the front
    integer, intent(in) :: reached   !! later ones

    update_size = int(reached, i8)**2 + int(columns_along, i8)*(own + reached)
  end function update_size

  !> Where the update matrix of each front, what it leaves to the later equations, begins behind the factor:
  !! in its own place where all are kept. Else fronts right below one are eliminated one after another, each
  !! with all that is below it, then the one itself. So each begins behind that of its parent and what those
  !! before it have left there. And one behind the last [fronts + 1].
  pure function update_starts(self, kept) result(start)
    class(front_layout), intent(in) :: self
    logical, intent(in) :: kept   !! all update matrices are kept
    integer(i8) :: start(size(self%first))
    !> Entries of each; what those below it leave, and what they have at once; what is left before it
    integer(i8), dimension(size(self%first)) :: before, left, most, own
    integer :: above(size(self%own)), p

    above = merge(self%parent, size(start), self%parent > 0 .and. .not. kept)
    own = [update_size(self%own, self%reached), 0_i8]
    left = 0
    most = 0
    do p = 1, size(above)
      before(p) = left(above(p))
      left(above(p)) = before(p) + own(p)
      most(above(p)) = max(most(above(p)), left(above(p)) + most(p))
    end do
    start(size(start)) = self%entries_of_factor() + 1
    do p = size(above), 1, -1
      start(p) = start(above(p)) + own(above(p)) + before(p)
    end do
    start(size(start)) = start(size(start)) + most(size(start))
  end function update_starts

  !> Operations that the factorization takes.
  pure real(wp) function operations(self)
    class(front_layout), intent(in) :: self

    associate (n => real(self%own, wp), m => real(self%reached, wp))
      operations = sum(n*(n**2/3.0_wp + m*(n + m)))
    end associate
  end function operations
end module epcont_linalg_front_layout
