!> How far to go along a step of joined bodies (`linear/joined_search.f90`), and whether it is the last.
module epcont_linear_line_search
  use epcont_base_bracket, only: bracket
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: negligible, no_effect
  implicit none
  private
  public :: has_settled, least_at, part_of_largest

  !> A step is cut where the slope at its end is more than this part of that where it begins.
  real(wp), parameter :: flat_enough = 0.1_wp
  !> Places that are tried.
  integer, parameter :: most_tried = 200

contains

  !> Part of a step, up to all of it, at which a function of it is about least, by regula falsi and geometric
  !! means: the energy of bodies, their loads, and springs whose forces have bounds.
  real(wp) function least_at(curvature, descent, pull, loss, opening, lower, upper) result(t)
    real(wp), intent(in) :: curvature    !! of the energy of all but the springs [energy]
    real(wp), intent(in) :: descent      !! what that and the loads lose where the step begins [energy]
    real(wp), intent(in) :: pull(:)      !! of each spring there [force]
    real(wp), intent(in) :: loss(:)      !! of pull, by the whole step [force]
    real(wp), intent(in) :: opening(:)   !! of the gaps by it [length]
    real(wp), intent(in) :: lower(:), upper(:)   !! bounds of the forces of springs [force]
    type(bracket) :: zero                ! of the slope
    real(wp) :: begin, now
    integer :: i

    t = 1.0_wp
    begin = slope(0.0_wp)
    zero = bracket([0.0_wp, 1.0_wp], [begin, slope(1.0_wp)])
    if (zero%values(2) <= flat_enough*abs(begin)) return
    do i = 1, most_tried
      t = zero%likely()
      if (mod(i, 3) == 0) t = sqrt(max(zero%at(1), tiny(1.0_wp)))*sqrt(zero%at(2))
      now = slope(t)
      if (abs(now) <= flat_enough*abs(begin)) return
      call zero%take(t, now)
    end do

  contains

    !> Of the function there.
    real(wp) function slope(t)
      real(wp), intent(in) :: t

      slope = t*curvature - descent - sum(min(max(lower, pull - t*loss), upper)*opening)
    end function slope
  end function least_at

  !> The largest of some changes, of the largest of all.
  pure real(wp) function part_of_largest(change, whole) result(part)
    real(wp), intent(in) :: change(:, :), whole(:, :)   !! [any, any]

    part = maxval(abs(change))/max(maxval(abs(whole)), tiny(1.0_wp))
  end function part_of_largest

  !> Has what steps change come to an end? The next step would change as much less, or it is rounding.
  elemental logical function has_settled(change, before)
    real(wp), intent(in) :: change, before   !! by the last step and the one before, of the largest

    has_settled = change*merge(min(1.0_wp, change/max(before, tiny(1.0_wp))), 1.0_wp, before <= 1.0_wp) &
                  <= negligible .or. change <= no_effect .and. change > 0.5_wp*before
  end function has_settled
end module epcont_linear_line_search
