!> Sets that are joined two at a time (union-find).
module epcont_base_partition
  implicit none
  private
  public :: partition, new_partition

  type :: partition
    private
    integer, allocatable :: parent(:)
  contains
    procedure, non_overridable :: join
    procedure, non_overridable :: root
    procedure, non_overridable :: numbers
  end type partition

contains

  !> `count` sets of one member each.
  pure function new_partition(count) result(sets)
    integer, intent(in) :: count   !! of members
    type(partition) :: sets
    integer :: i

    sets%parent = [(i, i=1, count)]
  end function new_partition

  !> Join the sets of a and b; the smaller root remains.
  pure subroutine join(self, a, b)
    class(partition), intent(inout) :: self
    integer, intent(in) :: a, b   !! members of the two sets
    integer :: low, high

    call self%root(a, low)
    call self%root(b, high)
    self%parent(max(low, high)) = min(low, high)
  end subroutine join

  !> The smallest member of the set of a.
  pure subroutine root(self, a, top)
    class(partition), intent(inout) :: self
    integer, intent(in) :: a   !! a member
    integer, intent(out) :: top   !! the smallest of its set
    integer :: next, at

    top = a
    do while (self%parent(top) /= top)
      top = self%parent(top)
    end do
    at = a
    do while (self%parent(at) /= top)  ! shorten the way for the next call
      next = self%parent(at)
      self%parent(at) = top
      at = next
    end do
  end subroutine root

  !> The sets numbered from 1 in order of their smallest members: the number of each member's set.
  pure subroutine numbers(self, number, count)
    class(partition), intent(inout) :: self
    integer, allocatable, intent(out) :: number(:)   !! of each member's set
    integer, intent(out) :: count   !! of sets
    integer :: i, top

    allocate (number(size(self%parent)))
    count = 0
    do i = 1, size(number)
      call self%root(i, top)
      if (top == i) then
        count = count + 1
        number(i) = count
      else
        number(i) = number(top)
      end if
    end do
  end subroutine numbers
end module epcont_base_partition
