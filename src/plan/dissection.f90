!> Nested dissection: an order of a body's nodes in which elimination fills little, and the fronts it falls
!> into.
!>
!> A set of nodes is halved by a separator: with its nodes out of the way the halves know nothing of each
!> other, so each is eliminated by itself, and in the same manner, before the separator (George, SIAM J.
!> Numer. Anal. 10 (1973) 345). It is the shortest within a band about the median of that coordinate across
!> which the shortest line of nodes has neighbours.
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
    integer, allocatable :: first(:)   !! the first of each front in it, and one behind the last [fronts + 1]
    integer, allocatable :: below(:)   !! the first of all that is eliminated into each front [fronts]
  end type dissection

  !> Sets of so few nodes are not halved. From 12 to 24 it matters little: fewer operations against more and
  !! smaller matrices.
  integer, parameter :: few = 16
  !> The part of a set on either side of the band. From .3 to .4 operations are level within 3 %; the wider
  !! the band, the more regular meshes gain (triangles by turns 20 %), and the longer it takes.
  real(wp), parameter :: end_part = 0.35_wp
  !> In larger sets the band becomes narrower, by the root of their size, since ways through a wide one take
  !! ever more rounds; no narrower than by the root of this, or it would be lost in what thresholds are off.
  integer, parameter :: large = 30000
  real(wp), parameter :: least_square = 1.0_wp/6.0_wp
  !> Coordinates that halve a set less evenly are not used.
  real(wp), parameter :: largest_half = 2.0_wp/3.0_wp
  !> Larger halves are tasks of their own, if there are threads: by themselves they take a millisecond.
  integer, parameter :: many = 4000
  !> Coordinates along which sets are halved, and nodes of a set whose median serves for that of all.
  integer, parameter :: axes = 5, most_sampled = 128

  !> What is noted of a node of the set that is being halved, a bit for each axis: it is in the lower half,
  !! in the upper, has neighbours across in the lower, in the upper.
  integer, parameter :: lower(axes) = [1, 2, 4, 8, 16], to_upper = axes, to_across = 2*axes
  integer, parameter :: both = 2**to_across - 1

contains

  !> Dissect a body, or bodies that pairs join, along x, y, their diagonals, and one more coordinate. The
  !! nodes that are wanted last are a front of their own, the last.
  function dissect(model, further, nodes, wanted_last, pairs) result(found)
    type(model_type), intent(in) :: model      !! its nodes, connectivity, and elements around nodes are used
    real(wp), intent(in) :: further(:)         !! the one more coordinate [all nodes]
    integer, intent(in) :: nodes(:)            !! of the body, or bodies
    logical, intent(in) :: wanted_last(:)      !! [all nodes]
    !> Of each node those that join it to others; not given: elements alone do [all nodes]
    type(incidence), intent(in), optional :: pairs
    type(dissection) :: found
    type(parted_graph) :: graph                ! of the nodes that are not wanted last
    real(wp), allocatable :: coordinate(:, :)  ! of these [axes, nodes]
    integer, allocatable :: noted(:)           ! of nodes of the set that is being halved; 0 of others
    integer, allocatable :: free(:), order(:)
    !> Where a front begins in the order the first that is eliminated into it; else 0
    integer, allocatable :: below(:)
    integer :: i

    free = pack(nodes, .not. wanted_last(nodes))
    allocate (coordinate(axes, size(free)), noted(size(free)), order(size(free)))
    allocate (below(size(nodes) + 1), source=0)
    do i = 1, size(free)
      associate (x => model%x(1, free(i)), y => model%x(2, free(i)))
        coordinate(:, i) = [x + y, x - y, x, y, further(free(i))]
      end associate
      order(i) = i
    end do
    graph = new_parted_graph(neighbours(model, free, pairs))
    noted = 0
    !$omp parallel num_threads(threads_over(size(order)))
    !$omp single
    call dissect_set(1, size(order))
    !$omp end single
    !$omp end parallel
    below([size(order), size(nodes)] + 1) = 1
    found%node = [free(order), pack(nodes, wanted_last(nodes))]
    found%first = pack([(i, i=1, size(below))], below > 0)
    found%below = below(found%first(:size(found%first) - 1))

  contains

    !> Dissect what stands there in the order; or leave it as a front, where no node of it is without a
    !! neighbour across. One half has no neighbours in the other: threads may be at both.
    recursive subroutine dissect_set(first, last)
      integer, intent(in) :: first, last
      integer :: nodes_of(left:edge)

      below(first) = first
      if (last - first < few) return
      call lay_band(order(first:last))
      call find_separator(graph, order(first:last))
      call arrange(order(first:last), nodes_of)
      if (any(nodes_of(:right) > last - first)) return
      !$omp task if(nodes_of(left) > many)
      call dissect_set(first, first + nodes_of(left) - 1)
      !$omp end task
      call dissect_set(first + nodes_of(left), last - nodes_of(edge))
      if (nodes_of(edge) > 0) below(last - nodes_of(edge) + 1) = first
      !$omp taskwait
    end subroutine dissect_set

    !> Put a set in order: left, right, edge. It is no longer looked at then.
    subroutine arrange(set, nodes_of)
      integer, intent(inout) :: set(:)
      integer, intent(out) :: nodes_of(left:edge)   !! how many are where
      integer :: next(left:edge), node(size(set)), i

      node = set
      nodes_of = 0
      do i = 1, size(node)
        associate (n => nodes_of(graph%side(node(i))))
          n = n + 1
        end associate
      end do
      next = 1 + [0, nodes_of(left), 0, size(set) - nodes_of(edge)]
      do i = 1, size(node)
        associate (side => graph%side(node(i)))
          set(next(side)) = node(i)
          next(side) = next(side) + 1
          side = outside
        end associate
        noted(node(i)) = 0
      end do
    end subroutine arrange

    !> Say of a set which nodes are left and right of a band. Where no coordinate halves it, since it has
    !! too few values, nodes are taken as they come.
    recursive subroutine lay_band(set)
      integer, intent(in) :: set(:)
      real(wp) :: at_left, at_right, beside, sample(most_sampled, axes), median(axes)
      integer :: axis, i, n

      n = 0
      do i = 1, size(set), (size(set) - 1)/most_sampled + 1
        n = n + 1
        sample(n, :) = coordinate(:, set(i))
      end do
      median = [(threshold(sample(:n, axis), n/2), axis=1, axes)]
      axis = best_axis(set, median)
      if (axis == 0) then
        do i = 1, size(set)
          coordinate(:, set(i)) = i
        end do
        call lay_band(set)
        return
      end if
      beside = min(1.0_wp, max(least_square, real(large, wp)/size(set)))
      beside = n*(0.5_wp - (0.5_wp - end_part)*sqrt(beside))
      at_left = threshold(sample(:n, axis), nint(beside))
      at_right = threshold(sample(:n, axis), n - nint(beside))
      do i = 1, size(set)
        associate (c => coordinate(axis, set(i)))
          graph%side(set(i)) = merge(left, merge(right, between, c > at_right), c <= at_left)
        end associate
      end do
      call widen_band(set, axis)
    end subroutine lay_band

    !> Of the coordinates whose medians halve a set the one where the fewest nodes of one half have
    !! neighbours in the other; 0: none halves it.
    integer function best_axis(set, median)
      integer, intent(in) :: set(:)
      real(wp), intent(in) :: median(:)   !! [axes]
      integer :: below(axes), fewest(axes), from_lower(axes), from_upper(axes), across, i, j

      below = 0
      do i = 1, size(set)
        associate (is_lower => merge(1, 0, coordinate(:, set(i)) <= median))
          below = below + is_lower
          noted(set(i)) = sum(lower*is_lower) + shiftl(sum(lower*(1 - is_lower)), to_upper)
        end associate
      end do
      from_lower = 0
      from_upper = 0
      do i = 1, size(set)
        across = 0
        do j = graph%beside%start(set(i)), graph%beside%start(set(i) + 1) - 1
          across = ior(across, noted(graph%beside%group(j)))
        end do
        across = iand(iand(across, both), not(noted(set(i))))
        if (across == 0) cycle
        noted(set(i)) = noted(set(i)) + shiftl(across, to_across)
        from_upper = from_upper + merge(1, 0, iand(across, lower) /= 0)
        from_lower = from_lower + merge(1, 0, iand(shiftr(across, to_upper), lower) /= 0)
      end do
      fewest = min(from_lower, from_upper)
      best_axis = minloc(fewest, dim=1, mask=max(below, size(set) - below) <= largest_half*size(set))
    end function best_axis

    !> Make nodes of the band of those that are left and right and neighbours: where elements are longer
    !! than it is wide.
    subroutine widen_band(set, axis)
      integer, intent(in) :: set(:), axis
      integer :: i, j

      do i = 1, size(set)
        if (graph%side(set(i)) /= right .or. .not. btest(noted(set(i)), to_across + axis - 1)) cycle
        do j = graph%beside%start(set(i)), graph%beside%start(set(i) + 1) - 1
          associate (other => graph%side(graph%beside%group(j)))
            if (other /= left) cycle
            other = between
            graph%side(set(i)) = between
          end associate
        end do
      end do
    end subroutine widen_band
  end function dissect

  !> The neighbours of each of some nodes among them, all by their places in the list.
  function neighbours(model, node, pairs) result(beside)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node(:)
    type(incidence), intent(in), optional :: pairs   !! of each node, those of one are neighbours too
    type(incidence) :: beside
    integer :: place(0:size(model%x, 2)), seen(0:size(node)), i, j, k, n

    place = 0
    place(node) = [(i, i=1, size(node))]
    associate (start => model%around%start, element => model%around%group)
      n = sum(start(node + 1) - start(node))*(size(model%connectivity, 1) - 1)
      if (present(pairs)) n = n + sum(model%row_start(pairs%group + 1) - model%row_start(pairs%group) - 1)
      allocate (beside%start(size(node) + 1), beside%group(n))
      n = 0
      seen = 0
      do i = 1, size(node)
        beside%start(i) = n + 1
        seen([0, i]) = i
        do j = start(node(i)), start(node(i) + 1) - 1
          do k = 1, size(model%connectivity, 1)
            call add(place(model%connectivity(k, element(j))))
          end do
        end do
        if (.not. present(pairs)) cycle
        do j = pairs%start(node(i)), pairs%start(node(i) + 1) - 1
          do k = model%row_start(pairs%group(j)), model%row_start(pairs%group(j) + 1) - 1
            call add(place(model%row_node(k)))
          end do
        end do
      end do
    end associate
    beside%start(size(node) + 1) = n + 1

  contains

    !> One more of node i, unless it has been seen.
    subroutine add(other)
      integer, intent(in) :: other

      if (seen(other) == i) return
      seen(other) = i
      n = n + 1
      beside%group(n) = other
    end subroutine add
  end function neighbours

  !> A value that so many of the keys are not above, within a sixteenth of all, as far as equal keys allow.
  !! Found by halving, it takes less than sorting does.
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
