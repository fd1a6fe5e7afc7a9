!> Sentence about a verdict: why the answer is not valid, and a remedy.
module epcont_messages_sentences
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real
  use epcont_base_tolerances, only: valid_to
  use epcont_certificate_certificate, only: figure_name
  use epcont_verdict, only: reason_limit_load, reason_lost_contact, reason_memory, &
      reason_no_equilibrium, reason_none, reason_not_converged, reason_overlap, &
      reason_rounding, reason_singular, reason_unsound
  use epcont_element_kinematics, only: directions
  use epcont_messages_names, only: first_grid, joined, when
  use epcont_messages_scene_text, only: scene_sentence, unsound
  use epcont_model_arrays, only: angle
  use epcont_model_controls, only: method_newton
  use epcont_model_finding, only: of_node
  use epcont_solution, only: solution_type
  implicit none
  private
  public :: body_name, limit_load, sentence_of

  !> Largest number of pairs that are named.
  integer, parameter, public :: most_pairs = 8
  character(len=*), parameter, public :: axis_name(2) = ['x', 'y']
  character(len=*), parameter :: ill_shaped = &
    'elements differ too much in size or stiffness, hardly anything resists a rigid-body mode, '// &
    'a body is too slender, or a Poisson''s ratio is too near 0.5'

contains

  !> Sentence about the verdict of a run; empty if the answer is valid.
  pure function sentence_of(run) result(text)
    class(solution_type), intent(in) :: run   !! model with its answer
    character(len=:), allocatable :: text

    select case (run%verdict%reason)
    case (reason_none, reason_lost_contact)
      text = ''
    case (reason_memory)
      text = 'there is not enough memory to factor '//body_name(run, run%answer%failed_body)
    case (reason_singular)
      text = 'the stiffness of '//body_name(run, run%answer%failed_body)//' cannot be factored: '// &
             ill_shaped//when(run%model%sections%has_flat_curve(), &
                              '; or the load exceeds the limit load (perfectly plastic material)')
    case (reason_no_equilibrium)
      text = escaping(run)
    case (reason_overlap)
      text = 'pairs overlap and no body can deform: CGAP '// &
             joined(pack(run%model%contact%pair_id, run%answer%contact%overlapping), ' ', most_pairs)
    case (reason_rounding)
      text = 'no active set passed the test, because of rounding: the condition of the stiffness is '// &
             'too large, or pairs hardly restrain a body (fix it with SPC1)'
    case (reason_unsound)
      text = scene_sentence(run%model, run%certificate%scene, unsound)
    case (reason_limit_load, reason_not_converged)
      text = unconverged(run)
    case default
      text = 'the answer is not reliable: '//doubts(run)
    end select
  end function sentence_of

  !> Does the rest of the loads move a body, after a part of them was in equilibrium? No solve of it is in the
  !! history then.
  pure logical function has_escaped(run)
    class(solution_type), intent(in) :: run

    has_escaped = any(abs(run%answer%contact%escape) > 0.0_wp)
  end function has_escaped

  !> Name the body that the load moves, and its direction.
  pure function escaping(run) result(text)
    class(solution_type), intent(in) :: run
    character(len=:), allocatable :: text
    integer :: k

    k = maxloc(abs(run%answer%contact%escape), dim=1)
    text = ' along '//merge('-', '+', run%answer%contact%escape(k) < 0)// &
           axis_name(min(directions, run%motions%component(k)))
    text = 'the load '//when(run%motions%component(k) == angle, 'rotates ', 'moves ')// &
           body_name(run, run%motions%body(k))//when(run%motions%component(k) /= angle, text)// &
           ' (SUPORT at '//run%model%name_of(of_node, run%motions%node(k))//'), and '// &
           when(run%model%contact%has_friction(), 'neither contact nor friction', 'no contact')//' resists it'
  end function escaping

  !> Say why an answer is not certified: the certificate value that exceeds its tolerance most, and lost
  !! digits.
  pure function doubts(run) result(text)
    class(solution_type), intent(in) :: run
    character(len=:), allocatable :: text
    real(wp), parameter :: least = 1.0e-200_wp   ! with a limit of zero, the ratio stays finite
    real(wp) :: figure(size(figure_name)), largest(size(figure_name)), much, taken
    integer :: worst

    call run%certificate%figures(figure, largest)
    worst = maxloc(figure/max(largest, least), dim=1)
    text = ''
    if (figure(worst) > largest(worst)) text = trim(figure_name(worst))//' '//short_real(figure(worst))// &
        ' (at most '//short_real(largest(worst))//')'
    much = 0.1_wp*valid_to
    taken = epsilon(1.0_wp)/run%answer%weakest%ratio   ! the cause, even after iterative refinement
    if (.not. all(figure <= huge(figure))) then
      text = 'the work of the loads is too far from 1.0 for a number: use other units'
    else if (taken > much) then
      if (len(text) > 0) text = text//'; '
      text = text//'rounding takes '//short_real(taken)//' of a pivot in the stiffness of '// &
             body_name(run, run%answer%weakest%body)//': '//ill_shaped
    else if (run%certificate%lost_stress > much) then
      text = text//'; the rounding of displacements is '//short_real(run%certificate%lost_stress)// &
             ' of the largest stress: elements too small or too stiff for their displacements, '// &
             'or a Poisson''s ratio is too near 0.5'
    else if (run%answer%condition*epsilon(1.0_wp) > much) then
      text = text//'; the condition of the stiffness is '//short_real(run%answer%condition)// &
             ': slender bodies or elements, or SUPORT nodes that are too near each other'
    end if
  end function doubts

  !> Describe an iteration that did not converge.
  pure function unconverged(run) result(text)
    class(solution_type), intent(in) :: run
    character(len=:), allocatable :: text

    if (has_escaped(run)) then
      text = 'limit load exceeded after load factor '//short_real(run%answer%load_factor)// &
             when(run%model%controls%sequence, ' of the load case')//': '//escaping(run)// &
             '. Results are those at this load factor'
      return
    end if
    associate (last => run%answer%history(size(run%answer%history)))
      text = when(run%answer%runs_away, 'limit load exceeded ')//'at load factor '// &
             short_real(last%load_factor)//when(run%model%controls%sequence, ' of the load case')// &
             when(run%answer%runs_away, ': displacements grow without bound (perfectly plastic material)', &
                  ' after '//plural(last%iteration, 'iteration')//' displacements still change by '// &
                  short_real(last%change)//' of the largest (increase PARAM MAXIT, or '// &
                  other_way(run)//')')// &
             when(run%answer%carried, '. Results are '//when(run%answer%load_factor > 0.0_wp, &
                  'for load factor '//short_real(run%answer%load_factor)//', the last converged load step', &
                  'those at the end of the load case before'))
    end associate
  end function unconverged

  !> What can be done, besides more iterations, if an iteration does not converge.
  pure function other_way(run) result(text)
    class(solution_type), intent(in) :: run
    character(len=:), allocatable :: text

    text = 'use METHOD NEWTON'
    if (run%iteration%method == method_newton) text = 'use more load steps (NLPARM)'
    if (run%model%controls%paper_ratio) text = 'choose another METHOD'
    if (run%model%controls%original) text = 'remove ORIGINAL'
  end function other_way

  !> Load factors of a limit load, for standard output; empty if the limit load was not exceeded.
  pure function limit_load(run) result(text)
    class(solution_type), intent(in) :: run
    character(len=:), allocatable :: text

    text = ''
    if (run%verdict%reason == reason_lost_contact) text = ' after load factor '// &
      short_real(run%answer%load_factor)
    if (run%verdict%reason /= reason_limit_load) return
    text = ' after load factor '//short_real(run%answer%load_factor)//':'
    if (has_escaped(run)) return
    text = ' at load factor '//short_real(run%answer%history(size(run%answer%history))%load_factor)
    if (run%answer%carried) text = text//'; last converged '//short_real(run%answer%load_factor)//':'
  end function limit_load

  !> Name a body by its first node.
  pure function body_name(run, body) result(name)
    class(solution_type), intent(in) :: run
    integer, intent(in) :: body
    character(len=:), allocatable :: name

    name = 'the body of '//first_grid(run%model, run%model%mesh%body == body)
  end function body_name
end module epcont_messages_sentences
