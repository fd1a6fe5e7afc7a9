!> Nested dissection: an order of the nodes in which elimination causes little fill, and its fronts.
!>
!> A separator divides a set of nodes into two halves. Without the separator the halves are independent, so
!> each is eliminated first, in the same manner, and the separator after them (George, SIAM J. Numer. Anal. 10
!> (1973) 345). The separator is the shortest within a band about the median of one coordinate. This is the
!> coordinate whose median has the fewest nodes with neighbours on the other side.
module epcont_plan_dissection
  use epcont_base_incidence, only: incidence
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_plan_separator, only: between, edge, find_separator, left, new_parted_graph, outside, &
    parted_graph, right
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: dissection, dissect

  type :: dissection
    integer, allocatable :: node(:)    !! in the order of elimination
    integer, allocatable :: first(:)   !! position of the first node of each front, and one more [fronts + 1]
    integer, allocatable :: below(:)   !! position of the first node eliminated into each front [fronts]
  end type dissection

  !> Sets with at most this number of nodes are not divided. Between 12 and 24 the time hardly depends on it.
  integer, parameter :: few = 16
  !> Part of a set on each side of the band. Between 0.3 and 0.4 operations differ by 3 %. Wider bands help
  !! regular meshes (by 20 % triangles in alternating directions) and take longer.
  real(wp), parameter :: end_part = 0.35_wp
  !> In larger sets the band becomes narrower, by the square root of their size, because paths through a wide
  !! band take more rounds. The limit keeps the band wider than the tolerance of `threshold`.
  integer, parameter :: large = 30000
  real(wp), parameter :: least_square = 1.0_wp/6.0_wp
  !> A coordinate is used only if neither half has more than this part of the set.
  real(wp), parameter :: largest_half = 2.0_wp/3.0_wp
  !> Halves with more nodes are tasks of their own: these take a millisecond or more.
  integer, parameter :: many = 4000
  !> Coordinates along which sets are divided, and number of nodes whose median represents that of a set.
  integer, parameter :: axes = 5, most_sampled = 128

  !> Bits of `noted`, one for each axis: the node is in the lower half, in the upper half, has neighbours
  !! across the median while it is in the lower half, in the upper half.
  integer, parameter :: lower(axes) = [1, 2, 4, 8, 16], to_upper = axes, to_across = 2*axes
  integer, parameter :: both = 2**to_across - 1

  !> State of a dissection.
  type :: dissector
    type(parted_graph) :: graph                ! of the nodes that are not eliminated last
    real(wp), allocatable :: coordinate(:, :)  ! of these nodes [axes, nodes]
    integer, allocatable :: noted(:)           ! bits of nodes in the set being divided; 0 of others [nodes]
    integer, allocatable :: order(:)           ! [nodes]
    !> If a front begins at this position: position of the first node eliminated into it; otherwise 0
    integer, allocatable :: below(:)
  contains
    procedure :: divide
    procedure :: arrange
    procedure :: lay_band
    procedure :: best_axis
    procedure :: widen_band
  end type dissector

contains

  !> Dissect a body, or bodies joined by pairs, along x, y, their diagonals and one more coordinate. Nodes
  !! that are to come last form the last front.
  function dissect(model, further, nodes, wanted_last, pairs) result(found)
    type(model_type), intent(in) :: model      !! its nodes, connectivity, and elements around nodes are used
    real(wp), intent(in) :: further(:)         !! the additional coordinate [all nodes]
    integer, intent(in) :: nodes(:)            !! nodes of the body or bodies
    logical, intent(in) :: wanted_last(:)      !! [all nodes]
    !> Pairs of each node, which join it to others; if absent, only elements join nodes [all nodes]
    type(incidence), intent(in), optional :: pairs
    type(dissection) :: found
    type(dissector) :: work
    integer, allocatable :: free(:)
    integer :: i

    free = pack(nodes, .not. wanted_last(nodes))
    allocate (work%coordinate(axes, size(free)))
    allocate (work%below(size(nodes) + 1), work%noted(size(free)), source=0)
    work%order = [(i, i=1, size(free))]
    do i = 1, size(free)
      associate (x => model%mesh%x(1, free(i)), y => model%mesh%x(2, free(i)))
        work%coordinate(:, i) = [x + y, x - y, x, y, further(free(i))]
      end associate
    end do
    work%graph = new_parted_graph(neighbours(model, free, pairs))
    !$omp parallel num_threads(threads_over(size(free)))
    !$omp single
    call work%divide(1, size(free))
    !$omp end single
    !$omp end parallel
    work%below([size(free), size(nodes)] + 1) = 1
    found%node = [free(work%order), pack(nodes, wanted_last(nodes))]
    found%first = pack([(i, i=1, size(work%below))], work%below > 0)
    found%below = work%below(found%first(:size(found%first) - 1))
  end function dissect

  !> Divide the nodes between two positions of the order, or make them a front if each of them has neighbours
  !! across. The halves are independent, so threads may work on both.
  recursive subroutine divide(self, first, last)
    class(dissector), intent(inout) :: self
    integer, intent(in) :: first, last
    integer :: nodes_of(left:edge)

    self%below(first) = first
    if (last - first < few) return
    call self%lay_band(self%order(first:last))
    call find_separator(self%graph, self%order(first:last))
    call self%arrange(first, last, nodes_of)
    if (any(nodes_of(:right) > last - first)) return
    !$omp task shared(self) firstprivate(first, nodes_of) if(nodes_of(left) > many)
    call self%divide(first, first + nodes_of(left) - 1)
    !$omp end task
    call self%divide(first + nodes_of(left), last - nodes_of(edge))
    if (nodes_of(edge) > 0) self%below(last - nodes_of(edge) + 1) = first
    !$omp taskwait
  end subroutine divide

  !> Order a set: left, right, separator. Afterwards its nodes are outside again.
  subroutine arrange(self, first, last, nodes_of)
    class(dissector), intent(inout) :: self
    integer, intent(in) :: first, last            !! positions of the set
    integer, intent(out) :: nodes_of(left:edge)   !! number of nodes of each
    integer :: i, next(left:edge), node(last - first + 1)

    node = self%order(first:last)
    nodes_of = 0
    do i = 1, size(node)
      associate (n => nodes_of(self%graph%side(node(i))))
        n = n + 1
      end associate
    end do
    next = first + [0, nodes_of(left), 0, size(node) - nodes_of(edge)]
    do i = 1, size(node)
      associate (side => self%graph%side(node(i)))
        self%order(next(side)) = node(i)
        next(side) = next(side) + 1
        side = outside
      end associate
      self%noted(node(i)) = 0
    end do
  end subroutine arrange

  !> Mark the nodes of a set as left of a band, in it, or right of it. If no coordinate divides the set,
  !! because it has too few values, the positions of the nodes are used instead.
  recursive subroutine lay_band(self, set)
    class(dissector), intent(inout) :: self
    integer, intent(in) :: set(:)
    real(wp) :: at_left, at_right, beside, sample(most_sampled, axes), median(axes)
    integer :: axis, i, n

    n = 0
    do i = 1, size(set), (size(set) - 1)/most_sampled + 1
      n = n + 1
      sample(n, :) = self%coordinate(:, set(i))
    end do
    median = [(threshold(sample(:n, axis), n/2), axis=1, axes)]
    axis = self%best_axis(set, median)
    if (axis == 0) then
      do i = 1, size(set)
        self%coordinate(:, set(i)) = i
      end do
      call self%lay_band(set)
      return
    end if
    beside = min(1.0_wp, max(least_square, real(large, wp)/size(set)))
    beside = n*(0.5_wp - (0.5_wp - end_part)*sqrt(beside))
    at_left = threshold(sample(:n, axis), nint(beside))
    at_right = threshold(sample(:n, axis), n - nint(beside))
    do i = 1, size(set)
      associate (c => self%coordinate(axis, set(i)))
        self%graph%side(set(i)) = merge(left, merge(right, between, c > at_right), c <= at_left)
      end associate
    end do
    call self%widen_band(set, axis)
  end subroutine lay_band

  !> Find the coordinate whose median has the fewest nodes of one half with neighbours in the other half; 0 if
  !! no median divides the set.
  integer function best_axis(self, set, median)
    class(dissector), intent(inout) :: self
    integer, intent(in) :: set(:)
    real(wp), intent(in) :: median(:)   !! [axes]
    integer :: below(axes), from_lower(axes), from_upper(axes), across, i, j

    below = 0
    do i = 1, size(set)
      associate (is_lower => merge(1, 0, self%coordinate(:, set(i)) <= median))
        below = below + is_lower
        self%noted(set(i)) = sum(lower*is_lower) + shiftl(sum(lower*(1 - is_lower)), to_upper)
      end associate
    end do
    from_lower = 0
    from_upper = 0
    do i = 1, size(set)
      across = 0
      do j = self%graph%beside%start(set(i)), self%graph%beside%start(set(i) + 1) - 1
        across = ior(across, self%noted(self%graph%beside%group(j)))
      end do
      across = iand(iand(across, both), not(self%noted(set(i))))
      if (across == 0) cycle
      self%noted(set(i)) = self%noted(set(i)) + shiftl(across, to_across)
      from_upper = from_upper + merge(1, 0, iand(across, lower) /= 0)
      from_lower = from_lower + merge(1, 0, iand(shiftr(across, to_upper), lower) /= 0)
    end do
    best_axis = minloc(min(from_lower, from_upper), dim=1, &
                       mask=max(below, size(set) - below) <= largest_half*size(set))
  end function best_axis

  !> Add left and right nodes that are neighbours to the band. They exist where elements are longer than the
  !! band is wide.
  subroutine widen_band(self, set, axis)
    class(dissector), intent(inout) :: self
    integer, intent(in) :: set(:), axis
    integer :: i, j

    associate (beside => self%graph%beside, side => self%graph%side)
      do i = 1, size(set)
        if (side(set(i)) /= right .or. .not. btest(self%noted(set(i)), to_across + axis - 1)) cycle
        do j = beside%start(set(i)), beside%start(set(i) + 1) - 1
          if (side(beside%group(j)) /= left) cycle
          side(beside%group(j)) = between
          side(set(i)) = between
        end do
      end do
    end associate
  end subroutine widen_band

  !> Find the neighbours of each of some nodes among these nodes, by their positions in the list.
  function neighbours(model, node, pairs) result(beside)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node(:)
    type(incidence), intent(in), optional :: pairs   !! of each node; the nodes of a pair are neighbours
    type(incidence) :: beside
    integer :: place(0:size(model%mesh%x, 2)), seen(0:size(node)), i, j, k, n

    place = 0
    place(node) = [(i, i=1, size(node))]
    associate (start => model%mesh%around%start, element => model%mesh%around%group)
      n = sum(start(node + 1) - start(node))*(size(model%mesh%connectivity, 1) - 1)
      if (present(pairs)) n = n + sum(model%contact%row_start(pairs%group + 1) - &
                                      model%contact%row_start(pairs%group) - 1)
      allocate (beside%start(size(node) + 1), beside%group(n))
      n = 0
      seen = 0
      do i = 1, size(node)
        beside%start(i) = n + 1
        seen([0, i]) = i
        do j = start(node(i)), start(node(i) + 1) - 1
          do k = 1, size(model%mesh%connectivity, 1)
            call add(place(model%mesh%connectivity(k, element(j))))
          end do
        end do
        if (.not. present(pairs)) cycle
        do j = pairs%start(node(i)), pairs%start(node(i) + 1) - 1
          do k = model%contact%row_start(pairs%group(j)), model%contact%row_start(pairs%group(j) + 1) - 1
            call add(place(model%contact%row_node(k)))
          end do
        end do
      end do
    end associate
    beside%start(size(node) + 1) = n + 1

  contains

    !> Add a neighbour of node i, unless it is in the list.
    subroutine add(other)
      integer, intent(in) :: other

      if (seen(other) == i) return
      seen(other) = i
      n = n + 1
      beside%group(n) = other
    end subroutine add
  end function neighbours

  !> Find a value that is not exceeded by this number of keys, within a sixteenth of all keys, as far as equal
  !! keys allow. Bisection is faster than sorting.
  pure real(wp) function threshold(key, wanted)
    real(wp), intent(in) :: key(:)
    integer, intent(in) :: wanted
    integer, parameter :: most_steps = 50
    real(wp) :: high, low
    integer :: below, step

    low = minval(key)
    high = maxval(key)
    do step = 1, most_steps
      threshold = 0.5_wp*(low + high)
      below = count(key <= threshold)
      if (16*abs(below - wanted) <= size(key)) exit
      if (below > wanted) then
        high = threshold
      else
        low = threshold
      end if
    end do
  end function threshold
end module epcont_plan_dissection
