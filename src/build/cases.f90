!> Load cases from case control, and the contents of their sets: FORCE, PLOADX1,
!> GRAV, RFORCE, LOAD, SPC and SPCD.
module epcont_build_cases
  use epcont_base_diagnostic, only: place_type
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: new_id_index
  use epcont_base_text, only: short_real
  use epcont_build_mass_loads, only: read_mass_loads
  use epcont_build_reference, only: card_index, check_choices, check_combinations, chosen_sets, &
      named_node, nodes_of_fields, note_unnamed, resolve
  use epcont_deck_card_kinds, only: card_bconp, card_bfric, card_force, card_grav, card_load, card_mats1, &
      card_moment, card_nlparm, card_param, card_pgap, card_ploadx1, card_rforce, card_spc, card_spc1, &
      card_spcd, element_cards, ring_cards
  use epcont_deck_deck, only: deck_type
  use epcont_deck_entry, only: farthest, least_cause
  use epcont_build_tie_cards, only: check_directions, digit, dof_node, find_moments, find_platens, names
  use epcont_model_arrays, only: angle, scene_type, side_pressure
  use epcont_model_finding, only: and_more, findings, of_pressure
  use epcont_model_load_cases, only: load_case, load_cases, set_displacement, set_pressure
  implicit none
  private
  public :: read_cases

  !> Cards whose first field is a set of loads, which LOAD may combine; and cards of supports.
  integer, parameter :: load_cards(*) = [card_force, card_ploadx1, card_spcd, card_grav, card_rforce, &
                                         card_moment]
  integer, parameter :: support_cards(*) = [card_spc, card_spc1]

contains

  !> Read the load cases of a deck, and the contents of their sets.
  subroutine read_cases(deck, nodes, data, cases, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    type(scene_type), intent(inout) :: data    !! elements and sections; gets the rotating RBE2 master nodes
    type(load_cases), intent(out) :: cases     !! of the model
    type(findings), intent(inout) :: found     !! errors are added
    integer, dimension(size(deck%subcase)) :: loads, supports
    integer, allocatable :: used(:)            ! sets of loads
    integer :: k

    call chosen_sets(deck, support_cards, deck%subcase%spc, 'SPC', found, supports)
    call note_unnamed(deck, support_cards, [1], supports, 'load case', found)
    call chosen_sets(deck, [load_cards, card_load], deck%subcase%load, 'LOAD', found, loads)
    allocate (cases%case(size(loads)))
    cases%sequence = deck%is_sequence()
    used = [integer ::]
    do k = 1, size(loads)
      cases%case(k)%id = deck%subcase(k)%id
      cases%case(k)%supports = supports(k)
      cases%case(k)%contact = deck%subcase(k)%contact%id
      call combine(loads(k), cases%case(k))
      used = [used, cases%case(k)%set]
    end do
    call check_combinations(deck, card_load, load_cards, 'loads', &
                            'give the set of FORCE, PLOADX1, MOMENT, GRAV, RFORCE or SPCD cards', found)
    call check_choices(deck, deck%subcase%contact, nint(deck%card(card_bconp)%value(1, :)), 'BCONTACT', &
                       'there is no such BCONP', 'give ALL, NONE or the id of a BCONP', found)
    call choose_load_steps()
    call check_history(deck, data%controls%by_increments, found)
    if (deck%linear%line > 0 .and. deck%card(card_mats1)%count > 0) &
      call found%add_note(deck%linear, 'SOL: materials with MATS1 yield, as with SOL 106')
    call note_unnamed(deck, load_cards, [1], used, 'load case', found)
    call note_unnamed(deck, [card_load], [1], loads, 'load case', found)
    call find_platens(deck, nodes, supports, used, data, found)
    call find_moments(deck, nodes, used, data, cases%moment, found)
    call add_forces(deck, nodes, used, cases, found)
    call add_pressures(deck, nodes, used, cases, found)
    call read_mass_loads(deck, nodes, any(deck%card(ring_cards)%count > 0), data%x, used, cases%body, found)
    call add_displacements(deck, nodes, data, used, cases%moved, found)

  contains

    !> Sets of a case: the chosen one, or the sets that a LOAD with this id combines.
    subroutine combine(chosen, case)
      integer, intent(in) :: chosen   !! 0 if absent
      type(load_case), intent(inout) :: case
      integer :: row

      associate (combined => deck%card(card_load))
        row = findloc(nint(combined%value(1, :)), chosen, dim=1)
        if (chosen == 0 .or. row == 0) then
          case%set = pack([chosen], [chosen > 0])
          case%factor = pack([1.0_wp], [chosen > 0])
        else
          associate (item => combined%list(combined%list_start(row):combined%list_start(row + 1) - 1))
            case%set = nint(item%number(2))
            case%factor = combined%number('S', row)*item%number(1)
          end associate
        end if
      end associate
    end subroutine combine

    !> Set the load steps and the iteration of each case: from its NLPARM, else from PARAM.
    subroutine choose_load_steps()
      integer :: k, row

      cases%case%load_steps = data%controls%load_steps
      cases%case%most_iterations = data%controls%most_iterations
      cases%case%tolerance = data%controls%tolerance
      cases%case%steps_by_accuracy = data%controls%by_increments .and. data%controls%accuracy > 0.0_wp .and. &
                                     deck%parameter_row('NLOAD') == 0
      associate (nlparm => deck%card(card_nlparm), choice => deck%subcase%nlparm)
        do k = 1, size(choice)
          row = findloc(nint(nlparm%value(1, :)), choice(k)%id, dim=1)
          if (choice(k)%id == 0 .or. row == 0) cycle
          associate (case => cases%case(k))
            case%load_steps = nint(nlparm%number('NINC', row))
            if (nlparm%has('NINC', row)) case%steps_by_accuracy = .false.
            if (nlparm%has('MAXITER', row)) case%most_iterations = nint(nlparm%number('MAXITER', row))
            if (nlparm%has('EPSU', row)) case%tolerance = nlparm%number('EPSU', row)
          end associate
        end do
        call check_choices(deck, choice, nint(nlparm%value(1, :)), 'NLPARM', 'there is no such NLPARM', &
                           'give the id of an NLPARM card', found)
        call note_unnamed(deck, [card_nlparm], [1], choice%id, 'load case', found)
        row = deck%parameter_row('NLOAD')
        if (row > 0 .and. any(choice%id > 0)) call found%add_error(card_param, row, 1, &
          ': NLPARM gives the number of load steps, too', 'remove one of the two')
      end associate
    end subroutine choose_load_steps
  end subroutine read_cases

  !> Check that a sequence has flow theory, and that a part of a longer history can be one.
  subroutine check_history(deck, by_increments, found)
    type(deck_type), intent(in) :: deck
    logical, intent(in) :: by_increments
    type(findings), intent(inout) :: found
    type(place_type) :: place
    character(len=:), allocatable :: name
    logical :: slips, yields

    associate (mats1 => deck%card(card_mats1), pgap => deck%card(card_pgap))
      yields = any(mats1%word(mats1%column('TYPE'), :) == 'PLASTIC')
      slips = deck%parameter_word('FRICTION') /= 'NO' .and. (deck%card(card_bfric)%count > 0 .or. &
              any(pgap%value(pgap%column('MU1'), :) > 0.0_wp))
    end associate
    place = deck%sequence
    if (deck%is_part()) then
      name = 'RESTART'
      place = deck%restart_place
      if (place%line == 0) then
        name = 'PARAM SAVE'
        place = deck%place(card_param, deck%parameter_row('SAVE'), 1)
      end if
      if (.not. (yields .or. slips)) then
        call found%add_error(place, name// &
          ': load cases do not depend on those before: no MATS1 is PLASTIC, and there is no friction', &
          'remove '//name)
      else if (.not. deck%is_sequence()) then
        call found%add_error(place, name//': the SUBCASEs are independent', &
                             'write SOL 106 or CNTNLSUB = YES: each starts from the end of the one before')
      end if
    end if
    if (deck%is_sequence() .and. yields .and. .not. by_increments) call found%add_error(place, &
      'a sequence of SUBCASEs needs flow theory: total theory has no memory of earlier loads', &
      'remove PARAM THEORY or ORIGINAL, or write CNTNLSUB = NO: each begins with the unloaded state')
  end subroutine check_history

  !> Read FORCE.
  subroutine add_forces(deck, nodes, used, cases, found)
    type(deck_type), intent(in) :: deck
    type(card_index), intent(in) :: nodes
    integer, intent(in) :: used(:)
    type(load_cases), intent(inout) :: cases
    type(findings), intent(inout) :: found
    integer :: i, node(deck%card(card_force)%count)
    real(wp) :: direction(2), factor, largest
    logical :: idle(size(node))   ! N1 and N2 are zero

    idle = .false.
    call resolve(deck, card_force, 2, nodes, found, node)
    associate (force => deck%card(card_force))
      node = merge(node, 0, force%sound .and. [(any(used == nint(force%value(1, i))), i=1, size(node))])
      allocate (cases%force(count(node > 0)))
      cases%force%set = pack(nint(force%value(1, :)), node > 0)
      cases%force%node = pack(node, node > 0)
      do i = 1, force%count
        if (node(i) == 0) cycle
        factor = force%number('F', i)
        direction = [force%number('N1', i), force%number('N2', i)]
        largest = maxval(abs(direction))
        idle(i) = all(direction == 0.0_wp)
        ! Not zero, but of a magnitude outside the allowed range.
        if (factor /= 0.0_wp .and. largest > 0.0_wp .and. &
            (abs(factor)*largest < least_cause .or. abs(factor)*largest > farthest)) &
          call found%add_error(card_force, i, force%column('F'), &
                               ': field 5 (F) times the vector of N1 and N2 is too far from 1.0', &
                               'use other units: forces from '//short_real(least_cause)//' to '// &
                               short_real(farthest)//', or 0.0')
        ! Rounding of a right angle, such as the cosine of 90 degrees, is set to zero.
        where (abs(direction) < epsilon(1.0_wp)*largest) direction = 0.0_wp
        cases%force(count(node(:i) > 0))%force = factor*direction
      end do
    end associate
    i = findloc(idle, .true., dim=1)
    if (i > 0) call found%add_warning(card_force, i, deck%card(card_force)%column('N1'), &
      ': N1 and N2 are 0.0: no force'//and_more(count(idle), '; so with ', ' more'), &
      'give the direction of the force, such as 0.0 and -1.0')
  end subroutine add_forces

  !> Read PLOADX1.
  subroutine add_pressures(deck, nodes, used, cases, found)
    type(deck_type), intent(in) :: deck
    type(card_index), intent(in) :: nodes
    integer, intent(in) :: used(:)
    type(load_cases), intent(inout) :: cases
    type(findings), intent(inout) :: found
    integer, dimension(deck%card(card_ploadx1)%count) :: a, b, element
    integer :: c, ga, i, last
    type(card_index) :: elements

    associate (pressure => deck%card(card_ploadx1))
      elements = card_index(new_id_index([(int(deck%card(element_cards(c))%value(1, :)), &
                                           c=1, size(element_cards))]), 'element', found%errors == 0)
      ga = pressure%column('GA')
      call resolve(deck, card_ploadx1, 2, elements, found, element)
      call resolve(deck, card_ploadx1, ga, nodes, found, a)
      call resolve(deck, card_ploadx1, ga + 1, nodes, found, b)
      allocate (cases%pressure(pressure%count))
      last = 0
      do i = 1, pressure%count
        if (element(i) == 0 .or. a(i) == 0 .or. b(i) == 0) cycle
        if (all(used /= nint(pressure%value(1, i)))) cycle
        last = last + 1
        cases%pressure(last) = set_pressure(nint(pressure%value(1, i)), side_pressure( &
                               element(i), [a(i), b(i)], pressure%value(3:4, i), pressure%number('THETA', i)))
        call found%add_origin([of_pressure, last, 0], [card_ploadx1, i, ga])
      end do
    end associate
    cases%pressure = cases%pressure(:last)
  end subroutine add_pressures

  !> Read SPCD of the sets that are used.
  subroutine add_displacements(deck, nodes, data, used, moved, found)
    type(deck_type), intent(in) :: deck
    type(card_index), intent(in) :: nodes
    type(scene_type), intent(in) :: data
    integer, intent(in) :: used(:)
    type(set_displacement), allocatable, intent(out) :: moved(:)
    type(findings), intent(inout) :: found
    type(named_node), allocatable :: named(:)
    integer :: at, c, i, last

    named = nodes_of_fields(deck, card_spcd, [2, 5], nodes, found)
    allocate (moved(angle*size(named)))
    last = 0
    do i = 1, size(named)
      associate (card => named(i)%card, digits => named(i)%digits, &
                 value => deck%card(card_spcd)%value(:, named(i)%card(2)))
        if (all(used /= nint(value(1)))) cycle
        if (value(digits + 1) /= 0.0_wp) &
          call check_directions(deck, data, named(i)%node, value(digits), [card(:2), digits], found)
        do c = 1, angle
          at = dof_node(data, c, named(i)%node)
          if (at == 0 .or. .not. names(value(digits), digit(c))) cycle
          last = last + 1
          moved(last) = set_displacement(nint(value(1)), c, at, value(digits + 1), card(2), card(3))
        end do
      end associate
    end do
    moved = moved(:last)
  end subroutine add_displacements
end module epcont_build_cases
