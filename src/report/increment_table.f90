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
    column(number, 'friction_force', force, 'sum of the magnitudes; empty without friction', width=0), &
    column(whole, 'pairs_sticking', '', 'numbers of pairs with friction; empty without', width=0), &
    column(whole, 'pairs_slipping', width=0), &
    column(number, 'friction_work', energy, 'of friction in the increment, by trapezoids', width=0), &
    column(number, 'dissipated', energy, 'since the start of the load case, also by yielding', width=0)]

  !> Friction of the increments, in the listing.
  type(column), parameter :: friction_columns(*) = [ &
    column(whole, head='increment', width=10), column(number, head='load factor'), &
    column(number, head='friction force', width=15), column(whole, head='stick', width=8), &
    column(whole, head='slip', width=8), column(number, head='friction work', width=15), &
    column(number, head='dissipated', width=15)]

contains

  !> Write a row for each increment; in the listing, friction has a table of its own.
  subroutine put_increments(run, table)
    type(run_results), intent(in) :: run
    type(table_type), intent(inout) :: table
    real(wp) :: approach, rubbing(2)
    real(wp) :: most   ! friction [force]
    integer :: k

    call table%begin('INCREMENTS', increment_columns, &
                     [1.0_wp, maxval(run%increment%pressure), maxval(run%increment%half_width), &
                      maxval([abs(run%answer%contact%approach), 0.0_wp]), maxval(run%increment%force)])
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
    if (.not. (table%listed .and. run%model%contact%has_friction())) return
    most = maxval(run%increment%force)*maxval(run%model%contact%friction)
    call table%begin('FRICTION OF THE INCREMENTS  (work: in each, by trapezoids; dissipated: since the '// &
                     'first, also by yielding)', friction_columns, &
                     [1.0_wp, most, spread(most*maxval(abs(run%answer%displacement)), 1, 2)])
    do k = 1, size(run%increment)
      associate (now => run%increment(k))
        call table%row([k, now%sticking, now%slipping], [now%load_factor, now%friction_force, &
                                                         now%friction_work, now%dissipated])
      end associate
    end do
  end subroutine put_increments
end module epcont_report_increment_table
