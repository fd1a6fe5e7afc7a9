!> A zero of a function that rises, between two places: regula falsi of Illinois.
module epcont_base_bracket
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: bracket

  type :: bracket
    real(wp) :: at(2)         !! before and behind the zero
    real(wp) :: values(2)     !! there, below and above zero; that of a place that stays is halved
    integer :: last = 0       !! which was found last; 0: none
  contains
    procedure :: likely
    procedure :: take
  end type bracket

contains

  !> Where a straight line between both would be zero.
  pure real(wp) function likely(self)
    class(bracket), intent(in) :: self

    likely = (self%at(1)*self%values(2) - self%at(2)*self%values(1))/(self%values(2) - self%values(1))
  end function likely

  !> A place between, and the value there.
  pure subroutine take(self, place, value)
    class(bracket), intent(inout) :: self
    real(wp), intent(in) :: place, value
    integer :: side

    side = merge(2, 1, value > 0.0_wp)
    self%at(side) = place
    self%values(side) = value
    if (side == self%last) self%values(3 - side) = 0.5_wp*self%values(3 - side)
    self%last = side
  end subroutine take
end module epcont_base_bracket
