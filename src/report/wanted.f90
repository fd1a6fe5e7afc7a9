!> Whether the contact pressures are as exact as PARAM ACCURACY wants them.
module epcont_report_wanted
  use epcont_accuracy_accuracy, only: accuracy_type
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real
  use epcont_model_model, only: model_type
  use epcont_report_file, only: text_file
  use epcont_report_layout, only: figure, right
  use epcont_report_number, only: estimate_number
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: list_wanted

contains

  !> The wish, and what stands in its way: PARAM ACCURACY sets the solution, but the mesh has the last word.
  subroutine list_wanted(file, model, answer, accuracy)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    type(accuracy_type), intent(in) :: accuracy
    real(wp) :: error

    call figure(file, 'wanted error of contact pressures', right(short_real(model%controls%accuracy), 13))
    if (accuracy%pressure_unbounded) then
      call file%line('    not to be had: the largest pressure is unbounded: it grows with every finer mesh')
    else if (accuracy%max_pressure < 0.0_wp .or. .not. any(answer%contact%force > 0.0_wp)) then
      call file%line('    (of the mesh''s error nothing is known: no pressure, or too few pairs in contact)')
    else
      error = accuracy%max_pressure/maxval(answer%pressure)
      if (error > model%controls%accuracy) then
        call file%line('    not reached: the mesh, not the dial, is the limit: its error is estimated at '// &
                       estimate_number(error)//'; refine the elements named above')
      else
        call file%line('    reached: the error of the mesh is estimated at '//estimate_number(error))
      end if
    end if
  end subroutine list_wanted
end module epcont_report_wanted
