!> What came of a run, in a word and a sentence.
module epcont_report_outcome
  use epcont_base_error, only: status_no_answer, status_numerical, status_usage, status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real
  use epcont_base_tolerances, only: lost_digits
  use epcont_certificate_certificate, only: figure_name
  use epcont_contact_problem, only: contact_no_equilibrium, contact_overlap, contact_solved
  use epcont_model_controls, only: precision_name
  use epcont_model_finding, only: of_node
  use epcont_report_names, only: first_grid, joined, when
  use epcont_report_scene_text, only: scene_sentence, unsound
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

  !> Pairs that are named.
  integer, parameter, public :: most_pairs = 8
  character(len=*), parameter :: reason = &
    'elements differ too much in size or stiffness, hardly anything resists a motion, '// &
    'a body is too slender, or a Poisson''s ratio is too near 0.5'

contains

  !> Judge a run.
  function judge(run) result(outcome)
    class(solution_type), intent(in) :: run   !! a scene with its answer
    type(outcome_type) :: outcome
    character(len=*), parameter :: memory = 'out of memory'

    associate (answer => run%answer)
      if (allocated(answer%against_double)) then
        call conclude(status_usage, memory, 'factors in single precision ('// &
                      trim(precision_name(answer%asked_precision))// &
                      ') give no answer to be trusted, and in double '//answer%against_double)
      else if (answer%lacks_memory) then
        call conclude(status_usage, memory, &
                      'there is not enough memory to factor '//body_name(answer%singular))
      else if (answer%singular > 0) then
        call conclude(status_numerical, 'singular stiffness', 'the stiffness of '// &
                      body_name(answer%singular)//' cannot be factored: '//reason// &
                      when(run%model%has_flat_curve(), '; or a flat curve carries no more (limit load)'))
      else if (answer%contact%state == contact_no_equilibrium) then
        call conclude(status_no_answer, 'no equilibrium', escaping())
      else if (answer%contact%state == contact_overlap) then
        call conclude(status_no_answer, 'overlap', 'pairs overlap and nothing can give way: CGAP '// &
                      joined(pack(run%model%pair_id, answer%contact%overlapping), ' ', most_pairs))
      else if (answer%contact%state /= contact_solved) then
        call conclude(status_numerical, 'contact not found', 'no set of touching pairs passed the test: '// &
                      'rounding has won (condition of the stiffness)')
      else
        call judge_answer()
        outcome%has_answer = .true.
      end if
    end associate

  contains

    !> What came of it.
    subroutine conclude(status, word, sentence)
      integer, intent(in) :: status
      character(len=*), intent(in) :: word, sentence

      outcome = outcome_type(status, word, sentence)
    end subroutine conclude

    !> Judge an answer, where there is one.
    subroutine judge_answer()
      character(len=*), parameter :: doubtful = 'not certified'
      logical :: is_exact

      associate (answer => run%answer, certificate => run%certificate)
        is_exact = answer%lost() <= lost_digits
        if (answer%converged .and. certificate%valid .and. is_exact) then
          call conclude(status_valid, 'valid', '')
          if (.not. certificate%scene%sound()) call conclude( &
            status_numerical, doubtful, scene_sentence(run%model, certificate%scene, unsound))
        else if (.not. answer%converged .and. &
                 (certificate%balanced .and. is_exact .or. answer%runs_away)) then
          call conclude(status_no_answer, 'not converged', unconverged())
        else
          call conclude(status_numerical, &
                        when(certificate%valid .or. certificate%balanced .and. .not. is_exact, &
                             'ill-conditioned', doubtful), &
                        'the figures are not to be trusted: '//doubts())
        end if
      end associate
    end subroutine judge_answer

    !> Which body moves off, and how.
    pure function escaping() result(text)
      character(len=:), allocatable :: text
      integer :: k

      associate (motions => run%motions, escape => run%answer%contact%escape)
        k = maxloc(abs(escape), dim=1)
        text = body_name(motions%body(k))//' moves off and no contact holds it: '// &
               run%model%name_of(of_node, motions%node(k))//' moves along '// &
               merge('-', '+', escape(k) < 0)//merge('x', 'y', motions%component(k) == 1)
      end associate
    end function escaping

    !> What speaks against an answer: the figure of the certificate that is farthest beyond its tolerance, and
    !! lost digits.
    pure function doubts() result(text)
      character(len=:), allocatable :: text
      real(wp), parameter :: least = 1.0e-200_wp   ! a figure over a limit of no size stays a number
      real(wp) :: figure(size(figure_name)), largest(size(figure_name)), much, taken
      integer :: worst

      call run%certificate%figures(figure, largest)
      worst = maxloc(figure/max(largest, least), dim=1)
      text = ''
      if (figure(worst) > largest(worst)) text = trim(figure_name(worst))//' '//short_real(figure(worst))// &
                                                 ' (at most '//short_real(largest(worst))//')'
      much = 0.1_wp*run%certificate%tolerance
      associate (answer => run%answer, lost => run%certificate%lost_stress)
        taken = epsilon(1.0_wp)/answer%weakest%ratio   ! of a pivot: the cause, even if mended
        if (.not. all(figure <= huge(figure))) then
          text = 'the work of the loads is too far from 1.0 for a number: other units'
        else if (taken > much) then
          if (len(text) > 0) text = text//'; '
          text = text//'rounding takes '//short_real(taken)//' of a pivot in the stiffness of '// &
                 body_name(answer%weakest%body)//': '//reason
        else if (lost > much) then
          text = text//'; the rounding of displacements is '//short_real(lost)// &
                 ' of the largest stress: elements too small or too stiff for how far they travel, '// &
                 'or a Poisson''s ratio is too near 0.5'
        else if (answer%condition*epsilon(1.0_wp) > much) then
          text = text//'; the condition of the stiffness is '//short_real(answer%condition)// &
                 ': slender bodies or elements, or SUPORT nodes that are near each other'
        end if
      end associate
    end function doubts

    !> An iteration that was given up, in words.
    pure function unconverged() result(text)
      character(len=:), allocatable :: text

      associate (answer => run%answer, last => run%answer%history(size(run%answer%history)))
        text = 'at load factor '//short_real(last%load_factor)//' '// &
               when(answer%runs_away, 'the displacements grow without end: '// &
                    'it is more than a material with a flat curve can carry (limit load)', &
                    'after '//plural(last%iteration, 'iteration')//' displacements still change by '// &
                    short_real(last%change)// &
                    ' of the largest (PARAM MAXIT: more of them; METHOD: another way)')// &
               when(answer%load_factor < last%load_factor, '; what follows is for load factor '// &
                    short_real(answer%load_factor)//', the largest that converged')
      end associate
    end function unconverged

    !> A body by its first node.
    pure function body_name(body) result(name)
      integer, intent(in) :: body
      character(len=:), allocatable :: name

      name = 'the body of '//first_grid(run%model, run%model%body == body)
    end function body_name
  end function judge
end module epcont_report_outcome
