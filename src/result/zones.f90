!> Zones in contact: runs of neighbouring pairs that touch, and how wide they are.
module epcont_result_zones
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_model_model, only: model_type
  use epcont_result_contact_line, only: contact_line, distance
  implicit none
  private
  public :: contact_zone, find_zones

  !> A run of neighbouring pairs that touch.
  type :: contact_zone
    integer :: first = 0, last = 0          !! pairs at its ends
    real(wp) :: force = 0.0_wp              !! [force]
    real(wp) :: max_pressure = 0.0_wp       !! [stress]
    real(wp) :: half_width_pairs = 0.0_wp   !! half of the length between its last pairs [length]
    real(wp) :: half_width = -1.0_wp        !! to where the pressure vanishes; negative: unknown [length]
    integer, allocatable :: pairs(:)        !! from end to end
  end type contact_zone

contains

  !> The zones, in the order of their first pairs. `touching` are the pairs `in_contact`.
  pure function find_zones(model, line, touching, force, pressure) result(zones)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    real(wp), intent(in) :: force(:), pressure(:)
    type(contact_zone), allocatable :: zones(:)
    type(partition) :: sets
    integer, allocatable :: number(:), start(:)   !! set of each pair; first pair of each zone
    integer :: count, k, pair, z

    sets = new_partition(model%pairs)
    do pair = 1, model%pairs
      do k = 1, 2
        if (line%neighbour(k, pair) == 0 .or. .not. touching(pair)) cycle
        if (touching(line%neighbour(k, pair))) call sets%join(pair, line%neighbour(k, pair))
      end do
    end do
    call sets%numbers(number, count)
    start = [(findloc(number, z, dim=1), z=1, count)]
    start = pack(start, touching(start))
    allocate (zones(size(start)))
    do z = 1, size(zones)
      zones(z) = walk(model, line, touching, force, pressure, start(z))
    end do
  end function find_zones

  !> One zone: its pairs from end to end, beginning with the end met first in the deck.
  pure function walk(model, line, touching, force, pressure, start) result(zone)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    real(wp), intent(in) :: force(:), pressure(:)
    integer, intent(in) :: start
    type(contact_zone) :: zone
    integer, allocatable :: run(:)
    real(wp) :: beyond(2), length
    logical :: falls(2)
    integer :: k

    run = run_from(line, touching, start)
    run = run_from(line, touching, run(size(run)))
    if (run(size(run)) < run(1)) run = run(size(run):1:-1)
    zone%pairs = run
    zone%first = run(1)
    zone%last = run(size(run))
    zone%force = sum(force(run))
    zone%max_pressure = maxval(pressure(run))
    length = 0.0_wp
    do k = 2, size(run)
      length = length + distance(model, line, run(k), run(k - 1))
    end do
    call extend(model, line, touching, pressure, run, beyond(2), falls(2))
    call extend(model, line, touching, pressure, run(size(run):1:-1), beyond(1), falls(1))
    if (line%mirrored(zone%first) .neqv. line%mirrored(zone%last)) then
      k = merge(2, 1, line%mirrored(zone%first))
      zone%half_width_pairs = length
      if (falls(k)) zone%half_width = length + beyond(k)
    else
      zone%half_width_pairs = 0.5_wp*length
      if (all(falls)) zone%half_width = 0.5_wp*(length + sum(beyond))
    end if
  end function walk

  !> The touching pairs from `start` as far as they go in one direction.
  pure function run_from(line, touching, start) result(run)
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    integer, intent(in) :: start
    integer, allocatable :: run(:)
    integer :: k, next

    run = [start]
    do
      next = 0
      do k = 1, 2
        associate (candidate => line%neighbour(k, run(size(run))))
          if (candidate == 0) cycle
          if (.not. touching(candidate) .or. any(run == candidate)) cycle
          next = candidate
          exit
        end associate
      end do
      if (next == 0) return
      run = [run, next]
    end do
  end function run_from

  !> How far beyond the last pair of a run the pressure vanishes: near the edge p**2 is linear. Not beyond the
  !! first open pair; not at all where that end is the last candidate, or the pressure does not fall towards
  !! it.
  pure subroutine extend(model, line, touching, pressure, run, beyond, falls)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    real(wp), intent(in) :: pressure(:)
    integer, intent(in) :: run(:)
    real(wp), intent(out) :: beyond
    logical, intent(out) :: falls
    real(wp) :: drop
    integer :: k, n, open

    n = size(run)
    beyond = 0.0_wp
    falls = .false.
    if (n < 2) return
    open = 0
    do k = 1, 2
      associate (other => line%neighbour(k, run(n)))
        if (other == 0) cycle
        if (.not. touching(other)) open = other
      end associate
    end do
    if (open == 0) return
    falls = pressure(run(n)) < 0.5_wp*maxval(pressure(run))
    drop = pressure(run(n - 1))**2 - pressure(run(n))**2
    if (drop <= 0.0_wp) return
    beyond = min(distance(model, line, run(n), run(n - 1))*pressure(run(n))**2/drop, distance(model, line, run(n), open))
  end subroutine extend
end module epcont_result_zones
