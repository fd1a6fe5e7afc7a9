!> What came of a run, in a word and a sentence; what the largest pressures are beside their figures: bounded,
!> unbounded, or not resolved by the mesh. And warnings and notes: what the deck has that is not as it seems,
!> and what of the answer is not as it should be. They stand in the listing, are counted in the summary, and
!> warnings go to standard error too.
module epcont_report_outcome
  use epcont_base_diagnostic, only: place_type, severity_warning
  use epcont_base_error, only: status_no_answer, status_numerical, status_usage, status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: newline, plural, short_real, text_of
  use epcont_base_tolerances, only: lost_digits, no_effect, valid_to
  use epcont_certificate_certificate, only: figure_name
  use epcont_contact_problem, only: contact_no_equilibrium, contact_overlap, contact_solved
  use epcont_element_kinematics, only: directions
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle
  use epcont_model_finding, only: findings, of_node, of_scene
  use epcont_report_columns, only: percent
  use epcont_report_names, only: centre_name, first_grid, joined, motion_name, when
  use epcont_report_scene_text, only: scene_sentence, scene_warnings, side_changed, unsound
  use epcont_result_answer, only: answer_type
  use epcont_result_locking, only: high_poisson
  use epcont_solution, only: solution_type
  implicit none
  private
  public :: outcome_type, judge, limit_of_pressure, reason_of
  public :: remark_lines, poisson_text

  character(len=*), parameter, public :: unbounded = 'unbounded'
  character(len=*), parameter :: not_resolved = 'not resolved', no_contact = 'no contact'

  !> What came of a run.
  type :: outcome_type
    integer :: status = status_valid            !! exit status
    character(len=:), allocatable :: word       !! valid, no equilibrium, ...
    character(len=:), allocatable :: sentence   !! empty where the answer is valid
    logical :: has_answer = .false.             !! displacements and forces were found
    type(findings) :: found                     !! warnings and notes of the answer
  end type outcome_type

  !> Pairs that are named.
  integer, parameter, public :: most_pairs = 8
  !> A component of the force on a body is warned of where its error is as large, but for a tenth, and it is
  !! some of the total contact force.
  real(wp), parameter :: as_much = 0.9_wp, of_total = 0.01_wp
  character(len=*), parameter :: axis_name(2) = ['x', 'y'], reason = &
    'elements differ too much in size or stiffness, hardly anything resists a motion, '// &
    'a body is too slender, or a Poisson''s ratio is too near 0.5'

contains

  !> Judge a run.
  function judge(run) result(outcome)
    class(solution_type), intent(in) :: run   !! a scene with its answer
    type(outcome_type) :: outcome

    if (run%answer%lacks_memory) then
      call conclude(status_usage, 'out of memory', &
                    'there is not enough memory to factor '//body_name(run%answer%failed_body))
    else if (run%answer%failed_body > 0) then
      call conclude(status_numerical, 'singular stiffness', 'the stiffness of '// &
                    body_name(run%answer%failed_body)//' cannot be factored: '//reason// &
                    when(run%model%has_flat_curve(), '; or a flat curve carries no more (limit load)'))
    else if (run%answer%contact%state == contact_no_equilibrium) then
      call conclude(status_no_answer, 'no equilibrium', escaping())
    else if (run%answer%contact%state == contact_overlap) then
      call conclude(status_no_answer, 'overlap', 'pairs overlap and nothing can give way: CGAP '// &
                    joined(pack(run%model%pair_id, run%answer%contact%overlapping), ' ', most_pairs))
    else if (run%answer%contact%state /= contact_solved) then
      call conclude(status_numerical, 'contact not found', 'no set of touching pairs passed the test: '// &
                    'inconclusive because of rounding ('//cause_of_rounding()//')')
    else
      call judge_answer()
      outcome%has_answer = .true.
      call remark_answer()
    end if

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

      is_exact = run%answer%lost() <= lost_digits
      if (run%answer%converged .and. run%certificate%valid .and. is_exact) then
        call conclude(status_valid, 'valid', '')
        if (.not. (run%certificate%scene%sound() .or. run%model%contact_is_off)) call conclude( &
          status_numerical, doubtful, scene_sentence(run%model, run%certificate%scene, unsound))
      else if (.not. run%answer%converged .and. &
               (run%certificate%balanced .and. is_exact .or. run%answer%runs_away)) then
        call conclude(status_no_answer, 'not converged', unconverged())
      else
        call conclude(status_numerical, &
                      when(run%certificate%valid .or. run%certificate%balanced .and. .not. is_exact, &
                           'ill-conditioned', doubtful), 'the figures are not to be trusted: '//doubts())
      end if
    end subroutine judge_answer

    !> Add warnings and notes of an answer: where its equations, solved as they are, are not those of the
    !! scene.
    subroutine remark_answer()
      integer :: k, vague

      if (run%model%contact_is_off .and. .not. run%certificate%scene%sound()) call warn( &
        'contact is off (BCONTACT): '//scene_sentence(run%model, run%certificate%scene, unsound))
      call warn_of_contact()
      call warn_of_forces()
      do k = 1, scene_warnings
        if (k == side_changed .and. run%answer%gradient%part > 0.0_wp) then
          call warn('displacements are not small: '//text_of(nint(100.0_wp*run%answer%gradient%part))// &
                    ' % of the volume turned or stretched by over 0.1, most at '// &
                    centre_name(run%model, run%answer%gradient%worst)// &
                    '; equilibrium and contact are those of the undeformed shape')
        else
          call warn(scene_sentence(run%model, run%certificate%scene, k))
        end if
      end do
      call warn_of_material()
      vague = count(run%answer%contact%indeterminate)
      if (vague > 0) call warn('the forces of '//plural(vague, 'pair')//' are one choice of many, and so '// &
        'are their pressures: pairs at one place, or parts that cannot bend (`force not unique` in CONTACT)')
      do k = 1, run%motions%count
        if (.not. run%answer%contact%motion_free(k)) cycle
        call outcome%found%add_note(place_type(), 'approach of '//motion_name(run, k)// &
                                    ': nothing resists or drives this motion: its value is a choice')
      end do
    end subroutine remark_answer

    !> Add a warning; an empty text is none.
    subroutine warn(text)
      character(len=*), intent(in) :: text

      if (len(text) > 0) call outcome%found%add_warning(of_scene, 0, 0, text, '')
    end subroutine warn

    !> No pair closes.
    subroutine warn_of_contact()
      integer :: nearest

      if (run%model%pairs == 0 .or. any(run%answer%contact%touching)) return
      associate (gap => run%answer%contact%gap)
        ! Of gaps that are as good as equal the first: rounding chooses no pair.
        nearest = findloc(gap <= (1.0_wp + no_effect)*minval(gap), .true., dim=1)
        call warn('nothing touches: no pair carries a force; nearest is '// &
                  run%model%name_of(of_node, run%model%pair_node(1, nearest))//', '// &
                  short_real(gap(nearest))//' away')
      end associate
    end subroutine warn_of_contact

    !> A component that narrow contact has by how its normals lean alone, and that may hold a body.
    subroutine warn_of_forces()
      real(wp) :: error, force
      integer :: c, i

      if (.not. allocated(run%accuracy%body_force)) return
      do i = 1, size(run%answer%bodies)
        do c = 1, directions
          force = abs(run%answer%bodies(i)%resultant(c))
          error = run%accuracy%body_force(c, i)
          if (error < as_much*force .or. force < of_total*sum(run%answer%contact%force)) cycle
          call warn('contact may not bear '//short_real(force)//' along '//axis_name(c)// &
                    ' on '//body_name(run%answer%bodies(i)%body)// &
                    ': its error is as large, normals lean there; what rests on it may slide')
        end do
      end do
    end subroutine warn_of_forces

    !> Elements that are too stiff, strained too far, or unloaded.
    subroutine warn_of_material()
      if (run%answer%locking%elements > 0) &
        call warn(plural(run%answer%locking%elements, 'three-node element')// &
                  ' of nearly constant volume ('//poisson_text(run%answer)// &
                '): too stiff; six-node elements or CQUAD4 would be right')
      if (any(run%answer%beyond)) &
        call warn(plural(count(run%answer%beyond), 'element')// &
                  ' strained beyond the last point of the table, whose last slope goes on')
      if (run%answer%shortfall > 0.0_wp) &
        call warn('formula (2-4) (MUP PAPER) is an approximation: stresses beyond yield are up to '// &
                  percent(run%answer%shortfall, 1.0_wp)//' below the curve; the certificate does not see it')
      if (run%answer%unloaded > 0) &
        call warn(plural(run%answer%unloaded, 'element')//' unloaded after yielding: '// &
                  'the theory takes them back along the curve, not along the elastic line')
    end subroutine warn_of_material

    !> Which body moves off, and how.
    pure function escaping() result(text)
      character(len=:), allocatable :: text
      integer :: k

      k = maxloc(abs(run%answer%contact%escape), dim=1)
      text = body_name(run%motions%body(k))//' moves off and no contact holds it: '// &
             run%model%name_of(of_node, run%motions%node(k))//' moves along '// &
             merge('-', '+', run%answer%contact%escape(k) < 0)// &
             axis_name(min(directions, run%motions%component(k)))
      if (run%motions%component(k) == angle) text = text(:index(text, ' moves along'))//'turns'
    end function escaping

    !> Why no set of pairs passed the test.
    pure function cause_of_rounding() result(text)
      character(len=:), allocatable :: text

      text = 'condition of the stiffness'
      if (.not. any(run%answer%contact%overlapping)) return
      associate (turn => abs(run%answer%contact%escape))
        text = 'CGAP '//joined(pack(run%model%pair_id, run%answer%contact%overlapping), ' ', most_pairs)// &
               ' alone hold '//motion_name(run, findloc(turn > 0.5_wp*maxval(turn), .true., dim=1))// &
               ', and hardly: hold it by SPC1'
      end associate
    end function cause_of_rounding

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
      much = 0.1_wp*valid_to
      taken = epsilon(1.0_wp)/run%answer%weakest%ratio   ! of a pivot: the cause, even if mended
      if (.not. all(figure <= huge(figure))) then
        text = 'the work of the loads is too far from 1.0 for a number: other units'
      else if (taken > much) then
        if (len(text) > 0) text = text//'; '
        text = text//'rounding takes '//short_real(taken)//' of a pivot in the stiffness of '// &
               body_name(run%answer%weakest%body)//': '//reason
      else if (run%certificate%lost_stress > much) then
        text = text//'; the rounding of displacements is '//short_real(run%certificate%lost_stress)// &
               ' of the largest stress: elements too small or too stiff for how far they travel, '// &
               'or a Poisson''s ratio is too near 0.5'
      else if (run%answer%condition*epsilon(1.0_wp) > much) then
        text = text//'; the condition of the stiffness is '//short_real(run%answer%condition)// &
               ': slender bodies or elements, or SUPORT nodes that are near each other'
      end if
    end function doubts

    !> An iteration that was given up, in words.
    pure function unconverged() result(text)
      character(len=:), allocatable :: text

      associate (last => run%answer%history(size(run%answer%history)))
        text = 'at load factor '//short_real(last%load_factor)//' '// &
               when(run%answer%runs_away, 'the displacements grow without end: '// &
                    'it is more than a material with a flat curve can carry (limit load)', &
                    'after '//plural(last%iteration, 'iteration')//' displacements still change by '// &
                    short_real(last%change)// &
                    ' of the largest (PARAM MAXIT: more of them; '// &
                    when(run%model%controls%original, 'no ORIGINAL', 'METHOD')//': another way)')// &
               when(run%answer%carried, '; what follows is for load factor '// &
                    short_real(run%answer%load_factor)//', the largest that converged')
      end associate
    end function unconverged

    !> A body by its first node.
    pure function body_name(body) result(name)
      integer, intent(in) :: body
      character(len=:), allocatable :: name

      name = 'the body of '//first_grid(run%model, run%model%body == body)
    end function body_name
  end function judge

  !> What the largest pressure of a zone is, or of all zones; empty where that is not known. Where no pair
  !! touches, it is 0.0, and that is said.
  pure function limit_of_pressure(run, zone) result(word)
    class(solution_type), intent(in) :: run   !! a scene with its answer
    integer, intent(in), optional :: zone     !! not given: the one with the largest pressure
    character(len=:), allocatable :: word
    integer :: z

    z = run%accuracy%leading
    if (present(zone)) z = zone
    word = ''
    if (z == 0 .and. run%model%pairs > 0 .and. .not. any(run%answer%contact%touching)) word = no_contact
    if (z == 0 .or. z > size(run%accuracy%zone)) return
    if (run%answer%zones(z)%max_pressure < 0.0_wp) return
    word = when(run%accuracy%zone(z)%resolved, 'bounded', not_resolved)
    if (run%accuracy%zone(z)%unbounded) word = unbounded
  end function limit_of_pressure

  !> What a limit means, for the end of a line of the listing; empty where there is nothing to say.
  pure function reason_of(word) result(text)
    character(len=*), intent(in) :: word   !! as `limit_of_pressure` has it
    character(len=:), allocatable :: text

    text = ''
    if (word == unbounded) text = '   unbounded: it grows with every finer mesh'
    if (word == no_contact) text = '   no contact: nothing touches'
    if (word == not_resolved) text = '   not resolved: too few pairs where it is largest'
  end function reason_of

  !> Warnings of an answer in lines, and its notes if these are wanted.
  pure function remark_lines(found, with_notes) result(text)
    type(findings), intent(in) :: found     !! of the answer
    logical, intent(in) :: with_notes       !! are they?
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, found%count
      if (found%list(i)%severity == severity_warning) then
        text = text//'warning: '//found%list(i)%what//newline
      else if (with_notes) then
        text = text//found%list(i)%what//newline
      end if
    end do
  end function remark_lines

  !> From which Poisson's ratio on three-node elements lock, and why they have it.
  pure function poisson_text(answer) result(text)
    type(answer_type), intent(in) :: answer   !! the answer
    character(len=:), allocatable :: text

    text = 'Poisson''s ratio '//short_real(high_poisson)//' or more'// &
           when(any(answer%plastic), ', as yielding has made it')
  end function poisson_text
end module epcont_report_outcome
