!> The load cases of a deck side by side: what came of each, in a row.
module epcont_report_case_table
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_report_columns, only: column, columns_text, estimate, estimate_number, known, length, number, &
      part, rounding, stress, table_type, unknown, whole, word
  use epcont_messages_outcome, only: limit_of_pressure, unbounded
  use epcont_report_run, only: run_results
  implicit none
  private
  public :: case_row, case_columns_text, put_cases, put_worst_case, row_of_case

  !> What came of a case. Numbers are those of its summary; negative where they are not known.
  type :: case_row
    integer :: subcase = 0                     !! its number
    logical :: has_answer = .false.            !! else nothing below is known, but for its status
    character(len=20) :: status = ''           !! in a word
    character(len=12) :: limit = ''            !! what the largest pressure is
    integer :: touching = 0, plastic = 0       !! pairs, elements
    real(wp) :: pressure = -1.0_wp, pressure_error = -1.0_wp   !! the largest [stress]
    real(wp) :: half_width = -1.0_wp           !! of the zone that has it [length]
    real(wp) :: approach = unknown             !! of the first free motion [length]
    real(wp) :: residual = unknown             !! of the certificate's equilibrium, relative
    real(wp) :: energy_norm = unknown          !! error of the mesh, relative
  end type case_row

  type(column), parameter :: case_columns(*) = [ &
    column(whole, 'subcase', '', 'its number', 'SUBCASE', 10), &
    column(word, 'status', '', 'what came of it, in a word', width=20), &
    column(whole, 'pairs_in_contact', '', 'pairs that touch', 'touching', 10), &
    column(whole, 'plastic_elements', '', 'elements beyond the yield point', 'plastic', 9), &
    column(known, 'max_pressure', stress, 'empty: no boundary, or no answer', 'max pressure'), &
    column(estimate, 'mesh_error_max_pressure', stress, 'empty: not known', 'error', 10), &
    column(word, 'max_pressure_is', '', 'bounded, unbounded, not resolved, or no contact', 'it is', 13), &
    column(known, 'half_width', length, 'of the zone with that pressure; empty: not known', 'half-width'), &
    column(number, 'approach', length, 'of the first free motion'), &
    column(rounding, 'equilibrium_residual', '', 'of the certificate, relative', 'residual', 11), &
    column(part, 'mesh_error_energy_norm', '', 'relative', 'mesh error', 12)]

contains

  !> The columns in a sentence.
  pure function case_columns_text() result(text)
    character(len=:), allocatable :: text

    text = 'Columns: '//columns_text(case_columns)//'.'
  end function case_columns_text

  !> What came of the load case at hand.
  pure type(case_row) function row_of_case(run) result(row)
    type(run_results), intent(in) :: run   !! what is known of the run

    row%subcase = run%deck%subcase(run%case)%id
    row%status = run%outcome%word
    row%has_answer = run%outcome%has_answer
    if (.not. row%has_answer) return
    row%touching = count(run%answer%contact%touching)
    row%plastic = count(run%answer%plastic)
    if (run%model%pairs > 0) then
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
    type(case_row), intent(in) :: row(:)       !! of all cases
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

  !> What a wanted accuracy has come to: the case whose largest pressure is worth least.
  subroutine put_worst_case(row, accuracy, listing)
    type(case_row), intent(in) :: row(:)       !! of all cases
    real(wp), intent(in) :: accuracy           !! wanted, relative; 0.0: none is
    type(table_type), intent(inout) :: listing
    real(wp) :: error(size(row))               ! relative; negative: nothing presses
    character(len=:), allocatable :: found
    integer :: worst

    if (accuracy <= 0.0_wp) return
    error = -1.0_wp
    where (row%pressure > 0.0_wp) error = huge(error)
    where (row%pressure > 0.0_wp .and. row%pressure_error >= 0.0_wp .and. row%limit /= unbounded) &
      error = row%pressure_error/row%pressure
    worst = maxloc(error, dim=1)
    found = 'reached in all'
    if (error(worst) < 0.0_wp) then
      found = 'nothing presses'
    else if (error(worst) > accuracy) then
      found = 'worst in SUBCASE '//text_of(row(worst)%subcase)//': not '
      if (row(worst)%limit == unbounded) then
        found = found//'to be had, the largest pressure is unbounded'
      else if (error(worst) >= huge(error)) then
        found = found//'known, there are too few pairs in contact'
      else
        found = found//'reached, the error of the mesh is estimated at '//estimate_number(error(worst))
      end if
    end if
    call listing%line('')
    call listing%line('  wanted error of contact pressures '//short_real(accuracy)//', '//found)
  end subroutine put_worst_case
end module epcont_report_case_table
