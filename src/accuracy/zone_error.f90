!> Errors of a zone's largest pressure and of its half-width.
!>
!> The estimate of the pressure uses six quantities: the distance of the peak from a parabola through the
!> nearest pairs, its distance from the normal stress of the recovered strains of both bodies, the number of
!> pairs, the relative mesh error of the energy, the difference between the pressures on the two lines, and
!> the oscillation from pair to pair. The estimate of the half-width uses the spacing at its ends and the
!> energy. Their weights are fitted (tests/accuracy). There is no estimate if the pressure is singular or the
!> zone has too few pairs.
module epcont_accuracy_zone_error
  use epcont_accuracy_limits, only: edge_pairs, has_tip
  use epcont_accuracy_peak, only: beside_peak, off_parabola, oscillation, peak_type, zone_end, zone_error
  use epcont_accuracy_surface_line, only: elements_behind, find_waves, first_element, surface_line
  use epcont_accuracy_weights, only: beyond_mean, lines_differ, oscillates, other_side, &
      stretched, tolerated, waves_alone, weights_of
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference, no_effect
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: model_type
  use epcont_result_answer, only: answer_type
  use epcont_result_contact_line, only: outer_sides
  use epcont_result_zones, only: contact_zone, falls
  implicit none
  private
  public :: zone_error, estimate_zone

  integer, parameter :: &
    !> Number of pairs (mirrored ones included) that a zone needs; with fewer the mesh is too coarse.
    few = 3, &
    !> Number of pairs on an edge with a mid-side node: a zone on one such edge, mirrored or not, represents
    !! the pressure no better than one parabola.
    one_side = 3

contains

  !> Estimate the errors of a zone. Of pressures equal up to rounding, those on the largest area are
  !! candidates (a corner on the axis may have its neighbour's); the result is the worse of the first and the
  !! last.
  pure function estimate_zone(model, line, answer, yielded, energy, zone) result(error)
    type(model_type), intent(in) :: model        !! model
    type(surface_line), intent(in) :: line       !! of its pairs
    type(answer_type), intent(in) :: answer      !! with their pressures
    logical, intent(in) :: yielded               !! the model yields somewhere
    real(wp), intent(in) :: energy               !! mesh error of the whole model
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

  !> Choose the element types whose weights apply to a pair: its own, and the opposite one if this has a lower
  !! degree.
  pure function kinds_at(model, pair, own) result(kinds)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    integer, intent(in) :: own              !! element type at the pair's node
    integer, allocatable :: elements(:), kinds(:)
    integer :: k

    kinds = [own]
    do k = 1, 2
      elements = elements_behind(model, model%contact%pair_node(k, pair))
      if (size(elements) == 0) cycle
      associate (there => model%mesh%kind(elements(1)))
        if (model%mesh%kinds(there)%degree < model%mesh%kinds(own)%degree) kinds = [own, there]
      end associate
    end do
  end function kinds_at

  !> Find the longest edge at a pair, of either body that deforms, along the contact; an edge with a mid-side
  !! node counts by half [length].
  pure real(wp) function longest_side(model, pair)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    integer, allocatable :: sides(:, :)
    integer :: i, k

    longest_side = 0.0_wp
    do k = 1, 2
      if (size(elements_behind(model, model%contact%pair_node(k, pair))) == 0) cycle
      sides = outer_sides(model, model%contact%pair_node(k, pair))
      do i = 1, size(sides, 2)
        associate (side => model%mesh%x(:, sides(2, i)) - model%mesh%x(:, sides(1, i)))
          longest_side = max(longest_side, abs(cross_product(side, model%contact%normal(:, pair))) &
                                           *merge(0.5_wp, 1.0_wp, sides(3, i) > 0))
        end associate
      end do
    end do
  end function longest_side

  !> Which of the values that count are the largest, up to rounding?
  pure function are_largest(values, counts)
    real(wp), intent(in) :: values(:)
    logical, intent(in) :: counts(:)
    logical :: are_largest(size(values))
    real(wp) :: largest

    largest = maxval(values, mask=counts)
    are_largest = counts .and. values >= largest - no_effect*abs(largest)
  end function are_largest

  !> Estimate the errors of a zone if this pair has the largest pressure.
  pure function estimate_at(model, line, answer, yielded, energy, zone, peak) result(error)
    type(model_type), intent(in) :: model        !! model
    type(surface_line), intent(in) :: line       !! of its pairs
    type(answer_type), intent(in) :: answer      !! with their pressures
    logical, intent(in) :: yielded               !! the model yields somewhere
    real(wp), intent(in) :: energy               !! mesh error of the whole model
    type(contact_zone), intent(in) :: zone       !! of these pairs
    integer, intent(in) :: peak                  !! position of this pair in the zone
    type(zone_error) :: error
    type(peak_type) :: seen
    logical :: waves
    integer :: at(2), k

    seen%peak = peak
    seen%energy = energy
    seen%n = size(zone%pairs)
    seen%p = answer%pressure(zone%pairs)
    error%peak = zone%pairs(seen%peak)
    seen%largest = seen%p(seen%peak)
    seen%kind = first_element(model, line%node(error%peak))
    seen%kind = merge(model%mesh%kind(max(seen%kind, 1)), 1, seen%kind > 0)
    error%weights = weights_of(model%mesh%kinds(kinds_at(model, error%peak, seen%kind))%estimated_as, &
                               model%has_rings(), yielded)
    if (seen%largest <= 0.0_wp) return
    seen%mirrored = line%mirrored([zone%first, zone%last])
    seen%long = zone%along(seen%n)
    seen%around = 0.0_wp
    if (seen%n > 2 .and. any(line%neighbour(:, zone%first) == zone%last)) then
      seen%around = seen%long + line%distance(zone%first, zone%last)
      seen%long = seen%around - seen%around/seen%n
    end if
    seen%ends = [end_at(model, line, zone, seen, 1), end_at(model, line, zone, seen, 2)]
    call find_waves(line, zone%pairs, seen%flattening, waves, error%wave_height)
    if (waves) error%waviness = seen%flattening/seen%largest

    error%half_length = 0.5_wp*(seen%long + sum(zone%vanishes))
    if (seen%mirrored(1) .neqv. seen%mirrored(2)) error%half_length = 2.0_wp*error%half_length
    if (zone%half_width >= 0.0_wp) &
      error%half_width = sum(error%weights%step*seen%ends%unknown)*merge(1.0_wp, 0.5_wp, any(seen%mirrored)) &
                         + error%weights%width_energy*seen%energy*zone%half_width &
                         + seen%flattening/seen%largest*zone%half_width   ! the load is given
    ! two pairs may stand at one point
    at = [max(1, count(zone%along < zone%along(seen%peak))), min(seen%n, 1 + &
        count(zone%along <= zone%along(seen%peak)))]
    seen%spacing = (zone%along(at(2)) - zone%along(at(1)))/max(1, &
        count(zone%along(at) /= zone%along(seen%peak)))
    at = line%neighbour(:, error%peak)
    if (seen%around > 0.0_wp) &
      seen%spacing = 0.5_wp*(line%distance(error%peak, at(1)) + line%distance(error%peak, at(2)))
    if (seen%n > 1 .and. all(zone%open <= 0.0_wp) .and. maxval(seen%p) - &
        minval(seen%p) <= no_effect*seen%largest) then
      error%resolution = 0.0_wp
    else
      ! for a single pair it stays 1
      if (error%half_length > seen%spacing .and. seen%n > 1) error%resolution = seen%spacing/error%half_length
      error%unbounded = any(seen%ends%edge)
      if (.not. error%unbounded) error%unbounded = has_tip(model, line, zone, seen%largest)
      error%resolved = error%unbounded .or. .not. any(seen%ends%cut_off) .and. &
                       seen%n + count(seen%mirrored)*(seen%n - 1) >= few .and. &
                       (model%mesh%kinds(seen%kind)%degree == 1 .or. seen%n > one_side)
    end if
    error%end_resolution = error%resolution
    if (seen%spacing > 0.0_wp .and. maxval(seen%ends%step) > seen%spacing) &
      error%end_resolution = error%resolution*maxval(seen%ends%step)/seen%spacing
    if (seen%flattening > waves_alone*seen%largest .and. .not. error%unbounded) error%resolved = .false.
    if (.not. error%resolved .or. error%unbounded) return
    at = merge(seen%peak + [-seen%n/2, seen%n/2], merge([2 - seen%n, 2*seen%n - 1], [1, seen%n], &
        seen%mirrored), seen%around > 0.0_wp)
    allocate (seen%row(2, at(1):at(2)))
    seen%row(:, :) = reshape([(place_and_pressure(zone, seen, k), k=at(1), at(2))], shape(seen%row))
    error%pressure = pressure_error(model, line, answer, zone, seen, error)
  end function estimate_at

  pure type(zone_end) function end_at(model, line, zone, seen, e) result(found)
    type(model_type), intent(in) :: model        !! the model
    type(surface_line), intent(in) :: line       !! of its pairs
    type(contact_zone), intent(in) :: zone       !! of these pairs
    type(peak_type), intent(in) :: seen          !! its peak
    integer, intent(in) :: e
    integer :: first, second   !! in p: at the end, and beside it
    real(wp) :: length

    if (seen%mirrored(e) .or. seen%around > 0.0_wp) return
    first = merge(1, seen%n, e == 1)
    second = max(1, count(zone%along < zone%along(seen%n)))
    if (e == 1) second = min(seen%n, 1 + count(zone%along <= 0.0_wp))
    length = abs(zone%along(second) - zone%along(first))
    found%step = max(zone%open(e), length)
    found%unknown = max(found%step, min(seen%long, other_side*longest_side(model, zone%pairs(first))))
    if (zone%open(e) > 0.0_wp) then
      found%cut_off = seen%n > few .and. seen%peak == first
    else
      found%edge = any(seen%p([first, second]) >= falls*seen%largest .and. &
                       [1, 2] <= edge_pairs(model, line, zone%pairs(first)))
      if (seen%peak == first) found%short = beyond_mean*(seen%largest - seen%p(second))
    end if
  end function end_at

  !> Of the largest pressure [stress].
  pure real(wp) function pressure_error(model, line, answer, zone, seen, error) result(off)
    type(model_type), intent(in) :: model        !! the model
    type(surface_line), intent(in) :: line       !! of its pairs
    type(answer_type), intent(in) :: answer      !! with their pressures
    type(contact_zone), intent(in) :: zone       !! of these pairs
    type(peak_type), intent(in) :: seen          !! its peak
    type(zone_error), intent(in) :: error        !! as far as known
    real(wp) :: apart, coarse, from(2)
    integer :: near(2*beside_peak + 1), k   ! pairs of the zone, on both sides of its peak

    near = [(k, k=seen%peak - beside_peak, seen%peak + beside_peak)]
    if (seen%around > 0.0_wp) near = modulo(near - 1, seen%n) + 1
    near = min(max(near, 1), seen%n)
    apart = maxval(abs(answer%apart(zone%pairs(near))))
    coarse = 0.0_wp   ! a uniform pressure needs no spacing
    if (error%resolution > 0.0_wp) &
      coarse = max(seen%long/max(1, seen%n - 1), depth_behind(model, error))/max(seen%spacing, &
          error%half_length)
    from = [off_parabola(seen, error), abs(seen%largest - line%smooth_pressure(error%peak))]
    associate (weights => error%weights)
      off = weights%parabola*from(1) + weights%stress*from(2) + weights%smaller*minval(from) + &
          seen%flattening &
            + lines_differ*max(0.0_wp, apart - tolerated*seen%largest) &
            + oscillates*max(0.0_wp, oscillation(model, seen) - tolerated*seen%largest) + &
                sum(seen%ends%short) &
            + ((weights%spacing + weights%square*error%resolution)*error%resolution &
               + weights%graded*max(0.0_wp, coarse - stretched*error%resolution) &
               + weights%pressure_energy*seen%energy)*seen%largest
    end associate
    if (off <= least_difference*seen%largest) off = 0.0_wp
  end function pressure_error

  !> How far the elements at the peak that can be strained reach into their bodies; of six-node ones half
  !! [length].
  pure real(wp) function depth_behind(model, error) result(depth)
    type(model_type), intent(in) :: model        !! the model
    type(zone_error), intent(in) :: error        !! as far as known
    real(wp), allocatable :: along(:)
    integer, allocatable :: elements(:)
    integer :: e, i, k

    depth = 0.0_wp
    do k = 1, 2
      elements = elements_behind(model, model%contact%pair_node(k, error%peak))
      do i = 1, size(elements)
        e = elements(i)
        along = matmul(model%contact%normal(:, error%peak), &
                       model%mesh%x(:, model%mesh%connectivity(:model%mesh%corners(e), e)))
        depth = max(depth, (maxval(along) - minval(along))/model%mesh%kinds(model%mesh%kind(e))%degree)
      end do
    end do
  end function depth_behind

  !> Distance from the peak and pressure of the k-th pair; of one before the first or after the last as
  !! mirrored at a line of symmetry, or of the other end of a closed zone.
  pure function place_and_pressure(zone, seen, k) result(both)
    type(contact_zone), intent(in) :: zone       !! of these pairs
    type(peak_type), intent(in) :: seen          !! its peak
    integer, intent(in) :: k
    real(wp) :: both(2)
    integer :: pair

    pair = modulo(k - 1, seen%n) + 1
    both = [zone%along(pair) + seen%around*((k - pair)/seen%n), seen%p(pair)]
    if (seen%around <= 0.0_wp .and. k < 1) both = [-zone%along(2 - k), seen%p(2 - k)]
    if (seen%around <= 0.0_wp .and. k > seen%n) both = [2.0_wp*zone%along(seen%n) - zone%along(2*seen%n - &
        k), seen%p(2*seen%n - k)]
    both(1) = both(1) - zone%along(seen%peak)
  end function place_and_pressure
end module epcont_accuracy_zone_error
