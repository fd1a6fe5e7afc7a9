!> The plan in words: what is modelled, what is not needed, and what it will take.
module epcont_report_plan_text
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_model_controls, only: method_inistr, method_modsec, method_name, method_newton, &
                                   precision_double, precision_name, precision_open, precision_single, &
                                   solver_auto, solver_band, solver_frontal, solver_name
  use epcont_model_model, only: line_contact, model_type
  use epcont_plan_iteration_plan, only: contact_plan, iteration_plan, many_pairs
  use epcont_plan_numbering, only: many_operations, numbering_type
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_report_columns, only: column, state, table_type, whole, word
  use epcont_report_layout, only: newline
  use epcont_report_names, only: joined, motion_name
  implicit none
  private
  public :: plan_text

  !> Free motions, bodies and contacts that are told of one by one, and corners of each line.
  integer, parameter :: most = 20, most_corners = 8

  type(column), parameter :: body_columns(*) = [ &
    column(whole, head='body', width=7), column(whole, head='nodes', width=7), &
    column(whole, head='equations', width=11), column(word, head='half-bandwidth', width=16), &
    column(whole, head='contact equations', width=19), column(whole, head='border', width=8), &
    column(word, head='factorizations', width=16), column(state, head='flexibility by', width=16)]

contains

  !> The plan of a scene, in lines.
  pure function plan_text(scene) result(text)
    type(planned_scene), intent(in) :: scene   !! what is to be solved, and how
    character(len=:), allocatable :: text
    integer :: k

    associate (model => scene%model, motions => scene%motions%count, iteration => scene%iteration)
      text = newline//'PLAN'//newline// &
             '  '//plural(model%nodes, 'node')//', '//plural(model%elements, 'element')//', '// &
             plural(model%pairs, 'pair')//'; bodies: '//text_of(model%bodies)//newline// &
             iteration_text(model, iteration)
      if (model%pairs == 0) then
        text = text//'  no pairs: no flexibility, no simplex'//newline
      else
        text = text//'  contact by '//rule_text(iteration%contact)//newline
      end if
      text = text//lines_text(model)
      do k = 1, min(most, motions)
        text = text//'  free motion: '//motion_name(scene, k)//newline
      end do
      if (motions > most) text = text//'  and '//plural(motions - most, 'further free motion')//newline
      text = text//solver_text(model, scene%numbering, iteration%precision)
      if (model%controls%accuracy > 0.0_wp) text = text//accuracy_text(model, iteration)
    end associate
    associate (iteration => scene%iteration, expected => scene%expected)
      text = text//newline//body_table(iteration, scene%numbering)
      text = text//newline//'  memory '//megabytes(expected%bytes)
      if (iteration%precision /= precision_double) &
        text = text//' (in double '//megabytes(expected%double_bytes)//')'
      text = text//', operations '//short_real(expected%operations)// &
             trim(merge(' a solve', '        ', iteration%yields))//newline
    end associate
  end function plan_text

  !> A row a body: what its matrix is like, how often that is factored, and how its flexibility follows from
  !! the factor: by inverting the trailing block, or by forward substitution of the pairs.
  pure function body_table(iteration, numbering) result(text)
    type(iteration_plan), intent(in) :: iteration
    type(numbering_type), intent(in) :: numbering
    character(len=:), allocatable :: text
    type(table_type) :: table
    character(len=14) :: width, times, way
    integer :: b

    call table%describe(body_columns)
    text = table%head_text()//newline
    do b = 1, min(most, size(numbering%body))
      associate (body => numbering%body(b))
        width = text_of(body%half_bandwidth)
        if (body%solver /= solver_band) width = solver_name(body%solver)
        times = '1'
        if (iteration%body(b) .and. iteration%method /= method_inistr) times = 'each iteration'
        if (body%equations == 0) times = '0'
        way = '-'
        if (body%contact_equations > 0) way = merge('inversion   ', 'substitution', body%contact_last)
        text = text// &
               table%row_text([b, size(body%node), body%equations, body%contact_equations, body%border], &
                              [real(wp) ::], [width, times, way])//newline
      end associate
    end do
    if (size(numbering%body) > most) &
      text = text//'  and '//plural(size(numbering%body) - most, 'further one')//newline
  end function body_table

  !> Memory, rounded up.
  pure function megabytes(bytes) result(text)
    integer(i8), intent(in) :: bytes
    character(len=:), allocatable :: text

    text = text_of((bytes + 999999_i8)/1000000_i8)//' MB'
  end function megabytes

  !> What PARAM ACCURACY has chosen.
  pure function accuracy_text(model, iteration) result(text)
    type(model_type), intent(in) :: model
    type(iteration_plan), intent(in) :: iteration
    character(len=:), allocatable :: text

    text = ''
    if (iteration%yields .and. model%controls%tolerance == 0.0_wp) &
      text = text//', TOL '//short_real(iteration%tolerance)
    if (iteration%yields .and. iteration%chosen_here) &
      text = text//', METHOD '//trim(method_name(iteration%method))
    if (model%controls%precision == precision_open) &
      text = text//', PRECIS '//trim(precision_name(iteration%precision))
    if (len(text) == 0) text = ', nothing: the deck sets all itself'
    text = '  ACCURACY '//short_real(model%controls%accuracy)//' chooses '//text(3:)//newline
  end function accuracy_text

  !> How the pairs in contact are found.
  pure function rule_text(plan) result(text)
    type(contact_plan), intent(in) :: plan
    character(len=:), allocatable :: text

    text = 'the simplex with contact entry rule (CONRY)'
    if (.not. plan%by_blocks) return
    text = 'block pivoting of the contacts (BLOCK)'
    if (plan%chosen_here) &
      text = text//newline//'    chosen here (AUTO): the faster rule from '//text_of(many_pairs)//' pairs on'
  end function rule_text

  !> How bodies are factored, where it is not in panels of their bands alone, and in double precision.
  pure function solver_text(model, numbering, precision) result(text)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering
    integer, intent(in) :: precision
    character(len=:), allocatable :: text
    integer :: fronts

    text = ''
    fronts = count(numbering%body%solver == solver_frontal)
    if (fronts > 0) text = '  bodies factored in nested fronts (FRONTAL): '//text_of(fronts)//newline
    if (fronts > 0 .and. model%controls%solver == solver_auto) text = text// &
      '    chosen here (AUTO): faster where a band (BAND) takes more than '//short_real(many_operations)// &
      ' operations'//newline
    if (precision == precision_double) return
    text = text//'  factors in single precision, '// &
           trim(merge('not refined      ', 'refined to double', precision == precision_single))// &
           ' ('//trim(precision_name(precision))//'); where that fails, all is solved anew in double'//newline
  end function solver_text

  !> Whether the scene can yield, and how that is iterated.
  pure function iteration_text(model, iteration) result(text)
    type(model_type), intent(in) :: model
    type(iteration_plan), intent(in) :: iteration
    character(len=:), allocatable :: text

    if (.not. iteration%yields) then
      text = '  elastic material only: one solve, no iteration'//newline
      return
    end if
    text = '  total theory of plasticity; bodies that can yield: '//text_of(count(iteration%body))//newline
    text = text//'  iteration '//trim(method_name(iteration%method))//': '//what_it_does(iteration)//newline
    if (iteration%chosen_here .and. iteration%method == method_newton) then
      text = text//'    chosen here (AUTO): it needs the fewest factorizations'//newline
    else if (iteration%chosen_here) then
      text = text//'    chosen here (AUTO): the method of the paper, '// &
             'as MUP PAPER has no tangent for NEWTON'//newline
    end if
    text = text//'    until no displacement changes, or is estimated to be off, by more than '// &
           short_real(iteration%tolerance)// &
           ' of the largest,'//newline//'    and no stress is off its curve by more than '// &
           short_real(iteration%off_curve)//' of the stress there; at most '// &
           plural(model%controls%most_iterations, 'iteration')//newline
    if (iteration%load_steps > 1) &
      text = text//'  '//plural(iteration%load_steps, 'load step')//'; elastic unloading is not modelled'// &
             newline
    if (model%controls%paper_ratio) &
      text = text//'  MUP PAPER: Poisson''s ratio in the equivalent strain by formula (2-4)'//newline
  end function iteration_text

  pure function what_it_does(iteration) result(text)
    type(iteration_plan), intent(in) :: iteration
    character(len=:), allocatable :: text

    select case (iteration%method)
    case (method_newton)
      text = 'consistent tangents, contact exact in each step, line search on the energy'
    case (method_modsec)
      text = 'secant moduli from that mixture of the last strains which changes least (Anderson)'
    case (method_inistr)
      text = 'elastic stiffness, factored once; plastic stresses as initial stresses, mixed (Anderson)'
    case default
      text = 'all load each time, secant moduli from the last strains'
    end select
  end function what_it_does

  !> All contacts of lines.
  pure function lines_text(model) result(text)
    type(model_type), intent(in) :: model
    character(len=:), allocatable :: text
    integer :: k

    text = ''
    do k = 1, min(most, size(model%line_contact))
      text = text//contact_text(model, model%line_contact(k))
    end do
    if (size(model%line_contact) > most) &
      text = text//'  and '//plural(size(model%line_contact) - most, 'further contact')//' of lines'//newline
  end function lines_text

  !> One of them.
  pure function contact_text(model, contact) result(text)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    character(len=:), allocatable :: text

    text = '  BCONP '//joined(contact%bconp, ', ')//': nodes of BLSEG '//joined(contact%slave_id, ', ')// &
           ' against sides of BLSEG '//joined(contact%master_id, ', ')//': '// &
           plural(contact%last - contact%first + 1, 'pair')//', initial gaps '// &
           short_real(minval(model%initial_gap(contact%first:contact%last)))//' to '// &
           short_real(maxval(model%initial_gap(contact%first:contact%last)))
    if (contact%nodes_left_out > 0) text = text//'; left out, since they face nothing within '// &
                                           short_real(contact%search)// &
                                           ': '//plural(contact%nodes_left_out, 'node')
    text = text//newline
    if (contact%last >= contact%first_of_master) &
      text = text//'    of these nodes of BLSEG '//joined(contact%master_id, ', ')// &
             ' that stand on sides of the former: '// &
             text_of(contact%last - contact%first_of_master + 1)//newline
    if (contact%is_wider .or. size(contact%came_near) > 0) &
      text = text//'    solved anew, with nodes that came near'//newline
    text = text//corner_text(model, contact%slave, contact%slave_id)// &
           corner_text(model, contact%master, contact%master_id)
  end function contact_text

  !> The corners of lines: where a face ends, and nothing is smoothed.
  pure function corner_text(model, line, id) result(text)
    type(model_type), intent(in) :: model
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: id(:)
    character(len=:), allocatable :: text
    integer, allocatable :: node(:)

    node = pack(line%segment(1, :), line%corner(1, :) .and. .not. line%mirrored(1, :))
    node = [node, pack(line%segment(2, :), line%corner(2, :) .and. .not. line%mirrored(2, :) .and. &
                       line%neighbour(2, :) == 0)]
    text = ''
    if (size(node) > 0) text = '    corners of BLSEG '//joined(id, ', ')//': GRID '// &
                               joined(model%node_id(node), ', ', most_corners)//newline
  end function corner_text
end module epcont_report_plan_text
