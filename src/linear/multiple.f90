!> Loads that are a multiple of others: of a linear body so is what they do.
module epcont_linear_multiple
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: multiple_of

  !> What factors of load cases round off.
  real(wp), parameter :: rounding = 4.0_wp*epsilon(1.0_wp)

contains

  !> How many times some forces others are; 0 where they are no multiple of them.
  pure real(wp) function multiple_of(force, of) result(times)
    real(wp), intent(in) :: force(:, :), of(:, :)   !! [force] [directions, nodes]
    integer :: at(2)

    times = 0.0_wp
    at = maxloc(abs(of))
    if (of(at(1), at(2)) == 0.0_wp) return
    times = force(at(1), at(2))/of(at(1), at(2))
    if (any(abs(force - times*of) > rounding*abs(force(at(1), at(2))))) times = 0.0_wp
  end function multiple_of
end module epcont_linear_multiple
