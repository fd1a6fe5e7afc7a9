!> Figures of an increment, and the error that the size of the increments causes in those at
!> the end of a load case.
!>
!> The error of backward Euler is proportional to the size of the increments, if these are small. So the
!> difference to a second run with another number of increments gives it.
module epcont_result_increment
  use epcont_base_kinds, only: wp
  use epcont_result_answer, only: answer_type, pair_slips, pair_sticks
  implicit none
  private
  public :: errors_of_increments, increment_errors, increment_of, increment_record, other_number
  public :: state_to_draw

  !> Factor of the estimated error: differences of two runs are not proportional to the size of the
  !! increments. This factor covers 90 % of the errors of random models (tests/accuracy/score_increments.py).
  real(wp), parameter :: safety = 4.0_wp

  !> Fewer increments than `few` are compared with twice as many, and `more` additional ones.
  integer, parameter :: few = 10, more = 4

  !> Figures at the end of an increment.
  type :: increment_record
    real(wp) :: load_factor = 0.0_wp    !! part of the loads of the load case
    integer :: iterations = 0           !! solves up to here
    integer :: touching = 0             !! pairs in contact
    integer :: yielded = 0              !! elements with plastic strain
    real(wp) :: pressure = -1.0_wp      !! the largest; negative if no boundary belongs to the pairs [stress]
    real(wp) :: half_width = -1.0_wp    !! of the zone with this pressure; negative: unknown [length]
    real(wp) :: force = 0.0_wp          !! sum of the contact forces [force]
    real(wp) :: sticks = -1.0_wp        !! largest half-width that sticks; negative: unknown [length]
    real(wp) :: friction_force = 0.0_wp            !! sum of the friction forces' magnitudes [force]
    integer :: sticking = -1, slipping = -1        !! pairs; negative: no friction
    real(wp) :: friction_work = 0.0_wp             !! in this increment, by the trapezoidal rule [energy]
    real(wp) :: dissipated = 0.0_wp                !! since the start of the load case, also by yielding
    real(wp), allocatable :: approach(:)    !! of each rigid-body mode [length] [modes]
    ! At the end of a load case only:
    real(wp), allocatable :: stress(:, :)   !! [stress] [4, elements]
    real(wp), allocatable :: friction(:)    !! friction forces [force] [tangential rows]
    type(answer_type), allocatable :: state !! for a drawing, if requested
  end type increment_record

  !> Errors by the size of the increments; negative: unknown.
  type :: increment_errors
    real(wp) :: pressure = -1.0_wp, half_width = -1.0_wp   !! [stress], [length]
    real(wp), allocatable :: approach(:)                   !! [length] [modes]
    real(wp) :: stress = -1.0_wp         !! largest error of a stress component of an element [stress]
    real(wp) :: friction = -1.0_wp       !! largest error of a friction force [force]
    real(wp) :: sticks = -1.0_wp         !! of the half-width that sticks [length]
  end type increment_errors

contains

  !> Collect the figures of a state.
  pure type(increment_record) function increment_of(answer, iterations, sliding) result(record)
    class(answer_type), intent(in) :: answer
    integer, intent(in) :: iterations
    integer, intent(in) :: sliding(:)   !! pair of each tangential row
    integer :: z

    record%load_factor = answer%load_factor
    record%iterations = iterations
    record%touching = count(answer%contact%touching)
    record%yielded = count(answer%plastic)
    if (size(answer%contact%force) > 0) record%pressure = answer%largest_pressure()
    record%force = sum(answer%contact%force)
    record%approach = answer%contact%approach
    if (allocated(answer%stick_zones)) record%sticks = maxval([answer%stick_zones%half_width, -1.0_wp])
    if (size(sliding) > 0) then
      record%friction_force = sum(abs(answer%contact%friction_force))
      record%sticking = count(answer%friction_states(sliding) == pair_sticks)
      record%slipping = count(answer%friction_states(sliding) == pair_slips)
    end if
    if (size(answer%zones) == 0) return
    z = maxloc(answer%zones%max_pressure, dim=1)
    record%half_width = answer%zones(z)%half_width
  end function increment_of

  !> Copy an answer without its data at the integration points.
  pure type(answer_type) function state_to_draw(answer) result(state)
    class(answer_type), intent(in) :: answer

    state = answer
    if (allocated(state%point)) deallocate (state%point)
    deallocate (state%strain, state%point_stress, state%deformation)
    where (.not. state%contact%touching .and. state%pressure > 0.0_wp) state%pressure = -1.0_wp
  end function state_to_draw

  !> Number of increments of the run to compare with: half as many. Errors of few increments decrease more
  !! slowly than their size, so they are compared with more.
  elemental integer function other_number(increments) result(other)
    integer, intent(in) :: increments

    other = merge(2*increments + more, (increments + 1)/2, increments < few)
  end function other_number

  !> Estimate the errors of the figures at the end of a load case.
  pure type(increment_errors) function errors_of_increments(found, other, increments, others) result(errors)
    type(increment_record), intent(in) :: found, other   !! of both runs
    integer, intent(in) :: increments, others            !! their number of increments
    real(wp) :: factor

    factor = safety*real(others, wp)/abs(increments - others)
    if (min(found%pressure, other%pressure) >= 0.0_wp) &
      errors%pressure = factor*abs(found%pressure - other%pressure)
    if (min(found%half_width, other%half_width) > 0.0_wp) &
      errors%half_width = factor*abs(found%half_width - other%half_width)
    errors%approach = factor*abs(found%approach - other%approach)
    errors%stress = factor*maxval(abs(found%stress - other%stress))
    if (min(found%sticks, other%sticks) > 0.0_wp) errors%sticks = factor*abs(found%sticks - other%sticks)
    if (.not. allocated(found%friction)) return
    if (size(found%friction) == size(other%friction)) &
      errors%friction = factor*maxval(abs(found%friction - other%friction))
  end function errors_of_increments
end module epcont_result_increment
