!> Errors of a zone's largest pressure and of its half-width.
!>
!> Of the pressure six things tell: how far the peak is off a parabola through the nearest pairs, off the
!> normal stress that the smooth strains of both sides give there, how many pairs the zone has, what part of
!> the energy the mesh is off by, how far the pressures on the two lines differ, and how much the pressure
!> oscillates from pair to pair; of the half-width the spacing at its ends, and the energy. What each counts
!> is measured (tests/accuracy). Where the pressure has no limit, or the zone too few pairs, nothing is said
!> of it.
module epcont_accuracy_zone_error
  use epcont_accuracy_limits, only: edge_pairs, has_tip
  use epcont_accuracy_surface_line, only: elements_behind, find_waves, first_element, surface_line
  use epcont_accuracy_weights, only: beyond_mean, estimate_weights, lines_differ, oscillates, other_side, &
      stretched, tolerated, waves_alone, weights_of
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: dependent, least_difference, no_effect
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: model_type
  use epcont_result_answer, only: answer_type
  use epcont_result_contact_line, only: outer_sides
  use epcont_result_zones, only: contact_zone, falls
  implicit none
  private
  public :: zone_error, estimate_zone

  integer, parameter :: &
    !> Pairs that the parabola goes through.
    around_peak = 7, &
    !> Pairs on either side of the peak at which the pressures on the two lines are compared; sides on either
    !! side of it on which oscillations count.
    beside_peak = 3, &
    !> Pairs, with those beyond a line of symmetry, that a zone must have for its pressure to be resolved.
    few = 3, &
    !> Pairs of a side with a middle node: a zone on one, mirrored or not, follows the pressure no better than
    !! one parabola.
    one_side = 3

  type :: zone_error
    integer :: peak = 0                  !! pair of the largest pressure
    logical :: unbounded = .false.       !! the pressure grows with every finer mesh: a tip, a sharp edge
    logical :: resolved = .true.         !! there are pairs enough to see where it is largest
    !> Of the largest pressure; negative: unbounded, or not resolved [stress]
    real(wp) :: pressure = -1.0_wp
    real(wp) :: half_width = -1.0_wp     !! negative: unknown [length]
    real(wp) :: resolution = 1.0_wp      !! spacing of the pairs over half of the zone's length
    real(wp) :: end_resolution = 1.0_wp  !! the same of the larger spacing at its ends
    real(wp) :: half_length = 0.0_wp     !! of the zone, to where the pressure vanishes [length]
    real(wp) :: wave_height = 0.0_wp     !! of waves of its gap [length]
    real(wp) :: waviness = 0.0_wp        !! what flattens these waves, of the largest pressure
    !> What contact on few pairs leaves open of how near the bodies come [length]
    real(wp) :: too_near = 0.0_wp
    type(estimate_weights) :: weights    !! of the elements there
  end type zone_error

  !> What is seen at an end of a zone that is no line of symmetry.
  type :: zone_end
    !> To the first open pair, or between the last two, if that is more [length]
    real(wp) :: step = 0.0_wp
    !> The same, or nearly as much as the longest side there, of either body; at most the zone [length]
    real(wp) :: unknown = 0.0_wp
    !> What a mean over the last side is short of the pressure at its end [stress]
    real(wp) :: short = 0.0_wp
    logical :: edge = .false.       !! the candidates do, and the pressure does not fall towards it
    logical :: cut_off = .false.    !! the pressure is largest at the last pair, though contact ends there
  end type zone_end

contains

  !> What the figures of a zone are worth. Of equal largest pressures, but for rounding, those on the largest
  !! area count (a corner on the axis may have its neighbour's), the first and the last: whichever is worse.
  pure function estimate_zone(model, line, answer, yielded, energy, zone) result(error)
    type(model_type), intent(in) :: model        !! the scene
    type(surface_line), intent(in) :: line       !! of its pairs
    type(answer_type), intent(in) :: answer      !! with their pressures
    logical, intent(in) :: yielded               !! something is beyond yield
    real(wp), intent(in) :: energy               !! error of the mesh over all of it
    type(contact_zone), intent(in) :: zone       !! of these pairs
    type(zone_error) :: error, other
    logical :: largest(size(zone%pairs))

    largest = are_largest(answer%pressure(zone%pairs), spread(.true., 1, size(largest)))
    largest = are_largest(line%tributary(zone%pairs), largest)
    error = estimate_at(model, line, answer, yielded, energy, zone, findloc(largest, .true., dim=1))
    if (count(largest) < 2 .or. error%pressure < 0.0_wp) return
    other = estimate_at(model, line, answer, yielded, energy, zone, &
                        findloc(largest, .true., dim=1, back=.true.))
    if (other%pressure < 0.0_wp .or. &
        other%pressure > (1.0_wp + least_difference)*error%pressure) error = other
  end function estimate_zone

  !> The kinds of elements that a pair's figures are judged by: its own, and of the other side what has no
  !! middle nodes where its own have some.
  pure function kinds_at(model, pair, own) result(kinds)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    integer, intent(in) :: own              !! kind of the elements at the pair's node
    integer, allocatable :: elements(:), kinds(:)
    integer :: k

    kinds = [own]
    do k = 1, 2
      elements = elements_behind(model, model%pair_node(k, pair))
      if (size(elements) == 0) cycle
      associate (there => model%kind(elements(1)))
        if (model%kinds(there)%degree < model%kinds(own)%degree) kinds = [own, there]
      end associate
    end do
  end function kinds_at

  !> The longest side at a pair, of either body that can be strained, along the contact; of those with a
  !! middle node half [length].
  pure real(wp) function longest_side(model, pair)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    integer, allocatable :: sides(:, :)
    integer :: i, k

    longest_side = 0.0_wp
    do k = 1, 2
      if (size(elements_behind(model, model%pair_node(k, pair))) == 0) cycle
      sides = outer_sides(model, model%pair_node(k, pair))
      do i = 1, size(sides, 2)
        associate (side => model%x(:, sides(2, i)) - model%x(:, sides(1, i)))
          longest_side = max(longest_side, abs(cross_product(side, model%normal(:, pair))) &
                                           *merge(0.5_wp, 1.0_wp, sides(3, i) > 0))
        end associate
      end do
    end do
  end function longest_side

  !> Of those of some values that count, the largest, but for rounding.
  pure function are_largest(values, counts)
    real(wp), intent(in) :: values(:)
    logical, intent(in) :: counts(:)
    logical :: are_largest(size(values))
    real(wp) :: largest

    largest = maxval(values, mask=counts)
    are_largest = counts .and. values >= largest - no_effect*abs(largest)
  end function are_largest

  !> The same, where one of its pairs has the largest pressure.
  pure function estimate_at(model, line, answer, yielded, energy, zone, peak) result(error)
    type(model_type), intent(in) :: model        !! the scene
    type(surface_line), intent(in) :: line       !! of its pairs
    type(answer_type), intent(in) :: answer      !! with their pressures
    logical, intent(in) :: yielded               !! something is beyond yield
    real(wp), intent(in) :: energy               !! error of the mesh over all of it
    type(contact_zone), intent(in) :: zone       !! of these pairs
    integer, intent(in) :: peak                  !! which of these
    type(zone_error) :: error
    type(zone_end) :: ends(2)
    real(wp), allocatable :: p(:)     !! pressures of its pairs [stress]
    !> Distance from the peak and pressure of the pairs in their order, with those beyond a line of symmetry;
    !! of a closed zone half of it on either side of the peak [length], [stress] [2, any]
    real(wp), allocatable :: row(:, :)
    !> Length of all of it, but for a mean side of one that goes all around; of that the whole way, else 0
    real(wp) :: long, around
    real(wp) :: flattening, largest, spacing
    logical :: mirrored(2), waves
    integer :: at(2), k, kind, n

    n = size(zone%pairs)
    p = answer%pressure(zone%pairs)
    error%peak = zone%pairs(peak)
    largest = p(peak)
    kind = first_element(model, line%node(error%peak))
    kind = merge(model%kind(max(kind, 1)), 1, kind > 0)
    error%weights = weights_of(model%kinds(kinds_at(model, error%peak, kind))%estimated_as, &
                               model%has_rings(), yielded)
    if (largest <= 0.0_wp) return
    mirrored = line%mirrored([zone%first, zone%last])
    long = zone%along(n)
    around = 0.0_wp
    if (n > 2 .and. any(line%neighbour(:, zone%first) == zone%last)) then
      around = long + line%distance(zone%first, zone%last)
      long = around - around/n
    end if
    ends = [end_at(1), end_at(2)]
    call find_waves(line, zone%pairs, flattening, waves, error%wave_height)
    if (waves) error%waviness = flattening/largest

    error%half_length = 0.5_wp*(long + sum(zone%vanishes))
    if (mirrored(1) .neqv. mirrored(2)) error%half_length = 2.0_wp*error%half_length
    if (zone%half_width >= 0.0_wp) &
      error%half_width = sum(error%weights%step*ends%unknown)*merge(1.0_wp, 0.5_wp, any(mirrored)) &
                         + error%weights%width_energy*energy*zone%half_width &
                         + flattening/largest*zone%half_width   ! the load is given
    ! two pairs may stand at one place
    at = [max(1, count(zone%along < zone%along(peak))), min(n, 1 + count(zone%along <= zone%along(peak)))]
    spacing = (zone%along(at(2)) - zone%along(at(1)))/max(1, count(zone%along(at) /= zone%along(peak)))
    at = line%neighbour(:, error%peak)
    if (around > 0.0_wp) &
      spacing = 0.5_wp*(line%distance(error%peak, at(1)) + line%distance(error%peak, at(2)))
    if (n > 1 .and. all(zone%open <= 0.0_wp) .and. maxval(p) - minval(p) <= no_effect*largest) then
      error%resolution = 0.0_wp
    else
      ! of a single pair it stays 1
      if (error%half_length > spacing .and. n > 1) error%resolution = spacing/error%half_length
      error%unbounded = any(ends%edge)
      if (.not. error%unbounded) error%unbounded = has_tip(model, line, zone, largest)
      error%resolved = error%unbounded .or. .not. any(ends%cut_off) .and. &
                       n + count(mirrored)*(n - 1) >= few .and. &
                       (model%kinds(kind)%degree == 1 .or. n > one_side)
    end if
    error%end_resolution = error%resolution
    if (spacing > 0.0_wp .and. maxval(ends%step) > spacing) &
      error%end_resolution = error%resolution*maxval(ends%step)/spacing
    if (flattening > waves_alone*largest .and. .not. error%unbounded) error%resolved = .false.
    if (.not. error%resolved .or. error%unbounded) return
    at = merge(peak + [-n/2, n/2], merge([2 - n, 2*n - 1], [1, n], mirrored), around > 0.0_wp)
    allocate (row(2, at(1):at(2)))
    row(:, :) = reshape([(place_and_pressure(k), k=at(1), at(2))], shape(row))
    error%pressure = pressure_error()

  contains

    pure type(zone_end) function end_at(e) result(found)
      integer, intent(in) :: e
      integer :: first, second   !! in p: at the end, and beside it
      real(wp) :: length

      if (mirrored(e) .or. around > 0.0_wp) return
      first = merge(1, n, e == 1)
      second = max(1, count(zone%along < zone%along(n)))
      if (e == 1) second = min(n, 1 + count(zone%along <= 0.0_wp))
      length = abs(zone%along(second) - zone%along(first))
      found%step = max(zone%open(e), length)
      found%unknown = max(found%step, min(long, other_side*longest_side(model, zone%pairs(first))))
      if (zone%open(e) > 0.0_wp) then
        found%cut_off = n > few .and. peak == first
      else
        found%edge = any(p([first, second]) >= falls*largest .and. &
                         [1, 2] <= edge_pairs(model, line, zone%pairs(first)))
        if (peak == first) found%short = beyond_mean*(largest - p(second))
      end if
    end function end_at

    !> Of the largest pressure [stress].
    pure real(wp) function pressure_error() result(off)
      real(wp) :: apart, coarse, from(2)
      integer :: near(2*beside_peak + 1), k   ! pairs of the zone, on both sides of its peak

      near = [(k, k=peak - beside_peak, peak + beside_peak)]
      if (around > 0.0_wp) near = modulo(near - 1, n) + 1
      near = min(max(near, 1), n)
      apart = maxval(abs(answer%apart(zone%pairs(near))))
      coarse = 0.0_wp   ! of an even pressure any spacing tells
      if (error%resolution > 0.0_wp) &
        coarse = max(long/max(1, n - 1), depth_behind())/max(spacing, error%half_length)
      from = [off_parabola(), abs(largest - line%smooth_pressure(error%peak))]
      associate (weights => error%weights)
        off = weights%parabola*from(1) + weights%stress*from(2) + weights%smaller*minval(from) + flattening &
              + lines_differ*max(0.0_wp, apart - tolerated*largest) &
              + oscillates*max(0.0_wp, oscillation() - tolerated*largest) + sum(ends%short) &
              + ((weights%spacing + weights%square*error%resolution)*error%resolution &
                 + weights%graded*max(0.0_wp, coarse - stretched*error%resolution) &
                 + weights%pressure_energy*energy)*largest
      end associate
      if (off <= least_difference*largest) off = 0.0_wp
    end function pressure_error

    !> How far the elements at the peak that can be strained reach into their bodies; of six-node ones half
    !! [length].
    pure real(wp) function depth_behind() result(depth)
      real(wp), allocatable :: along(:)
      integer, allocatable :: elements(:)
      integer :: e, i, k

      depth = 0.0_wp
      do k = 1, 2
        elements = elements_behind(model, model%pair_node(k, error%peak))
        do i = 1, size(elements)
          e = elements(i)
          along = matmul(model%normal(:, error%peak), &
                         model%x(:, model%connectivity(:model%corners(e), e)))
          depth = max(depth, (maxval(along) - minval(along))/model%kinds(model%kind(e))%degree)
        end do
      end do
    end function depth_behind

    !> Distance from the peak and pressure of the k-th pair; of one before the first or after the last as
    !! mirrored at a line of symmetry, or of the other end of a closed zone.
    pure function place_and_pressure(k) result(both)
      integer, intent(in) :: k
      real(wp) :: both(2)
      integer :: pair

      pair = modulo(k - 1, n) + 1
      both = [zone%along(pair) + around*((k - pair)/n), p(pair)]
      if (around <= 0.0_wp .and. k < 1) both = [-zone%along(2 - k), p(2 - k)]
      if (around <= 0.0_wp .and. k > n) both = [2.0_wp*zone%along(n) - zone%along(2*n - k), p(2*n - k)]
      both(1) = both(1) - zone%along(peak)
    end function place_and_pressure

    !> How much the pressure oscillates near the peak: of two pairs a side apart, one above the straight line
    !! between the pairs a side before and after it, the other below its own, the smaller of both distances;
    !! the largest of all. At the last pair of the zone, where contact ends within a side, it says nothing.
    !! [stress]
    pure real(wp) function oscillation()
      real(wp) :: above(lbound(row, 2):ubound(row, 2))
      integer :: k, side

      above = 0.0_wp
      associate (first => lbound(row, 2), last => ubound(row, 2))
        side = model%kinds(kind)%degree
        do k = max(peak - side*beside_peak, first + side + 1), min(peak + side*beside_peak, last - side - 1)
          associate (x => row(1, k - side:k + side:side), y => row(2, k - side:k + side:side))
            if (x(3) > x(1)) above(k) = y(2) - (y(1)*(x(3) - x(2)) + y(3)*(x(2) - x(1)))/(x(3) - x(1))
          end associate
        end do
        associate (one => above(:last - side), next => above(first + side:))
          oscillation = max(0.0_wp, maxval(min(abs(one), abs(next)), mask=one*next < 0.0_wp))
        end associate
      end associate
    end function oscillation

    !> How far the peak is off the least-squares parabola of p**2 through the pairs nearest to it, or short of
    !! its top, if that is more; mirrored ones and those the other way around too; of those that are as near
    !! all. Of too few pairs for one: what Hertz's pressure falls by over half a spacing [stress].
    pure real(wp) function off_parabola() result(off)
      real(wp) :: m(0:4), reach, right(0:2), square, unit
      real(wp), dimension(size(row, 2)) :: x, y
      logical :: left(size(row, 2))
      integer :: i, k

      x = row(1, :)/max(spacing, tiny(1.0_wp))
      unit = scale(1.0_wp, exponent(largest) - 1)   ! a power of two, so that no square overflows
      y = (row(2, :)/unit)**2
      off = largest*error%resolution**2/8.0_wp
      left = .true.
      if (size(left) <= 3) return
      m = 0.0_wp
      right = 0.0_wp
      reach = 0.0_wp
      do i = 1, size(left)
        k = minloc(abs(x), mask=left, dim=1)
        if (i > around_peak .and. abs(x(k)) > (1.0_wp + no_effect)*reach) exit
        reach = abs(x(k))
        left(k) = .false.
        m = m + [1.0_wp, x(k), x(k)**2, x(k)**3, x(k)**4]
        right = right + y(k)*[1.0_wp, x(k), x(k)**2]
      end do
      square = determinant(m, m(0:2))
      if (square <= dependent*m(0)*m(2)*m(4)) return
      associate (here => max(0.0_wp, determinant(m, right)/square))
        off = unit*sqrt(here) - largest
        off = max(-off, off + error%weights%rise*unit*rise(m, right, here))
      end associate
    end function off_parabola
  end function estimate_at

  !> What the root of a parabola rises by from the peak to its top, if that is no farther than a spacing.
  pure real(wp) function rise(m, right, here)
    real(wp), intent(in) :: m(0:4)       !! moments
    real(wp), intent(in) :: right(0:2)   !! right-hand side of its normal equations
    real(wp), intent(in) :: here         !! its value at the peak
    real(wp) :: bend, slope              !! times a determinant above 0

    slope = (right(1) - m(1)*here)*m(4) - (right(2) - m(2)*here)*m(3)
    bend = (right(2) - m(2)*here)*m(2) - (right(1) - m(1)*here)*m(3)
    rise = 0.0_wp
    if (bend < 0.0_wp .and. abs(slope) <= -2.0_wp*bend) &
      rise = sqrt(here - slope**2/(4.0_wp*bend*(m(2)*m(4) - m(3)**2))) - sqrt(here)
  end function rise

  !> Of the normal equations of a parabola, with this first column.
  pure real(wp) function determinant(m, column)
    real(wp), intent(in) :: m(0:4)        !! moments
    real(wp), intent(in) :: column(0:2)

    determinant = column(0)*(m(2)*m(4) - m(3)**2) - m(1)*(column(1)*m(4) - column(2)*m(3)) &
                  + m(2)*(column(1)*m(3) - column(2)*m(2))
  end function determinant
end module epcont_accuracy_zone_error
