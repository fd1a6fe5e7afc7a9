!> Contact zones: runs of neighbouring pairs in contact, and their widths.
module epcont_result_zones
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_base_tolerances, only: no_effect
  use epcont_result_contact_line, only: contact_line
  implicit none
  private
  public :: contact_zone, find_zones

  !> The pressure falls towards an end if it is below this part of the largest pressure there: half, minus
  !! rounding, since a linear pressure may have half.
  real(wp), parameter, public :: falls = 0.5_wp - no_effect

  !> A run of neighbouring pairs in contact.
  type :: contact_zone
    integer :: first = 0, last = 0          !! pairs at its ends
    real(wp) :: force = 0.0_wp              !! [force]
    real(wp) :: max_pressure = 0.0_wp       !! [stress]
    real(wp) :: half_width_pairs = 0.0_wp   !! half of the distance of its last pairs [length]
    real(wp) :: half_width = -1.0_wp        !! half of the length between the points of zero pressure;
                                            !! negative: unknown [length]
    integer, allocatable :: pairs(:)        !! from end to end
    real(wp), allocatable :: along(:)       !! distance of each from the first [length] [its pairs]
    integer, allocatable :: beyond(:)       !! pairs next to those at its ends
    !> Distance from each end to the first open pair; 0 if the end is the last candidate [length]
    real(wp) :: open(2) = 0.0_wp
    real(wp) :: vanishes(2) = 0.0_wp        !! distance to the point of zero pressure, at most `open` [length]
  end type contact_zone

contains

  !> Find the zones, in the order of their first pairs.
  function find_zones(line, touching, force, pressure) result(zones)
    type(contact_line), intent(in) :: line          !! of the pairs
    logical, intent(in) :: touching(:)              !! the pairs `in_contact` [pairs]
    real(wp), intent(in) :: force(:), pressure(:)   !! [force], [stress] [pairs]
    type(contact_zone), allocatable :: zones(:)
    type(partition) :: sets
    type(incidence) :: at                         !! pairs at each node
    integer, allocatable :: number(:), start(:)   !! set of each pair; first pair of each zone
    integer, allocatable :: next(:)
    logical :: met(size(touching))                !! already in a run
    integer :: count, k, pair, z

    sets = new_partition(size(touching))
    do pair = 1, size(touching)
      if (.not. touching(pair)) cycle
      next = beside(line, touching, pair, .true.)
      do k = 1, size(next)
        call sets%join(pair, next(k))
      end do
    end do
    call sets%numbers(number, count)
    allocate (start(count))
    do k = size(number), 1, -1
      start(number(k)) = k
    end do
    start = pack(start, touching(start))
    at = new_incidence(reshape(line%node, [1, size(number)]), maxval([line%node, 0]))
    met = .false.
    allocate (zones(size(start)))
    do z = 1, size(zones)
      zones(z) = zone_from(line, touching, pressure, at, number, met, start(z))
      zones(z)%force = sum(force(zones(z)%pairs))
    end do
  end function find_zones

  !> Find one zone: its pairs from end to end, from the end that comes first in the deck.
  function zone_from(line, touching, pressure, at, number, met, start) result(zone)
    type(contact_line), intent(in) :: line          !! of the pairs
    logical, intent(in) :: touching(:)              !! the pairs `in_contact` [pairs]
    real(wp), intent(in) :: pressure(:)             !! [stress] [pairs]
    type(incidence), intent(in) :: at               !! pairs at each node
    integer, intent(in) :: number(:)                !! set of each pair [pairs]
    logical, intent(inout) :: met(:)                !! already in a run [pairs]
    integer, intent(in) :: start
    type(contact_zone) :: zone
    integer, allocatable :: run(:)
    logical :: counts(2), falling(2)
    integer :: k, n

    run = run_from(line, touching, at, number, met, start)
    run = run_from(line, touching, at, number, met, run(size(run)))
    n = size(run)
    if (run(n) < run(1)) run = run(n:1:-1)
    zone%pairs = run
    zone%first = run(1)
    zone%last = run(n)
    zone%beyond = [line%neighbour(:, run(1)), line%neighbour(:, run(n))]
    zone%beyond = pack(zone%beyond, zone%beyond > 0)
    zone%max_pressure = maxval(pressure(run))
    allocate (zone%along(n), source=0.0_wp)
    do k = 2, n
      zone%along(k) = zone%along(k - 1) + line%distance(run(k), run(k - 1))
    end do
    call extend(line, touching, pressure, run(n:1:-1), zone%open(1), zone%vanishes(1), falling(1))
    call extend(line, touching, pressure, run, zone%open(2), zone%vanishes(2), falling(2))
    ! a line of symmetry cuts the zone in half
    counts = .not. line%mirrored(run([1, n])) .or. all(line%mirrored(run([1, n])))
    associate (half => merge(0.5_wp, 1.0_wp, all(counts)))
      zone%half_width_pairs = half*zone%along(n)
      if (all(falling .or. .not. counts)) &
        zone%half_width = half*(zone%along(n) + sum(zone%vanishes, mask=counts))
    end associate
  end function zone_from

  !> Find the neighbours of a pair that are in contact, or those that are open.
  pure function beside(line, touching, pair, touches) result(next)
    type(contact_line), intent(in) :: line          !! of the pairs
    logical, intent(in) :: touching(:)              !! the pairs `in_contact` [pairs]
    integer, intent(in) :: pair
    logical, intent(in) :: touches
    integer, allocatable :: next(:)

    next = pack(line%neighbour(:, pair), line%neighbour(:, pair) > 0)
    next = pack(next, touching(next) .eqv. touches)
  end function beside

  !> Find the pairs in contact from `start` on in one direction; pairs at the same node follow each other.
  function run_from(line, touching, at, number, met, start) result(run)
    type(contact_line), intent(in) :: line          !! of the pairs
    logical, intent(in) :: touching(:)              !! the pairs `in_contact` [pairs]
    type(incidence), intent(in) :: at               !! pairs at each node
    integer, intent(in) :: number(:)                !! set of each pair [pairs]
    logical, intent(inout) :: met(:)                !! already in a run [pairs]
    integer, intent(in) :: start
    integer, allocatable :: next(:), run(:)
    integer :: found(size(number)), last, n

    n = 1
    found(1) = start
    do
      last = found(n)
      met(last) = .true.
      next = at%of(line%node(last))
      next = [pack(next, number(next) == number(last)), beside(line, touching, last, .true.)]
      next = pack(next, .not. met(next))
      if (size(next) == 0) exit
      n = n + 1
      found(n) = next(1)
    end do
    run = found(:n)
    met(run) = .false.
  end function run_from

  !> Find the distance from the last pair of a run to the point of zero pressure: near the edge p**2 is
  !! linear. It is at most the distance of the first open pair, and zero if the end is the last candidate or
  !! the pressure does not fall towards it.
  pure subroutine extend(line, touching, pressure, run, open, vanishes, falling)
    type(contact_line), intent(in) :: line          !! of the pairs
    logical, intent(in) :: touching(:)              !! the pairs `in_contact` [pairs]
    real(wp), intent(in) :: pressure(:)             !! [stress] [pairs]
    integer, intent(in) :: run(:)
    !> Distances to the first open pair, and to the point of zero pressure [length]
    real(wp), intent(out) :: open, vanishes
    logical, intent(out) :: falling
    integer, allocatable :: next(:)   !! open pairs
    real(wp) :: drop
    integer :: before, n   !! the last pair of the run, and the pair at the node before

    n = size(run)
    before = findloc(line%node(run) /= line%node(run(n)), .true., dim=1, back=.true.)
    open = 0.0_wp
    next = beside(line, touching, run(n), .false.)
    if (size(next) > 0) open = line%distance(run(n), next(size(next)))
    falling = before > 0 .and. open > 0.0_wp .and. pressure(run(n)) < falls*maxval(pressure(run))
    vanishes = merge(open, 0.0_wp, before > 0)
    if (vanishes <= 0.0_wp) return
    drop = pressure(run(before))**2 - pressure(run(n))**2
    if (drop > 0.0_wp) vanishes = min(line%distance(run(n), run(before))*pressure(run(n))**2/drop, open)
  end subroutine extend
end module epcont_result_zones
