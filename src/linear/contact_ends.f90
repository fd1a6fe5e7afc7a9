!> Estimated ends of contact, from active sets with wrong ends.
!>
!> Near an end, pressure is the root of the distance from it. If contact is assumed to end a distance d
!> too far out, pressure changes by the factor (s - d/2)/sqrt(s), with the distance s from the assumed
!> end: half of the excess pairs are in tension. If it is assumed to end too early by d, the pairs beyond
!> overlap up to s = 3 d/2. Sets that follow only these signs halve the error; the estimate removes most.
module epcont_linear_contact_ends
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: reach_ends

  !> Change of a pair.
  integer, parameter :: stays_open = 0, stays_closed = 1, leaves = 2, comes = 3
  !> Fraction of the overlapping pairs at an end that will not be in contact.
  real(wp), parameter :: too_many = 1.0_wp/3.0_wp

contains

  !> Move ends of contact to their estimated positions: twice as many pairs leave as are in tension, but at
  !! most half of those in contact beside them, and a third fewer enter than overlap. Pairs must be numbered
  !! along the line.
  subroutine reach_ends(closed, wanted)
    logical, intent(in) :: closed(:)      !! pairs in contact so far
    logical, intent(inout) :: wanted(:)   !! pairs in compression, or overlapping; then those of the next set
    integer :: becomes(0:size(closed) + 1), begin(size(closed) + 1)   ! of each run of equal changes
    integer :: k, r, runs

    becomes = stays_open
    where (closed) becomes(1:size(closed)) = leaves
    where (wanted) becomes(1:size(closed)) = merge(stays_closed, comes, closed)
    runs = 0
    do k = 1, size(closed)
      if (k > 1 .and. becomes(k) == becomes(k - 1)) cycle
      runs = runs + 1
      begin(runs) = k
    end do
    begin(runs + 1) = size(closed) + 1
    do r = 1, runs
      call move_end(r)
    end do

  contains

    !> Move the end of a run that has pairs in contact on one side only.
    subroutine move_end(r)
      integer, intent(in) :: r
      integer :: beside, m

      associate (first => begin(r), next => begin(r + 1), before => becomes(begin(r) - 1) == stays_closed)
        if (before .eqv. becomes(next) == stays_closed) return
        beside = merge(r - 1, r + 1, before)
        if (becomes(first) == leaves) then
          m = min(next - first, (begin(beside + 1) - begin(beside))/2)
          if (before) wanted(first - m:first - 1) = .false.
          if (.not. before) wanted(next:next + m - 1) = .false.
        else if (becomes(first) == comes) then
          m = nint(too_many*(next - first))
          if (before) wanted(next - m:next - 1) = .false.
          if (.not. before) wanted(first:first + m - 1) = .false.
        end if
      end associate
    end subroutine move_end
  end subroutine reach_ends
end module epcont_linear_contact_ends
