!> Time of each stage of a run. A lap is the time since the previous one, so the laps add up to the run.
module epcont_system_stopwatch
  use epcont_base_kinds, only: i8, wp
  implicit none
  private
  public :: stopwatch

  !> Stages of a run, in order.
  integer, parameter, public :: &
    stage_reading = 1, &        !! lines, cards, fields
    stage_model = 2, &          !! checked cards, lines in contact
    stage_plan = 3, &           !! rigid-body modes, methods, memory
    stage_numbering = 4, &      !! of the equations
    stage_stiffness = 5, &      !! strain operator, changed materials
    stage_factor = 6, &         !! of the bodies, with their assembly
    stage_flexibility = 7, &
    stage_contact = 8, &        !! forces and gaps of the pairs
    stage_displacements = 9, &  !! under forces, with their strains
    stage_yielding = 10, &      !! work of the iteration between two solves
    stage_stresses = 11, &      !! of the answer, with pressures
    stage_certificate = 12, &
    stage_accuracy = 13, &      !! with the condition number of the stiffness
    stage_writing = 14, &
    stages = 14

  character(len=13), parameter, public :: stage_name(stages) = [character(len=13) :: &
    'reading', 'model', 'plan', 'numbering', 'stiffness', 'factor', 'flexibility', 'contact', &
    'displacements', 'yielding', 'stresses', 'certificate', 'accuracy', 'writing']

  type :: stopwatch
    !> Wall-clock time; processor time of all threads, with that of the system [s] [2, stages]
    real(wp) :: spent(2, stages) = 0.0_wp
    real(wp), private :: lap_began(2) = 0.0_wp   !! of both times [s]
  contains
    procedure :: start
    procedure :: lap
    procedure :: elapsed
  end type stopwatch

contains

  !> Start the first lap.
  subroutine start(self)
    class(stopwatch), intent(inout) :: self

    self%spent = 0.0_wp
    self%lap_began = now()
  end subroutine start

  !> Assign the time since the previous lap to `stage`.
  subroutine lap(self, stage)
    class(stopwatch), intent(inout) :: self
    integer, intent(in) :: stage   !! one of the stages above
    real(wp) :: ended(2)

    ended = now()
    self%spent(:, stage) = self%spent(:, stage) + (ended - self%lap_began)
    self%lap_began = ended
  end subroutine lap

  !> Time up to the last lap [s].
  pure real(wp) function elapsed(self)
    class(stopwatch), intent(in) :: self

    elapsed = sum(self%spent(1, :))
  end function elapsed

  function now() result(seconds)
    real(wp) :: seconds(2)
    integer(i8) :: count, rate

    call system_clock(count, rate)
    seconds(1) = real(count, wp)/real(max(rate, 1_i8), wp)
    call cpu_time(seconds(2))
  end function now
end module epcont_system_stopwatch
