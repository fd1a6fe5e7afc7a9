!> How far a stopped iteration still is from where it goes.
module epcont_result_iteration_error
  use epcont_base_kinds, only: wp
  use epcont_plasticity_iteration, only: iteration_record, rounding
  implicit none
  private
  public :: iteration_error, estimate_iteration_error

  !> Relative errors; negative: the changes do not get smaller, so that nothing is known.
  type :: iteration_error
    real(wp) :: displacement = 0.0_wp   !! of the largest displacement
    real(wp) :: force = 0.0_wp          !! of the largest contact force
  end type iteration_error

contains

  !> From the changes of the last load step.
  pure function estimate_iteration_error(history) result(error)
    type(iteration_record), intent(in) :: history(:)
    type(iteration_error) :: error
    integer :: n, m

    n = size(history)
    if (n == 0) return
    m = history(n)%iteration
    if (m < 2) return
    error%displacement = still_to_come(history(n - m + 1:n)%change)
    error%force = still_to_come(history(n - m + 1:n)%force_change)
    if (history(n)%residual > rounding) return
    ! What changes now is rounding, of that size.
    if (error%displacement < 0.0_wp) error%displacement = history(n)%change
    if (error%force < 0.0_wp) error%force = history(n)%force_change
  end function estimate_iteration_error

  !> Sum of the changes to come, if each is the last one times the rate observed: a change of 1 % in a slow iteration
  !! leaves much more than 1 %. The rate is the larger of that of the last step and of the last two.
  pure real(wp) function still_to_come(change)
    real(wp), intent(in) :: change(:)   !! at least two
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
    still_to_come = change(n)*rate/(1.0_wp - rate)
  end function still_to_come
end module epcont_result_iteration_error
