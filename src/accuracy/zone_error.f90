!> Errors of a zone's largest pressure and of its half-width.
!>
!> Of the pressure four things tell: how far the peak is off a parabola through the nearest pairs, off the
!> normal stress that the smooth strains of both sides give there, how many pairs the zone has, and what part
!> of the energy the mesh is off by; of the half-width the spacing at its ends, and the energy. What each
!> counts is measured (tests/accuracy). Where the pressure has no limit, or the zone too few pairs, nothing is
!> said of it.
module epcont_accuracy_zone_error
  use epcont_accuracy_contact_stress, only: gives_way
  use epcont_accuracy_limits, only: edge_pairs, has_tip
  use epcont_accuracy_patches, only: patch_table
  use epcont_accuracy_waves, only: find_waves
  use epcont_accuracy_weights, only: estimate_weights, weights_of
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: alike, dependent, least_difference
  use epcont_model_model, only: model_type
  use epcont_result_answer, only: answer_type
  use epcont_result_contact_line, only: contact_line
  use epcont_result_zones, only: contact_zone
  implicit none
  private
  public :: zone_error, estimate_zone

  !> Pairs that the parabola goes through.
  integer, parameter :: around_peak = 7
  !> Pairs, with those beyond a line of symmetry, that a zone must have for its pressure to be resolved.
  integer, parameter :: few = 3
  !> Pairs of a side with a middle node: a zone on one, mirrored or not, follows the pressure no better than
  !! one parabola.
  integer, parameter :: one_side = 3
  !> A pressure that is not below this part of the largest at an end does not fall towards it.
  real(wp), parameter :: falls = 0.5_wp

  !> An element so many times deeper than its side is wide is not graded.
  real(wp), parameter :: stretched = 1.8_wp
  !> The last pair of the candidates has half a side. Where pressures rise towards it, its own is the mean
  !! over that, and short of the pressure at the end itself: of a straight rise by half of what it is above
  !! the next pair, and of a steeper one by more.
  real(wp), parameter :: beyond_mean = 0.625_wp
  !> Where flattening the waves of the gap takes so much of the largest pressure, that is a pressure of the
  !! waves.
  real(wp), parameter :: waves_alone = 0.5_wp

  type :: zone_error
    integer :: peak = 0                  !! pair of the largest pressure
    logical :: unbounded = .false.       !! the pressure grows with every finer mesh: a tip, a sharp edge
    logical :: resolved = .true.         !! there are pairs enough to see where it is largest
    real(wp) :: pressure = -1.0_wp       !! of the largest pressure; negative: unbounded, or not resolved [stress]
    real(wp) :: half_width = -1.0_wp     !! negative: unknown [length]
    real(wp) :: resolution = 1.0_wp      !! spacing of the pairs over half of the zone's length
    real(wp) :: end_resolution = 1.0_wp  !! the same of the larger spacing at its ends
    real(wp) :: half_length = 0.0_wp     !! of the zone, to where the pressure vanishes [length]
    real(wp) :: wave_height = 0.0_wp     !! of waves of its gap [length]
    real(wp) :: waviness = 0.0_wp        !! what flattens these waves, of the largest pressure
    integer :: kind = 1                  !! of the elements there
  end type zone_error

contains

  !> `stress_pressure` is the pressure at each pair that the smooth strains give, `energy` what is missing of
  !! the energy.
  pure function estimate_zone(model, table, line, answer, stress_pressure, energy, zone) result(error)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    type(contact_line), intent(in) :: line
    type(answer_type), intent(in) :: answer
    real(wp), intent(in) :: stress_pressure(:)   !! [pairs]
    real(wp), intent(in) :: energy               !! error of the mesh over all of it
    type(contact_zone), intent(in) :: zone
    type(zone_error) :: error
    type(estimate_weights) :: weights
    real(wp), allocatable :: p(:)     !! pressures of its pairs [stress]
    real(wp), allocatable :: s(:)     !! place of each of them, from the first on [length]
    integer, allocatable :: inward(:) !! in p and s, from one end on
    real(wp) :: off(2), beyond(2), coarse, flattening, largest, open, short, spacing, step, uncertain, widest
    logical :: cut_off, edge, waves, ends, mirrored(2)   !! ends: an end of the zone is one of contact, not of the candidates
    integer :: e, k, n, peak

    n = size(zone%pairs)
    p = answer%pressure(zone%pairs)
    peak = peak_of(p, line%tributary(zone%pairs))
    error%peak = zone%pairs(peak)
    largest = p(peak)
    error%kind = kind_at(model, table, line%node(zone%first))
    if (largest <= 0.0_wp) return
    s = places(model, line, zone%pairs)
    mirrored = line%mirrored(zone%pairs([1, n]))
    weights = weights_of(model%kinds(error%kind)%estimated_as, model%has_rings(), any(answer%plastic))
    beyond = 0.0_wp
    uncertain = 0.0_wp
    widest = 0.0_wp
    short = 0.0_wp
    edge = .false.
    cut_off = .false.
    ends = .false.
    do e = 1, 2
      if (mirrored(e) .or. is_closed(line, zone%pairs)) cycle
      inward = [(merge(k, n + 1 - k, e == 1), k=1, n)]
      associate (last => zone%pairs(inward(1)), d => abs(s(inward) - s(inward(1))))
        open = to_first_open(model, line, answer%contact%touching, last)
        step = max(open, d(min(n, 2)))
        beyond(e) = vanishes(p(inward), d, open)
        uncertain = uncertain + weights%step*step
        widest = max(widest, step)
        ends = ends .or. open > 0.0_wp
        if (open == 0.0_wp) edge = edge .or. any(p(inward(:min(n, edge_pairs(model, line, last)))) >= falls*largest)
        cut_off = cut_off .or. open > 0.0_wp .and. n > few .and. peak == inward(1)
        if (open == 0.0_wp .and. peak == inward(1)) short = beyond_mean*(largest - p(inward(min(n, 2))))
      end associate
    end do
    error%half_length = 0.5_wp*(s(n) + sum(beyond))
    if (mirrored(1) .neqv. mirrored(2)) error%half_length = 2.0_wp*error%half_length
    if (zone%half_width >= 0.0_wp) error%half_width = uncertain*merge(1.0_wp, 0.5_wp, any(mirrored)) &
                                                      + weights%width_energy*energy*zone%half_width
    spacing = 0.0_wp
    if (n > 1) spacing = (s(min(n, peak + 1)) - s(max(1, peak - 1)))/(min(n, peak + 1) - max(1, peak - 1))
    if (n > 1 .and. .not. ends .and. maxval(p) - minval(p) <= alike*largest) then
      error%resolution = 0.0_wp
    else
      if (error%half_length > spacing .and. n > 1) error%resolution = spacing/error%half_length   ! of a single pair it stays 1
      error%unbounded = edge
      if (.not. edge) error%unbounded = has_tip(model, table, line, zone%pairs, largest)
      error%resolved = error%unbounded .or. enough(n, mirrored, model%kinds(error%kind)%degree) .and. .not. cut_off
    end if
    error%end_resolution = error%resolution
    if (spacing > 0.0_wp .and. widest > spacing) error%end_resolution = error%resolution*widest/spacing
    call find_waves(model, table, line, zone%pairs, flattening, waves, error%wave_height)
    if (waves) error%waviness = flattening/largest
    if (error%half_width >= 0.0_wp) error%half_width = error%half_width + flattening/largest*zone%half_width   ! the load is given
    if (flattening > waves_alone*largest .and. .not. error%unbounded) error%resolved = .false.
    if (error%unbounded .or. .not. error%resolved) return
    coarse = 0.0_wp   ! of an even pressure any spacing tells
    if (error%resolution > 0.0_wp) &
      coarse = max(s(n)/max(1, n - 1), depth_behind(model, table, error%peak))/max(spacing, error%half_length)
    off = [off_parabola(s, p, mirrored, peak, spacing, error%resolution), abs(largest - stress_pressure(error%peak))]
    error%pressure = weights%parabola*off(1) + weights%stress*off(2) + weights%smaller*minval(off) + flattening + short &
                     + ((weights%spacing + weights%square*error%resolution)*error%resolution &
                        + weights%graded*max(0.0_wp, coarse - stretched*error%resolution) &
                        + weights%pressure_energy*energy)*largest
    if (error%pressure <= least_difference*largest) error%pressure = 0.0_wp
  end function estimate_zone

  !> Are so many pairs enough to see where the pressure is largest?
  pure logical function enough(pairs, mirrored, degree)
    integer, intent(in) :: pairs
    logical, intent(in) :: mirrored(2)   !! the zone goes on beyond its ends
    integer, intent(in) :: degree        !! of the elements' sides

    enough = pairs + count(mirrored)*(pairs - 1) >= few
    if (degree > 1) enough = enough .and. pairs > one_side
  end function enough

  !> How far the elements at a pair that can be strained reach into their bodies; of six-node ones half
  !! [length].
  pure real(wp) function depth_behind(model, table, pair) result(depth)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    integer, intent(in) :: pair
    integer :: e, i, k

    depth = 0.0_wp
    do k = 1, 2
      associate (node => model%pair_node(k, pair))
        if (.not. gives_way(model, table, node)) cycle
        do i = table%around%start(node), table%around%start(node + 1) - 1
          e = table%around%group(i)
          associate (along => matmul(model%normal(:, pair), model%x(:, model%connectivity(:model%corners(e), e))))
            depth = max(depth, (maxval(along) - minval(along))/model%kinds(model%kind(e))%degree)
          end associate
        end do
      end associate
    end do
  end function depth_behind

  !> Does a zone go all around, its last pair beside its first? Then it has no ends.
  pure logical function is_closed(line, pairs)
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pairs(:)

    is_closed = size(pairs) > 2 .and. any(line%neighbour(:, pairs(1)) == pairs(size(pairs)))
  end function is_closed

  !> The largest pressure; of equal ones, but for rounding, that on the largest area: a corner on the axis may
  !! have its neighbour's.
  pure integer function peak_of(pressure, area) result(peak)
    real(wp), intent(in) :: pressure(:), area(:)

    peak = maxloc(area, mask=pressure >= maxval(pressure) - least_difference*abs(maxval(pressure)), dim=1)
  end function peak_of

  !> The kind of the first element at a node; of none: the first.
  pure integer function kind_at(model, table, node) result(kind)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    integer, intent(in) :: node

    kind = 1
    if (table%around%start(node + 1) > table%around%start(node)) &
      kind = model%kind(table%around%group(table%around%start(node)))
  end function kind_at

  !> Place of each pair along the zone.
  pure function places(model, line, pairs) result(s)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pairs(:)
    real(wp), allocatable :: s(:)
    integer :: k

    allocate (s(size(pairs)))
    s(1) = 0.0_wp
    do k = 2, size(pairs)
      s(k) = s(k - 1) + line%distance(pairs(k), pairs(k - 1))
    end do
  end function places

  !> Distance from the end of a zone to the first open pair; 0: there is none, the end is the last candidate.
  pure real(wp) function to_first_open(model, line, touching, last) result(far)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    integer, intent(in) :: last
    integer :: k

    far = 0.0_wp
    do k = 1, 2
      associate (next => line%neighbour(k, last))
        if (next == 0) cycle
        if (.not. touching(next)) far = line%distance(last, next)
      end associate
    end do
  end function to_first_open

  !> How far beyond an end the pressure vanishes, where p**2 is linear: by the last two pairs, not beyond the
  !! first open one.
  pure real(wp) function vanishes(pressure, inward, limit)
    real(wp), intent(in) :: pressure(:)
    real(wp), intent(in) :: inward(:)   !! distance of each pair from the end, which is the first [length]
    real(wp), intent(in) :: limit       !! distance to the first open pair [length]
    real(wp) :: drop

    vanishes = 0.0_wp
    if (size(pressure) < 2) return
    drop = pressure(2)**2 - pressure(1)**2
    vanishes = limit
    if (drop > 0.0_wp) vanishes = min(limit, inward(2)*pressure(1)**2/drop)
  end function vanishes

  !> How far the peak is off the least-squares parabola of p**2 through the pairs nearest to it, mirrored ones
  !! too. Of too few pairs for one: what Hertz's pressure falls by over half a spacing.
  pure real(wp) function off_parabola(s, p, mirrored, peak, spacing, resolution) result(off)
    real(wp), intent(in) :: s(:), p(:)
    logical, intent(in) :: mirrored(2)
    integer, intent(in) :: peak
    real(wp), intent(in) :: spacing, resolution
    real(wp) :: x(3*size(s)), y(3*size(s)), moment(0:4), right(0:2), determinant(0:1)
    logical :: taken(3*size(s))
    integer :: i, k, n

    n = size(s)
    x = [s, -s, 2.0_wp*s(n) - s] - s(peak)
    x = x/max(spacing, tiny(1.0_wp))
    y = [p, p, p]**2
    taken = [spread(.false., 1, n), spread(.not. mirrored(1), 1, n), spread(.not. mirrored(2), 1, n)]
    if (mirrored(1)) taken(n + 1) = .true.
    if (mirrored(2)) taken(3*n) = .true.
    off = p(peak)*resolution**2/8.0_wp
    if (count(.not. taken) <= 3) return
    moment = 0.0_wp
    right = 0.0_wp
    do i = 1, around_peak
      if (all(taken)) exit
      k = minloc(abs(x), mask=.not. taken, dim=1)
      taken(k) = .true.
      moment = moment + [1.0_wp, x(k), x(k)**2, x(k)**3, x(k)**4]
      right = right + y(k)*[1.0_wp, x(k), x(k)**2]
    end do
    determinant = [moment(0)*(moment(2)*moment(4) - moment(3)**2) - moment(1)*(moment(1)*moment(4) - moment(2)*moment(3)) &
                   + moment(2)*(moment(1)*moment(3) - moment(2)**2), &
                   right(0)*(moment(2)*moment(4) - moment(3)**2) - moment(1)*(right(1)*moment(4) - right(2)*moment(3)) &
                   + moment(2)*(right(1)*moment(3) - right(2)*moment(2))]
    if (determinant(0) > dependent*moment(0)*moment(2)*moment(4)) &
      off = abs(p(peak) - sqrt(max(0.0_wp, determinant(1)/determinant(0))))
  end function off_parabola
end module epcont_accuracy_zone_error
