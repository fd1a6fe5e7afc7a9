!> Union-find: disjoint sets that are joined.
module epcont_base_partition
  implicit none
  private
  public :: partition, new_partition

  type :: partition
    private
    integer, allocatable :: parent(:)   !! an earlier member of the same set, or itself
  contains
    procedure :: join
    procedure :: numbers
  end type partition

contains

  !> Make `count` sets of one member each.
  pure function new_partition(count) result(sets)
    integer, intent(in) :: count   !! number of members
    type(partition) :: sets
    integer :: i

    sets%parent = [(i, i=1, count)]
  end function new_partition

  !> Join the sets of a and b; the smaller root remains.
  pure subroutine join(self, a, b)
    class(partition), intent(inout) :: self
    integer, intent(in) :: a, b   !! members of the two sets
    integer :: i, root(2)

    root = [a, b]
    do i = 1, 2
      do while (self%parent(root(i)) /= root(i))
        self%parent(root(i)) = self%parent(self%parent(root(i)))   ! shortens later searches
        root(i) = self%parent(root(i))
      end do
    end do
    self%parent(maxval(root)) = minval(root)
  end subroutine join

  !> Number the sets from 1 in the order of their smallest members.
  pure subroutine numbers(self, number, count)
    class(partition), intent(in) :: self
    integer, allocatable, intent(out) :: number(:)   !! number of each member's set
    integer, intent(out) :: count   !! number of sets
    integer :: i

    allocate (number(size(self%parent)))
    count = 0
    do i = 1, size(number)
      if (self%parent(i) == i) then
        count = count + 1
        number(i) = count
      else
        number(i) = number(self%parent(i))
      end if
    end do
  end subroutine numbers
end module epcont_base_partition
