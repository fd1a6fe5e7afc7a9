!> The listing of the plastic iteration.
module epcont_report_iterations
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, text_of
  use epcont_model_model, only: model_type
  use epcont_report_file, only: text_file
  use epcont_report_layout, only: figure, heading, right
  use epcont_report_number, only: column_number, rounding_number
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: list_iterations, list_iteration_error

  !> Stresses so many times theirs off the curve have run away: how far, rounding decides.
  real(wp), parameter :: run_away = 10.0_wp

contains

  !> One line a solve, and what is to be known of the yielding.
  subroutine list_iterations(file, model, answer)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    integer :: k

    if (.not. any([(model%can_yield(k), k=1, model%elements)])) return
    call heading(file, 'ITERATIONS')
    call file%line(' iteration  load factor       change  off the curve  touching   yielded    pivots')
    do k = 1, size(answer%history)
      associate (now => answer%history(k))
        call file%line(right(text_of(now%iteration), 10)//column_number(now%load_factor, 1.0_wp)// &
                       right(rounding_number(now%change), 13)//right(curve_text(now%residual), 15)// &
                       right(text_of(now%touching), 10)//right(text_of(now%yielded), 10)//right(text_of(now%pivots), 10))
      end associate
    end do
    call file%line('')
    if (answer%load_steps > answer%asked_load_steps) &
      call file%line('  in '//plural(answer%asked_load_steps, 'load step')//' no answer was found; tried again in '// &
                     text_of(answer%load_steps)//' (AUTO)')
    if (any(answer%history%by_tangent)) &
      call file%line('  the last step is one by the tangent: its change is what the others have left')
    call file%line('  '//plural(count(answer%plastic), 'element')//' of '//text_of(model%elements)//' beyond the yield point')
    if (any(answer%beyond)) &
      call file%line('  beyond the last point of its table, whose last slope goes on: '// &
                     named(model, count(answer%beyond), findloc(answer%beyond, .true., dim=1)))
    if (answer%unloaded > 0) &
      call file%line('  the strain fell as the load grew, and went back along the curve (elastic unloading is not modelled): '// &
                     named(model, answer%unloaded, answer%first_unloaded))
  end subroutine list_iterations

  !> Distance of stresses from their curve.
  pure function curve_text(residual) result(text)
    real(wp), intent(in) :: residual
    character(len=:), allocatable :: text

    text = '> '//text_of(nint(run_away))
    if (residual <= run_away) text = rounding_number(residual)
  end function curve_text

  !> A number of elements, and one of them.
  pure function named(model, count, first) result(text)
    type(model_type), intent(in) :: model
    integer, intent(in) :: count, first
    character(len=:), allocatable :: text

    text = 'element '//text_of(model%element_id(first))
    if (count > 1) text = text//' and '//text_of(count - 1)//' more'
  end function named

  !> What stopping has left.
  subroutine list_iteration_error(file, model, answer)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer

    associate (last => answer%history(findloc(answer%history%load_factor, answer%load_factor, dim=1, back=.true.)))
      call figure(file, 'iteration error, of the largest displacement', right(error_text(last%error), 13))
      if (model%pairs > 0) &
        call figure(file, 'iteration error, of the largest force', right(error_text(last%force_error), 13))
    end associate
  end subroutine list_iteration_error

  pure function error_text(error) result(text)
    real(wp), intent(in) :: error
    character(len=:), allocatable :: text

    text = 'unknown'
    if (error >= 0.0_wp) text = rounding_number(error)
  end function error_text
end module epcont_report_iterations
