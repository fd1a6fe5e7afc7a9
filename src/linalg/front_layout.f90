!> Fronts: which equations are eliminated together, and which of the later ones they are then coupled with.
!>
!> Front p has the equations first(p) to first(p+1)-1 of its own, and reaches the equations row(row_start(p)) to
!> row(row_start(p+1)-1). All these stand in its parent, the front that the first of them belongs to, or are reached by it.
module epcont_linalg_front_layout
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: i8, wp
  use epcont_base_sorting, only: sorted_order
  implicit none
  private
  public :: front_layout, new_front_layout

  type :: front_layout
    integer, allocatable :: first(:)       !! equation of each front [fronts + 1]
    integer, allocatable :: front_of(:)    !! each equation
    integer, allocatable :: parent(:)      !! always a later one; 0: it reaches nothing [fronts]
    integer, allocatable :: row_start(:)   !! [fronts + 1]
    integer, allocatable :: row(:)         !! equations reached, ascending in each front
    integer, allocatable :: own(:)         !! how many equations are a front's own [fronts]
    integer, allocatable :: reached(:)     !! and how many it reaches [fronts]
    integer, allocatable :: element(:)     !! the elements in the order of the first fronts that they have equations of
  contains
    procedure :: find
    procedure :: entries
    procedure :: remainders
    procedure :: operations
  end type front_layout

contains

  !> The layout of the fronts that begin at these equations, for elements with these equations. A front reaches what elements
  !! join to its equations and what the fronts below it reach, as far as that comes later.
  pure function new_front_layout(first, numbers) result(layout)
    integer, intent(in) :: first(:)         !! [fronts + 1]
    integer, intent(in) :: numbers(:, :)    !! equations of each element; 0 and less: none [any, elements]
    type(front_layout) :: layout
    type(incidence) :: at
    logical, allocatable :: seen(:)
    integer, allocatable :: child(:), next(:), reached(:), row(:)
    integer, allocatable :: home(:, :)
    integer :: c, e, found, fronts, k, p

    fronts = size(first) - 1
    layout%first = first
    allocate (layout%front_of(first(fronts + 1) - 1))
    do p = 1, fronts
      layout%front_of(first(p):first(p + 1) - 1) = p
    end do
    home = lowest_front(layout%front_of, numbers)
    at = new_incidence(home, fronts)
    layout%element = [at%group, pack([(e, e=1, size(home))], home(1, :) == 0)]
    allocate (layout%parent(fronts), child(fronts), next(fronts), source=0)
    allocate (layout%row_start(fronts + 1), source=1)
    allocate (seen(size(layout%front_of)), source=.false.)
    allocate (reached(size(seen)), row(size(seen)))
    do p = 1, fronts
      found = 0
      do k = at%start(p), at%start(p + 1) - 1
        call add_new(numbers(:, at%group(k)), first(p + 1), seen, reached, found)
      end do
      c = child(p)
      do while (c > 0)
        call add_new(row(layout%row_start(c):layout%row_start(c + 1) - 1), first(p + 1), seen, reached, found)
        c = next(c)
      end do
      layout%row_start(p + 1) = layout%row_start(p) + found
      if (found == 0) cycle
      if (layout%row_start(p + 1) - 1 > size(row)) row = [row, row]
      row(layout%row_start(p):layout%row_start(p + 1) - 1) = in_order(reached(:found))
      seen(reached(:found)) = .false.
      associate (above => layout%parent(p))
        above = layout%front_of(row(layout%row_start(p)))
        next(p) = child(above)
        child(above) = p
      end associate
    end do
    layout%row = row(:layout%row_start(fronts + 1) - 1)
    layout%own = first(2:) - first(:fronts)
    layout%reached = layout%row_start(2:) - layout%row_start(:fronts)
  end function new_front_layout

  !> The first front that each element has equations of; 0 where it has none [1, elements].
  pure function lowest_front(front_of, numbers) result(front)
    integer, intent(in) :: front_of(:), numbers(:, :)
    integer, allocatable :: front(:, :)
    integer :: e, lowest

    allocate (front(1, size(numbers, 2)), source=0)
    do e = 1, size(numbers, 2)
      lowest = minval(numbers(:, e), mask=numbers(:, e) > 0)
      if (lowest <= size(front_of)) front(1, e) = front_of(lowest)
    end do
  end function lowest_front

  !> Put equations from `from` on that are not in the list yet at its end.
  pure subroutine add_new(number, from, seen, list, length)
    integer, intent(in) :: number(:)
    integer, intent(in) :: from
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

  pure function in_order(number)
    integer, intent(in) :: number(:)
    integer :: in_order(size(number))

    in_order = number(sorted_order(number))
  end function in_order

  !> Where an equation stands among the rows of a front; it must be among them, or before its first: then this is 0 or less.
  pure subroutine find(self, front, number, likely, place)
    class(front_layout), intent(in) :: self
    integer, intent(in) :: front, number
    integer, intent(inout) :: likely     !! where in `row` it is looked for first; on return behind where it was found
    integer, intent(out) :: place
    integer :: high, low, middle

    place = number - self%first(front) + 1
    if (place <= self%own(front)) return
    low = self%row_start(front)
    high = self%row_start(front + 1) - 1
    if (likely >= low .and. likely <= high) then
      if (self%row(likely) == number) then
        low = likely
        high = likely
      end if
    end if
    do while (low < high)
      middle = (low + high)/2
      if (self%row(middle) < number) then
        low = middle + 1
      else
        high = middle
      end if
    end do
    place = self%own(front) + low - self%row_start(front) + 1
    likely = low + 1
  end subroutine find

  !> Entries that the factor takes.
  pure integer(i8) function entries(self)
    class(front_layout), intent(in) :: self

    entries = sum(int(self%own, i8)*(self%own + self%reached))
  end function entries

  !> Entries of what is left to the later equations when each front has been eliminated: of all fronts where these are kept,
  !! else of those that are in work at a time, a front and all above it.
  pure integer(i8) function remainders(self, kept)
    class(front_layout), intent(in) :: self
    logical, intent(in) :: kept
    integer(i8), allocatable :: behind(:)
    integer :: p

    allocate (behind(0:size(self%parent)), source=0_i8)
    do p = size(self%parent), 1, -1
      behind(p) = merge(0_i8, behind(self%parent(p)), kept) + int(self%reached(p), i8)**2
    end do
    remainders = merge(sum(behind), maxval(behind), kept)
  end function remainders

  !> Operations that the factorization takes.
  pure real(wp) function operations(self)
    class(front_layout), intent(in) :: self

    associate (n => real(self%own, wp), m => real(self%reached, wp))
      operations = sum(n*(n**2/3.0_wp + m*(n + m)))
    end associate
  end function operations
end module epcont_linalg_front_layout
