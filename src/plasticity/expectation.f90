!> How long a run will take in all: by the plan's forecast before the first solve, by the clock and by how
!> fast the iteration comes to its end after it.
module epcont_plasticity_expectation
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: method_newton
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_run_time, only: run_time
  use epcont_plasticity_observer, only: iteration_record
  implicit none
  private
  public :: expectation_type, new_expectation, solves_to_come

  !> How much longer each step of NEWTON is than the one before, in digits. All decks in input that yield, and
  !! others, from the second solve on: 92 % of the numbers of solves expected are right within a factor 1.5;
  !! of the other methods, whose steps are even, 77 %. The order that the last two steps show serves worse (70
  !! %): NEWTON is slow before it is fast.
  real(wp), parameter :: newton_order = 1.5_wp
  !> A tolerance up to this is none, as of a scene that cannot yield.
  real(wp), parameter :: least = 1.0e-30_wp
  !> Logarithm of a distance that is 1 but for rounding.
  real(wp), parameter :: no_distance = 1.0e-6_wp

  type :: expectation_type
    real(wp) :: seconds = -1.0_wp            !! of the whole run; negative: unknown [s]
    real(wp) :: first_solve = 0.0_wp         !! when it will be done [s]
    type(iteration_plan), private :: plan
    integer, private :: most_iterations = 1
    real(wp), private :: finish = 0.0_wp     !! what comes after the last solve [s]
    real(wp), private :: solved_at = 0.0_wp  !! when the last one was done [s]
    integer, private :: solves = 0           !! at loads that are behind
    integer, private :: load_steps = 0       !! of these
    !> Of each solve at this load from the end of the iteration: at 1 it is there
    real(wp), allocatable, private :: distance(:)
  contains
    procedure :: learn
  end type expectation_type

contains

  !> Before the first solve. With yielding it is not known how many solves there will be.
  pure function new_expectation(plan, most_iterations, time) result(expected)
    type(iteration_plan), intent(in) :: plan   !! how yielding is iterated
    integer, intent(in) :: most_iterations   !! at a load
    type(run_time), intent(in) :: time       !! its parts, as forecast
    type(expectation_type) :: expected

    expected = expectation_type(first_solve=time%begun + time%solve, plan=plan, finish=time%finish, &
                                most_iterations=most_iterations, solved_at=time%begun)
    if (.not. plan%yields) expected%seconds = expected%first_solve + time%finish
  end function new_expectation

  !> A solve was done at `seconds`; `over` if it was the last one at its load. The next will take as long as
  !! it did.
  pure subroutine learn(self, now, over, seconds)
    class(expectation_type), intent(inout) :: self
    type(iteration_record), intent(in) :: now   !! that solve
    logical, intent(in) :: over                 !! see above
    real(wp), intent(in) :: seconds             !! since the run began [s]
    integer :: left    ! solves at this load
    real(wp) :: each   ! solves at each load to come: as at those behind, or else as at this one

    if (now%iteration == 1) self%distance = [real(wp) ::]
    self%distance = [self%distance, max(now%change/max(self%plan%tolerance, least), &
        now%residual/max(self%plan%off_curve, least))]
    left = 0
    if (over) then
      self%solves = self%solves + now%iteration
      self%load_steps = self%load_steps + 1
    else
      left = solves_to_come(self%distance, merge(newton_order, 1.0_wp, self%plan%method == method_newton), &
                            self%most_iterations)
    end if
    self%seconds = -1.0_wp
    if (left >= 0) then
      each = real(size(self%distance) + left, wp)
      if (self%load_steps > 0) each = real(self%solves, wp)/self%load_steps
      each = each*max(0, self%plan%load_steps - self%load_steps - merge(0, 1, over))
      self%seconds = seconds + (seconds - self%solved_at)*(left + each) + self%finish
    end if
    self%solved_at = seconds
  end subroutine learn

  !> Solves to come at a load, if the logarithm of the distance from the end goes on to fall as it did in the
  !! last one, each time `order` times as far; negative where it does not fall.
  pure integer function solves_to_come(distance, order, most) result(solves)
    real(wp), intent(in) :: distance(:)   !! of each solve so far; at 1 the iteration is over
    real(wp), intent(in) :: order         !! of convergence
    integer, intent(in) :: most           !! iterations that are allowed
    real(wp) :: fall, left
    integer :: n

    n = size(distance)
    solves = -1
    if (n < 2) return
    if (distance(n) >= distance(n - 1)) return
    solves = 0
    if (distance(n) <= 1.0_wp) return
    left = log(distance(n))
    fall = log(distance(n - 1)) - left
    do while (left > no_distance .and. n + solves < most)
      fall = fall*order
      left = left - fall
      solves = solves + 1
    end do
  end function solves_to_come
end module epcont_plasticity_expectation
