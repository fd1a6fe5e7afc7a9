!> Levels of pairs between bodies: those of a body are in one level or in two that follow each other.
!>
!> Of one or two bodies all pairs are one level. Of many, those at the same distance from the first, counted
!> in bodies that lie between, are one; small ones are joined.
module epcont_linalg_levels
  use epcont_base_incidence, only: incidence, new_incidence
  implicit none
  private
  public :: levels_of_pairs

  !> Pairs of a level, at least, so that most of the work is done by blocks. (1 000 bodies of 7 pairs each: 32
  !! and 128 take no longer by more than a fifth.)
  integer, parameter :: least_level = 64

contains

  !> The level of each pair, from one on.
  function levels_of_pairs(body, bodies) result(level)
    integer, intent(in) :: body(:, :)   !! of each pair; 0 ends them [any, pairs]
    integer, intent(in) :: bodies       !! in all
    integer :: level(size(body, 2))

    level = joined_levels(distances(body, bodies))
  end function levels_of_pairs

  !> Of each pair: how many bodies are between its farthest and the first of those that hang together with it,
  !! and so much more that all levels of the bodies that do come behind those of others.
  function distances(body, bodies) result(level)
    integer, intent(in) :: body(:, :), bodies
    integer :: level(size(body, 2))
    type(incidence) :: pairs         ! of each body
    integer :: distance(bodies)      ! level of each body; 0: not met
    integer :: queue(bodies)         ! bodies in the order in which they were met
    integer :: b, first, k, last, met

    pairs = new_incidence(body, bodies)
    distance = 0
    met = 0
    last = 0
    do b = 1, bodies
      if (distance(b) > 0) cycle
      first = met
      call walk(from=b)
      ! Once more from the one that is farthest away: more levels, and smaller ones.
      distance(queue(first + 1:met)) = 0
      k = queue(met)
      met = first
      call walk(from=k)
      last = distance(queue(met))
    end do
    level = 1
    do k = 1, size(level)
      level(k) = maxval([distance(pack(body(:, k), body(:, k) > 0)), 1])
    end do

  contains

    !> Meet all bodies that hang together with one, the nearest first.
    subroutine walk(from)
      integer, intent(in) :: from
      integer :: at, i, j, next, pair

      met = met + 1
      queue(met) = from
      distance(from) = last + 1
      at = met
      do while (at <= met)
        do i = pairs%start(queue(at)), pairs%start(queue(at) + 1) - 1
          pair = pairs%group(i)
          do j = 1, size(body, 1)
            next = body(j, pair)
            if (next == 0) exit
            if (distance(next) > 0) cycle
            met = met + 1
            queue(met) = next
            distance(next) = distance(queue(at)) + 1
          end do
        end do
        at = at + 1
      end do
    end subroutine walk
  end function distances

  !> Levels of some size, without empty ones; one alone where there would be two: nothing is zero then.
  pure function joined_levels(level) result(joined)
    integer, intent(in) :: level(:)   !! of each pair
    integer :: joined(size(level))
    integer, allocatable :: number(:), pairs(:)   ! of each level
    integer :: gathered, k, l, last

    allocate (pairs(maxval([level, 1])), source=0)
    do k = 1, size(level)
      pairs(level(k)) = pairs(level(k)) + 1
    end do
    allocate (number(size(pairs)))
    last = 1
    gathered = 0
    do l = 1, size(pairs)
      if (gathered >= least_level .and. pairs(l) > 0) then
        last = last + 1
        gathered = 0
      end if
      number(l) = last
      gathered = gathered + pairs(l)
    end do
    if (last == 2) number = 1
    joined = number(level)
  end function joined_levels
end module epcont_linalg_levels
