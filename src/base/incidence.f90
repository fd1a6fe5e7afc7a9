!> Inverse of a table of groups: the groups that each member belongs to.
module epcont_base_incidence
  implicit none
  private
  public :: add_new, incidence, new_incidence

  !> Member i belongs to the groups group(start(i):start(i+1)-1), ascending.
  type :: incidence
    integer, allocatable :: start(:), group(:)
  contains
    procedure :: of
    procedure :: members
  end type incidence

contains

  !> Make the table from the members of each group [any, groups]; 0 is ignored.
  pure function new_incidence(member, members) result(table)
    integer, intent(in) :: member(:, :)   !! members of each group; 0 ends them [any, groups]
    integer, intent(in) :: members   !! number of all members
    type(incidence) :: table
    integer :: g, k
    integer, allocatable :: next(:)

    allocate (table%start(members + 1), source=0)
    do g = 1, size(member, 2)
      do k = 1, size(member, 1)
        if (member(k, g) == 0) exit
        table%start(member(k, g) + 1) = table%start(member(k, g) + 1) + 1
      end do
    end do
    table%start(1) = 1
    do k = 1, members
      table%start(k + 1) = table%start(k) + table%start(k + 1)
    end do
    allocate (table%group(table%start(members + 1) - 1))
    next = table%start
    do g = 1, size(member, 2)
      do k = 1, size(member, 1)
        if (member(k, g) == 0) exit
        table%group(next(member(k, g))) = g
        next(member(k, g)) = next(member(k, g)) + 1
      end do
    end do
  end function new_incidence

  !> Groups of a member, ascending.
  pure function of(self, member) result(groups)
    class(incidence), intent(in) :: self
    integer, intent(in) :: member   !! its number
    integer, allocatable :: groups(:)

    groups = self%group(self%start(member):self%start(member + 1) - 1)
  end function of

  !> List the members that belong to at least one group, ascending.
  pure function members(self)
    class(incidence), intent(in) :: self
    integer, allocatable :: members(:)
    integer :: i

    members = pack([(i, i=1, size(self%start) - 1)], self%start(2:) > self%start(:size(self%start) - 1))
  end function members

  !> Append to a list all members with numbers of at least `from` that are not in it yet.
  pure subroutine add_new(number, from, seen, list, length)
    integer, intent(in) :: number(:), from
    logical, intent(inout) :: seen(:)   !! members of the list [members]
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
end module epcont_base_incidence
