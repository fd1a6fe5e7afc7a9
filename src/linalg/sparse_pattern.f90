!> Which entries the lower triangle of an assembled matrix has, and which equations go together.
module epcont_linalg_sparse_pattern
  use epcont_base_incidence, only: incidence, new_incidence
  implicit none
  private
  public :: find_blocks, find_pattern

contains

  !> Blocks of one or two equations that stand one after the other: those of a node. Whatever is coupled with one of them
  !! is taken to be coupled with both.
  pure function find_blocks(order, numbers) result(first)
    integer, intent(in) :: order
    integer, intent(in) :: numbers(:, :)    !! equations of each element, x and y of its nodes in turn; 0 and less: none
    integer, allocatable :: first(:)        !! equation of each block [blocks + 1]
    logical, allocatable :: joined(:)       !! to the equation before
    integer :: e, i

    allocate (joined(order + 1), source=.false.)
    do e = 1, size(numbers, 2)
      do i = 2, size(numbers, 1), 2
        if (numbers(i - 1, e) > 0 .and. numbers(i, e) == numbers(i - 1, e) + 1) joined(numbers(i, e)) = .true.
      end do
    end do
    do i = 2, order
      if (joined(i - 1)) joined(i) = .false.
    end do
    first = pack([(i, i=1, order + 1)], .not. joined)
  end function find_blocks

  !> Rows of the entries, column by column, ascending; the diagonal is always there. Blocks are taken in ascending order and
  !! put into the columns before them, so nothing has to be sorted.
  pure subroutine find_pattern(numbers, first, start, row)
    integer, intent(in) :: numbers(:, :)               !! as above [any, elements]
    integer, intent(in) :: first(:)                    !! as found above
    integer, allocatable, intent(out) :: start(:)      !! the first entry of each column [order + 1]
    integer, allocatable, intent(out) :: row(:)        !! [entries]
    type(incidence) :: around
    integer, allocatable :: member(:, :), near(:), next(:), seen(:), below(:)
    integer :: b, blocks, found, j, k

    blocks = size(first) - 1
    member = blocks_of(numbers, first)
    around = new_incidence(member, blocks)
    allocate (start(first(blocks + 1)), next(first(blocks + 1) - 1))
    allocate (near(blocks), below(blocks), seen(blocks), source=0)
    do b = 1, blocks
      call find_blocks_before(around, member, b, seen, near, found)
      below(near(:found)) = below(near(:found)) + (first(b + 1) - first(b))
    end do
    start(1) = 1
    do b = 1, blocks
      do j = first(b), first(b + 1) - 1
        start(j + 1) = start(j) + (first(b + 1) - j) + below(b)
      end do
    end do
    allocate (row(start(size(start)) - 1))
    seen = 0
    next = start(:size(next))
    do b = 1, blocks
      call find_blocks_before(around, member, b, seen, near, found)
      do k = 1, found
        do j = first(near(k)), first(near(k) + 1) - 1
          call append(first(b), first(b + 1) - 1, row, next(j))
        end do
      end do
      do j = first(b), first(b + 1) - 1
        call append(j, first(b + 1) - 1, row, next(j))
      end do
    end do
  end subroutine find_pattern

  !> The blocks before a block that elements join to it.
  pure subroutine find_blocks_before(around, member, b, seen, near, count)
    type(incidence), intent(in) :: around
    integer, intent(in) :: member(:, :)      !! blocks of each element
    integer, intent(in) :: b
    integer, intent(inout) :: seen(:)        !! the last block that each was found for
    integer, intent(inout) :: near(:)        !! receives the blocks
    integer, intent(out) :: count
    integer :: e, i

    count = 0
    do e = around%start(b), around%start(b + 1) - 1
      do i = 1, size(member, 1)
        associate (other => member(i, around%group(e)))
          if (other == 0) exit
          if (other >= b .or. seen(other) == b) cycle
          seen(other) = b
          count = count + 1
          near(count) = other
        end associate
      end do
    end do
  end subroutine find_blocks_before

  !> Put rows where the next entries of a column go.
  pure subroutine append(from, to, row, next)
    integer, intent(in) :: from, to
    integer, intent(inout) :: row(:), next
    integer :: i

    do i = from, to
      row(next + i - from) = i
    end do
    next = next + (to - from + 1)
  end subroutine append

  !> Blocks of each element, each once, put first; then zeros.
  pure function blocks_of(numbers, first) result(member)
    integer, intent(in) :: numbers(:, :), first(:)
    integer, allocatable :: member(:, :)
    integer, allocatable :: block_of(:)
    integer :: b, e, i, k

    allocate (block_of(first(size(first)) - 1))
    do b = 1, size(first) - 1
      block_of(first(b):first(b + 1) - 1) = b
    end do
    allocate (member(size(numbers, 1), size(numbers, 2)), source=0)
    do e = 1, size(numbers, 2)
      k = 0
      do i = 1, size(numbers, 1)
        if (numbers(i, e) <= 0) cycle
        b = block_of(numbers(i, e))
        if (any(member(:k, e) == b)) cycle
        k = k + 1
        member(k, e) = b
      end do
    end do
  end function blocks_of
end module epcont_linalg_sparse_pattern
