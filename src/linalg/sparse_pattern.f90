!> Which entries the lower triangle of an assembled matrix has.
module epcont_linalg_sparse_pattern
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_sorting, only: sorted_order
  implicit none
  private
  public :: find_pattern

contains

  !> Rows of the entries, column by column, ascending; the diagonal is always there.
  pure subroutine find_pattern(order, numbers, start, row)
    integer, intent(in) :: order
    integer, intent(in) :: numbers(:, :)               !! equations of each element; 0 and less: none [any, elements]
    integer, allocatable, intent(out) :: start(:)      !! the first entry of each column [order + 1]
    integer, allocatable, intent(out) :: row(:)        !! [entries]
    type(incidence) :: around
    integer, allocatable :: seen(:), column(:)
    integer :: e, filled, i, j, k

    around = new_incidence(packed(numbers), order)
    allocate (start(order + 1), seen(order), source=0)
    allocate (column(order), row(0))
    filled = 0
    do j = 1, order
      start(j) = filled + 1
      k = 1
      column(1) = j
      do e = around%start(j), around%start(j + 1) - 1
        do i = 1, size(numbers, 1)
          associate (number => numbers(i, around%group(e)))
            if (number <= j) cycle
            if (seen(number) == j) cycle
            seen(number) = j
            k = k + 1
            column(k) = number
          end associate
        end do
      end do
      call reserve(row, filled + k)
      row(filled + 1:filled + k) = column(sorted_order(column(:k)))
      filled = filled + k
    end do
    start(order + 1) = filled + 1
    row = row(:filled)
  end subroutine find_pattern

  !> Equations of each element that are in the matrix, put first; then zeros.
  pure function packed(numbers) result(member)
    integer, intent(in) :: numbers(:, :)
    integer, allocatable :: member(:, :)
    integer :: e, i, k

    allocate (member(size(numbers, 1), size(numbers, 2)), source=0)
    do e = 1, size(numbers, 2)
      k = 0
      do i = 1, size(numbers, 1)
        if (numbers(i, e) <= 0) cycle
        if (any(member(:k, e) == numbers(i, e))) cycle
        k = k + 1
        member(k, e) = numbers(i, e)
      end do
    end do
  end function packed

  !> Make room for `length` elements, and for as many again.
  pure subroutine reserve(list, length)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: length
    integer, allocatable :: longer(:)

    if (size(list) >= length) return
    allocate (longer(2*length))
    longer(:size(list)) = list
    call move_alloc(longer, list)
  end subroutine reserve
end module epcont_linalg_sparse_pattern
