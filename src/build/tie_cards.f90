!> Dependent DOFs beside those of RBE2: rotating master nodes and their
!> moments (MOMENT); equations (MPC, MPCADD); springs (CELAS1, CELAS2, PELAS).
module epcont_build_tie_cards
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: new_id_index
  use epcont_base_text, only: text_of
  use epcont_build_reference, only: card_index, check_combinations, chosen_sets, named_node, &
      nodes_of_fields, note_unnamed, resolve
  use epcont_deck_card_kinds, only: card_celas1, card_celas2, card_grid, card_moment, card_mpc, card_mpcadd, &
      card_pelas, card_rbe2, card_spc, card_spcd, card_suport
  use epcont_deck_deck, only: deck_type
  use epcont_model_arrays, only: angle, linear_equation, scene_type, spring_type
  use epcont_model_finding, only: findings, of_equation, of_platen, of_spring
  use epcont_model_load_cases, only: set_moment
  implicit none
  private
  public :: check_directions, direction_text, dof_node, find_moments, find_platens, names, &
    read_equations, read_springs

  !> Digits of both displacements and of the rotation about z.
  integer, parameter, public :: digit(angle) = [1, 2, 6]

  character(len=*), parameter :: in_plane = ': models are in the x-y plane'

contains

  !> Is a direction among the digits of a field?
  elemental logical function names(digits, c)
    real(wp), intent(in) :: digits
    integer, intent(in) :: c

    names = any(mod(nint(digits)/10**[0, 1, 2, 3, 4, 5], 10) == c)
  end function names

  !> Node of a DOF; of a rotation, the number of its platen; 0 if there is no such DOF.
  pure integer function dof_node(data, c, node)
    type(scene_type), intent(in) :: data   !! with the rotating master nodes
    integer, intent(in) :: c, node         !! direction, or `angle`; and node

    dof_node = node
    if (c == angle) dof_node = findloc(data%platen%leader, node, dim=1)
  end function dof_node

  !> Text of a DOF for messages: `direction 1 of GRID 17`.
  pure function direction_text(deck, c, node) result(text)
    type(deck_type), intent(in) :: deck   !! its cards
    integer, intent(in) :: c, node        !! direction, or `angle`; and node
    character(len=:), allocatable :: text

    text = 'direction '//text_of(digit(c))//' of '//deck%card(card_grid)%identity(node)
  end function direction_text

  !> Report a direction that a field names and the node lacks: 3 to 5, and 6 unless the node is a rotating
  !! RBE2 master.
  subroutine check_directions(deck, data, node, digits, card, found)
    type(deck_type), intent(in) :: deck       !! its cards
    type(scene_type), intent(in) :: data      !! with the rotating master nodes
    integer, intent(in) :: node
    real(wp), intent(in) :: digits            !! of the field
    integer, intent(in) :: card(3)            !! table, card, field of the directions
    type(findings), intent(inout) :: found    !! an error is added
    integer :: c

    do c = 3, digit(angle)
      if (.not. names(digits, c) .or. (c == digit(angle) .and. any(data%platen%leader == node))) cycle
      call found%add_error(card(1), card(2), card(3), ': '//deck%card(card_grid)%identity(node)// &
                           ' has no direction '//text_of(c), 'give direction 1 or 2; 6 at the GN of an RBE2')
      return
    end do
  end subroutine check_directions

  !> Find rotating RBE2 master nodes: a SUPORT, a displacement or a MOMENT in a used set names their rotation.
  !! The rotation of the others is fixed.
  subroutine find_platens(deck, nodes, supports, loads, data, found)
    type(deck_type), intent(in) :: deck           !! its cards
    type(card_index), intent(in) :: nodes         !! ids of GRID
    integer, intent(in) :: supports(:), loads(:)  !! ids of the sets that are used
    type(scene_type), intent(inout) :: data       !! gets the master nodes
    type(findings), intent(inout) :: found        !! gets the cards of these nodes
    type(findings) :: unheard   ! reported later, when these cards are read
    type(named_node), allocatable :: named(:)
    logical :: rotates(deck%card(card_grid)%count)
    logical, allocatable :: turns(:)   ! first RBE2 of each rotating master node
    integer :: i, k, leader(deck%card(card_rbe2)%count)
    integer, allocatable :: row(:)     ! indices of these RBE2

    rotates = .false.
    named = [nodes_of_fields(deck, card_suport, [1, 3, 5, 7], nodes, unheard), &
             nodes_of_fields(deck, card_spc, [2, 5], nodes, unheard), &
             nodes_of_fields(deck, card_spcd, [2, 5], nodes, unheard), &
             nodes_of_fields(deck, card_moment, [2], nodes, unheard)]
    do i = 1, size(named)
      associate (card => named(i)%card(1), digits => named(i)%digits, &
                 value => deck%card(named(i)%card(1))%value(:, named(i)%card(2)))
        if (card == card_spc .and. all(supports /= nint(value(1)))) cycle
        if (any(card == [card_spcd, card_moment]) .and. all(loads /= nint(value(1)))) cycle
        if (card /= card_moment) then
          if (.not. names(value(digits), digit(angle))) cycle
        end if
        if (any(card == [card_spc, card_spcd])) then
          if (value(digits + 1) == 0.0_wp) cycle
        end if
        rotates(named(i)%node) = .true.
      end associate
    end do
    call resolve(deck, card_rbe2, 2, nodes, unheard, leader)
    turns = [(leader(i) > 0 .and. all(leader(:i - 1) /= leader(i)), i=1, size(leader))]
    where (turns) turns = rotates(max(1, leader))
    row = pack([(i, i=1, size(leader))], turns)
    deallocate (data%platen)
    allocate (data%platen(size(row)))
    data%platen%leader = leader(row)
    do k = 1, size(row)
      allocate (data%platen(k)%follower(0))
      call found%add_origin([of_platen, k, 0], [card_rbe2, row(k), 2])
    end do
  end subroutine find_platens

  !> Read MOMENT, about z.
  subroutine find_moments(deck, nodes, loads, data, moment, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    integer, intent(in) :: loads(:)            !! ids of the sets that are used
    type(scene_type), intent(in) :: data       !! with the rotating master nodes
    type(set_moment), allocatable, intent(out) :: moment(:)
    type(findings), intent(inout) :: found     !! errors are added
    integer :: i, node(deck%card(card_moment)%count), platen

    call resolve(deck, card_moment, 2, nodes, found, node)
    allocate (moment(0))
    associate (cards => deck%card(card_moment))
      do i = 1, cards%count
        if (node(i) == 0 .or. all(loads /= nint(cards%value(1, i))) .or. .not. cards%sound(i)) cycle
        platen = findloc(data%platen%leader, node(i), dim=1)
        if (cards%number('N3', i) == 0.0_wp) then
          call found%add_error(card_moment, i, cards%column('N3'), ': field 8 (N3) is 0.0: no direction', &
                               'write 1.0, or -1.0 for clockwise')
        else if (platen == 0) then
          call found%add_error(card_moment, i, 2, ': '//deck%card(card_grid)%identity(node(i))// &
                               ' is not GN of an RBE2, and elements have no rotations', &
                               'give the GN of an RBE2 that distributes the moment')
        else
          moment = [moment, set_moment(nint(cards%value(1, i)), platen, &
                                       cards%number('M', i)*cards%number('N3', i))]
        end if
      end do
    end associate
  end subroutine find_moments

  !> Read MPC of the chosen set, which an MPCADD may combine from others.
  subroutine read_equations(deck, nodes, data, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    type(scene_type), intent(inout) :: data    !! gets the equations
    type(findings), intent(inout) :: found     !! errors are added
    integer :: i, k, set(size(deck%subcase))
    integer, allocatable :: card(:), sets(:)
    logical :: sound

    call chosen_sets(deck, [card_mpc, card_mpcadd], deck%subcase%mpc, 'MPC', found, set)
    k = findloc(set /= set(1), .true., dim=1)
    if (k > 0) call found%add_error(deck%subcase(k)%mpc%place, 'MPC is not that of the first load case', &
                                    'use the same equations in all load cases')
    call check_combinations(deck, card_mpcadd, [card_mpc], 'MPC', 'give the set of MPC cards', found)
    sets = set(:1)
    associate (sums => deck%card(card_mpcadd))
      do i = 1, sums%count
        if (nint(sums%value(1, i)) /= set(1)) cycle
        sets = [sets, sums%list(sums%list_start(i):sums%list_start(i + 1) - 1)%from]
      end do
    end associate
    call note_unnamed(deck, [card_mpc], [1], sets, 'load case', found)
    call note_unnamed(deck, [card_mpcadd], [1], set, 'load case', found)
    card = pack([(i, i=1, deck%card(card_mpc)%count)], &
                [(any(sets == nint(deck%card(card_mpc)%value(1, i))), i=1, deck%card(card_mpc)%count)])
    deallocate (data%equation)
    allocate (data%equation(size(card)))
    k = 0
    do i = 1, size(card)
      call read_equation(card(i), data%equation(k + 1), sound)
      if (.not. sound) cycle
      k = k + 1
      call found%add_origin([of_equation, k, 0], [card_mpc, card(i), 0])
      call found%add_origin([of_equation, k, -1], &
                            [card_mpc, card(i), -deck%card(card_mpc)%list_start(card(i))])
    end do
    data%equation = data%equation(:k)

  contains

    !> Read the terms of a card. Terms with the coefficient 0.0 are skipped, except the first.
    subroutine read_equation(card, equation, sound)
      integer, intent(in) :: card
      type(linear_equation), intent(out) :: equation
      logical, intent(out) :: sound
      integer, allocatable :: c(:), node(:)
      real(wp), allocatable :: a(:)
      integer :: k
      logical, allocatable :: counts(:)

      associate (table => deck%card(card_mpc), before => deck%card(card_mpc)%list_start(card) - 1)
        associate (item => table%list(before + 1:table%list_start(card + 1) - 1))
          node = nodes%find(nint(item%number(1)))
          c = nint(item%number(2))
          a = item%number(3)
          do k = 1, size(node)
            if (node(k) == 0 .and. nodes%whole) call found%add_error(card_mpc, card, -before - k, &
              ': there is no GRID '//text_of(nint(item(k)%number(1))), 'give the id of a GRID')
            if (node(k) > 0 .and. c(k) > 2) call found%add_error(card_mpc, card, -before - k, ': '// &
              deck%card(card_grid)%identity(node(k))//' has no direction '//text_of(c(k)), &
              'give direction 1 or 2'//in_plane)
          end do
        end associate
        sound = table%sound(card) .and. all(node > 0 .and. c <= 2)
        if (.not. sound) return
        counts = [.true., a(2:) /= 0.0_wp]
        equation%node = pack(node, counts)
        equation%component = pack(c, counts)
        equation%coefficient = pack(a, counts)
      end associate
    end subroutine read_equation
  end subroutine read_equations

  !> Read CELAS1 with PELAS, and CELAS2.
  subroutine read_springs(deck, nodes, data, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    type(scene_type), intent(inout) :: data    !! gets the springs
    type(findings), intent(inout) :: found     !! errors are added
    type(card_index) :: properties
    integer :: property(deck%card(card_celas1)%count)
    real(wp), allocatable :: stiffness(:)      ! of the properties

    associate (pelas => deck%card(card_pelas))   ! a card may have two properties
      properties = card_index(new_id_index(int([pelas%value(1, :), pelas%value(5, :)])), 'PELAS', &
                              deck%whole .and. all(pelas%sound))
      stiffness = [pelas%value(2, :), pelas%value(6, :)]
    end associate
    call resolve(deck, card_celas1, 2, properties, found, property)
    call read_table(card_celas1)
    call read_table(card_celas2)

  contains

    !> Read the cards of one type. A spring is left out if a node or its property was not found.
    subroutine read_table(card)
      integer, intent(in) :: card
      integer, parameter :: first = 3   ! column of nodes and directions
      integer, dimension(deck%card(card)%count) :: a, b
      type(spring_type) :: spring
      integer :: end, i

      call resolve(deck, card, first, nodes, found, a)
      call resolve(deck, card, first + 2, nodes, found, b)
      associate (table => deck%card(card))
        do i = 1, table%count
          if (.not. table%sound(i)) cycle
          spring = spring_type(nint(table%value([first + 1, first + 3], i)), [a(i), b(i)], &
                               table%value(2, i), int(table%value(1, i)))
          if (card == card_celas1) then
            if (property(i) == 0) cycle
            spring%stiffness = stiffness(property(i))
          end if
          if (any(spring%node == 0 .and. nint(table%value([first, first + 2], i)) > 0)) cycle
          data%spring = [data%spring, spring]
          do end = 0, 2
            call found%add_origin([of_spring, size(data%spring), end], [card, i, first + max(0, 2*end - 1)])
          end do
        end do
      end associate
    end subroutine read_table
  end subroutine read_springs
end module epcont_build_tie_cards
