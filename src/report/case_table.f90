!> Table of the load cases of a deck: the outcome of each in one row.
module epcont_report_case_table
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_report_columns, only: column, estimate, estimate_number, known, length, number, &
      part, rounding, stress, table_type, unknown, whole, word
  use epcont_messages_names, only: when
  use epcont_messages_outcome, only: limit_of_pressure, unbounded
  use epcont_report_run, only: run_results
  implicit none
  private
  public :: accuracy_text, case_row, put_cases, put_worst_case, row_of_case

  !> Outcome of a load case. Numbers are those of its summary; negative if unknown.
  type :: case_row
    integer :: subcase = 0                     !! its number
    logical :: has_answer = .false.            !! false: only the status is known
    character(len=20) :: status = ''           !! in one word
    character(len=16) :: limit = ''            !! bounded, singular ... (largest pressure)
    integer :: touching = -1, plastic = -1     !! pairs, elements
    real(wp) :: pressure = -1.0_wp, pressure_error = -1.0_wp   !! largest [stress]
    real(wp) :: half_width = -1.0_wp           !! of the zone with this pressure [length]
    real(wp) :: approach = unknown             !! of the first rigid-body mode [length]
    real(wp) :: residual = unknown             !! equilibrium residual of the certificate, relative
    real(wp) :: energy_norm = unknown          !! mesh error, relative
  end type case_row

  type(column), parameter, public :: case_columns(*) = [ &
    column(whole, 'subcase', '', 'its number', 'SUBCASE', 10), &
    column(word, 'status', '', 'its outcome', width=20), &
    column(whole, 'pairs_in_contact', '', 'pairs in contact', 'in contact', 11), &
    column(whole, 'plastic_elements', '', 'yielded elements', 'yielded', 9), &
    column(known, 'max_pressure', stress, 'empty if there is no boundary or no answer', 'p_max'), &
    column(estimate, 'mesh_error_max_pressure', stress, 'empty if unknown', 'p_max error', 13), &
    column(word, 'max_pressure_is', '', 'bounded, singular, mesh too coarse, no contact', 'p_max is', 17), &
    column(known, 'half_width', length, 'of the zone with that pressure; empty if unknown', 'half-width'), &
    column(number, 'approach', length, 'the first one in the summary'), &
    column(rounding, 'equilibrium_residual', '', 'of the certificate, relative', 'residual', 11), &
    column(part, 'mesh_error_energy_norm', '', 'relative', 'energy error', 14)]

contains

  !> Collect the outcome of the current load case.
  pure type(case_row) function row_of_case(run) result(row)
    type(run_results), intent(in) :: run   !! run and its results

    row%subcase = run%deck%subcase(run%case)%id
    row%status = run%outcome%word
    row%has_answer = run%outcome%has_answer
    if (.not. row%has_answer) return
    row%touching = count(run%answer%contact%touching)
    row%plastic = count(run%answer%plastic)
    if (run%model%contact%pairs > 0) then
      row%pressure = run%answer%largest_pressure()
      row%pressure_error = run%accuracy%max_pressure
      row%limit = limit_of_pressure(run)
    end if
    if (run%accuracy%leading > 0) row%half_width = run%answer%zones(run%accuracy%leading)%half_width
    if (run%motions%count > 0) row%approach = run%answer%contact%approach(1)
    row%residual = run%certificate%equilibrium
    row%energy_norm = run%accuracy%energy_norm
  end function row_of_case

  !> Write the table.
  subroutine put_cases(row, table)
    type(case_row), intent(in) :: row(:)       !! of all load cases
    type(table_type), intent(inout) :: table   !! the listing, or a file
    integer :: k

    table%mark = ''
    call table%begin('LOAD CASES', case_columns, &
                     [maxval(row%pressure), maxval(row%pressure), maxval(row%half_width), &
                      maxval(abs(row%approach), mask=row%approach > unknown), 1.0_wp, 1.0_wp])
    do k = 1, size(row)
      call table%row([row(k)%subcase, row(k)%touching, row(k)%plastic], &
                     [row(k)%pressure, row(k)%pressure_error, row(k)%half_width, row(k)%approach, &
                      row(k)%residual, row(k)%energy_norm], &
                     [character(len=20) :: row(k)%status, row(k)%limit])
    end do
  end subroutine put_cases

  !> Error of the largest pressure, relative; negative if there is no pressure, huge if the error is unknown.
  elemental real(wp) function relative_error(row) result(error)
    type(case_row), intent(in) :: row   !! of a load case

    error = -1.0_wp
    if (row%pressure <= 0.0_wp) return
    error = huge(error)
    if (row%pressure_error >= 0.0_wp .and. row%limit /= unbounded) error = row%pressure_error/row%pressure
  end function relative_error

  !> Say whether a load case has the accuracy of PARAM ACCURACY.
  pure function accuracy_text(row, wanted) result(text)
    type(case_row), intent(in) :: row       !! of the load case
    real(wp), intent(in) :: wanted          !! relative
    character(len=:), allocatable :: text

    if (row%pressure <= 0.0_wp) then
      text = 'unknown: no pair has a pressure'
    else if (row%limit == unbounded) then
      text = 'not possible: the largest pressure is singular'
    else if (row%pressure_error < 0.0_wp) then
      text = 'unknown: too few pairs are in contact'
    else
      text = when(relative_error(row) > wanted, 'not reached', 'reached')// &
             ': the estimated mesh error is '//estimate_number(relative_error(row))
    end if
  end function accuracy_text

  !> Name the load case with the largest relative error.
  subroutine put_worst_case(row, wanted, listing)
    type(case_row), intent(in) :: row(:)       !! of all load cases
    real(wp), intent(in) :: wanted             !! PARAM ACCURACY, relative; 0 if not set
    type(table_type), intent(inout) :: listing
    integer :: worst

    if (wanted <= 0.0_wp) return
    worst = maxloc(relative_error(row), dim=1)
    call listing%line('')
    call listing%say('wanted error of contact pressures '//short_real(wanted)//', worst in SUBCASE '// &
                     text_of(row(worst)%subcase)//': '//accuracy_text(row(worst), wanted))
  end subroutine put_worst_case
end module epcont_report_case_table
