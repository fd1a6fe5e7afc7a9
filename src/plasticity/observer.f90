!> What may look on while loads are followed: the stopwatch, and the display of progress after each solve.
!> What it does changes nothing.
module epcont_plasticity_observer
  use epcont_base_kinds, only: wp
  use epcont_system_stopwatch, only: stopwatch
  implicit none
  private
  public :: iteration_record, observer

  !> One solve.
  type :: iteration_record
    real(wp) :: load_factor = 1.0_wp   !! part of the loads it is for
    integer :: iteration = 0           !! its number in its load step
    real(wp) :: change = 0.0_wp        !! largest change of a displacement / largest displacement
    real(wp) :: force_change = 0.0_wp  !! largest change of a contact force / largest contact force
    !> Largest distance of a stress from its curve / the curve's stress there
    real(wp) :: residual = 0.0_wp
    !> Of a displacement, of a contact force, estimated / largest of these; negative: not known
    real(wp) :: error = 0.0_wp, force_error = 0.0_wp
    logical :: by_tangent = .false.    !! the step that tests what was estimated, and ends the iteration
    integer :: touching = 0            !! pairs
    integer :: yielded = 0             !! elements
    integer :: pivots = 0
    integer :: kept = 0                !! of these, the first
  end type iteration_record

  !> One that says nothing.
  type, extends(stopwatch) :: observer
  contains
    procedure :: expect
    procedure :: solved
  end type observer

contains

  !> The plan is made; solves begin.
  subroutine expect(self, operations)
    class(observer), intent(inout) :: self
    real(wp), intent(in) :: operations   !! of a solve
  end subroutine expect

  !> A solve has been done.
  subroutine solved(self, now)
    class(observer), intent(inout) :: self
    type(iteration_record), intent(in) :: now   !! that solve
  end subroutine solved
end module epcont_plasticity_observer
