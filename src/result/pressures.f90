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

  integer, parameter :: &
    !> Corners around a middle, and around a corner, that the polynomial goes through.
    around_middle = 4, around_corner = 5, &
    !> Of the latter, those before it.
    before = 2, &
    !> Corners of the least run of sides for which this is done; for a corner without an area, of which force
    !! over area says nothing.
    least_corners = 4, least_at_axis = 3

  !> A run of sides that touch all along, in their order.
  type :: run_type
    integer, allocatable :: corner(:), middle(:)    !! pairs [sides + 1], [sides]
    !> Area and force, summed up to each corner, and beyond a line of symmetry as mirrored there; corner k has
    !! index k. A closed run goes on with itself. [2, corners]
    real(wp), allocatable :: total(:, :)
    !> The pressure goes on evenly beyond the end: symmetry, the axis of rings
    logical :: even(2) = .false.
  end type run_type

contains

  !> Pressures; negative where no boundary belongs to a pair [stress] [pairs].
  function pair_pressures(model, line, touching, force) result(pressure)
    type(model_type), intent(in) :: model   !! the scene
    type(contact_line), intent(in) :: line  !! of its pairs
    logical, intent(in) :: touching(:)      !! the pairs `in_contact` [pairs]
    real(wp), intent(in) :: force(:)        !! [force] [pairs]
    real(wp), allocatable :: pressure(:)
    logical :: done(model%pairs)
    type(run_type) :: run
    integer :: k

    pressure = merge(force/max(line%tributary, tiny(1.0_wp)), -1.0_wp, line%tributary > 0.0_wp)
    done = .false.
    do k = 1, model%pairs
      if (done(k) .or. .not. is_whole(line, touching, k)) cycle
      call find_run(line, touching, run, k)
      call sum_up(model, line, touching, force, run)
      call derive(model, line, run, pressure)
      done(run%middle) = .true.
    end do
    do k = 1, size(line%at_place%start) - 1
      call level(line, force, pressure, line%at_place%of(k))
    end do
    do k = 1, model%pairs
      if (line%tributary(k) <= 0.0_wp) call complete(touching, force, pressure, k, &
          maxval(line%neighbour(:, k)))
    end do
  end function pair_pressures

  !> Pairs at one place have one pressure.
  subroutine level(line, force, pressure, pairs)
    type(contact_line), intent(in) :: line       !! of its pairs
    real(wp), intent(in) :: force(:)             !! [force] [pairs]
    real(wp), intent(inout) :: pressure(:)       !! [stress] [pairs]
    integer, intent(in) :: pairs(:)
    real(wp) :: area
    integer :: i

    area = sum(line%tributary(pairs))
    if (size(pairs) == 1 .or. area <= 0.0_wp) return
    do i = 1, size(pairs)
      if (force(pairs(i)) > 0.0_wp) pressure(pairs(i)) = sum(force(pairs))/area
    end do
  end subroutine level

  !> The pressure at a corner on the axis that has none of its own: that of the middle beside it. So it is
  !! at most where the corner has opened, which it does where pressures rise away from the axis.
  subroutine complete(touching, force, pressure, pair, next)
    logical, intent(in) :: touching(:)           !! the pairs `in_contact` [pairs]
    real(wp), intent(in) :: force(:)             !! [force] [pairs]
    real(wp), intent(inout) :: pressure(:)       !! [stress] [pairs]
    integer, intent(in) :: pair, next

    if (next == 0) return
    if (.not. touching(next)) return
    if (pressure(pair) < 0.0_wp) pressure(pair) = pressure(next)
    if (force(pair) == 0.0_wp) pressure(pair) = min(pressure(pair), pressure(next))
  end subroutine complete

  !> Is the pair at the middle of a side that touches all along?
  pure logical function is_whole(line, touching, pair)
    type(contact_line), intent(in) :: line       !! of its pairs
    logical, intent(in) :: touching(:)           !! the pairs `in_contact` [pairs]
    integer, intent(in) :: pair
    integer :: corners(2)

    is_whole = .false.
    if (pair == 0) return
    corners = line%neighbour(:, pair)
    if (.not. line%middle(pair) .or. any(corners == 0)) return
    ! Where a line turns a corner, the corner's pair may belong to the other side alone.
    is_whole = touching(pair) .and. all(touching(corners)) .and. &
               all(any(line%neighbour(:, corners) == pair, dim=1))
  end function is_whole

  !> The run that a side belongs to, given by its middle.
  subroutine find_run(line, touching, run, side)
    type(contact_line), intent(in) :: line       !! of its pairs
    logical, intent(in) :: touching(:)           !! the pairs `in_contact` [pairs]
    type(run_type), intent(inout) :: run        !! sides that touch
    integer, intent(in) :: side
    integer, allocatable :: chain(:)   !! corners and middles by turns
    integer :: corner, direction, next

    chain = [line%neighbour(1, side), side, line%neighbour(2, side)]
    do direction = 1, 2
      do
        corner = chain(size(chain))
        next = sum(line%neighbour(:, corner)) - chain(size(chain) - 1)   ! the other one
        if (.not. is_whole(line, touching, next) .or. any(chain == next)) exit
        chain = [chain, next, sum(line%neighbour(:, next)) - corner]
      end do
      chain = chain(size(chain):1:-1)
    end do
    run%corner = chain(1::2)
    run%middle = chain(2::2)
  end subroutine find_run

  !> Area and force from the first corner on. What a corner bears goes to the sides that touch as its area
  !! does.
  subroutine sum_up(model, line, touching, force, run)
    type(model_type), intent(in) :: model        !! the model
    type(contact_line), intent(in) :: line       !! of its pairs
    logical, intent(in) :: touching(:)           !! the pairs `in_contact` [pairs]
    real(wp), intent(in) :: force(:)             !! [force] [pairs]
    type(run_type), intent(inout) :: run        !! sides that touch
    integer :: beyond(2), end, k, n
    logical :: closed, mirrored(2)

    n = size(run%middle)
    associate (ends => run%corner([1, n + 1]))
      closed = ends(1) == ends(2)
      run%even = line%mirrored(ends) .or. closed
      ! Of rings the pressure is even in the radius: a smooth function of the area from the axis on.
      mirrored = run%even .and. .not. closed .and. .not. (model%has_rings() .and. line%x(1, ends) == 0.0_wp)
    end associate
    beyond = merge(min(n, before), 0, mirrored .or. closed)
    if (allocated(run%total)) deallocate (run%total)
    allocate (run%total(2, 1 - beyond(1):n + 1 + beyond(2)), source=0.0_wp)
    associate (total => run%total)
      do k = 1, n
        total(:, k + 1) = total(:, k) + [line%tributary(run%middle(k)), force(run%middle(k))]
        do end = k, k + 1
          total(:, k + 1) = total(:, k + 1) + share_of_side(line, touching, force, run%corner(end), &
              run%middle(k))
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

  !> What a side has of the area and of the force of its corner: all of the latter where the next middle
  !! does not touch.
  pure function share_of_side(line, touching, force, corner, middle) result(share)
    type(contact_line), intent(in) :: line       !! of its pairs
    logical, intent(in) :: touching(:)           !! the pairs `in_contact` [pairs]
    real(wp), intent(in) :: force(:)             !! [force] [pairs]
    integer, intent(in) :: corner, middle
    real(wp) :: share(2), other

    associate (next => line%neighbour(:, corner), part => line%part(:, corner))
      share = [sum(part, mask=next == middle), force(corner)]
      other = sum(part, mask=next /= middle .and. next > 0 .and. touching(max(1, next)))
    end associate
    if (other > 0.0_wp) share(2) = force(corner)*(share(1)/(share(1) + other))
  end function share_of_side

  !> Pressures of a run. At an end where contact ends, the last side's own are left: there the pressure has
  !! no polynomial.
  subroutine derive(model, line, run, pressure)
    type(model_type), intent(in) :: model        !! the model
    type(contact_line), intent(in) :: line       !! of its pairs
    type(run_type), intent(inout) :: run        !! sides that touch
    real(wp), intent(inout) :: pressure(:)       !! [stress] [pairs]
    integer :: first, k, last

    if (size(run%total, 2) < least_corners) then
      if (size(run%total, 2) < least_at_axis) return
      do k = 1, size(run%corner), size(run%middle)
        if (line%tributary(run%corner(k)) <= 0.0_wp) &
          pressure(run%corner(k)) = slope(run, 1, least_at_axis, run%total(1, k))
      end do
      return
    end if
    first = merge(1, 2, run%even(1))
    last = size(run%middle) - merge(0, 1, run%even(2))
    do k = first, last
      pressure(run%middle(k)) = slope(run, k - 1, around_middle, area_at_middle(model, line, run, k))
    end do
    do k = first, last + 1
      pressure(run%corner(k)) = slope(run, k - before, around_corner, run%total(1, k))
    end do
  end subroutine derive

  !> Area up to the middle node of a side.
  pure real(wp) function area_at_middle(model, line, run, k) result(area)
    type(model_type), intent(in) :: model        !! the model
    type(contact_line), intent(in) :: line       !! of its pairs
    type(run_type), intent(in) :: run        !! sides that touch
    integer, intent(in) :: k
    real(wp) :: half(2)

    associate (a => run%corner(k), m => run%middle(k), b => run%corner(k + 1), radius => line%x(1, :))
      half = [line%distance(m, a), line%distance(b, m)]
      if (model%has_rings()) half = half*[radius(a) + radius(m), radius(m) + radius(b)]
    end associate
    area = run%total(1, k) + (run%total(1, k + 1) - run%total(1, k))*half(1)/sum(half)
  end function area_at_middle

  !> Derivative of force by area: of the polynomial through some corners, from one of them on if the run has
  !! so many.
  pure real(wp) function slope(run, from, many, at)
    type(run_type), intent(in) :: run        !! sides that touch
    integer, intent(in) :: from, many
    real(wp), intent(in) :: at   !! this area
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
