!> How far a stopped iteration still is from where it goes.
module epcont_result_iteration_error
  use epcont_base_kinds, only: wp
  use epcont_plasticity_iteration, only: rounding
  use epcont_plasticity_onlooker, only: iteration_record
  implicit none
  private
  public :: iteration_error, estimate_iteration_error

  !> Relative errors; negative: the changes do not get smaller, so that nothing is known.
  type :: iteration_error
    real(wp) :: displacement = 0.0_wp   !! of the largest displacement
    real(wp) :: force = 0.0_wp          !! of the largest contact force
  end type iteration_error

contains

  !> From the changes at one load.
  pure function estimate_iteration_error(history, load_factor) result(error)
    type(iteration_record), intent(in) :: history(:)
    real(wp), intent(in) :: load_factor
    type(iteration_error) :: error
    type(iteration_record), allocatable :: step(:)
    real(wp), allocatable :: change(:)
    integer :: n

    step = pack(history, history%load_factor == load_factor)
    n = size(step)
    if (n < 2) return
    change = step%change
    error%displacement = still_to_come(change, step(n)%residual)
    change = step%force_change
    error%force = still_to_come(change, step(n)%residual)
    if (step(n)%residual > rounding) return
    ! What changes now is rounding, of that size.
    if (error%displacement < 0.0_wp) error%displacement = step(n)%change
    if (error%force < 0.0_wp) error%force = step(n)%force_change
  end function estimate_iteration_error

  !> Sum of the changes to come, if each is the last one times the rate observed: a change of 1 % in a slow iteration
  !! leaves much more than 1 %. The rate is the larger of that of the last step and of the last two. A mixture may fall into
  !! place faster than it has come near: as long as stresses are off their curves, no less is left than the last change.
  pure real(wp) function still_to_come(change, residual)
    real(wp), intent(in) :: change(:)   !! at least two
    real(wp), intent(in) :: residual    !! of the last step
    real(wp) :: rate
    integer :: n

    n = size(change)
    still_to_come = 0.0_wp
    if (change(n) <= 0.0_wp) return
    still_to_come = -1.0_wp
    if (change(n) >= change(n - 1)) return
    rate = change(n)/change(n - 1)
    if (n > 2) then
      if (change(n) >= change(n - 2)) return
      rate = max(rate, sqrt(change(n)/change(n - 2)))
    end if
    still_to_come = max(change(n)*rate/(1.0_wp - rate), min(change(n), residual))
  end function still_to_come
end module epcont_result_iteration_error
