!> Nested dissection: an order of the nodes in which elimination causes little fill, and its fronts.
!>
!> A separator divides a set of nodes into two halves. Without the separator the halves are independent, so
!> each is eliminated first, in the same manner, and the separator after them (George, SIAM J. Numer. Anal. 10
!> (1973) 345). The separator has the nodes of one half with neighbours in the other. The halves are those
!> below and above the median of one coordinate, for which the separator is shortest.
module epcont_plan_dissection
  use epcont_base_incidence, only: incidence
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: halve
  use epcont_model_model, only: model_type
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
  !> A coordinate is used only if neither half has more than this part of the set.
  real(wp), parameter :: largest_half = 2.0_wp/3.0_wp
  !> Halves with more nodes are tasks of their own: these take a millisecond or more.
  integer, parameter :: many = 4000
  !> Coordinates along which sets are divided, and number of nodes whose median represents that of a set.
  integer, parameter :: axes = 5, most_sampled = 128

  !> Position of a node: in one of the halves, or in the separator.
  integer, parameter :: left = 1, right = 2, edge = 3

  !> State of a dissection.
  type :: dissector
    type(incidence) :: beside                  ! neighbours of the nodes that are not eliminated last
    real(wp), allocatable :: coordinate(:, :)  ! of these nodes [axes, nodes]
    !> Bits of nodes in the set being divided: one for each axis if the node is below the median, and one more
    !! that is always set; 0 for nodes outside the set [nodes]
    integer, allocatable :: noted(:)
    integer, allocatable :: order(:)           ! [nodes]
    !> If a front begins at this position: position of the first node eliminated into it; otherwise 0
    integer, allocatable :: below(:)
  contains
    procedure :: divide
    procedure :: cut
    procedure :: look_across
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
    work%beside = neighbours(model, free, pairs)
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

  !> Divide the nodes between two positions of the order, or make them a front if one of the halves would have
  !! only nodes with neighbours across. The halves are independent, so threads may work on both.
  recursive subroutine divide(self, first, last)
    class(dissector), intent(inout) :: self
    integer, intent(in) :: first, last
    integer :: lefts, node(last - first + 1), rights, side(last - first + 1)

    self%below(first) = first
    if (last - first < few) return
    node = self%order(first:last)
    call self%cut(node, side)
    self%noted(node) = 0
    lefts = count(side == left)
    rights = count(side == right)
    if (lefts == 0 .or. rights == 0) return
    self%order(first:last) = [pack(node, side == left), pack(node, side == right), pack(node, side == edge)]
    !$omp task shared(self) firstprivate(first, lefts) if(lefts > many)
    call self%divide(first, first + lefts - 1)
    !$omp end task
    call self%divide(first + lefts, first + lefts + rights - 1)
    if (lefts + rights < size(node)) self%below(first + lefts + rights) = first
    !$omp taskwait
  end subroutine divide

  !> Divide a set. If no coordinate divides it, because it has too few values, the positions of the nodes are
  !! used instead.
  recursive subroutine cut(self, set, side)
    class(dissector), intent(inout) :: self
    integer, intent(in) :: set(:)
    integer, intent(out) :: side(:)    !! position of each node
    real(wp) :: sample(most_sampled, axes), middle(axes)
    integer :: across(size(set))       ! bit of each axis: the node has neighbours in the other half
    integer :: lower(axes)             ! number of nodes below each median
    integer :: crossing(2, axes)       ! those with neighbours across, of the lower and of the upper half
    integer :: axis, i, n, smaller

    n = 0
    do i = 1, size(set), (size(set) - 1)/most_sampled + 1
      n = n + 1
      sample(n, :) = self%coordinate(:, set(i))
    end do
    middle = [(median(sample(:n, axis)), axis=1, axes)]
    lower = 0
    do i = 1, size(set)
      associate (is_lower => merge(1, 0, self%coordinate(:, set(i)) <= middle))
        lower = lower + is_lower
        self%noted(set(i)) = 2**axes + sum(is_lower*[(2**n, n=0, axes - 1)])
      end associate
    end do
    call self%look_across(set, across, crossing)
    axis = minloc(minval(crossing, dim=1), dim=1, &
                  mask=max(lower, size(set) - lower) <= largest_half*size(set))
    if (axis == 0) then
      do i = 1, size(set)
        self%coordinate(:, set(i)) = i
      end do
      call self%cut(set, side)
      return
    end if
    side = merge(left, right, btest(self%noted(set), axis - 1))
    smaller = minloc(crossing(:, axis), dim=1)
    where (btest(across, axis - 1) .and. side == smaller) side = edge
  end subroutine cut

  !> Find the nodes of a set that have neighbours across a median, and count those of the lower and of the
  !! upper half.
  subroutine look_across(self, set, across, crossing)
    class(dissector), intent(in) :: self
    integer, intent(in) :: set(:)
    integer, intent(out) :: across(:)        !! bit of each axis [set]
    integer, intent(out) :: crossing(:, :)   !! [2, axes]
    integer :: axis, i, j

    crossing = 0
    do i = 1, size(set)
      across(i) = 0
      associate (own => self%noted(set(i)))
        do j = self%beside%start(set(i)), self%beside%start(set(i) + 1) - 1
          associate (other => self%noted(self%beside%group(j)))
            if (other > 0) across(i) = ior(across(i), ieor(own, other))
          end associate
        end do
        if (across(i) == 0) cycle
        do axis = 1, axes
          if (.not. btest(across(i), axis - 1)) cycle
          associate (many => crossing(merge(left, right, btest(own, axis - 1)), axis))
            many = many + 1
          end associate
        end do
      end associate
    end do
  end subroutine look_across

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

  !> Largest of the lower half of some keys.
  pure real(wp) function median(key)
    real(wp), intent(in) :: key(:)
    integer :: i, item(size(key))

    item = [(i, i=1, size(key))]
    call halve(key, item)
    median = maxval(key(item(:size(key)/2)))
  end function median
end module epcont_plan_dissection
