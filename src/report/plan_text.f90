!> The plan in words: model, methods, memory and operations.
module epcont_report_plan_text
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_model_controls, only: method_inistr, method_name, method_newton, rule_joined, solver_auto, &
      solver_band, solver_frontal, solver_name
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_model, only: model_type
  use epcont_plan_joining, only: many_of
  use epcont_plan_numbering, only: many_operations
  use epcont_plan_planned_model, only: planned_model
  use epcont_report_columns, only: column, table_type, whole, word
  use epcont_messages_names, only: joined, motion_name, when
  implicit none
  private
  public :: plan_text

  !> Largest number of rigid-body modes, bodies and contacts that are listed, and of corners of each line.
  integer, parameter :: most = 20, most_corners = 8

  type(column), parameter :: body_columns(*) = [ &
    column(whole, head='body', width=7), column(whole, head='nodes', width=7), &
    column(whole, head='equations', width=11), column(word, head='half-bandwidth', width=16), &
    column(whole, head='contact equations', width=19), column(word, head='factorizations', width=16)]

  !> Descriptions of the methods, beginning with SECANT.
  character(len=*), parameter :: method_text(*) = [character(len=90) :: &
    'full load, secant moduli from the previous strains', &
    'full load, secant moduli from previous strains with Anderson acceleration', &
    'elastic stiffness, factored once; initial stresses with Anderson acceleration', &
    'consistent tangent, exact contact in each iteration, line search on the energy']

contains

  !> Write the plan of a model, in lines.
  function plan_text(scene, of) result(text)
    type(planned_model), intent(in) :: scene   !! model and plan
    character(len=*), intent(in), optional :: of   !! names of the load cases
    character(len=:), allocatable :: text
    type(table_type) :: plan
    logical :: deformable(scene%model%mesh%bodies)
    integer :: k

    deformable = .false.
    deformable(scene%model%mesh%body(scene%model%mesh%connectivity(1, :))) = .true.
    if (present(of)) call plan%heading('PLAN  ('//of//')')
    if (.not. present(of)) call plan%heading('PLAN')
    call plan%say(plural(scene%model%mesh%nodes, 'node')//', '// &
                  plural(scene%model%mesh%elements, 'element')//', '// &
             plural(scene%model%contact%pairs, 'contact pair')//'; bodies: '//text_of(count(deformable))// &
             ' deformable'//when(.not. all(deformable), ', '//text_of(count(.not. deformable))//' rigid'))
    if (scene%iteration%from_first_pivot) &
      call plan%say('ORIGINAL: as in about 1980, with all pivots of the simplex in each iteration')
    call say_iteration(plan, scene, present(of))
    call say_rule(plan, scene)
    do k = 1, min(most, size(scene%model%contact%line_contact))
      call say_contact(plan, scene, scene%model%contact%line_contact(k))
    end do
    call say_further(size(scene%model%contact%line_contact), 'further contact', ' of lines')
    do k = 1, min(most, scene%motions%count)
      call plan%say('rigid-body mode solved for (SUPORT): '//motion_name(scene, k))
    end do
    call say_further(scene%motions%count, 'further rigid-body mode', '')
    call say_factors()
    if (scene%model%controls%accuracy > 0.0_wp) call say_choices()
    call say_bodies()
    call plan%line('')
    call plan%say('memory '//megabytes(scene%expected%bytes)// &
             when(scene%iteration%joined, ' (up to '//megabytes(scene%expected%apart_bytes)// &
                  ' with CONRY)')// &
             ', operations '//short_real(scene%expected%operations)// &
             when(scene%iteration%yields, ' per solve'))
    text = plan%lines()

  contains

    !> Say how many are not listed.
    subroutine say_further(count, noun, behind)
      integer, intent(in) :: count
      character(len=*), intent(in) :: noun, behind

      if (count > most) call plan%say('and '//plural(count - most, noun)//behind)
    end subroutine say_further

    !> Say how many bodies are factored with fronts.
    subroutine say_factors()
      integer :: fronts

      fronts = count(scene%numbering%body%solver == solver_frontal)
      if (fronts > 0 .and. .not. scene%iteration%joined) then
        call plan%say('bodies factored with nested fronts (FRONTAL): '//text_of(fronts))
        if (scene%model%controls%solver == solver_auto) &
          call plan%say('  chosen by AUTO: faster if a band (BAND) needs more than '// &
                   short_real(many_operations)//' operations, or a long contact makes it wide')
      end if
    end subroutine say_factors

    !> Say what PARAM ACCURACY has chosen.
    subroutine say_choices()
      character(len=:), allocatable :: chosen

      chosen = when(scene%iteration%yields .and. scene%model%controls%tolerance == 0.0_wp, &
                    ', TOL '//short_real(scene%iteration%tolerance))// &
               when(scene%iteration%yields .and. scene%iteration%chosen_here, &
                    ', METHOD '//trim(method_name(scene%iteration%method)))
      if (len(chosen) == 0) chosen = ', nothing: no iteration, or TOL and METHOD are in the deck'
      call plan%say('ACCURACY '//short_real(scene%model%controls%accuracy)//' chooses '//chosen(3:))
    end subroutine say_choices

    !> A row for each body with equations: its matrix, and the number of factorizations.
    subroutine say_bodies()
      character(len=14) :: width, times
      integer :: b, listed

      call plan%line('')
      call plan%begin('', body_columns)
      listed = 0
      do b = 1, size(scene%numbering%body)
        if (scene%numbering%body(b)%equations == 0) cycle   ! rigid
        listed = listed + 1
        if (listed > most) cycle
        associate (body => scene%numbering%body(b))
          width = text_of(body%half_bandwidth)
          if (body%solver /= solver_band) width = solver_name(body%solver)
          times = '1'
          if (body%can_yield .and. scene%iteration%method /= method_inistr) times = 'each iteration'
          call plan%row([b, size(body%node), body%equations, body%contact_equations], [real(wp) ::], &
                        [width, times])
        end associate
      end do
      call say_further(listed, 'further one', '')
    end subroutine say_bodies
  end function plan_text

  !> Say whether the model can yield, and how the iteration works.
  subroutine say_iteration(plan, scene, several)
    type(table_type), intent(inout) :: plan
    type(planned_model), intent(in) :: scene
    logical, intent(in) :: several             !! the plan is for several load cases
    logical, allocatable :: yields(:)          ! [bodies]
    integer :: e

    if (scene%model%contact%has_friction()) call plan%say('friction at '// &
      plural(size(scene%model%contact%sliding), 'pair')//': the answer depends on the path of the loads')
    if (.not. scene%iteration%yields) then
      if (scene%iteration%follows .and. scene%iteration%load_steps > 1) then
        call plan%say('elastic material only: '//text_of(scene%iteration%load_steps)// &
                      ' load steps, each from the end of the one before')
        return
      end if
      call plan%say('elastic material only: one solve, no iteration')
      if (scene%model%controls%sequence .and. .not. scene%iteration%follows) &
        call plan%say('a sequence of load cases: without plastic strain, each is independent of those before')
      return
    end if
    associate (mesh => scene%model%mesh)
      allocate (yields(mesh%bodies), source=.false.)
      yields(pack(mesh%body(mesh%connectivity(1, :)), &
                  scene%model%can_yield([(e, e=1, mesh%elements)]))) = .true.
    end associate
    call plan%say(theory_text(scene%model)//'; bodies that can yield: '//text_of(count(yields)))
    associate (method => scene%iteration%method)
      call plan%say('plasticity iteration '//trim(method_name(method))//': '//method_text(method))
    end associate
    if (scene%iteration%chosen_here) call plan%say('  chosen by AUTO: '// &
      when(scene%iteration%method == method_newton, 'it needs the fewest factorizations', &
           'MUP PAPER has no tangent for NEWTON'))
    call plan%say('  converged if change and estimated error of displacements are at most '// &
             short_real(scene%iteration%tolerance)//' of the largest,')
    call plan%say('  and the stress error is at most '//short_real(scene%iteration%off_curve)// &
             '; at most '//plural(scene%model%controls%most_iterations, 'iteration'))
    if (scene%model%controls%steps_by_accuracy) &
      call plan%say('increments: as many as PARAM ACCURACY needs, each from the end of the one before')
    if (scene%iteration%load_steps > 1) &
      call plan%say(plural(scene%iteration%load_steps, when(scene%model%controls%by_increments, &
        'increment', 'load step'))//when(several, ' in the first of these load cases')// &
        when(scene%model%controls%by_increments, ', each from the end of the one before', &
             '; elastic unloading is not modelled'))
    if (scene%model%controls%paper_ratio) call plan%say('MUP PAPER: Poisson''s ratio in the equivalent '// &
      'strain by formula (2-4): stresses up to (1 - 2 nu)/3 below the curve')
  end subroutine say_iteration

  !> Name the theory of plasticity, and the reason for flow theory.
  pure function theory_text(model) result(text)
    type(model_type), intent(in) :: model
    character(len=:), allocatable :: text

    text = 'total theory of plasticity'
    if (.not. model%controls%by_increments) return
    text = 'flow theory of plasticity ('
    if (model%controls%sequence) then
      text = text//'a sequence of load cases, each from the end of the one before)'
    else
      text = text//when(any(model%sections%curve%kinematic > 0.0_wp), 'kinematic hardening', &
                        'PARAM THEORY')//')'
    end if
  end function theory_text

  !> Name the contact solver.
  subroutine say_rule(plan, scene)
    type(table_type), intent(inout) :: plan
    type(planned_model), intent(in) :: scene

    if (scene%model%contact%pairs == 0) then
      call plan%say('no contact pairs')
    else if (scene%iteration%joined) then
      call plan%say('contact solver JOINED: all bodies in one sparse system, no flexibility matrix')
      if (scene%iteration%rule_chosen_here) call plan%say('  chosen by AUTO: faster if the '// &
        'flexibility matrix needs more than '//short_real(many_of(scene%model))//' operations per node')
    else
      call plan%say('contact solver: Conry-Seireg simplex (CONRY)')
    end if
    if (scene%model%controls%rule == rule_joined .and. .not. (scene%iteration%joined .or. scene%other_rule)) &
      call plan%say('  not JOINED: no pair is at a deformable body')
  end subroutine say_rule

  !> Describe a contact of lines.
  subroutine say_contact(plan, scene, contact)
    type(table_type), intent(inout) :: plan
    type(planned_model), intent(in) :: scene
    type(line_contact), intent(in) :: contact
    character(len=:), allocatable :: master

    master = joined(contact%master_id, ', ')
    associate (gap => scene%model%contact%initial_gap(contact%first:contact%last))
      call plan%say('BCONP '//joined(contact%bconp, ', ')//': nodes of BLSEG '// &
               joined(contact%slave_id, ', ')//' against edges of BLSEG '//master//': '// &
               plural(size(gap), 'pair')//', initial gaps '//short_real(minval(gap))//' to '// &
               short_real(maxval(gap))// &
               when(contact%nodes_left_out > 0, '; '//plural(contact%nodes_left_out, 'node')// &
                    ' without a pair: no edge within '//short_real(contact%search)))
    end associate
    if (contact%last >= contact%first_of_master) &
      call plan%say('  of these, corners of BLSEG '//master//' on edges of the slave line: '// &
               text_of(contact%last - contact%first_of_master + 1))
    if (contact%is_wider .or. size(contact%came_near) > 0) &
      call plan%say('  solved again, with pairs for nodes that came close')
    call say_corners(contact%slave, contact%slave_id)
    call say_corners(contact%master, contact%master_id)

  contains

    !> List the corners of a line, where normals are not smoothed.
    subroutine say_corners(line, id)
      class(boundary_line), intent(in) :: line
      integer, intent(in) :: id(:)
      logical, allocatable :: ends(:, :)
      integer, allocatable :: node(:)

      ends = line%corner .and. .not. line%mirrored
      node = [pack(line%segment(1, :), ends(1, :)), &
              pack(line%segment(2, :), ends(2, :) .and. line%neighbour(2, :) == 0)]
      if (size(node) > 0) call plan%say('  corners of BLSEG '//joined(id, ', ')//': GRID '// &
          joined(scene%model%mesh%node_id(node), ', ', most_corners))
    end subroutine say_corners
  end subroutine say_contact

  !> Write an amount of memory, rounded up.
  pure function megabytes(bytes) result(text)
    integer(i8), intent(in) :: bytes   !! of it
    character(len=:), allocatable :: text

    text = text_of((bytes + 999999_i8)/1000000_i8)//' MB'
  end function megabytes
end module epcont_report_plan_text
