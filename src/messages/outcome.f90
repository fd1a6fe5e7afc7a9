!> Result of a run in words: status and sentence; type of the largest pressures (bounded, singular, or mesh
!> too coarse); warnings and notes about the answer. The listing has them all; the summary counts them;
!> warnings also go to standard error.
module epcont_messages_outcome
  use epcont_base_diagnostic, only: place_type, severity_warning
  use epcont_base_error, only: status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: newline, plural, short_real, text_of
  use epcont_base_tolerances, only: no_effect
  use epcont_element_kinematics, only: directions
  use epcont_messages_names, only: centre_name, motion_name, percent, when
  use epcont_messages_scene_text, only: large_displacements, scene_sentence, scene_warnings, side_changed, &
      unsound
  use epcont_messages_sentences, only: axis_name, body_name, limit_load, sentence_of
  use epcont_model_finding, only: findings, of_node, of_scene
  use epcont_result_locking, only: high_poisson
  use epcont_solution, only: solution_type
  implicit none
  private
  public :: outcome_type, judge, limit_of_pressure, reason_of
  public :: remark_lines

  character(len=*), parameter, public :: unbounded = 'singular'
  character(len=*), parameter :: not_resolved = 'mesh too coarse', no_contact = 'no contact'

  !> Result of a run.
  type :: outcome_type
    integer :: status = status_valid            !! exit status
    character(len=:), allocatable :: word       !! valid, no equilibrium, limit load, ...
    character(len=:), allocatable :: sentence   !! empty if the answer is valid
    !> Of a limit load: ` at load factor 0.7000; last converged 0.6000:`; otherwise empty
    character(len=:), allocatable :: at_load
    logical :: has_answer = .false.             !! displacements and forces are available
    type(findings) :: found                     !! warnings and notes about the answer
  end type outcome_type

  !> A component of the force on a body gives a warning if its error is at least this part of it, and it is at
  !! least this part of the total contact force.
  real(wp), parameter :: as_much = 0.9_wp, of_total = 0.01_wp

contains

  !> Judge a run.
  function judge(run) result(outcome)
    class(solution_type), intent(in) :: run   !! model with its answer
    type(outcome_type) :: outcome

    outcome%status = run%verdict%status()
    outcome%word = run%verdict%word()
    outcome%sentence = sentence_of(run)
    outcome%at_load = limit_load(run)
    outcome%has_answer = run%verdict%has_answer()
    if (outcome%has_answer) call remark_answer(run, outcome%found)
  end function judge

  !> Add warnings and notes about an answer, for example if small-displacement theory does not apply.
  subroutine remark_answer(run, found)
    class(solution_type), intent(in) :: run
    type(findings), intent(inout) :: found
    integer :: k, vague

    if (run%model%contact%contact_is_off .and. .not. run%certificate%scene%sound()) call warn(found,  &
      'contact is off (BCONTACT): '//scene_sentence(run%model, run%certificate%scene, unsound))
    call warn_of_contact(run, found)
    if (run%answer%lost_contact) call warn(found, 'no contact is left after load factor '// &
      short_real(run%answer%load_factor)//' of the load case: the results are those at this load factor')
    call warn_of_forces(run, found)
    do k = 1, scene_warnings
      if (k == side_changed .and. run%answer%gradient%part > 0.0_wp) then
        call warn(found, large_displacements//'rotation or strain exceeds 0.1 in '// &
                  text_of(nint(100.0_wp*run%answer%gradient%part))//' % of the volume (largest at '// &
                  centre_name(run%model, run%answer%gradient%worst)// &
                  '); equilibrium and contact use the undeformed shape')
      else
        call warn(found, scene_sentence(run%model, run%certificate%scene, k))
      end if
    end do
    call warn_of_material(run, found)
    vague = count(run%answer%contact%indeterminate)
    if (vague > 0) call warn(found, &
      'the forces and pressures of '//plural(vague, 'pair')//' are one choice of many: pairs at one '// &
      'point, or parts that cannot bend (`force not unique` in CONTACT)')
    call warn_of_friction(run, found)
    do k = 1, run%motions%count
      if (.not. run%answer%contact%motion_free(k)) cycle
      call found%add_note(place_type(), 'approach of '//motion_name(run, k)// &
                         ': undetermined rigid-body mode; its value is the smallest that the gaps allow')
    end do
  end subroutine remark_answer

  !> Warn of further answers with friction, or note that they are not searched for. Note the pairs whose
  !! friction force is undetermined.
  subroutine warn_of_friction(run, found)
    class(solution_type), intent(in) :: run
    type(findings), intent(inout) :: found
    integer, allocatable :: still(:)
    integer :: k

    if (allocated(run%answer%contact%several)) then
      associate (several => run%answer%contact%several)
        if (any(several)) call warn(found, 'friction allows more than one answer; this is one of them: '// &
          'others differ at '//plural(count(several), 'pair')//', the first '// &
          text_of(run%model%contact%pair_id(findloc(several, .true., dim=1))))
      end associate
    end if
    if (.not. run%answer%contact%searched) call found%add_note(place_type(), &
      'friction may allow other answers; they are not searched for, as there are more than 100 pairs')
    still = pack([(k, k=1, run%model%contact%pairs)], run%model%contact%friction > 0.0_wp)
    still = pack(still, [(all(run%model%contact%sliding /= still(k)), k=1, size(still))])
    if (size(still) > 0) call found%add_note(place_type(), plural(size(still), 'pair')// &
      ' with friction cannot slide, as supports fix both nodes along the tangent: '// &
      text_of(run%model%contact%pair_id(still(1)))//when(size(still) > 1, ' and others')// &
      '; friction forces are undetermined there, and 0.0')
  end subroutine warn_of_friction

  !> Add a warning, unless the text is empty.
  subroutine warn(found, text)
    type(findings), intent(inout) :: found
    character(len=*), intent(in) :: text

    if (len(text) > 0) call found%add_warning(of_scene, 0, 0, text, '')
  end subroutine warn

  !> Warn if no pair is in contact.
  subroutine warn_of_contact(run, found)
    class(solution_type), intent(in) :: run
    type(findings), intent(inout) :: found
    integer :: nearest

    if (run%model%contact%pairs == 0 .or. any(run%answer%contact%touching)) return
    associate (gap => run%answer%contact%gap)
      ! If gaps are almost equal, the first is named, so that rounding does not choose.
      nearest = findloc(gap <= (1.0_wp + no_effect)*minval(gap), .true., dim=1)
      call warn(found, 'nothing touches: no pair carries a force; nearest is '// &
                run%model%name_of(of_node, run%model%contact%pair_node(1, nearest))//', '// &
                short_real(gap(nearest))//' away')
    end associate
  end subroutine warn_of_contact

  !> Warn of force components that may not exist: narrow contact has them only through the inclination of its
  !! normals, but they may support a body.
  subroutine warn_of_forces(run, found)
    class(solution_type), intent(in) :: run
    type(findings), intent(inout) :: found
    real(wp) :: error, force
    integer :: c, i

    if (.not. allocated(run%accuracy%body_force) .or. run%model%contact%has_friction()) return
    do i = 1, size(run%answer%bodies)
      do c = 1, directions
        force = abs(run%answer%bodies(i)%resultant(c))
        error = run%accuracy%body_force(c, i)
        if (error < as_much*force .or. force < of_total*sum(run%answer%contact%force)) cycle
        call warn(found, 'contact may not carry '//short_real(force)//' along '//axis_name(c)// &
                  ' on '//body_name(run, run%answer%bodies(i)%body)// &
                  ': the error is as large, because normals are inclined; supported parts may slide')
      end do
    end do
  end subroutine warn_of_forces

  !> Warn of elements that are too stiff, or strained too far.
  subroutine warn_of_material(run, found)
    class(solution_type), intent(in) :: run
    type(findings), intent(inout) :: found

    if (run%answer%locking%elements > 0) &
      call warn(found, plural(run%answer%locking%elements, 'three-node element')// &
                when(run%answer%locking%elements > 1, ' are', ' is')// &
                ' too stiff (locking): nearly incompressible'// &
                when(any(run%answer%plastic), ' after yielding')//' (Poisson''s ratio '// &
                short_real(high_poisson)//' or more), the mean stress scatters by '// &
                percent(run%answer%locking%scatter, 1.0_wp)// &
                ' of the equivalent stress. Use six-node elements or CQUAD4')
    if (any(run%answer%beyond)) &
      call warn(found, 'strained beyond the last point of the table; its last slope is used: '// &
                'element '//text_of(run%model%mesh%element_id(findloc(run%answer%beyond, .true., dim=1)))// &
                when(count(run%answer%beyond) > 1, ' and '//text_of(count(run%answer%beyond) - 1)//' more'))
    if (run%answer%shortfall > 0.0_wp) &
      call warn(found, 'formula (2-4) (MUP PAPER) is an approximation: stresses beyond yield are up to '// &
                percent(run%answer%shortfall, 1.0_wp)//' below the curve; the certificate does not see it')
  end subroutine warn_of_material

  !> Type of the largest pressure of a zone, or of all zones; empty if unknown. If no pair is in contact, the
  !! pressure is 0.0.
  pure function limit_of_pressure(run, zone) result(word)
    class(solution_type), intent(in) :: run   !! model with its answer
    integer, intent(in), optional :: zone     !! if absent, the zone with the largest pressure
    character(len=:), allocatable :: word
    integer :: z

    z = run%accuracy%leading
    if (present(zone)) z = zone
    word = ''
    if (z == 0 .and. run%model%contact%pairs > 0 .and. .not. any(run%answer%contact%touching)) word = &
      no_contact
    if (z == 0 .or. z > size(run%accuracy%zone)) return
    if (run%answer%zones(z)%max_pressure < 0.0_wp) return
    word = when(run%accuracy%zone(z)%resolved, 'bounded', not_resolved)
    if (run%accuracy%zone(z)%unbounded) word = unbounded
  end function limit_of_pressure

  !> Explain this type at the end of a line of the listing; empty if no explanation is needed.
  pure function reason_of(word) result(text)
    character(len=*), intent(in) :: word   !! from `limit_of_pressure`
    character(len=:), allocatable :: text

    text = ''
    if (word == unbounded) text = '   singular: diverges with mesh refinement'
    if (word == no_contact) text = '   no contact: nothing touches'
    if (word == not_resolved) text = '   mesh too coarse: too few pairs in contact where it is largest'
  end function reason_of

  !> Warnings about an answer, one line each, and its notes if requested.
  pure function remark_lines(found, with_notes) result(text)
    type(findings), intent(in) :: found     !! findings about the answer
    logical, intent(in) :: with_notes       !! include notes
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
end module epcont_messages_outcome
