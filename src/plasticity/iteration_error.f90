!> How far an iteration still is from where it goes, from what its last steps were worth.
!>
!> An iteration takes x to g(x). To first order a step dx changes g by J dx and the rest g - x by (J - 1) dx,
!> so that of a rest r there is J/(1 - J) r to come in g. How much that is at most, the steps behind tell:
!> |dg|/|d(g - x)|. In an iteration without mixing it is the sum of the changes to come, each the last times
!> the rate at which they fall.
module epcont_plasticity_iteration_error
  use epcont_base_kinds, only: wp
  use epcont_plasticity_onlooker, only: iteration_record
  use epcont_linear_scene_state, only: scene_state
  implicit none
  private
  public :: error_estimator, ratio

  type :: error_estimator
    ! The last g, with its contact forces, and the last g - x.
    real(wp), allocatable :: displacement(:, :), force(:), rest(:, :)
    ! |dg|/|d(g - x)| of the steps at this load, the contact forces' [force/length].
    real(wp), allocatable :: gain(:), force_gain(:)
  contains
    procedure :: restart
    procedure :: estimate
    procedure :: largest_gain
  end type error_estimator

contains

  !> Another load begins.
  pure subroutine restart(self)
    class(error_estimator), intent(inout) :: self

    self%gain = [real(wp) ::]
    self%force_gain = [real(wp) ::]
  end subroutine restart

  !> What a solve, from `about` to `found`, leaves: the errors of the record.
  pure subroutine estimate(self, steps, about, found, now)
    class(error_estimator), intent(inout) :: self
    integer, intent(in) :: steps               !! behind that are asked
    type(scene_state), intent(in) :: about, found
    type(iteration_record), intent(inout) :: now
    real(wp), allocatable :: rest(:, :)
    real(wp) :: step, largest
    logical :: falls

    rest = found%displacement - about%displacement
    largest = maxval(abs(rest))
    now%error = -1.0_wp
    now%force_error = -1.0_wp
    if (now%iteration > 1) then
      step = maxval(abs(rest - self%rest))
      self%gain = [self%gain, ratio(maxval(abs(found%displacement - self%displacement)), step)]
      self%force_gain = [self%force_gain, ratio(maxval([0.0_wp, abs(found%contact%force - self%force)]), step)]
      falls = largest < maxval(abs(self%rest)) .or. largest == 0.0_wp
      ! A step may by chance be short where much is to come: as long as stresses are off their curves, no less
      ! than the last change.
      if (falls) now%error = max(ratio(self%largest_gain(steps)*largest, maxval(abs(found%displacement))), &
                                 min(now%change, now%residual))
      if (falls .and. any(found%contact%force > 0.0_wp)) then
        now%force_error = max(ratio(maxval(last(self%force_gain, steps))*largest, maxval(found%contact%force)), &
                              min(now%force_change, now%residual))
      else if (falls) then
        now%force_error = 0.0_wp
      end if
    end if
    self%displacement = found%displacement
    self%force = found%contact%force
    self%rest = rest
  end subroutine estimate

  !> Of the last steps at this load.
  pure real(wp) function largest_gain(self, steps)
    class(error_estimator), intent(in) :: self
    integer, intent(in) :: steps

    largest_gain = maxval([0.0_wp, last(self%gain, steps)])
  end function largest_gain

  pure function last(values, steps)
    real(wp), intent(in) :: values(:)
    integer, intent(in) :: steps
    real(wp), allocatable :: last(:)

    last = values(max(1, size(values) - steps + 1):)
  end function last

  !> a/b, 0 where both are 0; finite.
  pure real(wp) function ratio(a, b)
    real(wp), intent(in) :: a, b

    ratio = 0.0_wp
    if (a > 0.0_wp) ratio = a/max(b, tiny(b)*max(a, 1.0_wp))
  end function ratio
end module epcont_plasticity_iteration_error
