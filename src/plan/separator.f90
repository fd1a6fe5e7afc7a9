!> The fewest nodes of a graph that keep two sides of it apart.
!>
!> Between the left and the right lies a band. By Menger's theorem the fewest nodes of it without which
!> nothing leads from the one to the other are as many as ways through it can be laid that do not meet: one
!> on each. Ways are laid by augmenting (Ford and Fulkerson), the shortest first, many at a time (Dinic
!> 1970): where a new one comes upon one that is laid it goes back along that, which is led on elsewhere. So
!> each node has two states that a new way may reach: it has come to it, -node, and it may go on from it to
!> any neighbour, node.
module epcont_plan_separator
  use epcont_base_incidence, only: incidence
  implicit none
  private
  public :: between, edge, find_separator, left, new_parted_graph, outside, parted_graph, right

  !> Where a node is: not among those that are looked at, in one of the halves, in the band between them, or
  !! in the separator.
  integer, parameter :: outside = 0, left = 1, right = 2, between = 3, edge = 4

  type :: parted_graph
    type(incidence) :: beside            !! neighbours of each node
    integer, allocatable :: side(:)      !! where each node is [nodes]
    !> Nodes before and behind each on its way, or `the_end`, or `no_way`
    integer, allocatable, private :: before(:), behind(:)
    integer, allocatable, private :: from(:)   !! from where a new way has come to a node
    integer, allocatable, private :: tried(:)  !! the neighbour to which it went on last
    !> How far a state is from the right; of nodes that are not in the band `no_way` [-nodes:nodes]
    integer, allocatable, private :: far(:)
  end type parted_graph

  integer, parameter :: no_way = -1, the_end = 0
  !> From there the right is not reached.
  integer, parameter :: never = huge(1)

contains

  !> A graph of which no node is looked at yet.
  pure function new_parted_graph(beside) result(self)
    type(incidence), intent(in) :: beside   !! neighbours of each node
    type(parted_graph) :: self
    integer :: nodes

    nodes = size(beside%start) - 1
    self%beside = beside
    allocate (self%side(nodes), source=outside)
    allocate (self%before(nodes), self%behind(nodes), self%from(nodes), self%tried(nodes))
    allocate (self%far(-nodes:nodes), source=no_way)
  end function new_parted_graph

  !> Part the band of a set: the fewest nodes to the edge, the others to the halves, which become as even as
  !! so few allow. Left and right may be joined through the band only.
  subroutine find_separator(self, set)
    type(parted_graph), intent(inout) :: self
    integer, intent(in) :: set(:)   !! nodes that are left, right, or between; all others are outside
    integer, allocatable :: band(:), beside(:)
    integer, allocatable :: list(:)             ! states to go on from
    integer, allocatable :: first(:), last(:)   ! of the band, with neighbours left, and right
    integer :: i, laid, ways

    band = pack(set, self%side(set) == between)
    allocate (list(2*size(band)))
    beside = [(sides_beside(self, band(i)), i=1, size(band))]
    first = pack(band, btest(beside, left))
    last = pack(band, btest(beside, right))
    self%before(band) = no_way
    ways = 0
    laid = -1
    do while (ways > laid)
      laid = ways
      call measure(self, band, last, list)
      do i = 1, size(first)
        if (self%far(-first(i)) /= never) call lay_way(self, first(i), list, ways)
      end do
    end do
    call part_evenly(self, band, first, list, (size(set) - ways)/2 - count(self%side(set) == left))
    self%far(band) = no_way
    self%far(-band) = no_way
  end subroutine find_separator

  !> The sides that the neighbours of a node are on, as bits.
  pure integer function sides_beside(self, node) result(sides)
    type(parted_graph), intent(in) :: self
    integer, intent(in) :: node
    integer :: j

    sides = 0
    do j = self%beside%start(node), self%beside%start(node + 1) - 1
      sides = ior(sides, shiftl(1, self%side(self%beside%group(j))))
    end do
  end function sides_beside

  !> How far each state is from the right, in steps that a new way may go.
  subroutine measure(self, band, last, list)
    type(parted_graph), intent(inout) :: self
    integer, intent(in) :: band(:), last(:)
    integer, intent(out) :: list(:)
    integer :: done, found, i, j, node

    do i = 1, size(band)
      self%far(band(i)) = never
      self%far(-band(i)) = never
    end do
    found = 0
    do i = 1, size(last)
      call reach(last(i), 0)
    end do
    done = 0
    do while (done < found)
      done = done + 1
      node = abs(list(done))
      associate (onward => self%far(list(done)) + 1)
        if (list(done) > 0) then
          self%tried(node) = self%beside%start(node) - 1
          if (self%before(node) == no_way) then
            call reach(-node, onward)
          else if (self%behind(node) /= the_end) then
            call reach(-self%behind(node), onward)
          end if
        else
          if (self%before(node) /= no_way) call reach(node, onward)
          do j = self%beside%start(node), self%beside%start(node + 1) - 1
            call reach(self%beside%group(j), onward)
          end do
        end if
      end associate
    end do

  contains

    subroutine reach(state, far)
      integer, intent(in) :: state, far

      if (self%far(state) /= never) return
      self%far(state) = far
      found = found + 1
      list(found) = state
    end subroutine reach
  end subroutine measure

  !> Lay a way from a node of the left to the right, if one leads there by steps that each come nearer.
  subroutine lay_way(self, first, list, ways)
    type(parted_graph), intent(inout) :: self
    integer, intent(in) :: first
    integer, intent(out) :: list(:)
    integer, intent(inout) :: ways
    integer :: deep, next, node

    deep = 0
    call come_to(first, the_end)
    do while (deep > 0)
      node = list(deep)
      if (self%far(node) == 0) then
        call join(self, node)
        ways = ways + 1
        return
      end if
      do
        self%tried(node) = self%tried(node) + 1
        if (self%tried(node) < self%beside%start(node + 1)) then
          next = self%beside%group(self%tried(node))
        else if (self%tried(node) == self%beside%start(node + 1)) then
          next = node   ! out of it by where its own way comes in
        else
          deep = deep - 1
          exit
        end if
        if (self%far(-next) /= self%far(node) - 1) cycle
        call come_to(next, node)
        exit
      end do
    end do

  contains

    !> Come to a node, once, and go on from it, or, if it is on a way, from the one before it there.
    subroutine come_to(node, from)
      integer, intent(in) :: node, from

      self%far(-node) = never
      self%from(node) = from
      deep = deep + 1
      list(deep) = merge(node, self%before(node), self%before(node) == no_way)
    end subroutine come_to
  end subroutine lay_way

  !> Join a new way that has got to its last node, and lead on elsewhere those that it came upon.
  subroutine join(self, last)
    type(parted_graph), intent(inout) :: self
    integer, intent(in) :: last
    integer :: freed, next, node

    node = last
    next = the_end
    do while (node /= the_end)
      if (self%before(node) == no_way) then
        self%behind(node) = next
        next = node
      else
        freed = self%behind(node)
        self%behind(node) = next
        next = freed
        do while (self%from(next) == next)
          freed = self%behind(next)
          self%before(next) = no_way
          next = freed
        end do
      end if
      node = self%from(next)
      self%before(next) = node
    end do
  end subroutine join

  !> Part the band where no further way leads to the right. All that new ways get on from is left; where
  !! they come to a node and no further, it is in the separator. It may be passed where that leads nowhere
  !! either: the separator behind is as short. So the left grows as long as it is not half of all.
  subroutine part_evenly(self, band, first, list, wanted)
    type(parted_graph), intent(inout) :: self
    integer, intent(in) :: band(:), first(:)
    integer, intent(out) :: list(:)
    integer, intent(in) :: wanted   !! nodes of the band that are to be left
    integer :: stopped(size(band)), deep, found, i, stops

    deep = 0
    found = 0
    stops = 0
    do i = 1, size(first)
      if (self%side(first(i)) == between) call come_to(first(i))
      call go_on_from_all()
    end do
    i = 0
    do while (i < stops .and. found < wanted)
      i = i + 1
      if (self%side(stopped(i)) /= edge .or. self%far(stopped(i)) /= never) cycle
      call go_on_from(stopped(i))
      call go_on_from_all()
    end do
    do i = 1, size(band)
      if (self%side(band(i)) == between) self%side(band(i)) = right
    end do

  contains

    subroutine come_to(node)
      integer, intent(in) :: node

      if (self%before(node) == no_way) then
        call go_on_from(node)
      else
        self%side(node) = edge
        stops = stops + 1
        stopped(stops) = node
        call go_back_from(node)
      end if
    end subroutine come_to

    subroutine go_on_from(node)
      integer, intent(in) :: node

      self%side(node) = left
      found = found + 1
      deep = deep + 1
      list(deep) = node
    end subroutine go_on_from

    !> To the node before on its way.
    subroutine go_back_from(node)
      integer, intent(in) :: node

      if (self%before(node) <= the_end) return
      if (self%side(self%before(node)) /= left) call go_on_from(self%before(node))
    end subroutine go_back_from

    subroutine go_on_from_all()
      integer :: j, node

      do while (deep > 0)
        node = list(deep)
        deep = deep - 1
        call go_back_from(node)
        do j = self%beside%start(node), self%beside%start(node + 1) - 1
          if (self%side(self%beside%group(j)) == between) call come_to(self%beside%group(j))
        end do
      end do
    end subroutine go_on_from_all
  end subroutine part_evenly
end module epcont_plan_separator
