!> What came of a run, in a word and a sentence.
module epcont_report_outcome
  use epcont_base_error, only: status_no_answer, status_numerical, status_usage, status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real
  use epcont_base_tolerances, only: lost_digits
  use epcont_certificate_certificate, only: figure_name
  use epcont_contact_problem, only: contact_no_equilibrium, contact_overlap, contact_solved
  use epcont_model_controls, only: precision_name
  use epcont_model_model, only: model_type
  use epcont_report_names, only: first_grid, grid_name, joined
  use epcont_report_scene_text, only: scene_fault
  use epcont_result_answer, only: answer_type
  use epcont_solution, only: solution_type
  implicit none
  private
  public :: judge, outcome_type

  !> What came of a run.
  type :: outcome_type
    integer :: status = status_valid            !! exit status
    character(len=:), allocatable :: word       !! valid, no equilibrium, ...
    character(len=:), allocatable :: sentence   !! empty where the answer is valid
    logical :: has_answer = .false.             !! displacements and forces were found
  end type outcome_type

  character(len=*), parameter :: reason = &
    'elements differ too much in size or stiffness, hardly anything resists a motion, '// &
    'a body is too slender, or a Poisson''s ratio is too near 0.5'
  !> Pairs that are named.
  integer, parameter :: most_pairs = 8
  character(len=*), parameter :: axis(2) = ['x', 'y']

contains

  !> Judge a run.
  pure function judge(run) result(outcome)
    class(solution_type), intent(in) :: run   !! a scene with its answer
    type(outcome_type) :: outcome

    associate (model => run%model, answer => run%answer)
      if (allocated(answer%against_double)) then
        outcome = new_outcome(status_usage, 'out of memory', 'factors in single precision ('// &
                               trim(precision_name(answer%asked_precision))// &
                               ') give no answer to be trusted, and in double '//answer%against_double)
      else if (answer%lacks_memory) then
        outcome = new_outcome(status_usage, 'out of memory', &
                               'there is not enough memory to factor '//body_name(model, answer%singular))
      else if (answer%singular > 0) then
        outcome = new_outcome(status_numerical, 'singular stiffness', 'the stiffness of '// &
                              body_name(model, answer%singular)// &
                               ' cannot be factored: '//reason)
        if (model%has_flat_curve()) &
          outcome%sentence = outcome%sentence//'; or a flat curve carries no more (limit load)'
      else if (answer%contact%state == contact_no_equilibrium) then
        outcome = new_outcome(status_no_answer, 'no equilibrium', escaping(run))
      else if (answer%contact%state == contact_overlap) then
        outcome = new_outcome(status_no_answer, 'overlap', 'pairs overlap and nothing can give way: CGAP '// &
                               joined(pack(model%pair_id, answer%contact%overlapping), ' ', most_pairs))
      else if (answer%contact%state /= contact_solved) then
        outcome = new_outcome(status_numerical, 'contact not found', &
                              'no set of touching pairs passed the test: rounding has won '// &
                              '(condition of the stiffness)')
      else
        outcome = outcome_of_answer(run)
      end if
    end associate
  end function judge

  !> Judge an answer, where there is one.
  pure function outcome_of_answer(run) result(outcome)
    class(solution_type), intent(in) :: run
    type(outcome_type) :: outcome
    logical :: is_exact

    associate (answer => run%answer, certificate => run%certificate)
      is_exact = answer%lost() <= lost_digits
      if (answer%converged .and. certificate%valid .and. is_exact) then
        outcome = new_outcome(status_valid, 'valid', '')
        if (.not. certificate%scene%sound()) &
          outcome = new_outcome(status_numerical, 'not certified', scene_fault(run%model, certificate%scene))
      else if (.not. answer%converged .and. (certificate%balanced .and. is_exact .or. answer%runs_away)) then
        outcome = new_outcome(status_no_answer, 'not converged', unconverged(answer))
      else
        outcome = new_outcome(status_numerical, 'not certified', &
                              'the figures are not to be trusted: '//doubts(run))
        if (certificate%valid .or. certificate%balanced .and. .not. is_exact) outcome%word = 'ill-conditioned'
      end if
    end associate
    outcome%has_answer = .true.
  end function outcome_of_answer

  !> An outcome.
  pure function new_outcome(status, word, sentence) result(outcome)
    integer, intent(in) :: status
    character(len=*), intent(in) :: word, sentence
    type(outcome_type) :: outcome

    outcome%status = status
    outcome%word = word
    outcome%sentence = sentence
  end function new_outcome

  !> Which body moves off, and how.
  pure function escaping(run) result(text)
    class(solution_type), intent(in) :: run
    character(len=:), allocatable :: text
    integer :: k

    associate (motions => run%motions, escape => run%answer%contact%escape)
      k = maxloc(abs(escape), dim=1)
      text = body_name(run%model, motions%body(k))//' moves off and no contact holds it: '// &
             grid_name(run%model, motions%node(k))//' moves along '//merge('-', '+', escape(k) < 0)// &
             axis(motions%component(k))
    end associate
  end function escaping

  !> What speaks against an answer: the figure of the certificate that is farthest beyond its tolerance, and
  !! lost digits.
  pure function doubts(run) result(text)
    class(solution_type), intent(in) :: run
    character(len=:), allocatable :: text
    real(wp), parameter :: least = 1.0e-200_wp   ! a figure over a limit of no size stays a number
    real(wp) :: figure(size(figure_name)), largest(size(figure_name)), taken
    integer :: worst

    call run%certificate%figures(figure, largest)
    worst = maxloc(figure/max(largest, least), dim=1)
    taken = epsilon(1.0_wp)/run%answer%weakest%ratio   ! of a pivot: the cause, even if mended
    text = ''
    if (figure(worst) > largest(worst)) &
      text = trim(figure_name(worst))//' '//short_real(figure(worst))//' (at most '// &
             short_real(largest(worst))//')'
    if (.not. all(figure <= huge(figure))) then
      text = 'the work of the loads is too far from 1.0 for a number: other units'
    else if (taken > 0.1_wp*run%certificate%tolerance) then
      if (len(text) > 0) text = text//'; '
      text = text//'rounding takes '//short_real(taken)// &
             ' of a pivot in the stiffness of '//body_name(run%model, run%answer%weakest%body)//': '//reason
    else if (run%certificate%lost_stress > 0.1_wp*run%certificate%tolerance) then
      text = text//'; the rounding of displacements is '//short_real(run%certificate%lost_stress)// &
             ' of the largest stress: elements too small or too stiff for how far they travel, '// &
             'or a Poisson''s ratio is too near 0.5'
    else if (run%answer%condition*epsilon(1.0_wp) > 0.1_wp*run%certificate%tolerance) then
      text = text//'; the condition of the stiffness is '//short_real(run%answer%condition)// &
             ': slender bodies or elements, or SUPORT nodes that are near each other'
    end if
  end function doubts

  !> An iteration that was given up, in words.
  pure function unconverged(answer) result(text)
    type(answer_type), intent(in) :: answer
    character(len=:), allocatable :: text

    associate (last => answer%history(size(answer%history)))
      text = 'at load factor '//short_real(last%load_factor)//' '
      if (answer%runs_away) then
        text = text//'the displacements grow without end: '// &
               'it is more than a material with a flat curve can carry (limit load)'
      else
        text = text//'after '//plural(last%iteration, 'iteration')//' displacements still change by '// &
               short_real(last%change)//' of the largest (PARAM MAXIT: more of them; METHOD: another way)'
      end if
      if (answer%load_factor < last%load_factor) &
        text = text//'; what follows is for load factor '//short_real(answer%load_factor)// &
               ', the largest that converged'
    end associate
  end function unconverged

  !> A body by its first node.
  pure function body_name(model, body) result(name)
    type(model_type), intent(in) :: model
    integer, intent(in) :: body
    character(len=:), allocatable :: name

    name = 'the body of '//first_grid(model, model%body == body)
  end function body_name
end module epcont_report_outcome
