!> The plan in words: what is modelled, what is not needed, and what it will take.
module epcont_report_plan_text
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_model_controls, only: method_inistr, method_modsec, method_name, method_newton, precision_double, &
                                   precision_name, precision_open, solver_auto, solver_band, solver_frontal, solver_name
  use epcont_model_model, only: model_type
  use epcont_plan_forecast, only: forecast_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_iteration_plan, only: contact_plan, iteration_plan, many_pairs
  use epcont_plan_numbering, only: body_numbering, many_operations, numbering_type
  use epcont_report_layout, only: newline, right
  use epcont_report_line_plan, only: lines_text
  use epcont_report_precision, only: precision_text
  implicit none
  private
  public :: plan_text

  !> Free motions, and bodies, that are told of one by one.
  integer, parameter :: most = 20

contains

  pure function plan_text(model, motions, iteration, numbering, expected) result(text)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(iteration_plan), intent(in) :: iteration
    type(numbering_type), intent(in) :: numbering
    type(forecast_type), intent(in) :: expected
    character(len=:), allocatable :: text
    integer :: b, k

    text = newline//'PLAN'//newline
    text = text//'  '//plural(model%nodes, 'node')//', '//plural(model%elements, 'element')//', '// &
           plural(model%pairs, 'pair')//'; bodies: '//text_of(model%bodies)//newline
    text = text//iteration_text(model, iteration)
    if (model%pairs == 0) then
      text = text//'  no pairs: no flexibility, no simplex'//newline
    else
      text = text//'  contact by '//rule_text(iteration%contact)//newline
    end if
    text = text//lines_text(model)
    do k = 1, min(most, motions%count)
      text = text//'  free motion: GRID '//text_of(model%node_id(motions%node(k)))//' direction '// &
             text_of(motions%component(k))//newline
    end do
    if (motions%count > most) text = text//'  and '//plural(motions%count - most, 'further free motion')//newline
    text = text//solver_text(model, numbering)//precision_text(iteration%precision)
    if (model%controls%accuracy > 0.0_wp) text = text//accuracy_text(model, iteration)
    text = text//newline//'   body  nodes  equations  half-bandwidth  contact equations  border  factorizations'// &
           '  flexibility by'//newline
    do b = 1, min(most, model%bodies)
      associate (body => numbering%body(b))
        text = text//right(text_of(b), 7)//right(text_of(size(body%node)), 7)//right(text_of(body%equations), 11)// &
               right(width_text(body), 16)//right(text_of(body%contact_equations), 19)// &
               right(text_of(body%border), 8)//right(factorizations(iteration, body, b), 16)//'  '//flexibility_text(body)//newline
      end associate
    end do
    if (model%bodies > most) text = text//'  and '//plural(model%bodies - most, 'further one')//newline
    text = text//newline//'  memory '//megabytes(expected%bytes)
    if (iteration%precision /= precision_double) text = text//' (in double '//megabytes(expected%double_bytes)//')'
    text = text//', operations '//short_real(expected%operations)// &
           trim(merge(' a solve', '        ', iteration%yields))//newline
  end function plan_text

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
    if (iteration%yields .and. model%controls%tolerance == 0.0_wp) text = text//', TOL '//short_real(iteration%tolerance)
    if (iteration%yields .and. iteration%chosen_here) text = text//', METHOD '//trim(method_name(iteration%method))
    if (model%controls%precision == precision_open) text = text//', PRECIS '//trim(precision_name(iteration%precision))
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
    if (plan%chosen_here) text = text//newline//'    chosen here (AUTO): the faster rule from '//text_of(many_pairs)//' pairs on'
  end function rule_text

  !> How bodies are factored, where it is not in panels of their bands alone.
  pure function solver_text(model, numbering) result(text)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering
    character(len=:), allocatable :: text

    text = ''
    if (.not. any(numbering%body%solver == solver_frontal)) return
    text = '  bodies factored in nested fronts (FRONTAL): '//text_of(count(numbering%body%solver == solver_frontal))//newline
    if (model%controls%solver /= solver_auto) return
    text = text//'    chosen here (AUTO): faster where a band (BAND) takes more than '//short_real(many_operations)// &
           ' operations'//newline
  end function solver_text

  !> Half-bandwidth, or the solver of a body that has none.
  pure function width_text(body) result(text)
    type(body_numbering), intent(in) :: body
    character(len=:), allocatable :: text

    text = text_of(body%half_bandwidth)
    if (body%solver /= solver_band) text = trim(solver_name(body%solver))
  end function width_text

  !> How a body's flexibility follows from its factor: by inverting the trailing block, or by forward substitution of
  !! the pairs.
  pure function flexibility_text(body) result(text)
    type(body_numbering), intent(in) :: body
    character(len=:), allocatable :: text

    text = '-'
    if (body%contact_equations > 0) text = trim(merge('inversion   ', 'substitution', body%contact_last))
  end function flexibility_text

  !> How often a body is factored.
  pure function factorizations(iteration, body, b) result(text)
    type(iteration_plan), intent(in) :: iteration
    type(body_numbering), intent(in) :: body
    integer, intent(in) :: b
    character(len=:), allocatable :: text

    text = '1'
    if (iteration%body(b) .and. iteration%method /= method_inistr) text = 'each iteration'
    if (body%equations == 0) text = '0'
  end function factorizations

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
    if (iteration%chosen_here) text = text//'    chosen here (AUTO): '//why(iteration)//newline
    text = text//'    until no displacement changes, or is estimated to be off, by more than '//short_real(iteration%tolerance)// &
           ' of the largest,'//newline//'    and no stress is off its curve by more than '// &
           short_real(iteration%off_curve)//' of the stress there; at most '// &
           plural(model%controls%most_iterations, 'iteration')//newline
    if (iteration%load_steps > 1) &
      text = text//'  '//plural(iteration%load_steps, 'load step')//'; elastic unloading is not modelled'//newline
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

  pure function why(iteration) result(text)
    type(iteration_plan), intent(in) :: iteration
    character(len=:), allocatable :: text

    if (iteration%method == method_newton) then
      text = 'it needs the fewest factorizations'
    else
      text = 'the method of the paper, as MUP PAPER has no tangent for NEWTON'
    end if
  end function why
end module epcont_report_plan_text
