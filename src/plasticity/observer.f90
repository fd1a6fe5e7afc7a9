!> Observers of the load path: the stopwatch, and the display of progress after each solve. They do not change
!> results.
module epcont_plasticity_observer
  use epcont_base_kinds, only: wp
  use epcont_system_stopwatch, only: stopwatch
  implicit none
  private
  public :: iteration_record, observer

  !> Data of one solve.
  type :: iteration_record
    real(wp) :: load_factor = 1.0_wp   !! part of the loads
    integer :: iteration = 0           !! number in its load step
    real(wp) :: change = 0.0_wp        !! largest change of a displacement / largest displacement
    real(wp) :: force_change = 0.0_wp  !! largest change of a contact force / largest contact force
    !> Largest stress error, relative
    real(wp) :: residual = 0.0_wp
    !> Estimated error of a displacement / largest displacement, and of a contact force / largest force;
    !! negative: unknown
    real(wp) :: error = 0.0_wp, force_error = 0.0_wp
    logical :: by_tangent = .false.    !! this step tests the estimate, and ends the iteration
    integer :: touching = 0            !! number of pairs in contact
    integer :: yielded = 0             !! number of yielded elements
    integer :: pivots = 0
  end type iteration_record

  !> An observer without output.
  type, extends(stopwatch) :: observer
  contains
    procedure :: expect
    procedure :: solved
  end type observer

contains

  !> Announce the solves after the plan.
  subroutine expect(self, operations)
    class(observer), intent(inout) :: self
    real(wp), intent(in) :: operations   !! of a solve
  end subroutine expect

  !> Report a solve.
  subroutine solved(self, now)
    class(observer), intent(inout) :: self
    type(iteration_record), intent(in) :: now   !! its data
  end subroutine solved
end module epcont_plasticity_observer
