!> Sorting and searching.
module epcont_base_sorting
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: sorted_order, halve, id_index, is_first, new_id_index

  !> Index that finds the position of an id in a list.
  type :: id_index
    private
    integer, allocatable :: key(:)       !! ids, ascending, each once [n]
    integer, allocatable :: position(:)  !! position of the first occurrence in the list [n]
  contains
    procedure :: find
    procedure :: within
  end type id_index

contains

  !> Which entries occur for the first time in a list?
  pure function is_first(number) result(first)
    integer, intent(in) :: number(:)   !! in a range that is not much larger than the list
    logical :: first(size(number)), met(minval(number):maxval(number))
    integer :: k

    met = .false.
    do k = 1, size(number)
      first(k) = .not. met(number(k))
      met(number(k)) = .true.
    end do
  end function is_first

  !> Permutation that sorts `key`; equal keys keep their order (merge sort).
  pure function sorted_order(key) result(order)
    integer, intent(in) :: key(:)   !! in any order
    integer, allocatable :: order(:), merged(:)
    integer, parameter :: run = 8   ! length of runs that are sorted by insertion
    integer :: n, width, left, i, j, k

    n = size(key)
    order = [(i, i=1, n)]
    if (all(key(2:) >= key(:n - 1))) return
    do left = 1, n, run
      do k = left + 1, min(left + run - 1, n)
        do j = k, left + 1, -1
          if (key(order(j - 1)) <= key(k)) exit
          order(j) = order(j - 1)
        end do
        order(j) = k
      end do
    end do
    if (n <= run) return
    allocate (merged(n))
    width = run
    do while (width < n)
      do left = 1, n, 2*width
        call merge_runs(key, order, left, min(left + width, n + 1), min(left + 2*width, n + 1), merged)
      end do
      order = merged
      width = 2*width
    end do
  end function sorted_order

  !> Merge two sorted runs, which begin at `left` and `middle`; the next run begins at `right`.
  pure subroutine merge_runs(key, order, left, middle, right, merged)
    integer, intent(in) :: key(:), order(:), left, middle, right
    integer, intent(inout) :: merged(:)
    integer :: i, j, k
    logical :: is_second

    i = left
    j = middle
    do k = left, right - 1
      is_second = i >= middle
      if (.not. is_second .and. j < right) is_second = key(order(j)) < key(order(i))
      if (is_second) then
        merged(k) = order(j)
        j = j + 1
      else
        merged(k) = order(i)
        i = i + 1
      end if
    end do
  end subroutine merge_runs

  !> Rearrange items so that no key of the first half exceeds any key of the second; the first half has n/2
  !! items, rounded down (Hoare's selection).
  pure subroutine halve(key, item)
    real(wp), intent(in) :: key(:)          !! [n]
    integer, intent(inout) :: item(:)       !! [n]
    real(wp) :: sorted(size(key)), pivot
    integer :: first, i, j, last, middle

    sorted = key
    middle = size(key)/2
    first = 1
    last = size(key)
    do while (first < last)
      pivot = sorted((first + last)/2)
      i = first
      j = last
      do
        do while (sorted(i) < pivot)
          i = i + 1
        end do
        do while (pivot < sorted(j))
          j = j - 1
        end do
        if (i <= j) then
          sorted([i, j]) = sorted([j, i])
          item([i, j]) = item([j, i])
          i = i + 1
          j = j - 1
        end if
        if (i > j) exit
      end do
      if (middle <= j) then
        last = j
      else if (middle >= i) then
        first = i
      else
        exit
      end if
    end do
  end subroutine halve

  !> Index of a list of ids. Of equal ids, the first is found.
  pure function new_id_index(ids) result(index)
    integer, intent(in) :: ids(:)   !! in any order
    type(id_index) :: index
    integer :: n

    index%position = sorted_order(ids)
    index%key = ids(index%position)
    n = size(ids)
    if (n < 2) return
    index%position = pack(index%position, [.true., index%key(2:) /= index%key(:n - 1)])
    index%key = ids(index%position)
  end function new_id_index

  !> Position of `id` in the list; 0 if it is not there.
  elemental integer function find(self, id) result(position)
    class(id_index), intent(in) :: self
    integer, intent(in) :: id   !! id to be found
    integer :: at, n

    position = 0
    n = size(self%key)
    if (n == 0) return
    if (id < self%key(1) .or. id > self%key(n)) return
    at = min(id - self%key(1) + 1, n)   ! its position if no id before it is missing: the usual case
    if (self%key(at) /= id) at = first_not_below(self%key, id)
    if (self%key(at) == id) position = self%position(at)
  end function find

  !> Positions of all ids between `first` and `last`, in ascending order of id.
  pure function within(self, first, last) result(positions)
    class(id_index), intent(in) :: self
    integer, intent(in) :: first, last   !! need not be in the list
    integer, allocatable :: positions(:)

    positions = self%position(first_not_below(self%key, first):first_not_below(self%key, last + 1) - 1)
  end function within

  !> First position in the ascending list `key` whose value is at least `id`; size + 1 if there is no such
  !! value.
  pure integer function first_not_below(key, id) result(low)
    integer, intent(in) :: key(:), id
    integer :: middle, high

    low = 1
    high = size(key) + 1
    do while (low < high)
      middle = low + (high - low)/2
      if (key(middle) < id) then
        low = middle + 1
      else
        high = middle
      end if
    end do
  end function first_not_below
end module epcont_base_sorting
