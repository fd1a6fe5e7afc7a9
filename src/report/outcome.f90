!> What came of a run, in a word and a sentence.
module epcont_report_outcome
  use epcont_base_error, only: status_no_answer, status_numerical, status_usage, status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_certificate_certificate, only: certificate_type, figure_name
  use epcont_contact_problem, only: contact_no_equilibrium, contact_overlap, contact_solved
  use epcont_model_controls, only: precision_name
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_report_scene_text, only: scene_fault
  use epcont_result_answer, only: answer_type, largest_loss
  implicit none
  private
  public :: outcome_type, judge

  type :: outcome_type
    integer :: status = status_valid            !! exit status
    character(len=:), allocatable :: word       !! valid, no equilibrium, ...
    character(len=:), allocatable :: sentence   !! empty where the answer is valid
    logical :: has_answer = .false.             !! displacements and forces were found
  end type outcome_type

  character(len=*), parameter :: reason = &
    'elements differ too much in size or stiffness, hardly anything resists a motion, a body is too slender, '// &
    'or a Poisson''s ratio is too near 0.5'
  character(len=*), parameter :: axis(2) = ['x', 'y']

contains

  !> Judge an answer.
  pure function judge(model, motions, answer, certificate, singular) result(outcome)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(answer_type), intent(in) :: answer
    type(certificate_type), intent(in) :: certificate
    integer, intent(in) :: singular  !! body that could not be factored, or 0
    type(outcome_type) :: outcome
    integer :: k

    outcome%sentence = ''
    if (allocated(answer%against_double)) then
      outcome%status = status_usage
      outcome%word = 'out of memory'
      outcome%sentence = 'factors in single precision ('//trim(precision_name(answer%asked_precision))// &
                         ') give no answer to be trusted, and in double '//answer%against_double
    else if (answer%lacks_memory) then
      outcome%status = status_usage
      outcome%word = 'out of memory'
      outcome%sentence = 'there is not enough memory to factor the body of GRID '//first_node(model, singular)
    else if (singular > 0) then
      outcome%status = status_numerical
      outcome%word = 'singular stiffness'
      outcome%sentence = 'the stiffness of the body of GRID '//first_node(model, singular)// &
                         ' cannot be factored: '//reason
      if (model%has_flat_curve()) outcome%sentence = outcome%sentence//'; or a flat curve carries no more (limit load)'
    else if (answer%contact%state == contact_no_equilibrium) then
      outcome%status = status_no_answer
      outcome%word = 'no equilibrium'
      k = maxloc(abs(answer%contact%escape), dim=1)
      outcome%sentence = 'the body of GRID '//first_node(model, motions%body(k))// &
                         ' moves off and no contact holds it: GRID '// &
                         text_of(model%node_id(motions%node(k)))//' moves along '// &
                         merge('-', '+', answer%contact%escape(k) < 0)//axis(motions%component(k))
    else if (answer%contact%state == contact_overlap) then
      outcome%status = status_no_answer
      outcome%word = 'overlap'
      outcome%sentence = 'pairs overlap and nothing can give way: CGAP'//names(model, answer%contact%overlapping)
    else if (answer%contact%state /= contact_solved) then
      outcome%status = status_numerical
      outcome%word = 'contact not found'
      outcome%sentence = 'no set of touching pairs passed the test: rounding has won (condition of the stiffness)'
    else
      outcome%has_answer = .true.
      outcome%word = 'valid'
      if (answer%converged .and. certificate%valid .and. answer%lost() <= largest_loss) then
        if (certificate%scene%sound()) return
        outcome%status = status_numerical
        outcome%word = 'not certified'
        outcome%sentence = scene_fault(model, certificate%scene)
        return
      end if
      if (.not. answer%converged .and. (certificate%balanced .and. answer%lost() <= largest_loss .or. answer%runs_away)) then
        outcome%status = status_no_answer
        outcome%word = 'not converged'
        outcome%sentence = unconverged(model, answer)
        return
      end if
      outcome%status = status_numerical
      outcome%word = trim(merge('ill-conditioned', 'not certified  ', certificate%valid .or. certificate%balanced .and. &
                                answer%lost() > largest_loss))
      outcome%sentence = 'the figures are not to be trusted: '//doubts(model, answer, certificate)
    end if
  end function judge

  !> What speaks against an answer: the figure of the certificate that is farthest beyond its tolerance, and lost digits.
  pure function doubts(model, answer, certificate) result(text)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    type(certificate_type), intent(in) :: certificate
    character(len=:), allocatable :: text
    real(wp), parameter :: least = 1.0e-200_wp   ! a limit of no size is none, and no figure over it beyond the largest number
    real(wp) :: figure(size(figure_name)), largest(size(figure_name)), taken
    integer :: worst

    call certificate%figures(figure, largest)
    worst = maxloc(figure/max(largest, least), dim=1)
    taken = epsilon(1.0_wp)/answer%weakest%ratio   ! of a pivot: the cause, though refinement may have mended it
    text = ''
    if (figure(worst) > largest(worst)) &
      text = trim(figure_name(worst))//' '//short_real(figure(worst))//' (at most '//short_real(largest(worst))//')'
    if (.not. all(figure <= huge(figure))) then
      text = 'the work of the loads is too far from 1.0 for a number: other units'
    else if (taken > 0.1_wp*certificate%tolerance) then
      if (len(text) > 0) text = text//'; '
      text = text//'rounding takes '//short_real(taken)// &
             ' of a pivot in the stiffness of the body of GRID '//first_node(model, answer%weakest%body)//': '//reason
    else if (certificate%lost_stress > 0.1_wp*certificate%tolerance) then
      text = text//'; the rounding of displacements is '//short_real(certificate%lost_stress)// &
             ' of the largest stress: elements too small or too stiff for how far they travel, '// &
             'or a Poisson''s ratio is too near 0.5'
    else if (answer%condition*epsilon(1.0_wp) > 0.1_wp*certificate%tolerance) then
      text = text//'; the condition of the stiffness is '//short_real(answer%condition)// &
             ': slender bodies or elements, or SUPORT nodes that are near each other'
    end if
  end function doubts

  !> An iteration that was given up, in words.
  pure function unconverged(model, answer) result(text)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    character(len=:), allocatable :: text
    integer :: n

    n = size(answer%history)
    text = 'at load factor '//short_real(answer%history(n)%load_factor)//' '
    if (answer%runs_away) then
      text = text//'the displacements grow without end: it is more than a material with a flat curve can carry (limit load)'
    else
      text = text//'after '//plural(answer%history(n)%iteration, 'iteration')//' displacements still change by '// &
             short_real(answer%history(n)%change)//' of the largest (PARAM MAXIT: more of them; METHOD: another way)'
    end if
    if (answer%load_factor < answer%history(n)%load_factor) &
      text = text//'; what follows is for load factor '//short_real(answer%load_factor)//', the largest that converged'
  end function unconverged

  !> Id of the first node of a body.
  pure function first_node(model, body) result(id)
    type(model_type), intent(in) :: model
    integer, intent(in) :: body
    character(len=:), allocatable :: id

    id = text_of(minval(model%node_id, mask=model%body == body))
  end function first_node

  !> Ids of the first pairs of a set.
  pure function names(model, chosen) result(text)
    type(model_type), intent(in) :: model
    logical, intent(in) :: chosen(:)
    character(len=:), allocatable :: text
    integer, parameter :: most = 8
    integer :: k, named

    text = ''
    named = 0
    do k = 1, model%pairs
      if (.not. chosen(k)) cycle
      named = named + 1
      if (named <= most) text = text//' '//text_of(model%pair_id(k))
    end do
    if (named > most) text = text//' and '//text_of(named - most)//' more'
  end function names
end module epcont_report_outcome
