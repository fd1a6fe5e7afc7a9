!> What ties freedoms to each other, beside the nodes that RBE2 leads: which of its leaders turn, and with
!> which moments (MOMENT); equations (MPC, MPCADD); springs (CELAS1, CELAS2, PELAS).
module epcont_build_tie_cards
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index, new_id_index
  use epcont_base_text, only: text_of
  use epcont_build_reference, only: card_index, check_combinations, chosen_sets, note_unused, resolve
  use epcont_deck_card_kinds, only: card_celas1, card_celas2, card_moment, card_mpc, card_mpcadd, &
      card_pelas, card_rbe2, card_spc, card_spcd, card_suport
  use epcont_deck_deck, only: deck_type
  use epcont_model_arrays, only: linear_equation, spring_type
  use epcont_model_finding, only: findings, of_node
  use epcont_model_load_cases, only: set_moment
  use epcont_model_model, only: model_type
  use epcont_model_ties, only: check_equation
  implicit none
  private
  public :: build_equations, build_springs, check_directions, find_platens, find_moments, names

  !> The digit of a turn about z.
  integer, parameter, public :: turn = 6

  character(len=*), parameter :: in_plane = ': scenes lie in the x-y plane'

contains

  !> Is a direction among the digits of a field?
  elemental logical function names(digits, c)
    real(wp), intent(in) :: digits
    integer, intent(in) :: c

    names = any(mod(nint(digits)/10**[0, 1, 2, 3, 4, 5], 10) == c)
  end function names

  !> Report a direction that a field names and the node does not have: 3 to 5, and 6 unless it leads an RBE2
  !! that rotates.
  subroutine check_directions(model, node, digits, card, found)
    type(model_type), intent(in) :: model     !! the scene: which leaders turn
    integer, intent(in) :: node
    real(wp), intent(in) :: digits            !! of the field
    integer, intent(in) :: card(3)            !! table, card, field of the directions
    type(findings), intent(inout) :: found    !! an error is added
    integer :: c

    do c = 3, turn
      if (.not. names(digits, c) .or. (c == turn .and. any(model%platen%leader == node))) cycle
      call found%add_error(card(1), card(2), card(3), ': '//model%name_of(of_node, node)// &
                           ' has no direction '//text_of(c), 'direction 1 or 2; 6 at the GN of an RBE2')
      return
    end do
  end subroutine check_directions

  !> Leaders of RBE2 that turn: a SUPORT, a displacement or a MOMENT of sets that are used names their turn.
  !! Others are held.
  subroutine find_platens(deck, nodes, supports, loads, model, found)
    type(deck_type), intent(in) :: deck           !! its cards
    type(card_index), intent(in) :: nodes         !! ids of GRID
    integer, intent(in) :: supports(:), loads(:)  !! ids of the sets that are used
    type(model_type), intent(inout) :: model      !! the scene: its mesh; gets the leaders
    type(findings), intent(inout) :: found        !! what is wrong is added
    type(findings) :: unheard   ! is told where the cards are read
    logical :: named(model%nodes)
    logical, allocatable :: turns(:)   ! the first RBE2 of each leader that does
    integer :: i, k, leader(deck%card(card_rbe2)%count)
    integer, parameter :: columns(*) = [1, 3, 5, 7]

    named = .false.
    do k = 1, size(columns)
      call name_by(card_suport, columns(k), columns(k) + 1, .false.)
    end do
    do k = 2, 5, 3
      call name_by(card_spc, k, k + 1, .true.)
      call name_by(card_spcd, k, k + 1, .true.)
    end do
    call name_by(card_moment, 2, 0, .false.)
    call resolve(deck, card_rbe2, 2, nodes, unheard, leader)
    turns = [(leader(i) > 0 .and. all(leader(:i - 1) /= leader(i)), i=1, size(leader))]
    where (turns) turns = named(max(1, leader))
    deallocate (model%platen)
    allocate (model%platen(count(turns)))
    model%platen%leader = pack(leader, turns)
    do k = 1, size(model%platen)
      allocate (model%platen(k)%follower(0))
    end do
    i = findloc(turns, .true., dim=1)
    if (i == 0 .or. model%elements == 0) return
    if (model%has_rings()) call found%add_error(card_rbe2, i, 2, ': '// &
      model%name_of(of_node, leader(i))//' would turn, and rings do not', &
      'no MOMENT, SUPORT or SPC that names its direction 6')

  contains

    !> Nodes that a field of some cards names, with directions in another one; behind these there may be a
    !! displacement.
    subroutine name_by(card, column, digits, displaced)
      integer, intent(in) :: card, column, digits
      logical, intent(in) :: displaced
      integer :: i, node(deck%card(card)%count)

      call resolve(deck, card, column, nodes, unheard, node)
      associate (value => deck%card(card)%value)
        do i = 1, size(node)
          if (node(i) == 0) cycle
          if (card == card_spc .and. all(supports /= nint(value(1, i)))) cycle
          if (any(card == [card_spcd, card_moment]) .and. all(loads /= nint(value(1, i)))) cycle
          if (digits > 0) then
            if (.not. names(value(digits, i), turn)) cycle
            if (displaced .and. value(digits + 1, i) == 0.0_wp) cycle
          end if
          named(node(i)) = .true.
        end do
      end associate
    end subroutine name_by
  end subroutine find_platens

  !> MOMENT, about z.
  subroutine find_moments(deck, nodes, loads, model, moment, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    integer, intent(in) :: loads(:)            !! ids of the sets that are used
    type(model_type), intent(in) :: model      !! the scene: which leaders turn
    type(set_moment), allocatable, intent(out) :: moment(:)
    type(findings), intent(inout) :: found     !! what is wrong is added
    integer :: i, node(deck%card(card_moment)%count), platen

    call resolve(deck, card_moment, 2, nodes, found, node)
    allocate (moment(0))
    associate (cards => deck%card(card_moment))
      do i = 1, cards%count
        if (node(i) == 0 .or. all(loads /= nint(cards%value(1, i)))) cycle
        platen = findloc(model%platen%leader, node(i), dim=1)
        if (any([cards%number('N1', i), cards%number('N2', i)] /= 0.0_wp)) then
          call found%add_error(card_moment, i, cards%column('N1'), ': the moment is not about z', &
                               'N1 and N2 0.0'//in_plane)
        else if (cards%number('N3', i) == 0.0_wp) then
          call found%add_error(card_moment, i, cards%column('N3'), ': field 8 (N3) is 0.0: no direction', &
                               '1.0, or -1.0 for clockwise')
        else if (platen == 0) then
          call found%add_error(card_moment, i, 2, ': '//model%name_of(of_node, node(i))// &
                               ' leads no RBE2, and elements have no rotations', &
                               'the GN of an RBE2 that spreads the moment')
        else
          moment = [moment, set_moment(nint(cards%value(1, i)), platen, &
                                       cards%number('M', i)*cards%number('N3', i))]
        end if
      end do
    end associate
  end subroutine find_moments

  !> MPC of the set that is chosen, which MPCADD may make of others.
  subroutine build_equations(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    type(model_type), intent(inout) :: model   !! the scene, with its supports and RBE2
    type(findings), intent(inout) :: found     !! what is wrong is added
    integer :: i, k, set(size(deck%subcase))
    integer, allocatable :: card(:), sets(:)
    logical :: sound

    call chosen_sets(deck, [card_mpc, card_mpcadd], deck%subcase%mpc, 'MPC', found, set)
    k = findloc(set /= set(1), .true., dim=1)
    if (k > 0) call found%add_error(deck%subcase(k)%mpc%place, 'MPC is not that of the first load case', &
                                    'the same equations in all of them')
    call check_combinations(deck, card_mpcadd, [card_mpc], 'MPC', 'the set of MPC cards', found)
    sets = set(:1)
    associate (sums => deck%card(card_mpcadd))
      do i = 1, sums%count
        if (nint(sums%value(1, i)) /= set(1)) cycle
        sets = [sets, sums%list(sums%list_start(i):sums%list_start(i + 1) - 1)%from]
      end do
    end associate
    call note_unused(deck, [card_mpc], sets, found)
    call note_unused(deck, [card_mpcadd], set, found)
    card = pack([(i, i=1, deck%card(card_mpc)%count)], &
                [(any(sets == nint(deck%card(card_mpc)%value(1, i))), i=1, deck%card(card_mpc)%count)])
    deallocate (model%equation)
    allocate (model%equation(size(card)))
    k = 0
    do i = 1, size(card)
      call read_equation(card(i), model%equation(k + 1), sound)
      if (sound) k = k + 1
    end do
    model%equation = model%equation(:k)

  contains

    !> Terms of a card; those times 0.0 are none, but for the first.
    subroutine read_equation(card, equation, sound)
      integer, intent(in) :: card
      type(linear_equation), intent(out) :: equation
      logical, intent(out) :: sound
      integer, allocatable :: c(:), node(:)
      real(wp), allocatable :: a(:)
      integer :: k
      logical, allocatable :: counts(:)

      equation%card = card
      associate (table => deck%card(card_mpc), before => deck%card(card_mpc)%list_start(card) - 1)
        associate (item => table%list(before + 1:table%list_start(card + 1) - 1))
          node = nodes%find(nint(item%number(1)))
          c = nint(item%number(2))
          a = item%number(3)
          do k = 1, size(node)
            if (node(k) == 0 .and. nodes%whole) call found%add_error(card_mpc, card, -before - k, &
              ': there is no GRID '//text_of(nint(item(k)%number(1))), 'the id of a GRID')
            if (node(k) > 0 .and. c(k) > 2) call found%add_error(card_mpc, card, -before - k, ': '// &
              model%name_of(of_node, node(k))//' has no direction '//text_of(c(k)), &
              'direction 1 or 2'//in_plane)
          end do
        end associate
        sound = table%sound(card) .and. all(node > 0 .and. c <= 2)
        if (.not. sound) return
        counts = [.true., a(2:) /= 0.0_wp]
        equation%node = pack(node, counts)
        equation%component = pack(c, counts)
        equation%coefficient = pack(a, counts)
        call check_equation(model, equation, [card_mpc, card, -before - 1], found)
      end associate
    end subroutine read_equation
  end subroutine build_equations

  !> CELAS1 with PELAS, CELAS2.
  subroutine build_springs(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found     !! what is wrong is added
    type(id_index) :: properties
    real(wp), allocatable :: stiffness(:)      ! of the properties
    integer :: i

    associate (pelas => deck%card(card_pelas))
      properties = new_id_index(int([pelas%value(1, :), pelas%value(5, :)]))
      stiffness = [pelas%value(2, :), pelas%value(6, :)]
      call check_properties(pelas%count)
    end associate
    call read_springs(card_celas1, 3)
    call read_springs(card_celas2, 3)

  contains

    !> A card may have two properties: each has an id of its own.
    subroutine check_properties(cards)
      integer, intent(in) :: cards
      integer :: at

      do i = 1, 2*cards
        associate (column => merge(1, 5, i <= cards), row => merge(i, i - cards, i <= cards))
          if (.not. deck%card(card_pelas)%given(column, row)) cycle
          at = findloc(int([deck%card(card_pelas)%value(1, :), deck%card(card_pelas)%value(5, :)]), &
                       int(deck%card(card_pelas)%value(column, row)), dim=1)
          if (at < i) call found%add_error(card_pelas, row, column, ': the id '// &
            text_of(nint(deck%card(card_pelas)%value(column, row)))//' is taken by another PELAS', &
            'an id of its own')
        end associate
      end do
    end subroutine check_properties

    !> The cards of one kind: nodes and directions begin at a column.
    subroutine read_springs(card, first)
      integer, intent(in) :: card, first
      integer, dimension(deck%card(card)%count) :: a, b
      type(spring_type) :: spring
      integer :: property

      call resolve(deck, card, first, nodes, found, a)
      call resolve(deck, card, first + 2, nodes, found, b)
      associate (table => deck%card(card))
        do i = 1, table%count
          if (.not. table%sound(i)) cycle
          spring = spring_type([nint(table%value(first + 1, i)), nint(table%value(first + 3, i))], &
                               [a(i), b(i)], table%value(2, i), int(table%value(1, i)))
          if (card == card_celas1) then
            property = properties%find(nint(table%value(2, i)))
            if (property == 0) call found%add_error(card, i, 2, ': there is no PELAS '// &
              text_of(nint(table%value(2, i))), 'the id of a PELAS')
            if (property == 0) cycle
            spring%stiffness = stiffness(property)
          end if
          call check_ends(spring, nint(table%value([first, first + 2], i)), [card, i, first])
        end do
      end associate
    end subroutine read_springs

    !> A spring has one end at least at a freedom, and the other elsewhere.
    subroutine check_ends(spring, id, card)
      type(spring_type), intent(in) :: spring
      integer, intent(in) :: id(2)             !! of its nodes, 0: the ground
      integer, intent(in) :: card(3)           !! table, card, field of the first node
      integer :: bare, grounded   ! end without a direction; with the direction of the ground; 0: none

      grounded = findloc(id == 0 .and. spring%component > 0, .true., dim=1)
      bare = findloc(id > 0 .and. spring%component == 0, .true., dim=1)
      if (all(id == 0)) then
        call found%add_error(card(1), card(2), card(3), ': has no node', &
                             'a node and its direction at one end; 0 or blank: the ground')
      else if (grounded > 0) then
        call found%add_error(card(1), card(2), card(3) + 2*grounded - 1, ': has a direction at the ground', &
                             '0 or blank, or a node before it')
      else if (bare > 0) then
        call found%add_error(card(1), card(2), card(3) + 2*bare - 1, ': has no direction there', &
                             'direction 1 or 2')
      else if (id(1) == id(2) .and. spring%component(1) == spring%component(2)) then
        call found%add_error(card(1), card(2), card(3), ': has both ends at one freedom', 'two of them')
      else if (all((spring%node > 0) .eqv. (id > 0))) then
        model%spring = [model%spring, spring]
      end if
    end subroutine check_ends
  end subroutine build_springs
end module epcont_build_tie_cards
