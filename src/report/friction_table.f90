!> Table of the friction of pairs: forces, tractions and slip.
module epcont_report_friction_table
  use epcont_base_kinds, only: wp
  use epcont_report_columns, only: column, force, length, number, state, stress, table_type, &
      unknown, whole
  use epcont_report_run, only: run_results
  use epcont_result_answer, only: pair_open, pair_slips
  implicit none
  private
  public :: friction_columns, put_friction

  type(column), parameter :: friction_columns(*) = [ &
    column(whole, 'pair', '', 'id, as in the table of pairs', width=10), &
    column(number, 'x', length, 'undeformed GRID B'), &
    column(number, 'y'), &
    column(number, 'friction', '', 'coefficient', 'mu', 8), &
    column(number, 'force', force, 'of contact'), &
    column(number, 'friction_force', force, 'on B, along the tangent: x = ny, y = -nx', &
           'friction force', 15), &
    column(number, 'limit', force, 'mu times the contact force', width=0), &
    column(number, 'shear', stress, 'traction; empty if no boundary belongs to the pair'), &
    column(number, 'slip', length, 'of B relative to A in this increment, along the tangent'), &
    column(number, 'slid', length, 'the same since the start of the loads', width=0), &
    column(state, 'state', '', 'sticks, slips or open', width=7)]

contains

  !> Write a row for each pair with friction.
  subroutine put_friction(run, table)
    type(run_results), intent(in) :: run
    type(table_type), intent(inout) :: table
    real(wp) :: shear(size(run%model%contact%sliding))
    character(len=6), parameter :: does(pair_open:pair_slips) = ['open  ', 'sticks', 'slips ']
    integer :: how(size(run%model%contact%sliding)), j

    associate (contact => run%answer%contact, rows => run%model%contact, &
               travel => run%model%contact%slides(run%answer%displacement))
      call table%begin('FRICTION', friction_columns, &
                       [0.0_wp, 0.0_wp, 0.0_wp, spread(maxval(contact%force), 1, 3), &
                        maxval(run%answer%pressure), spread(maxval(abs(run%answer%displacement)), 1, 2)])
      shear = run%answer%shear(rows%sliding)
      where (run%answer%pressure(rows%sliding) < 0.0_wp) shear = unknown
      how = run%answer%friction_states(rows%sliding)
      do j = 1, size(rows%sliding)
        associate (k => rows%sliding(j))
          call table%row([rows%pair_id(k)], [run%model%mesh%x(:, rows%pair_node(2, k)), rows%friction(k), &
                         contact%force(k), contact%friction_force(j), rows%friction(k)*contact%force(k), &
                         shear(j), contact%slip(j), travel(j)], [does(how(j))])
        end associate
      end do
    end associate
  end subroutine put_friction
end module epcont_report_friction_table
