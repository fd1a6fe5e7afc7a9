!> The precision of the factors, where it is not double: what the plan and the listing say of it.
module epcont_report_precision
  use epcont_base_text, only: short_real
  use epcont_model_controls, only: precision_double, precision_name, precision_single
  use epcont_report_file, only: text_file
  use epcont_report_layout, only: figure, newline, right
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: precision_text, list_precision

contains

  !> For the plan.
  pure function precision_text(precision) result(text)
    integer, intent(in) :: precision
    character(len=:), allocatable :: text

    text = ''
    if (precision == precision_double) return
    text = '  factors in single precision, refined to double'
    if (precision == precision_single) text = '  factors in single precision, not refined'
    text = text//' ('//trim(precision_name(precision))//'); where that fails, all is solved anew in double'//newline
  end function precision_text

  !> For the listing: what single precision has left, and why it was given up.
  subroutine list_precision(file, answer)
    type(text_file), intent(in) :: file
    type(answer_type), intent(in) :: answer

    if (answer%precision == precision_single) &
      call figure(file, 'error that single precision leaves', right(short_real(answer%rounding_error), 13))
    if (answer%precision == answer%asked_precision) return
    if (answer%asked_precision == precision_single) then
      call file%line('    (factors in double: in single precision they left an error of more than '// &
                     short_real(answer%largest_rounding_error)//', or no answer)')
    else
      call file%line('    (factors in double: in single precision there was no answer that refinement could reach)')
    end if
  end subroutine list_precision
end module epcont_report_precision
