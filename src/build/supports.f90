!> Supports, ties and reference freedoms from GRID PS, SPC, SPC1, RBE2, SUPORT, MPC and springs.
module epcont_build_supports
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_build_tie_cards, only: build_equations, build_springs, check_directions, names, turn
  use epcont_build_reference, only: card_index, resolve
  use epcont_deck_card_kinds, only: card_grid, card_rbe2, card_spc, card_spc1, card_spcd, card_suport
  use epcont_deck_deck, only: deck_type
  use epcont_element_kinematics, only: directions
  use epcont_model_finding, only: findings, of_node
  use epcont_model_arrays, only: angle
  use epcont_model_freedoms, only: follow_to_the_end, freedom, set_reference, tie
  use epcont_model_load_cases, only: load_cases
  use epcont_model_model, only: model_type
  use epcont_model_ties, only: complete_ties, turn_with
  implicit none
  private
  public :: build_ties, check_displacements, hold_nodes

  !> A node that a card names, with some of its freedoms.
  type :: named_node
    integer :: card(3) = 0   !! table, card, field or item of its list that names the node
    integer :: node = 0      !! which
    integer :: digits = 0    !! the field that names the freedoms
  end type named_node

contains

  !> The freedoms that GRID PS and a set of supports hold, and where.
  subroutine hold_nodes(deck, nodes, set, model, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    integer, intent(in) :: set                 !! of SPC and SPC1; 0: none
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found     !! what is wrong with it is added
    type(named_node), allocatable :: named(:)
    integer :: i, ps

    model%held = .false.
    model%prescribed = 0.0_wp
    model%platen%held = .false.
    model%platen%prescribed = 0.0_wp
    associate (grid => deck%card(card_grid))
      ps = grid%column('PS')
      do i = 1, grid%count
        if (grid%given(ps, i)) call hold(named_node([card_grid, i, ps], i, ps))
      end do
    end associate
    named = [nodes_of_fields(deck, card_spc, [2, 5], nodes, found), &
             nodes_of_lists(deck, card_spc1, nodes, found)]
    do i = 1, size(named)
      call hold(named(i))
    end do

  contains

    !> What a card says of the freedoms of a node. Of those that are held at another displacement already one
    !! is told.
    subroutine hold(named)
      type(named_node), intent(in) :: named
      integer :: c, conflict, i
      real(wp) :: displacement

      conflict = 0
      displacement = 0.0_wp
      associate (card => named%card, node => named%node, &
                 value => deck%card(named%card(1))%value(:, named%card(2)))
        if (card(1) /= card_grid .and. nint(value(1)) /= set) return
        if (card(1) == card_spc) displacement = value(named%digits + 1)
        do c = 1, directions
          if (.not. names(value(named%digits), c)) cycle
          if (model%held(c, node) .and. model%prescribed(c, node) /= displacement) conflict = c
          model%held(c, node) = .true.
          model%prescribed(c, node) = displacement
        end do
        do i = 1, size(model%platen)
          associate (platen => model%platen(i))
            if (platen%leader /= node .or. .not. names(value(named%digits), turn)) cycle
            if (platen%held .and. platen%prescribed /= displacement) conflict = angle
            platen%held = .true.
            platen%prescribed = displacement
          end associate
        end do
        if (conflict > 0) call found%add_error( &
          card(1), card(2), card(3), ': '//freedom(model, conflict, node)// &
          ' is held at another displacement already', 'one displacement for each freedom')
      end associate
    end subroutine hold
  end subroutine hold_nodes

  !> Check that each SPCD of a load case moves a DOF that the supports of the case fix, and that no DOF has
  !! two different displacements. Each SPCD is reported once.
  subroutine check_displacements(cases, model, held, found)
    type(load_cases), intent(in) :: cases
    type(model_type), intent(in) :: model
    logical, intent(in) :: held(:, :, :)      !! DOFs that are fixed, by direction or `angle`, node, pattern
    type(findings), intent(inout) :: found    !! what is wrong is added
    logical :: reported(size(cases%moved))
    integer, allocatable :: before(:, :)      ! first displacement that each DOF has; 0: none
    integer :: i, k, node

    reported = .false.
    do k = 1, size(cases%case)
      before = spread(spread(0, 1, angle), 2, model%nodes)
      do i = 1, size(reported)
        associate (at => cases%moved(i))
          if (all(cases%case(k)%set /= at%set) .or. reported(i)) cycle
          node = at%node
          if (at%c == angle) node = model%platen(at%node)%leader
          if (before(at%c, node) == 0) before(at%c, node) = i
          if (.not. held(at%c, node, cases%case(k)%pattern)) then
            call refuse(' is not fixed', 'SPC or SPC1 of this direction, in the set that the case has')
          else if (displacement(i) /= displacement(before(at%c, node))) then
            call refuse(' has another displacement already', 'one displacement for each direction')
          end if
        end associate
      end do
    end do

  contains

    pure real(wp) function displacement(i)
      integer, intent(in) :: i

      displacement = cases%case(k)%share_of(cases%moved(i)%set)*cases%moved(i)%displacement
    end function displacement

    subroutine refuse(why, remedy)
      character(len=*), intent(in) :: why, remedy

      reported(i) = .true.
      associate (at => cases%moved(i))
        call found%add_error(card_spcd, at%card, at%field, ': '//freedom(model, at%c, node)//why// &
                             cases%case(k)%where_text(), remedy)
      end associate
    end subroutine refuse
  end subroutine check_displacements

  !> Ties of the freedoms that no support holds, of which chains are followed to their end; then the reference
  !! freedoms, which must be free of both.
  subroutine build_ties(deck, nodes, always_held, model, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    !> Fixed in all load cases; a SUPORT DOF that is fixed in some of them has no effect there [angle, nodes]
    logical, intent(in) :: always_held(:, :)
    type(model_type), intent(inout) :: model   !! the scene, with its supports
    type(findings), intent(inout) :: found     !! what is wrong with it is added
    type(named_node), allocatable :: named(:)
    integer :: c, i, leader(deck%card(card_rbe2)%count), platen

    model%sum_of = spread([0, 0], 2, model%nodes)
    call resolve(deck, card_rbe2, 2, nodes, found, leader)
    call check_ties()
    named = nodes_of_lists(deck, card_rbe2, nodes, found)
    do i = 1, size(named)
      associate (card => named(i)%card, node => named(i)%node)
        platen = findloc(model%platen%leader, leader(card(2)), dim=1)
        if (platen > 0) call turn_with(model, platen, node, card, found)
        do c = 1, merge(directions, 0, platen == 0)
          if (leader(card(2)) > 0 .and. names(deck%card(card_rbe2)%value(named(i)%digits, card(2)), c)) &
            call tie(model, c, node, leader(card(2)), card, found)
        end do
      end associate
    end do
    call follow_to_the_end(model%leader)
    named = nodes_of_fields(deck, card_suport, [1, 3, 5, 7], nodes, found)
    do i = 1, size(named)
      associate (card => named(i)%card, node => named(i)%node)
        do c = 1, directions
          if (model%held(c, node) .and. .not. always_held(c, node)) cycle
          if (names(deck%card(card_suport)%value(named(i)%digits, card(2)), c)) &
            call set_reference(model, c, node, card, found)
        end do
        call check_directions(model, node, deck%card(card_suport)%value(named(i)%digits, card(2)), &
                              [card_suport, card(2), named(i)%digits], found)
        platen = findloc(model%platen%leader, node, dim=1)
        if (platen == 0) cycle
        if (model%platen(platen)%held .and. .not. always_held(angle, node)) cycle
        if (names(deck%card(card_suport)%value(named(i)%digits, card(2)), turn)) &
          call set_reference(model, angle, node, card, found)
      end associate
    end do
    call build_equations(deck, nodes, model, found)
    call complete_ties(model, found)
    call build_springs(deck, nodes, model, found)

  contains

    !> An RBE2 ties direction 1 or 2; if its leader rotates, both.
    subroutine check_ties()
      logical :: tied(directions)
      integer :: i

      do i = 1, size(leader)
        tied = names(deck%card(card_rbe2)%value(3, i), [1, 2])
        if (all(tied) .or. leader(i) == 0) cycle
        if (any(model%platen%leader == leader(i))) then
          call found%add_note(card_rbe2, i, 3, &
            ': '//model%name_of(of_node, leader(i))//' rotates, so GM follow in directions 1 and 2')
        else if (.not. any(tied)) then
          call found%add_warning(card_rbe2, i, 3, ': field 4 (CM) ties neither direction 1 nor 2', &
                                 'the directions in which GM move as GN does, such as 12')
        end if
      end do
    end subroutine check_ties
  end subroutine build_ties

  !> SPC and SUPORT: nodes, each with its directions in the next field.
  function nodes_of_fields(deck, card, columns, nodes, found) result(named)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card, columns(:)   !! which table, the fields of its nodes
    type(card_index), intent(in) :: nodes
    type(findings), intent(inout) :: found
    type(named_node), allocatable :: named(:)
    integer :: i, k, node(deck%card(card)%count)

    allocate (named(size(columns)*size(node)))
    do k = 1, size(columns)
      call resolve(deck, card, columns(k), nodes, found, node)
      do i = 1, size(node)
        named((k - 1)*size(node) + i) = named_node([card, i, columns(k)], node(i), columns(k) + 1)
      end do
    end do
    named = pack(named, named%node > 0)
  end function nodes_of_fields

  !> SPC1 and RBE2: directions, then a list of nodes. Of a range some may be missing.
  function nodes_of_lists(deck, card, nodes, found) result(named)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card   !! which table
    type(card_index), intent(in) :: nodes
    type(findings), intent(inout) :: found
    type(named_node), allocatable :: named(:)
    integer :: i, item, k, last
    integer, allocatable :: node(:)

    last = 0
    allocate (named(64))
    associate (table => deck%card(card))
      do i = 1, table%count
        do item = table%list_start(i), table%list_start(i + 1) - 1
          node = nodes%within(table%list(item)%from, table%list(item)%to)
          if (size(node) == 0 .and. nodes%whole) call refuse(i, item)
          do while (last + size(node) > size(named))   ! room doubles
            named = [named, named]
          end do
          do k = 1, size(node)
            named(last + k) = named_node([card, i, -item], node(k), table%entry%list_slot - 1)
          end do
          last = last + size(node)
        end do
      end do
    end associate
    named = named(:last)

  contains

    !> There is none of these nodes.
    subroutine refuse(i, item)
      integer, intent(in) :: i, item
      character(len=:), allocatable :: ids

      associate (from => deck%card(card)%list(item)%from, to => deck%card(card)%list(item)%to)
        ids = text_of(from)
        if (to > from) ids = ids//' to '//text_of(to)
      end associate
      call found%add_error(card, i, -item, ': there is no GRID '//ids, 'the id of a GRID')
    end subroutine refuse
  end function nodes_of_lists
end module epcont_build_supports
