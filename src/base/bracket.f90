!> Zero of an increasing function between two points: regula falsi, Illinois variant.
module epcont_base_bracket
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: bracket

  type :: bracket
    real(wp) :: at(2)         !! points before and after the zero
    real(wp) :: values(2)     !! values there, below and above zero; the value at a point that stays is halved
    integer :: last = 0       !! point that was found last; 0 if none was found
  contains
    procedure :: likely
    procedure :: take
  end type bracket

contains

  !> Zero of the straight line through both points.
  pure real(wp) function likely(self)
    class(bracket), intent(in) :: self

    likely = (self%at(1)*self%values(2) - self%at(2)*self%values(1))/(self%values(2) - self%values(1))
  end function likely

  !> Take a point between them with its value.
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
