!> What the largest pressures are beside their figures: bounded, unbounded, or not resolved by the mesh.
module epcont_report_limit
  use epcont_base_kinds, only: wp
  use epcont_report_run, only: run_results
  implicit none
  private
  public :: limit_of_zone, limit_of_largest, reason_of

  character(len=*), parameter, public :: unbounded = 'unbounded'
  character(len=*), parameter :: bounded = 'bounded', not_resolved = 'not resolved'

contains

  !> Of the largest pressure of a zone; empty where that is not known, or nothing presses.
  pure function limit_of_zone(run, z) result(word)
    type(run_results), intent(in) :: run   !! what is known of the run
    integer, intent(in) :: z               !! the zone
    character(len=:), allocatable :: word

    word = ''
    if (z > size(run%accuracy%zone)) return
    if (run%answer%zones(z)%max_pressure < 0.0_wp) return
    word = bounded
    if (.not. run%accuracy%zone(z)%resolved) word = not_resolved
    if (run%accuracy%zone(z)%unbounded) word = unbounded
  end function limit_of_zone

  !> Of the largest pressure of all.
  pure function limit_of_largest(run) result(word)
    type(run_results), intent(in) :: run   !! what is known of the run
    character(len=:), allocatable :: word

    word = ''
    if (size(run%answer%zones) > 0) word = limit_of_zone(run, maxloc(run%answer%zones%max_pressure, dim=1))
  end function limit_of_largest

  !> What a limit means, for the end of a line of the listing; empty where there is nothing to say.
  pure function reason_of(word) result(text)
    character(len=*), intent(in) :: word   !! of one of the functions above
    character(len=:), allocatable :: text

    text = ''
    if (word == unbounded) text = '   unbounded: it grows with every finer mesh'
    if (word == not_resolved) text = '   not resolved: too few pairs where it is largest'
  end function reason_of
end module epcont_report_limit
