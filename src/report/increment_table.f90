!> Table of the increments of a load case: figures at their ends, and energies.
module epcont_report_increment_table
  use epcont_base_kinds, only: wp
  use epcont_report_columns, only: column, energy, force, known, length, number, stress, table_type, &
      unknown, whole
  use epcont_report_run, only: run_results
  implicit none
  private
  public :: increment_columns, put_increments

  type(column), parameter :: increment_columns(*) = [ &
    column(whole, 'increment', '', 'counted from the start of the load case', width=10), &
    column(number, 'load_factor', '', 'part of the way from the loads before to those of the load case', &
           'load factor'), &
    column(known, 'max_pressure', stress, 'empty if there is no boundary', 'p_max'), &
    column(known, 'half_width', length, 'of the zone with that pressure; empty if unknown', 'half-width'), &
    column(number, 'approach', length, 'the first one in the summary'), &
    column(number, 'total_contact_force', force, 'sum over the pairs', 'total force'), &
    column(whole, 'pairs_in_contact', '', 'their number', 'in contact', 12), &
    column(whole, 'plastic_elements', '', 'elements that have yielded', 'yielded', 10), &
    column(whole, 'iterations', '', 'solves from the start of the load case', 'solves', 9), &
    column(number, 'friction_force', force, 'sum of the magnitudes; empty without friction', &
           'friction force', 15), &
    column(whole, 'pairs_sticking', '', 'numbers of pairs with friction; empty without', 'stick', 8), &
    column(whole, 'pairs_slipping', '', '', 'slip', 8), &
    column(number, 'friction_work', energy, 'of friction in the increment, by trapezoids', &
           'friction work', 15), &
    column(number, 'dissipated', energy, 'since the start of the load case, also by yielding', width=15)]

  !> Columns without friction, and first column of friction.
  integer, parameter :: plain(*) = [3, 4, 5, 6, 7, 8, 9], from_friction = 10

contains

  !> Write a row for each increment; in the listing, friction has a table of its own.
  subroutine put_increments(run, table)
    type(run_results), intent(in) :: run
    type(table_type), intent(inout) :: table
    type(column) :: columns(size(increment_columns))

    columns = increment_columns
    columns(from_friction:)%width = 0
    call put_rows('INCREMENTS', columns, run, table)
    if (.not. (table%listed .and. run%model%contact%has_friction())) return
    columns = increment_columns
    columns(plain)%width = 0
    call put_rows('FRICTION OF THE INCREMENTS  (work: in each, by trapezoids; dissipated: since the '// &
                  'first, also by yielding)', columns, run, table)
  end subroutine put_increments

  !> Write a row for each increment.
  subroutine put_rows(title, columns, run, table)
    character(len=*), intent(in) :: title
    type(column), intent(in) :: columns(:)   !! those that the listing leaves out have no width
    type(run_results), intent(in) :: run
    type(table_type), intent(inout) :: table
    real(wp) :: approach, rubbing(2)
    real(wp) :: most   ! friction [force]
    integer :: k

    most = maxval([run%increment%force, 0.0_wp])*maxval([run%model%contact%friction, 0.0_wp])
    call table%begin(title, columns, &
                     [1.0_wp, maxval(run%increment%pressure), maxval(run%increment%half_width), &
                      maxval([abs(run%answer%contact%approach), 0.0_wp]), maxval(run%increment%force), &
                      most, spread(most*maxval(abs(run%answer%displacement)), 1, 2)])
    do k = 1, size(run%increment)
      associate (now => run%increment(k))
        approach = unknown
        if (size(now%approach) > 0) approach = now%approach(1)
        rubbing = [now%friction_force, now%friction_work]
        if (now%sticking < 0) rubbing = unknown
        call table%row([k, now%touching, now%yielded, now%iterations, now%sticking, now%slipping], &
                       [now%load_factor, now%pressure, now%half_width, approach, now%force, &
                        rubbing, now%dissipated])
      end associate
    end do
  end subroutine put_rows
end module epcont_report_increment_table
