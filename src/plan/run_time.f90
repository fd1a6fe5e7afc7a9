!> How long a run will take, as far as that can be told before its first solve.
!>
!> What reading, model and numbering have taken tells how fast this machine is with a mesh, and what else
!> grows with the mesh alone is a part of that. Operations of the factors count at the rate of products of
!> matrices, their entries at that of memory. Tested in `tests/extremes/test_time.py`.
module epcont_plan_run_time
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: method_inistr, method_newton
  use epcont_plan_forecast, only: forecast_type
  use epcont_plan_iteration_plan, only: iteration_plan
  implicit none
  private
  public :: run_time, foresee, likely_rate

  !> Operations of products of matrices in a second, where that was not measured: one core with AVX2.
  real(wp), parameter :: likely_rate = 3.0e10_wp
  !> Of the first contact problem, as often again: sets on the way to its answer, and the accuracy of that.
  real(wp), parameter :: contact_more = 2.0_wp
  !> What each entry of a factor takes beside operations: memory from the system, assembly, small fronts [s].
  real(wp), parameter :: of_entry = 4.0e-9_wp
  !> Over what comes before the first solve: what a solve takes beside its factors (strains, states,
  !! residual), and what comes after the last (stresses, certificate, accuracy, listing).
  !! Of a further load case of elastic bodies, whose first case has left what does not depend on loads, the
  !! latter is less.
  real(wp), parameter :: solve_part = 0.3_wp, end_part = 1.4_wp, case_part = 0.15_wp
  !> Files and process of a deck of no size, and a row of a table, in the listing and in its file [s].
  real(wp), parameter :: of_files = 1.5e-3_wp, of_row = 1.2e-5_wp
  !> Each two free motions: the rigid start, and what loads along the one do to the other (stacks of 100 to
  !! 3 000 bodies: .8 to 1.2 of the time). Where bodies bear each other in many ways, as in walls, more is
  !! there of what loads do, and the rigid start takes each three (walls of 30 to 900 bodies: .8 to 1.3) [s].
  real(wp), parameter :: of_motions = 6.0e-8_wp, of_looped = 5.5e-7_wp, of_start = 5.5e-10_wp
  !> Solves at each load: the middle of all decks of `input` and `tests` that yield, most of which take four
  !! to nine by NEWTON to 1E-8, and by SECANT to 1E-2; of initial stresses, where each is quick, more.
  integer, parameter :: usual_solves = 7, elastic_solves = 13
  !> TOL of these numbers, of the methods but NEWTON: they take as many again for as many digits more.
  real(wp), parameter :: usual_tolerance = 0.01_wp

  type :: run_time
    real(wp) :: begun = 0.0_wp    !! before the first solve [s]
    real(wp) :: solve = 0.0_wp    !! the first solve [s]
    real(wp) :: next = 0.0_wp     !! each other one, where something yields [s]
    real(wp) :: finish = 0.0_wp   !! what comes after the last [s]
    real(wp) :: further = 0.0_wp  !! the same of a further load case [s]
    integer :: solves = 1         !! as most scenes take
    integer :: cases = 1          !! of loads
    integer :: patterns = 1       !! of these, that share no factors
  contains
    procedure :: whole
  end type run_time

contains

  !> The parts of a run that has come to its first solve.
  pure function foresee(plan, expected, rows, begun, rate) result(time)
    type(iteration_plan), intent(in) :: plan       !! how yielding is iterated
    type(forecast_type), intent(in) :: expected    !! its work
    integer, intent(in) :: rows                    !! of tables that will be written
    real(wp), intent(in) :: begun                  !! what it has taken so far [s]
    real(wp), intent(in) :: rate                   !! of products of matrices [1/s]
    type(run_time) :: time
    real(wp) :: motions, looped, start   ! all; those that depend on many; the rigid start [s]

    motions = expected%motions
    looped = min(motions, 2.0_wp*expected%loops)
    start = of_start*motions**2*looped
    time%begun = begun
    time%solve = (expected%operations + contact_more*expected%contact)/rate + &
                 of_entry*expected%entries + solve_part*begun + start
    time%next = expected%operations_again/rate + of_entry*expected%entries_again + solve_part*begun + &
                merge(0.0_wp, start, plan%joined)
    time%finish = end_part*begun + of_files + of_row*rows + of_motions*motions**2 + of_looped*motions*looped
    time%further = time%finish
    if (.not. plan%yields) time%further = time%finish - (end_part - case_part)*begun
    if (plan%yields) time%solves = plan%load_steps*solves_at_a_load(plan)
  end function foresee

  !> Solves that most scenes take at each load.
  pure integer function solves_at_a_load(plan) result(solves)
    type(iteration_plan), intent(in) :: plan

    solves = merge(elastic_solves, usual_solves, plan%method == method_inistr)
    if (plan%method /= method_newton .and. plan%tolerance > 0.0_wp .and. plan%tolerance < usual_tolerance) &
      solves = nint(solves*log(plan%tolerance)/log(usual_tolerance))
  end function solves_at_a_load

  !> From begin to end [s].
  pure real(wp) function whole(self)
    class(run_time), intent(in) :: self

    whole = self%begun + self%patterns*(self%solve + self%finish) + &
            (self%solves*self%cases - self%patterns)*self%next + (self%cases - self%patterns)*self%further
  end function whole
end module epcont_plan_run_time
