!> Smallest separator: the fewest nodes of a graph whose removal disconnects its left side from its right
!> side.
!>
!> The separator is chosen within a band between both sides. By Menger's theorem it has as many nodes as there
!> are node-disjoint paths through the band: one node of each path. Paths are found by augmentation (Ford and
!> Fulkerson), shortest first and many at a time (Dinic 1970). If a new path meets an old one, it runs back
!> along the old path, whose remainder is rerouted. So each node has two states: `-node` if a new path has
!> entered it, and `node` if the path may leave it to any neighbour.
module epcont_plan_separator
  use epcont_base_incidence, only: incidence
  implicit none
  private
  public :: between, edge, find_separator, left, new_parted_graph, outside, parted_graph, right

  !> Position of a node: not in the set, in one of the halves, in the band between them, or in the separator.
  integer, parameter :: outside = 0, left = 1, right = 2, between = 3, edge = 4

  type :: parted_graph
    type(incidence) :: beside            !! neighbours of each node
    integer, allocatable :: side(:)      !! position of each node [nodes]
    !> Previous and next node on the path of each node, or `the_end`, or `no_way`
    integer, allocatable, private :: before(:), behind(:)
    integer, allocatable, private :: from(:)   !! node from which a new path entered each node
    integer, allocatable, private :: tried(:)  !! last neighbour that a new path tried from each node
    !> Distance of each state from the right side; `no_way` for nodes outside the band [-nodes:nodes]
    integer, allocatable, private :: far(:)
  end type parted_graph

  integer, parameter :: no_way = -1, the_end = 0
  !> Distance of states from which the right side cannot be reached
  integer, parameter :: never = huge(1)

contains

  !> Graph in which all nodes are outside the set.
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

  !> Split the band of a set: the fewest nodes become the separator, the others join the halves, which become
  !! as equal as this permits. Left and right nodes must be connected through the band only.
  subroutine find_separator(self, set)
    type(parted_graph), intent(inout) :: self
    integer, intent(in) :: set(:)   !! nodes that are left, right or between; all other nodes are outside
    integer, allocatable :: band(:), beside(:)
    integer, allocatable :: list(:)             ! states to be continued
    integer, allocatable :: first(:), last(:)   ! band nodes with left neighbours, and with right neighbours
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

  !> Sides of the neighbours of a node, as bits.
  pure integer function sides_beside(self, node) result(sides)
    type(parted_graph), intent(in) :: self
    integer, intent(in) :: node
    integer :: j

    sides = 0
    do j = self%beside%start(node), self%beside%start(node + 1) - 1
      sides = ior(sides, shiftl(1, self%side(self%beside%group(j))))
    end do
  end function sides_beside

  !> Measure the distance of each state from the right side, in steps of a new path.
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

  !> Add a path from a left node to the right side, if each step of it reduces the distance.
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
          next = node   ! leave it by the path that enters it
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

    !> Enter a node, once. Continue from it or, if it is on a path, from the node before it on that path.
    subroutine come_to(node, from)
      integer, intent(in) :: node, from

      self%far(-node) = never
      self%from(node) = from
      deep = deep + 1
      list(deep) = merge(node, self%before(node), self%before(node) == no_way)
    end subroutine come_to
  end subroutine lay_way

  !> Complete a new path at its last node, and reroute the paths that it met.
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

  !> Split the band if no further path reaches the right side. Nodes that new paths can leave become left;
  !! nodes that they only enter form the separator. A separator node with no path to the right behind it may
  !! become left: the next separator is as small. So the left side grows until it has half of all nodes.
  subroutine part_evenly(self, band, first, list, wanted)
    type(parted_graph), intent(inout) :: self
    integer, intent(in) :: band(:), first(:)
    integer, intent(out) :: list(:)
    integer, intent(in) :: wanted   !! band nodes that shall become left
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

    !> Continue from the previous node on the path.
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
