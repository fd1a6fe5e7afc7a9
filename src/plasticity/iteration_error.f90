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
  public :: error_estimator, new_estimator, ratio

  type :: error_estimator
    private
    integer :: steps = 0   !! behind that are asked
    ! The last g, with its contact forces, and the last g - x.
    real(wp), allocatable :: displacement(:, :), force(:), rest(:, :)
    ! |dg|/|d(g - x)| of the steps at this load, the contact forces' [force/length].
    real(wp), allocatable :: gain(:), force_gain(:)
  contains
    procedure :: estimate
  end type error_estimator

contains

  !> One for another load.
  pure type(error_estimator) function new_estimator(steps) result(estimator)
    integer, intent(in) :: steps   !! behind that are asked

    estimator%steps = steps
    allocate (estimator%gain(0), estimator%force_gain(0))
  end function new_estimator

  !> What a solve, from `about` to `found`, leaves: the errors of the record.
  pure subroutine estimate(self, about, found, now)
    class(error_estimator), intent(inout) :: self
    type(scene_state), intent(in) :: about, found   !! displacements and contact forces
    type(iteration_record), intent(inout) :: now    !! changes and residual; negative errors are not known
    real(wp), allocatable :: rest(:, :)
    real(wp) :: step, largest
    integer :: first

    rest = found%displacement - about%displacement
    largest = maxval(abs(rest))
    now%error = -1.0_wp
    now%force_error = -1.0_wp
    associate (u => found%displacement, force => found%contact%force)
      if (now%iteration > 1) then
        step = maxval(abs(rest - self%rest))
        self%gain = [self%gain, ratio(maxval(abs(u - self%displacement)), step)]
        self%force_gain = [self%force_gain, ratio(maxval([0.0_wp, abs(force - self%force)]), step)]
        if (largest < maxval(abs(self%rest)) .or. largest == 0.0_wp) then
          first = max(1, size(self%gain) - self%steps + 1)
          ! A step may by chance be short where much is to come: as long as stresses are off their curves, no
          ! less than the last change.
          now%error = max(ratio(maxval(self%gain(first:))*largest, maxval(abs(u))), min(now%change, now%residual))
          now%force_error = 0.0_wp
          if (any(force > 0.0_wp)) &
            now%force_error = max(ratio(maxval(self%force_gain(first:))*largest, maxval(force)), &
                                  min(now%force_change, now%residual))
        end if
      end if
      self%displacement = u
      self%force = force
    end associate
    self%rest = rest
  end subroutine estimate

  !> a/b, 0 where both are 0; finite.
  pure real(wp) function ratio(a, b)
    real(wp), intent(in) :: a, b   !! not negative

    ratio = 0.0_wp
    if (a > 0.0_wp) ratio = a/max(b, tiny(b)*max(a, 1.0_wp))
  end function ratio
end module epcont_plasticity_iteration_error
