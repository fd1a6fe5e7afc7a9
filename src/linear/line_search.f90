!> Line search along a step of joined bodies (`linear/joined_search.f90`), and its convergence test.
module epcont_linear_line_search
  use epcont_base_bracket, only: bracket
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: negligible, no_effect
  implicit none
  private
  public :: has_settled, least_at, part_of_largest

  !> A step is cut if the slope at its end is more than this fraction of the slope at its start.
  real(wp), parameter :: flat_enough = 0.1_wp
  !> Maximum number of points that are tried.
  integer, parameter :: most_tried = 200

contains

  !> Fraction of a step, at most 1, that approximately minimises a function, by regula falsi and geometric
  !! means: the energy of bodies, their loads, and springs with bounded forces.
  real(wp) function least_at(curvature, descent, pull, loss, opening, lower, upper) result(t)
    real(wp), intent(in) :: curvature    !! of the energy of bodies and loads [energy]
    real(wp), intent(in) :: descent      !! initial decrease of this energy [energy]
    real(wp), intent(in) :: pull(:)      !! initial force of each spring [force]
    real(wp), intent(in) :: loss(:)      !! decrease of `pull` in the whole step [force]
    real(wp), intent(in) :: opening(:)   !! of the gaps in the whole step [length]
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

    !> Slope of the function at t.
    real(wp) function slope(t)
      real(wp), intent(in) :: t

      slope = t*curvature - descent - sum(min(max(lower, pull - t*loss), upper)*opening)
    end function slope
  end function least_at

  !> Largest change, over the largest value.
  pure real(wp) function part_of_largest(change, whole) result(part)
    real(wp), intent(in) :: change(:, :), whole(:, :)   !! [any, any]

    part = maxval(abs(change))/max(maxval(abs(whole)), tiny(1.0_wp))
  end function part_of_largest

  !> Has a change converged? The next step would change less by the same factor, or this is rounding.
  elemental logical function has_settled(change, before)
    real(wp), intent(in) :: change, before   !! in the last step and the one before, over the largest value

    has_settled = change*merge(change/max(before, change, tiny(1.0_wp)), 1.0_wp, before <= 1.0_wp) &
                  <= negligible .or. change <= no_effect .and. change > 0.5_wp*before
  end function has_settled
end module epcont_linear_line_search
