!> The tables: columns and rows. They are written to files, to the listing, or to both.
module epcont_report_tables
  use epcont_accuracy_unit_loads, only: most_bodies
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_element_kinematics, only: directions
  use epcont_report_case_table, only: case_columns
  use epcont_report_columns, only: column, columns_text, estimate, force, known, length, no_number, number, &
      off_curve, rounding, state, stress, table_type, unknown, whole, word
  use epcont_messages_outcome, only: limit_of_pressure
  use epcont_report_friction_table, only: friction_columns, put_friction
  use epcont_report_increment_table, only: increment_columns, put_increments
  use epcont_report_run, only: run_results
  use epcont_result_stresses, only: place_of_point
  use epcont_result_zones, only: contact_zone
  implicit none
  private
  public :: columns_in, put_table

  type(column), parameter :: contact_columns(*) = [ &
    column(whole, 'pair', '', 'id of the CGAP; pairs of a BCONP have their own ids', width=10), &
    column(whole, 'ga', '', 'GRID A and GRID B', 'GA', 9), &
    column(whole, 'gb', '', '', 'GB', 9), &
    column(number, 'x', length, 'undeformed GRID B'), &
    column(number, 'y'), &
    column(number, 'nx', '', 'normal; contact pushes B along it', width=0), &
    column(number, 'ny', width=0), &
    column(number, 'initial_gap', length, 'undeformed; negative: initial overlap', width=0), &
    column(number, 'force', force, 'of contact'), &
    column(known, 'pressure', stress, 'empty if no boundary belongs to the pair'), &
    column(number, 'gap', length, 'under load'), &
    column(state, 'status', '', 'touching or open', 'state', 10), &
    column(word, width=1)]

  type(column), parameter :: zone_columns(*) = [ &
    column(whole, 'zone', '', 'number of the run of neighbouring pairs in contact', width=8), &
    column(whole, 'first_pair', '', 'pairs at its ends', 'first pair', 11), &
    column(whole, 'last_pair', '', '', 'last pair', 11), &
    column(number, 'force', force, 'sum over its pairs'), &
    column(known, 'max_pressure', stress, 'empty if no boundary belongs to its pairs', 'max pressure'), &
    column(number, 'half_width_last_pair', length, 'half of the distance between its last pairs', &
           'to last closed', 16), &
    column(known, 'half_width', length, 'half-length to zero pressure; empty if unknown', 'half-width'), &
    column(word, 'max_pressure_is', '', 'bounded, singular or mesh too coarse; empty if unknown', width=0)]

  type(column), parameter :: line_columns(*) = [ &
    column(word, head='BCONP', width=10), column(word, head='slave', width=9), &
    column(word, head='master', width=9), column(whole, head='pairs', width=9), &
    column(whole, head='no pair', width=9), column(whole, head='closed', width=9), &
    column(number, head='force'), column(number, head='on slave'), column(number, head='on master'), &
    column(number, head='difference')]

  type(column), parameter :: body_columns(*) = [ &
    column(whole, 'body', '', 'its number', width=10), &
    column(whole, 'first_node', '', 'its first GRID', 'first GRID', 12), &
    column(number, 'force_x', force, 'contact resultant; x is empty for axisymmetric bodies', 'force x'), &
    column(estimate, head='error', width=12), &
    column(number, 'force_y', '', '', 'force y'), &
    column(estimate, 'mesh_error_x', force, 'estimated mesh error of the force; empty if unknown', width=0), &
    column(estimate, 'mesh_error_y', '', '', 'error', 12)]

  type(column), parameter :: node_columns(*) = [ &
    column(whole, 'node', '', 'id of the GRID', 'GRID', 10), &
    column(number, 'x', length, 'undeformed'), &
    column(number, 'y'), &
    column(number, 'ux', length, 'displacement'), &
    column(number, 'uy'), &
    column(number, 'rx', force, 'reaction of the support'), &
    column(number, 'ry')]

  type(column), parameter :: element_columns(*) = [ &
    column(whole, 'element', '', 'its id', width=10), &
    column(number, 'x', length, 'mean of its undeformed nodes', width=0), &
    column(number, 'y', width=0), &
    column(number, 'sx', stress, 'means over the element'), &
    column(number, 'sy'), &
    column(number, 'sz'), &
    column(number, 'txy'), &
    column(number, 'equivalent_stress', stress, 'von Mises, mean over the element', 'equivalent'), &
    column(number, 'max_equivalent_stress', stress, 'the largest of its integration points', 'largest'), &
    column(word, head='at GRID', width=9), &
    column(number, 'max_x', length, 'undeformed position of that integration point', width=0), &
    column(number, 'max_y', width=0), &
    column(number, 'equivalent_strain', '', 'mean over the element', 'strain'), &
    column(number, 'secant_modulus', stress, 'of the curve at that strain', 'secant'), &
    column(state, 'state', '', 'plastic if it has yielded at any of its integration points', width=9)]

  type(column), parameter :: plastic_columns(*) = [ &
    column(whole, 'element', '', 'its id', width=10), &
    column(number, 'plastic_x', '', 'plastic strains, means over the element'), &
    column(number, 'plastic_y'), &
    column(number, 'plastic_z'), &
    column(number, 'plastic_xy', '', 'engineering shear strain'), &
    column(number, 'accumulated', '', 'equivalent plastic strain, which never decreases')]

  type(column), parameter :: history_columns(*) = [ &
    column(whole, 'iteration', '', 'counted through all load steps', width=0), &
    column(whole, head='iteration', width=10), column(number, head='load factor'), &
    column(rounding, 'change', '', 'of a displacement / largest displacement', 'disp. change'), &
    column(off_curve, 'stress_error', '', 'deviation of a stress from the curve, relative', &
           'stress error', 15), &
    column(whole, 'pairs_in_contact', '', 'their number', 'in contact', 12), &
    column(whole, 'plastic_elements', '', 'elements that yield in this solve', 'yielding', 10), &
    column(whole, 'pivots', '', 'of the contact solver', width=10), &
    column(number, 'load_factor', '', 'part of the loads that the iteration is for', width=0)]

contains

  !> Describe the columns of a file of results; empty if it is not one of these tables.
  pure function columns_in(suffix) result(text)
    character(len=*), intent(in) :: suffix   !! of the file's name
    character(len=:), allocatable :: text
    type(column), allocatable :: columns(:)

    if (suffix == '.contact.csv') columns = contact_columns
    if (suffix == '.friction.csv') columns = friction_columns
    if (suffix == '.zones.csv') columns = zone_columns
    if (suffix == '.bodies.csv') columns = body_columns
    if (suffix == '.history.csv') columns = history_columns
    if (suffix == '.increments.csv') columns = increment_columns
    if (suffix == '.nodes.csv') columns = node_columns
    if (suffix == '.elements.csv') columns = element_columns
    if (suffix == '.plastic.csv') columns = plastic_columns
    if (suffix == '.cases.csv') columns = case_columns
    text = ''
    if (allocated(columns)) text = 'Columns: '//columns_text(columns)//'.'
  end function columns_in

  !> Write a table, if the model has it.
  subroutine put_table(run, name, table)
    type(run_results), intent(in) :: run       !! run and its results
    character(len=*), intent(in) :: name       !! of the table: that of its file, or lines or sticks
    type(table_type), intent(inout) :: table   !! the listing, or a file
    integer :: k

    select case (name)
    case ('contact')
      call put_contact()
    case ('friction')
      if (run%model%contact%has_friction()) call put_friction(run, table)
    case ('zones')
      call put_zones('CONTACT ZONES  (half-width: of the full zone, mirrored at symmetry lines; '// &
                     'force: of the listed pairs only)', run%answer%zones, zone_columns)
    case ('sticks')
      if (run%model%contact%has_friction()) call put_zones('STICK ZONES  (half-width: up to full slip)', &
                                                           run%answer%stick_zones, stick_columns())
    case ('lines')
      if (size(run%answer%lines) > 0) call put_lines()
    case ('bodies')
      if (run%model%contact%pairs > 0) call put_bodies()
    case ('nodes')
      call put_nodes()
    case ('elements')
      call put_elements(run, table)
    case ('plastic')
      if (allocated(run%answer%plastic_strain)) call put_plastic(run, table)
    case ('history')
      call put_history(run, table)
    case ('increments')
      if (run%is_flow()) call put_increments(run, table)
    end select

  contains

    !> Forces, pressures and gaps: one row for each pair.
    subroutine put_contact()
      associate (model => run%model, contact => run%answer%contact)
        call table%begin('CONTACT', contact_columns, &
                         [spread(0.0_wp, 1, 5), maxval(abs(contact%force)), maxval(run%answer%pressure), &
                          max(maxval(abs(contact%gap)), maxval(abs(run%answer%displacement)))])
        do k = 1, model%contact%pairs
          call table%row([model%contact%pair_id(k), model%mesh%node_id(model%contact%pair_node(:, k))], &
                         [model%mesh%x(:, model%contact%pair_node(2, k)), model%contact%normal(:, k), &
                          model%contact%initial_gap(k), &
                          contact%force(k), run%answer%pressure(k), contact%gap(k)], &
                         [merge('touching          ', 'open              ', contact%touching(k)), &
                          merge(', force not unique', '                  ', contact%indeterminate(k))])
        end do
      end associate
    end subroutine put_contact

    !> Runs of pairs that are in contact or stick: one row for each zone.
    subroutine put_zones(title, zones, columns)
      character(len=*), intent(in) :: title
      type(contact_zone), intent(in) :: zones(:)
      type(column), intent(in) :: columns(:)
      character(len=16) :: limit

      call table%begin(title, columns, [sum(run%answer%contact%force), 0.0_wp, 0.0_wp, 0.0_wp])
      do k = 1, size(zones)
        limit = limit_of_pressure(run, k)
        associate (zone => zones(k))
          call table%row([k, run%model%contact%pair_id([zone%first, zone%last])], &
                         [zone%force, zone%max_pressure, zone%half_width_pairs, zone%half_width], [limit])
        end associate
      end do
    end subroutine put_zones

    !> Contact of lines, from both sides: one row for each contact.
    subroutine put_lines()
      call table%begin('CONTACT LINES  (largest pressure on the slave line, and on the master line from '// &
                       'its nodal forces)', line_columns, &
                       [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp])
      do k = 1, size(run%answer%lines)
        associate (contact => run%model%contact%line_contact(k), line => run%answer%lines(k))
          call table%row([contact%last - contact%first + 1, contact%nodes_left_out, line%touching], &
                         [line%force, line%on_slave, line%on_master, line%difference], &
                         [first_of(contact%bconp), first_of(contact%slave_id), first_of(contact%master_id)])
        end associate
      end do
    end subroutine put_lines

    !> Contact forces on bodies with elements, one row each. Axisymmetric bodies have no x.
    subroutine put_bodies()
      type(column) :: columns(size(body_columns))

      columns = body_columns
      if (run%model%has_rings()) columns([3, 4, 6])%kind = no_number
      associate (bodies => run%answer%bodies)
        call table%begin('CONTACT FORCE ON BODIES  (deformable bodies; mesh error, estimated for at most '// &
                         text_of(most_bodies)//' bodies)', &
                         columns, spread(maxval([(abs(bodies(k)%resultant), k=1, size(bodies))]), 1, 5))
        do k = 1, size(bodies)
          call table%row([bodies(k)%body, run%model%mesh%node_id(bodies(k)%node)], &
                         [bodies(k)%resultant(1), run%accuracy%body_force(1, k), &
                          bodies(k)%resultant(2), run%accuracy%body_force(:, k)])
        end do
      end associate
    end subroutine put_bodies

    !> Displacements and reactions: one row for each node.
    subroutine put_nodes()
      call table%begin('DISPLACEMENTS AND REACTIONS', node_columns, &
                       [0.0_wp, 0.0_wp, spread(maxval(abs(run%answer%displacement)), 1, directions), &
                        spread(maxval(abs(run%answer%reaction)), 1, directions)])
      do k = 1, run%model%mesh%nodes
        call table%row([run%model%mesh%node_id(k)], &
                       [run%model%mesh%x(:, k), run%answer%displacement(:, k), run%answer%reaction(:, k)])
      end do
    end subroutine put_nodes
  end subroutine put_table

  !> Equilibrium iteration: one row for each solve.
  subroutine put_history(run, table)
    type(run_results), intent(in) :: run
    type(table_type), intent(inout) :: table
    integer :: k

    call table%begin('ITERATIONS', history_columns, [1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp])
    do k = 1, size(run%answer%history)
      associate (now => run%answer%history(k))
        call table%row([k, now%iteration, now%touching, now%yielded, now%pivots], &
                       [now%load_factor, now%change, now%residual, now%load_factor])
      end associate
    end do
  end subroutine put_history

  !> Plastic strains of flow theory: one row for each element.
  subroutine put_plastic(run, table)
    type(run_results), intent(in) :: run
    type(table_type), intent(inout) :: table
    integer :: k

    associate (strain => run%answer%plastic_strain)
      call table%begin('PLASTIC STRAINS  (means over the element)', plastic_columns, &
                       [spread(maxval(abs(strain(:4, :))), 1, 4), maxval(strain(5, :))])
      do k = 1, size(strain, 2)
        call table%row([run%model%mesh%element_id(k)], strain(:, k))
      end do
    end associate
  end subroutine put_plastic

  !> Stresses and strains: one row for each element.
  subroutine put_elements(run, table)
    type(run_results), intent(in) :: run
    type(table_type), intent(inout) :: table
    integer :: k

    call table%begin('STRESSES  (means over the element; largest: von Mises at the integration point '// &
                     'nearest to that GRID of it)', element_columns, &
                     [0.0_wp, 0.0_wp, spread(maxval(abs(run%answer%stress)), 1, 6), 0.0_wp, 0.0_wp, &
                      maxval(run%answer%equivalent_strain), 0.0_wp])
    do k = 1, run%model%mesh%elements
      call table%row([run%model%mesh%element_id(k)], &
                     [sum(run%model%mesh%coordinates(k), dim=2)/run%model%mesh%node_count(k), &
                      run%answer%stress(:, k), run%answer%equivalent_stress(k), &
                      run%answer%largest_stress(k), place_of_point(run%model, run%answer%largest_at(k)), &
                      run%answer%equivalent_strain(k), run%answer%secant_modulus(k)], &
                     [nearest_grid(run%answer%largest_at(k)), &
                      merge('plastic ', 'elastic ', run%answer%plastic(k))])
    end do

  contains

    !> Id of the corner nearest to an integration point; `-` if the element has one point.
    pure function nearest_grid(point) result(id)
      integer, intent(in) :: point
      character(len=8) :: id
      real(wp) :: x(directions)

      associate (model => run%model, e => run%model%mesh%point_element(point))
        id = '-'
        if (model%mesh%first_point(e + 1) - model%mesh%first_point(e) == 1) return
        x = place_of_point(model, point)
        associate (corner => model%mesh%connectivity(:model%mesh%corners(e), e))
          id = text_of(model%mesh%node_id(corner(minloc((model%mesh%x(1, corner) - x(1))**2 + &
              (model%mesh%x(2, corner) - x(2))**2, dim=1))))
        end associate
      end associate
    end function nearest_grid
  end subroutine put_elements

  !> Columns of the zones that stick, which are in the listing only.
  pure function stick_columns() result(columns)
    type(column) :: columns(size(zone_columns))

    columns = zone_columns
    columns(4:6)%head = [character(len=16) :: 'friction force', '', 'to last sticking']
    columns(4:6)%width = [15, 0, 17]
  end function stick_columns

  !> Write the first of some ids, and `+` if there are more. The plan lists all.
  pure function first_of(id) result(text)
    integer, intent(in) :: id(:)
    character(len=10) :: text

    text = text_of(id(1))//merge('+', ' ', size(id) > 1)
  end function first_of
end module epcont_report_tables
