!> Pressures at the pairs.
!>
!> A pair's force over its area is exact enough where sides are straight from node to node. Along sides with a
!> node between, it swings: low at corners, high at middles, by a per cent or two. What the whole of each side
!> carries does not, so that there the force is summed along the line up to each corner, and the pressure is
!> the derivative of that sum by the area, of the polynomial through the corners around. (As finite volumes
!> recover point values from means.)
module epcont_result_pressures
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_result_contact_line, only: contact_line
  implicit none
  private
  public :: pair_pressures

  !> Corners around a middle, and around a corner, that the polynomial goes through.
  integer, parameter :: around_middle = 4, around_corner = 5
  !> Of the latter, those before it.
  integer, parameter :: before = 2
  !> Corners of the least run of sides for which this is done; for a corner without an area, of which force
  !! over area says nothing.
  integer, parameter :: least_corners = 4, least_at_axis = 3

  !> A run of sides that touch all along, in their order.
  type :: run_type
    integer, allocatable :: corner(:), middle(:)    !! pairs [sides + 1], [sides]
    !> Summed up to each corner, and beyond a line of symmetry as mirrored there; corner k has index k. A
    !! closed run goes on with itself.
    real(wp), allocatable :: area(:), force(:)
    logical :: even(2) = .false.                    !! the pressure goes on evenly beyond the end: symmetry, the axis of rings
  end type run_type

contains

  !> Pressures; negative where no boundary belongs to a pair. `touching` are the pairs `in_contact`.
  pure function pair_pressures(model, line, touching, force) result(pressure)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    real(wp), intent(in) :: force(:)
    real(wp), allocatable :: pressure(:)
    logical, allocatable :: done(:)
    type(run_type) :: run
    integer :: pair

    pressure = merge(force/max(line%tributary, tiny(1.0_wp)), -1.0_wp, line%tributary > 0.0_wp)
    allocate (done(model%pairs), source=.false.)
    do pair = 1, model%pairs
      if (done(pair) .or. .not. is_whole(line, touching, pair)) cycle
      call find_run(line, touching, pair, run)
      done(run%middle) = .true.
      call sum_up(model, line, touching, force, run)
      call derive(model, line, run, pressure)
    end do
    call level(line, force, pressure)
    do pair = 1, model%pairs
      if (line%tributary(pair) <= 0.0_wp) call complete(line, touching, force, pair, pressure)
    end do
  end function pair_pressures

  !> Pairs at one place have one pressure.
  pure subroutine level(line, force, pressure)
    type(contact_line), intent(in) :: line
    real(wp), intent(in) :: force(:)
    real(wp), intent(inout) :: pressure(:)
    real(wp), allocatable :: area(:), sum(:)
    integer, allocatable :: pairs(:)
    integer :: k

    if (.not. allocated(line%place)) return
    allocate (area(maxval(line%place)), sum(maxval(line%place)), source=0.0_wp)
    allocate (pairs(maxval(line%place)), source=0)
    do k = 1, size(force)
      associate (at => line%place(k))
        area(at) = area(at) + line%tributary(k)
        sum(at) = sum(at) + force(k)
        pairs(at) = pairs(at) + 1
      end associate
    end do
    do k = 1, size(force)
      associate (at => line%place(k))
        if (pairs(at) > 1 .and. force(k) > 0.0_wp .and. area(at) > 0.0_wp) pressure(k) = sum(at)/area(at)
      end associate
    end do
  end subroutine level

  !> The pressure at a corner on the axis that has none of its own: that of the middle beside it. So it is at
  !! most where the corner has opened, which it does where pressures rise away from the axis.
  pure subroutine complete(line, touching, force, pair, pressure)
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    real(wp), intent(in) :: force(:)
    integer, intent(in) :: pair
    real(wp), intent(inout) :: pressure(:)

    associate (next => maxval(line%neighbour(:, pair)))
      if (next == 0) return
      if (.not. touching(next)) return
      if (pressure(pair) < 0.0_wp) pressure(pair) = pressure(next)
      if (force(pair) == 0.0_wp) pressure(pair) = min(pressure(pair), pressure(next))
    end associate
  end subroutine complete

  !> Is the pair at the middle of a side that touches all along?
  pure logical function is_whole(line, touching, pair)
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    integer, intent(in) :: pair

    is_whole = .false.
    if (pair == 0) return
    if (.not. line%middle(pair) .or. any(line%neighbour(:, pair) == 0)) return
    associate (corners => line%neighbour(:, pair))
      ! Where a line turns a corner, the corner's pair may belong to the other side alone.
      if (.not. (any(line%neighbour(:, corners(1)) == pair) .and. any(line%neighbour(:, corners(2)) == pair))) return
      is_whole = touching(pair) .and. all(touching(corners))
    end associate
  end function is_whole

  !> The run that a side belongs to.
  pure subroutine find_run(line, touching, start, run)
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    integer, intent(in) :: start
    type(run_type), intent(out) :: run
    integer :: direction

    run%middle = [start]
    run%corner = line%neighbour(:, start)
    do direction = 1, 2
      call extend(line, touching, run)
      run%middle = run%middle(size(run%middle):1:-1)
      run%corner = run%corner(size(run%corner):1:-1)
    end do
  end subroutine find_run

  !> Go on behind the last corner.
  pure subroutine extend(line, touching, run)
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    type(run_type), intent(inout) :: run
    integer :: corner, next

    do
      corner = run%corner(size(run%corner))
      next = other_than(run%middle(size(run%middle)), line%neighbour(:, corner))
      if (.not. is_whole(line, touching, next)) return
      if (any(run%middle == next)) return
      run%middle = [run%middle, next]
      run%corner = [run%corner, other_than(corner, line%neighbour(:, next))]
    end do
  end subroutine extend

  !> Of two neighbours the other one.
  pure integer function other_than(one, both) result(other)
    integer, intent(in) :: one, both(2)

    other = merge(both(2), both(1), both(1) == one)
  end function other_than

  !> Area and force from the first corner on. What a corner bears goes to the sides that touch as its area
  !! does.
  pure subroutine sum_up(model, line, touching, force, run)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    real(wp), intent(in) :: force(:)
    type(run_type), intent(inout) :: run
    integer :: end, k, n, outside(2)
    logical :: closed, mirrored(2)

    n = size(run%middle)
    associate (ends => run%corner([1, n + 1]))
      closed = ends(1) == ends(2)
      run%even = line%mirrored(ends) .or. closed
      ! Of rings the pressure is even in the radius: a smooth function of the area from the axis on.
      mirrored = run%even .and. .not. closed .and. .not. (model%has_rings() .and. model%x(1, line%node(ends)) == 0.0_wp)
    end associate
    outside = merge(min(n, before), 0, mirrored .or. closed)
    allocate (run%area(1 - outside(1):n + 1 + outside(2)), run%force(1 - outside(1):n + 1 + outside(2)), source=0.0_wp)
    do k = 1, n
      run%area(k + 1) = run%area(k) + line%tributary(run%middle(k))
      run%force(k + 1) = run%force(k) + force(run%middle(k))
      do end = 0, 1
        associate (corner => run%corner(k + end))
          run%area(k + 1) = run%area(k + 1) + sum(line%part(:, corner), mask=line%neighbour(:, corner) == run%middle(k))
          run%force(k + 1) = run%force(k + 1) + force(corner)*share_of_side(line, touching, corner, run%middle(k))
        end associate
      end do
    end do
    if (closed) then
      do k = 1, before
        if (k > n) exit
        run%area(1 - k) = run%area(n + 1 - k) - run%area(n + 1)
        run%force(1 - k) = run%force(n + 1 - k) - run%force(n + 1)
        run%area(n + 1 + k) = run%area(n + 1) + run%area(1 + k)
        run%force(n + 1 + k) = run%force(n + 1) + run%force(1 + k)
      end do
      return
    end if
    do k = 1, outside(1)
      run%area(1 - k) = -run%area(1 + k)
      run%force(1 - k) = -run%force(1 + k)
    end do
    do k = 1, outside(2)
      run%area(n + 1 + k) = 2.0_wp*run%area(n + 1) - run%area(n + 1 - k)
      run%force(n + 1 + k) = 2.0_wp*run%force(n + 1) - run%force(n + 1 - k)
    end do
  end subroutine sum_up

  !> The share of a side in what its corner bears: all of it where the next middle does not touch.
  pure real(wp) function share_of_side(line, touching, corner, middle) result(share)
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    integer, intent(in) :: corner, middle
    integer :: k
    real(wp) :: other, own

    own = 0.0_wp
    other = 0.0_wp
    do k = 1, 2
      associate (neighbour => line%neighbour(k, corner))
        if (neighbour == 0) cycle
        if (neighbour == middle) then
          own = own + line%part(k, corner)
        else if (touching(neighbour)) then
          other = other + line%part(k, corner)
        end if
      end associate
    end do
    share = 1.0_wp
    if (other > 0.0_wp) share = own/(own + other)
  end function share_of_side

  !> Pressures of a run. At an end where contact ends, the last side's own are left: there the pressure has no
  !! polynomial.
  pure subroutine derive(model, line, run, pressure)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    type(run_type), intent(in) :: run
    real(wp), intent(inout) :: pressure(:)
    integer :: first, k, last

    if (size(run%area) < least_corners) then
      if (size(run%area) < least_at_axis) return
      do k = 1, size(run%corner), size(run%middle)
        if (line%tributary(run%corner(k)) <= 0.0_wp) pressure(run%corner(k)) = slope(run, 1, least_at_axis, run%area(k))
      end do
      return
    end if
    first = merge(1, 2, run%even(1))
    last = size(run%middle) - merge(0, 1, run%even(2))
    do k = first, last
      pressure(run%middle(k)) = slope(run, k - 1, around_middle, area_at_middle(model, line, run, k))
    end do
    do k = first, last + 1
      pressure(run%corner(k)) = slope(run, k - before, around_corner, run%area(k))
    end do
  end subroutine derive

  !> Area up to the middle node of a side.
  pure real(wp) function area_at_middle(model, line, run, k) result(area)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    type(run_type), intent(in) :: run
    integer, intent(in) :: k
    real(wp) :: half(2)

    associate (a => model%x(:, line%node(run%corner(k))), m => model%x(:, line%node(run%middle(k))), &
               b => model%x(:, line%node(run%corner(k + 1))))
      half = [norm2(m - a), norm2(b - m)]
      if (model%has_rings()) half = half*[a(1) + m(1), m(1) + b(1)]
    end associate
    area = run%area(k) + (run%area(k + 1) - run%area(k))*half(1)/sum(half)
  end function area_at_middle

  !> Derivative of the polynomial through some corners, from one of them on if the run has so many.
  pure real(wp) function slope(run, from, many, at)
    type(run_type), intent(in) :: run
    integer, intent(in) :: from, many
    real(wp), intent(in) :: at
    integer :: first, i, j, k, last
    real(wp) :: product, total

    first = max(lbound(run%area, 1), min(from, ubound(run%area, 1) - many + 1))
    last = min(ubound(run%area, 1), first + many - 1)
    slope = 0.0_wp
    do k = first, last
      total = 0.0_wp
      do j = first, last
        if (j == k) cycle
        product = 1.0_wp/(run%area(k) - run%area(j))
        do i = first, last
          if (i /= k .and. i /= j) product = product*(at - run%area(i))/(run%area(k) - run%area(i))
        end do
        total = total + product
      end do
      slope = slope + run%force(k)*total
    end do
  end function slope
end module epcont_result_pressures
