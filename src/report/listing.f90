!> The listing for people: ASCII, at most 132 columns, nothing in it that varies from run to run.
module epcont_report_listing
  use epcont_accuracy_accuracy, only: accuracy_type
  use epcont_accuracy_body_shares, only: most_bodies
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_base_version, only: program_name, program_version
  use epcont_certificate_certificate, only: certificate_type
  use epcont_contact_problem, only: contact_solution
  use epcont_deck_deck, only: deck_type
  use epcont_deck_render, only: printable
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_report_file, only: text_file
  use epcont_report_layout, only: figure, heading, right, wrap
  use epcont_report_limit, only: limit_of_largest, reason_of
  use epcont_report_number, only: column_number, estimate_number, known_column, rounding_number
  use epcont_report_outcome, only: outcome_type
  use epcont_report_scene_text, only: list_scene
  use epcont_result_answer, only: answer_type
  use epcont_result_body_force, only: body_force
  use epcont_result_line_pressure, only: line_pressure
  use epcont_result_stresses, only: first_largest, place_of_point
  use epcont_result_zones, only: contact_zone
  implicit none
  private
  public :: list_deck, list_outcome, list_contact, list_zones, list_lines, list_bodies, list_nodes, list_elements, list_summary

contains

  !> Title, and what the deck holds.
  subroutine list_deck(file, deck)
    type(text_file), intent(in) :: file
    type(deck_type), intent(in) :: deck
    integer :: k

    call file%line(program_name//' '//program_version//'   elastoplastic contact of plane bodies and rings')
    call file%line('')
    if (len(deck%title) > 0) call file%line('  '//printable(deck%title))
    if (len(deck%subtitle) > 0) call file%line('  '//printable(deck%subtitle))
    if (len(deck%label) > 0) call file%line('  '//printable(deck%label))
    if (len_trim(deck%parameter_word('UNITS', '')) > 0) then
      call file%line('  units: '//trim(deck%parameter_word('UNITS', '')))
    else
      call file%line('  units: as the deck has them')
    end if
    call heading(file, 'DECK')
    do k = 1, size(deck%card)
      if (deck%card(k)%count > 0) &
        call file%line('  '//deck%card(k)%entry%name//'  '//right(text_of(deck%card(k)%count), 9))
    end do
  end subroutine list_deck

  !> What came of the run, where the answer is not valid.
  subroutine list_outcome(file, outcome)
    type(text_file), intent(inout) :: file
    type(outcome_type), intent(in) :: outcome

    if (len(outcome%sentence) == 0) return
    call file%line('')
    file%mark = '  *NOT VALID: '//outcome%word//'*'
    call wrap(file, '  *NOT VALID*  '//outcome%word//': '//outcome%sentence)
  end subroutine list_outcome

  !> Forces, pressures and gaps of the pairs, and the pivots that led to them.
  subroutine list_contact(file, model, answer)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    real(wp) :: force_scale, gap_scale, pressure_scale
    integer :: k

    call heading(file, 'CONTACT')
    call file%line('      pair       GA       GB            x            y        force     pressure          gap  state')
    force_scale = maxval(abs(answer%contact%force))
    gap_scale = max(maxval(abs(answer%contact%gap)), maxval(abs(answer%displacement)))
    pressure_scale = maxval(answer%pressure)
    do k = 1, model%pairs
      associate (b => model%pair_node(2, k))
        call file%line(right(text_of(model%pair_id(k)), 10)//right(text_of(model%node_id(model%pair_node(1, k))), 9)// &
                       right(text_of(model%node_id(b)), 9)//column_number(model%x(1, b), 0.0_wp)// &
                       column_number(model%x(2, b), 0.0_wp)//column_number(answer%contact%force(k), force_scale)// &
                       known_column(answer%pressure(k), pressure_scale)//column_number(answer%contact%gap(k), gap_scale)// &
                       merge('  touching', '  open    ', answer%contact%touching(k))// &
                       merge(', force not unique', '                  ', answer%contact%indeterminate(k)))
      end associate
    end do
    call file%line('')
    call file%line('  '//exchanges(answer%contact)// &
                   trim(merge(', in the last solve', '                   ', size(answer%history) > 1)))
    call list_pivots(file, model, answer)
  end subroutine list_contact

  !> How the set of contacts was found.
  pure function exchanges(contact) result(text)
    type(contact_solution), intent(in) :: contact
    character(len=:), allocatable :: text

    if (contact%by_blocks) then
      text = 'block pivoting: '//plural(contact%block_steps, 'set')//', '//plural(contact%pivots, 'exchange')//' of pairs'
      return
    end if
    text = plural(contact%pivots, 'pivot')//', '//text_of(contact%degenerate_pivots)//' degenerate'
    if (contact%block_steps > 0) &
      text = text//' (CONRY, after '//plural(contact%block_steps, 'set')//' of block pivoting)'
  end function exchanges

  !> The first pivots.
  subroutine list_pivots(file, model, answer)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    integer :: k

    if (size(answer%contact%history) == 0) return
    call file%line('     pivot          entered             left  load factor        ratio')
    do k = 1, size(answer%contact%history)
      associate (pivot => answer%contact%history(k))
        call file%line(right(text_of(k), 10)//right(variable(model, pivot%entered), 17)//right(variable(model, pivot%left), 17)// &
                       column_number(pivot%load_factor, 1.0_wp)//column_number(pivot%ratio, 1.0_wp))
      end associate
    end do
    if (answer%contact%pivots > size(answer%contact%history)) &
      call file%line('  and '//text_of(answer%contact%pivots - size(answer%contact%history))//' more')
  end subroutine list_pivots

  !> A variable of the simplex by the id of its pair.
  pure function variable(model, code) result(text)
    type(model_type), intent(in) :: model
    integer, intent(in) :: code
    character(len=:), allocatable :: text

    if (code == 0) then
      text = 'load'
    else if (code > 0) then
      text = 'force '//text_of(model%pair_id(code))
    else
      text = 'gap '//text_of(model%pair_id(-code))
    end if
  end function variable

  !> Runs of touching pairs.
  subroutine list_zones(file, model, zones)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(contact_zone), intent(in) :: zones(:)
    integer :: z

    call heading(file, 'ZONES  (half-widths of whole zones, mirrored at lines of symmetry; forces of the pairs listed alone)')
    call file%line('    zone first pair  last pair        force max pressure  to last pair   half-width')
    do z = 1, size(zones)
      associate (zone => zones(z))
        call file%line(right(text_of(z), 8)//right(text_of(model%pair_id(zone%first)), 11)// &
                       right(text_of(model%pair_id(zone%last)), 11)//column_number(zone%force, 0.0_wp)// &
                       known_column(zone%max_pressure, 0.0_wp)//' '//column_number(zone%half_width_pairs, 0.0_wp)// &
                       known_column(zone%half_width, 0.0_wp))
      end associate
    end do
  end subroutine list_zones

  !> Contact of lines, seen from both sides.
  subroutine list_lines(file, model, line)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(line_pressure), intent(in) :: line(:)
    integer :: c

    call heading(file, 'LINES IN CONTACT  (pressures on the slave line are those above; on the master line by its nodes'' forces)')
    call file%line('     BCONP    slave   master    pairs left out touching        force     on slave    on master   difference')
    do c = 1, size(line)
      associate (contact => model%line_contact(c))
        call file%line(right(first_of(contact%bconp), 10)//right(first_of(contact%slave_id), 9)// &
                       right(first_of(contact%master_id), 9)// &
                       right(text_of(contact%last - contact%first + 1), 9)//right(text_of(contact%nodes_left_out), 9)// &
                       right(text_of(line(c)%touching), 9)//column_number(line(c)%force, 0.0_wp)// &
                       column_number(line(c)%on_slave, 0.0_wp)//column_number(line(c)%on_master, 0.0_wp)// &
                       column_number(line(c)%difference, 1.0_wp))
      end associate
    end do
  end subroutine list_lines

  !> The first of some ids, and a mark where there are more: the plan has them all.
  pure function first_of(id) result(text)
    integer, intent(in) :: id(:)
    character(len=:), allocatable :: text

    text = text_of(id(1))//trim(merge('+', ' ', size(id) > 1))
  end function first_of

  !> What contact exerts on each body.
  subroutine list_bodies(file, model, bodies, error)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(body_force), intent(in) :: bodies(:)
    real(wp), intent(in) :: error(:, :)   !! [2, bodies]
    character(len=:), allocatable :: x
    real(wp) :: scale
    integer :: i

    call heading(file, 'BODIES  (force of contact on each that has elements; error: of the mesh, estimated of up to '// &
                 text_of(most_bodies)//' bodies)')
    call file%line('      body  first GRID      force x       error      force y       error')
    scale = maxval([(abs(bodies(i)%resultant), i=1, size(bodies))])
    do i = 1, size(bodies)
      associate (body => bodies(i))
        x = right('-', 13)//right('-', 12)
        if (.not. model%has_rings()) x = column_number(body%resultant(1), scale)//error_column(error(1, i), scale)
        call file%line(right(text_of(body%body), 10)//right(text_of(model%node_id(body%node)), 12)//x// &
                       column_number(body%resultant(2), scale)//error_column(error(2, i), scale))
      end associate
    end do
  end subroutine list_bodies

  !> An error of two digits; none where it is rounding; one that is not known.
  pure function error_column(error, scale) result(text)
    real(wp), intent(in) :: error
    real(wp), intent(in) :: scale   !! of the column
    character(len=12) :: text
    real(wp), parameter :: none = 1.0e-9_wp

    text = right('-', 12)
    if (error >= 0.0_wp) text = right('0.0', 12)
    if (error > none*scale) text = right(estimate_number(error), 12)
  end function error_column

  !> Displacements and reactions.
  subroutine list_nodes(file, model, answer)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    real(wp) :: u, r
    integer :: i

    call heading(file, 'DISPLACEMENTS AND REACTIONS')
    call file%line('      GRID            x            y           ux           uy           rx           ry')
    u = maxval(abs(answer%displacement))
    r = maxval(abs(answer%reaction))
    do i = 1, model%nodes
      call file%line(right(text_of(model%node_id(i)), 10)//column_number(model%x(1, i), 0.0_wp)// &
                     column_number(model%x(2, i), 0.0_wp)//column_number(answer%displacement(1, i), u)// &
                     column_number(answer%displacement(2, i), u)//column_number(answer%reaction(1, i), r)// &
                     column_number(answer%reaction(2, i), r))
    end do
  end subroutine list_nodes

  !> Stresses.
  subroutine list_elements(file, model, answer)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    real(wp) :: s, strain
    integer :: e

    call heading(file, 'STRESSES  (means over the element; largest: von Mises at the integration point nearest to that GRID of it)')
    call file%line('   element           sx           sy           sz          txy   equivalent      largest  at GRID'// &
                   '       strain       secant  state')
    s = maxval(abs(answer%stress))
    strain = maxval(answer%equivalent_strain)
    do e = 1, model%elements
      call file%line(right(text_of(model%element_id(e)), 10)//column_number(answer%stress(1, e), s)// &
                     column_number(answer%stress(2, e), s)//column_number(answer%stress(3, e), s)// &
                     column_number(answer%stress(4, e), s)//column_number(answer%equivalent_stress(e), s)// &
                     column_number(answer%largest_stress(e), s)//right(nearest_grid(model, answer%largest_at(e)), 9)// &
                     column_number(answer%equivalent_strain(e), strain)// &
                     column_number(answer%secant_modulus(e), 0.0_wp)//merge('  plastic', '  elastic', answer%plastic(e)))
    end do
  end subroutine list_elements

  !> Id of the corner of an element that an integration point is nearest to; of one in the middle: none.
  pure function nearest_grid(model, point) result(id)
    type(model_type), intent(in) :: model
    integer, intent(in) :: point
    character(len=:), allocatable :: id
    real(wp) :: x(2)

    associate (e => model%point_element(point))
      id = '-'
      if (model%first_point(e + 1) - model%first_point(e) == 1) return
      x = place_of_point(model, point)
      associate (corner => model%connectivity(:model%corners(e), e))
        id = text_of(model%node_id(corner(minloc((model%x(1, corner) - x(1))**2 + (model%x(2, corner) - x(2))**2, dim=1))))
      end associate
    end associate
  end function nearest_grid

  !> Summary and certificate.
  subroutine list_summary(file, model, motions, answer, certificate, accuracy, outcome)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(answer_type), intent(in) :: answer
    type(certificate_type), intent(in) :: certificate
    type(accuracy_type), intent(in) :: accuracy
    type(outcome_type), intent(in) :: outcome
    real(wp) :: place(2)
    integer :: k

    call heading(file, 'SUMMARY')
    if (model%pairs > 0) then
      call figure(file, 'largest pressure', known_column(answer%largest_pressure(), 0.0_wp)// &
                  reason_of(limit_of_largest(answer, accuracy)))
      call figure(file, 'total contact force', column_number(sum(answer%contact%force), 0.0_wp))
      call figure(file, 'pairs in contact', right(text_of(count(answer%contact%touching)), 13))
    end if
    do k = 1, motions%count
      call figure(file, 'approach: GRID '//text_of(model%node_id(motions%node(k)))//' direction '// &
                  text_of(motions%component(k)), column_number(answer%contact%approach(k), maxval(abs(answer%displacement))))
      if (answer%contact%motion_free(k)) call file%line('    nothing resists or drives this motion: its value is a choice')
    end do
    if (any(answer%plastic)) call figure(file, 'elements beyond the yield point', right(text_of(count(answer%plastic)), 13))
    associate (e => first_largest(answer%largest_stress))
      place = place_of_point(model, answer%largest_at(e))
      call figure(file, 'largest equivalent stress', column_number(answer%largest_stress(e), 0.0_wp)//'   in element '// &
                  text_of(model%element_id(e))//' at '//short_real(place(1))//' '//short_real(place(2)))
    end associate
    call figure(file, 'largest displacement', column_number(maxval(norm2(answer%displacement, dim=1)), 0.0_wp))
    call figure(file, 'status', right(outcome%word, 13))
    call heading(file, 'CERTIFICATE  (recomputed from displacements and forces alone; tolerance '// &
                 short_real(certificate%tolerance)//')')
    call figure(file, 'equilibrium residual', right(rounding_number(certificate%equilibrium), 13))
    call figure(file, 'most negative force, of the largest', &
                right(rounding_number(max(0.0_wp, -certificate%smallest_force)/certificate%force_scale), 13))
    call figure(file, 'most negative gap, of the largest length', &
                right(rounding_number(certificate%overlap/certificate%length_scale), 13))
    call figure(file, 'largest force times gap', &
                right(rounding_number(certificate%force_gap/certificate%force_scale/certificate%length_scale), 13))
    call figure(file, 'stress off the curve', right(rounding_number(certificate%off_curve), 13))
    if (certificate%curve_tolerance > certificate%tolerance) &
      call figure(file, 'of which the iteration may leave', right(short_real(certificate%curve_tolerance), 13))
    if (certificate%off_curve > certificate%curve_tolerance .and. certificate%off_curve <= certificate%off_curve_limit) &
      call figure(file, 'and with the rounding of displacements', right(short_real(certificate%off_curve_limit), 13))
    call figure(file, 'energy balance', right(rounding_number(certificate%energy), 13))
    call list_scene(file, model, certificate%scene)
  end subroutine list_summary
end module epcont_report_listing
