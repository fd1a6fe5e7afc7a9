!> Error estimate of an iteration, from its last steps.
!>
!> An iteration maps x to g(x). To first order, a step dx changes g by J dx and the residual g - x by (J - 1)
!> dx, so for a residual r the remaining change of g is J/(1 - J) r. Its upper bound follows from the previous
!> steps: |dg|/|d(g - x)|. Without acceleration it is the sum of the remaining changes, each the previous one
!> times the convergence rate; the last steps are the slowest.
module epcont_plasticity_error_estimate
  use epcont_base_kinds, only: wp
  use epcont_linear_solved_state, only: solved_state
  use epcont_plasticity_observer, only: iteration_record
  implicit none
  private
  public :: error_estimate, finite_ratio

  type :: error_estimate
    !> Last displacements: g(x), and residual g - x [length] [directions, nodes]
    real(wp), allocatable, private :: displacement(:, :), rest(:, :)
    !> Gain of displacements and contact forces, |dg|/|d(g - x)|, of the steps at this load [1],
    !! [force/length]
    real(wp), allocatable, private :: gain(:), force_gain(:)
    real(wp) :: doubt = 1.0_wp   !! error shown by a tangent step / estimated error
  contains
    procedure :: begin
    procedure :: estimate
  end type error_estimate

contains

  !> Start at a new load.
  pure subroutine begin(self)
    class(error_estimate), intent(inout) :: self

    self%gain = [real(wp) ::]
    self%force_gain = [real(wp) ::]
    self%doubt = 1.0_wp
  end subroutine begin

  !> Estimate the errors of a step from x to g; negative if unknown.
  subroutine estimate(self, from, to, force, mixes, now)
    class(error_estimate), intent(inout) :: self
    type(solved_state), intent(in) :: from, to      !! x and g
    real(wp), intent(in) :: force(:)               !! previous contact forces [force] [pairs]
    logical, intent(in) :: mixes                   !! the iteration combines its last states
    type(iteration_record), intent(inout) :: now   !! of this step; receives the errors
    real(wp), allocatable :: last_rest(:, :)
    real(wp) :: step, largest
    integer :: first

    call move_alloc(self%rest, last_rest)
    self%rest = to%displacement - from%displacement
    largest = maxval(abs(self%rest))
    now%error = -1.0_wp
    now%force_error = -1.0_wp
    if (now%iteration > 1) then
      associate (u => to%displacement, now_force => to%contact%force)
        step = maxval(abs(self%rest - last_rest))
        self%gain = [self%gain, finite_ratio(maxval(abs(u - self%displacement)), step)]
        self%force_gain = [self%force_gain, finite_ratio(maxval([0.0_wp, abs(now_force - force)]), step)]
        if (largest < maxval(abs(last_rest)) .or. largest == 0.0_wp) then
          first = merge(1, max(1, size(self%gain) - 1), mixes)
          ! A step may be short by chance, far from the solution. As long as there are stress errors, the
          ! estimate is at least the last change.
          now%error = max(finite_ratio(maxval(self%gain(first:))*largest, maxval(abs(u))), &
                          min(now%change, now%residual))
          now%force_error = 0.0_wp
          if (any(now_force > 0.0_wp)) &
            now%force_error = max(finite_ratio(maxval(self%force_gain(first:))*largest, maxval(now_force)), &
                                  min(now%force_change, now%residual))
        end if
      end associate
    end if
    self%displacement = to%displacement
  end subroutine estimate

  !> a/b; 0 if both are 0; finite.
  pure real(wp) function finite_ratio(a, b)
    real(wp), intent(in) :: a, b

    finite_ratio = max(a, 0.0_wp)/max(b, tiny(b)*max(a, 1.0_wp))
  end function finite_ratio
end module epcont_plasticity_error_estimate
