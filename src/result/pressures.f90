!> Pressures at the pairs.
!>
!> On edges with two nodes the pressure is force over area. On edges with a mid-side node this ratio
!> oscillates by one or two per cent, low at corners and high at mid-side nodes, but the force on each edge
!> does not. There the force is summed along the line up to each corner. The pressure is the derivative of
!> this sum by the area, of the polynomial through the nearest corners (finite volumes recover point values
!> from means in the same way).
module epcont_result_pressures
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_result_contact_line, only: contact_line
  implicit none
  private
  public :: pair_pressures

  integer, parameter :: &
    !> Corners of the polynomial for a mid-side node, and for a corner.
    around_middle = 4, around_corner = 5, &
    !> Corners before the corner itself.
    before = 2, &
    !> Least number of corners of a run; and for a corner without area, whose force over area is undefined.
    least_corners = 4, least_at_axis = 3

  !> A run of edges whose three pairs are all in contact, in their order.
  type :: run_type
    type(model_type), pointer :: model => null()
    type(contact_line), pointer :: line => null()   !! of its pairs
    logical, pointer :: touching(:) => null()       !! pairs `in_contact` [pairs]
    real(wp), pointer :: force(:) => null()         !! [force] [pairs]
    integer, allocatable :: corner(:), middle(:)    !! pairs [edges + 1], [edges]
    !> Area and force, summed up to each corner; beyond a line of symmetry mirrored. Corner k has index k. A
    !! closed run continues with itself. [2, corners]
    real(wp), allocatable :: total(:, :)
    !> The pressure is symmetric at the end: line of symmetry, axis of axisymmetric bodies
    logical :: even(2) = .false.
  end type run_type

contains

  !> Find the pressures; negative if no boundary belongs to a pair [stress] [pairs].
  function pair_pressures(model, line, touching, force) result(pressure)
    type(model_type), target, intent(in) :: model   !! the model
    type(contact_line), target, intent(in) :: line  !! of its pairs
    logical, target, intent(in) :: touching(:)      !! pairs `in_contact` [pairs]
    real(wp), target, intent(in) :: force(:)        !! [force] [pairs]
    real(wp), allocatable :: pressure(:)
    logical :: done(model%contact%pairs)
    type(run_type) :: run
    integer :: k

    pressure = merge(force/max(line%tributary, tiny(1.0_wp)), -1.0_wp, line%tributary > 0.0_wp)
    run%model => model
    run%line => line
    run%touching => touching
    run%force => force
    done = .false.
    do k = 1, model%contact%pairs
      if (done(k) .or. .not. is_whole(run, k)) cycle
      call find_run(run, k)
      call sum_up(run)
      call derive(run, pressure)
      done(run%middle) = .true.
    end do
    do k = 1, size(line%at_place%start) - 1
      call level(line%at_place%of(k))
    end do
    do k = 1, model%contact%pairs
      if (line%tributary(k) <= 0.0_wp) call complete(k, maxval(line%neighbour(:, k)))
    end do

  contains

    !> Give pairs at the same place the same pressure.
    subroutine level(pairs)
      integer, intent(in) :: pairs(:)
      real(wp) :: area

      area = sum(line%tributary(pairs))
      if (size(pairs) == 1 .or. area <= 0.0_wp) return
      where (force(pairs) > 0.0_wp) pressure(pairs) = sum(force(pairs))/area
    end subroutine level

    !> Give a corner on the axis, which has no area, the pressure of the mid-side node beside it; if the
    !! corner has opened, as upper bound: then the pressure increases away from the axis.
    subroutine complete(pair, next)
      integer, intent(in) :: pair, next

      if (next == 0) return
      if (.not. touching(next)) return
      if (pressure(pair) < 0.0_wp) pressure(pair) = pressure(next)
      if (force(pair) == 0.0_wp) pressure(pair) = min(pressure(pair), pressure(next))
    end subroutine complete
  end function pair_pressures

  !> Is the pair at the mid-side node of an edge whose three pairs are in contact?
  pure logical function is_whole(run, pair)
    type(run_type), intent(in) :: run
    integer, intent(in) :: pair
    integer :: corners(2)

    is_whole = .false.
    if (pair == 0) return
    corners = run%line%neighbour(:, pair)
    if (.not. run%line%middle(pair) .or. any(corners == 0)) return
    ! At a corner of the line, the corner's pair may belong to the other edge only.
    is_whole = run%touching(pair) .and. all(run%touching(corners)) .and. &
               all(any(run%line%neighbour(:, corners) == pair, dim=1))
  end function is_whole

  !> Find the run of an edge, given by its mid-side node.
  subroutine find_run(run, side)
    type(run_type), intent(inout) :: run
    integer, intent(in) :: side
    integer, allocatable :: chain(:)   !! corners and mid-side nodes alternate
    integer :: corner, direction, next

    associate (neighbour => run%line%neighbour)
      chain = [neighbour(1, side), side, neighbour(2, side)]
      do direction = 1, 2
        do
          corner = chain(size(chain))
          next = sum(neighbour(:, corner)) - chain(size(chain) - 1)   ! the other one
          if (.not. is_whole(run, next) .or. any(chain == next)) exit
          chain = [chain, next, sum(neighbour(:, next)) - corner]
        end do
        chain = chain(size(chain):1:-1)
      end do
    end associate
    run%corner = chain(1::2)
    run%middle = chain(2::2)
  end subroutine find_run

  !> Sum area and force from the first corner. The force of a corner is divided among its edges in contact by
  !! their areas.
  subroutine sum_up(run)
    type(run_type), intent(inout) :: run
    integer :: beyond(2), end, k, n
    logical :: closed, mirrored(2)

    n = size(run%middle)
    associate (ends => run%corner([1, n + 1]))
      closed = ends(1) == ends(2)
      run%even = run%line%mirrored(ends) .or. closed
      ! At the axis of axisymmetric bodies the pressure is a smooth function of the area: no mirroring.
      mirrored = run%even .and. .not. closed .and. &
                 .not. (run%model%has_rings() .and. run%line%x(1, ends) == 0.0_wp)
    end associate
    beyond = merge(min(n, before), 0, mirrored .or. closed)
    if (allocated(run%total)) deallocate (run%total)
    allocate (run%total(2, 1 - beyond(1):n + 1 + beyond(2)), source=0.0_wp)
    associate (total => run%total)
      do k = 1, n
        total(:, k + 1) = total(:, k) + [run%line%tributary(run%middle(k)), run%force(run%middle(k))]
        do end = k, k + 1
          total(:, k + 1) = total(:, k + 1) + share_of_side(run, run%corner(end), run%middle(k))
        end do
      end do
      do k = 1, min(n, before)
        if (closed) total(:, 1 - k) = total(:, n + 1 - k) - total(:, n + 1)
        if (closed) total(:, n + 1 + k) = total(:, n + 1) + total(:, 1 + k)
        if (mirrored(1)) total(:, 1 - k) = -total(:, 1 + k)
        if (mirrored(2)) total(:, n + 1 + k) = 2.0_wp*total(:, n + 1) - total(:, n + 1 - k)
      end do
    end associate
  end subroutine sum_up

  !> Part of the area and of the force of a corner that belongs to an edge: all of the force if the mid-side
  !! node of the next edge is open.
  pure function share_of_side(run, corner, middle) result(share)
    type(run_type), intent(in) :: run
    integer, intent(in) :: corner, middle
    real(wp) :: share(2), other

    associate (next => run%line%neighbour(:, corner), part => run%line%part(:, corner))
      share = [sum(part, mask=next == middle), run%force(corner)]
      other = sum(part, mask=next /= middle .and. next > 0 .and. run%touching(max(1, next)))
    end associate
    if (other > 0.0_wp) share(2) = run%force(corner)*(share(1)/(share(1) + other))
  end function share_of_side

  !> Find the pressures of a run. The last edge at an end of the contact keeps force over area: there the
  !! pressure is no polynomial.
  subroutine derive(run, pressure)
    type(run_type), intent(in) :: run
    real(wp), intent(inout) :: pressure(:)       !! [stress] [pairs]
    integer :: first, k, last

    if (size(run%total, 2) < least_corners) then
      if (size(run%total, 2) < least_at_axis) return
      do k = 1, size(run%corner), size(run%middle)
        if (run%line%tributary(run%corner(k)) <= 0.0_wp) &
          pressure(run%corner(k)) = slope(run, 1, least_at_axis, run%total(1, k))
      end do
      return
    end if
    first = merge(1, 2, run%even(1))
    last = size(run%middle) - merge(0, 1, run%even(2))
    do k = first, last
      pressure(run%middle(k)) = slope(run, k - 1, around_middle, area_at_middle(run, k))
    end do
    do k = first, last + 1
      pressure(run%corner(k)) = slope(run, k - before, around_corner, run%total(1, k))
    end do
  end subroutine derive

  !> Area up to the mid-side node of an edge.
  pure real(wp) function area_at_middle(run, k) result(area)
    type(run_type), intent(in) :: run
    integer, intent(in) :: k
    real(wp) :: half(2)

    associate (a => run%corner(k), m => run%middle(k), b => run%corner(k + 1), radius => run%line%x(1, :))
      half = [run%line%distance(m, a), run%line%distance(b, m)]
      if (run%model%has_rings()) half = half*[radius(a) + radius(m), radius(m) + radius(b)]
    end associate
    area = run%total(1, k) + (run%total(1, k + 1) - run%total(1, k))*half(1)/sum(half)
  end function area_at_middle

  !> Derivative of force by area, of the polynomial through at most `many` corners, if possible from corner
  !! `from`.
  pure real(wp) function slope(run, from, many, at)
    type(run_type), intent(in) :: run
    integer, intent(in) :: from, many
    real(wp), intent(in) :: at   !! area
    integer :: first, i, j, k, last
    real(wp) :: product, total

    first = max(lbound(run%total, 2), min(from, ubound(run%total, 2) - many + 1))
    last = min(ubound(run%total, 2), first + many - 1)
    slope = 0.0_wp
    associate (area => run%total(1, first:last), borne => run%total(2, first:last))
      do k = 1, size(area)
        total = 0.0_wp
        do j = 1, size(area)
          if (j == k) cycle
          product = 1.0_wp/(area(k) - area(j))
          do i = 1, size(area)
            if (i /= k .and. i /= j) product = product*(at - area(i))/(area(k) - area(i))
          end do
          total = total + product
        end do
        slope = slope + borne(k)*total
      end do
    end associate
  end function slope
end module epcont_result_pressures
