!> Where contact ends, told from sets of pairs where it does not.
!>
!> Near an end pressure is the root of the distance from it. Where contact is taken to end a distance d
!> further out, pressure there is (s - d/2)/sqrt(s) times the same, s being the distance from the end that is
!> taken: half of the pairs too many pull. Where it is taken to end as much too early, the pairs beyond come
!> together up to s = 3 d/2. So sets that follow what is found halve the error; these do not leave much of it.
module epcont_linear_contact_ends
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: reach_ends

  !> What becomes of a pair.
  integer, parameter :: stays_open = 0, stays_closed = 1, leaves = 2, comes = 3
  !> Of the pairs that come together at an end those that will not press.
  real(wp), parameter :: too_many = 1.0_wp/3.0_wp

contains

  !> Move ends of contact to where they are likely: twice as many pairs leave there as pull, but at most half
  !! of those that press beside them, and a third fewer come than are found together. Pairs that are numbered
  !! along a line are looked at so.
  subroutine reach_ends(closed, wanted)
    logical, intent(in) :: closed(:)      !! pairs in contact so far
    logical, intent(inout) :: wanted(:)   !! pairs that press, or overlap; then those of the next set
    integer :: becomes(0:size(closed) + 1), begin(size(closed) + 1)   ! of each run of like pairs
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

    !> Where a run has pairs that press on one side alone.
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
