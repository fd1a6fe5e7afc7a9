!> Loads that are a multiple of others: the response of a linear body is the same multiple.
module epcont_linear_multiple
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: multiple_of

  !> Rounding by the factors of load cases.
  real(wp), parameter :: rounding = 4.0_wp*epsilon(1.0_wp)

contains

  !> Factor between two fields of forces; 0 if they are not multiples.
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
