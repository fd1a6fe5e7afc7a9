!> What --plan says of a run to come, beside the plan.
module epcont_app_forecast_text
  use epcont_app_progress_display, only: duration
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: formatted, plural
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_plan_run_time, only: foresee, run_time
  use epcont_report_names, only: when
  use epcont_report_plan_text, only: megabytes
  implicit none
  private
  public :: forecast_text, rough_time

contains

  !> Time of the processor, the solves that this supposes where a scene may take more or fewer, and memory.
  pure function forecast_text(scene, cases, patterns, bytes, rows, begun, rate) result(text)
    type(planned_scene), intent(in) :: scene   !! what is to be solved
    integer, intent(in) :: cases, patterns     !! of loads, of these those that share no factors
    integer(i8), intent(in) :: bytes           !! of memory at the peak, on one thread
    integer, intent(in) :: rows                !! of tables that would be written
    real(wp), intent(in) :: begun              !! time of the processor so far [s]
    real(wp), intent(in) :: rate               !! of products of matrices [1/s]
    character(len=:), allocatable :: text
    type(run_time) :: time

    time = foresee(scene%iteration, scene%expected, rows, begun, rate)
    time%cases = cases
    time%patterns = patterns
    text = 'about '//rough_time(time%whole())//' of processor time'// &
           when(scene%iteration%yields, ' ('//plural(time%solves, 'solve')// &
                when(cases > 1, ' a load case')//')')//', '// &
           megabytes(bytes)
  end function forecast_text

  !> A time in one digit to three: forecasts are not better.
  pure function rough_time(seconds) result(text)
    real(wp), intent(in) :: seconds   !! a time [s]
    character(len=:), allocatable :: text

    if (seconds < 0.0995_wp) then
      text = formatted('(f6.3)', seconds)//' s'
    else if (seconds < 0.995_wp) then
      text = formatted('(f5.2)', seconds)//' s'
    else
      text = duration(seconds)
    end if
  end function rough_time
end module epcont_app_forecast_text
