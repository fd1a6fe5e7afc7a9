!> Supports, ties and SUPORT DOFs from GRID PS, SPC, SPC1, RBE2 and SUPORT.
module epcont_build_supports
  use epcont_base_kinds, only: wp
  use epcont_build_reference, only: card_index, named_node, nodes_of_fields, nodes_of_lists, resolve
  use epcont_base_text, only: text_of
  use epcont_build_tie_cards, only: check_directions, digit, direction_text, dof_node, names
  use epcont_deck_card_kinds, only: card_grid, card_rbe2, card_spc, card_spc1, card_spcd, card_suport
  use epcont_deck_deck, only: deck_type
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle, dof_tie, scene_type
  use epcont_model_finding, only: findings, of_platen, of_reference, of_tie
  use epcont_model_load_cases, only: load_cases, set_displacement
  implicit none
  private
  public :: read_references, read_supports, read_ties

contains

  !> Find the DOFs that the supports of each load case fix. Cases with the same supports and contacts form a
  !! pattern; the data get the supports of one pattern.
  subroutine read_supports(deck, nodes, pattern, data, cases, idle, found)
    type(deck_type), intent(in) :: deck         !! its cards
    type(card_index), intent(in) :: nodes       !! ids of GRID
    integer, intent(in) :: pattern              !! whose supports the data get
    type(scene_type), intent(inout) :: data     !! with the rotating master nodes; gets the supports
    type(load_cases), intent(inout) :: cases    !! get their patterns
    !> Fixed in this pattern, but not in all: a SUPORT DOF has no effect [angle, nodes]
    logical, allocatable, intent(out) :: idle(:, :)
    type(findings), intent(inout) :: found      !! errors are added
    logical, allocatable :: held(:, :, :)       ! by each pattern [angle, nodes, patterns]
    logical, allocatable :: now(:, :)           ! by a load case [angle, nodes]
    integer, allocatable :: first(:)            ! case of each pattern
    integer :: before, k, p

    allocate (held(angle, size(data%held, 2), 0), first(0), cases%held_at(0))
    do k = 1, size(cases%case)
      associate (case => cases%case)
        before = findloc(case(:k - 1)%supports, case(k)%supports, dim=1)
        if (before > 0) then
          now = held(:, :, case(before)%pattern)
        else
          call find_held(deck, nodes, case(k)%supports, data, now, cases%held_at, found)
        end if
        ! In a sequence, the cases of a pattern follow each other.
        do p = merge(max(1, size(first)), 1, cases%sequence), size(first)
          if (case(k)%contact == case(first(p))%contact .and. all(held(:, :, p) .eqv. now)) exit
        end do
        case(k)%pattern = p
      end associate
      if (cases%sequence .and. k > 1) call check_sequence(deck, k, now .neqv. held(:, :, size(first)), found)
      if (p <= size(first)) cycle
      first = [first, k]
      held = reshape([held, now], [angle, size(data%held, 2), p])
    end do
    cases%patterns = size(first)
    call check_displacements(deck, data, cases, held, found)
    now = held(:, :, min(pattern, cases%patterns))
    idle = now .and. .not. all(held, dim=3)
    data%held = now(:directions, :)
    data%platen%held = now(angle, data%platen%leader)
  end subroutine read_supports

  !> Check that a SUBCASE of a sequence has the supports of the one before.
  subroutine check_sequence(deck, case, differs, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: case           !! number of the SUBCASE
    logical, intent(in) :: differs(:, :)  !! the DOF is fixed in one of them only [angle, nodes]
    type(findings), intent(inout) :: found
    integer :: at(2)

    if (.not. any(differs)) return
    at = findloc(differs, .true.)
    call found%add_error(deck%subcase(case)%place, 'SUBCASE '//text_of(deck%subcase(case)%id)// &
      ': its supports are not those of the SUBCASE before: '//direction_text(deck, at(1), at(2)), &
      'fix the same DOFs in all SUBCASEs of a sequence, and move them with SPCD; or write CNTNLSUB = NO')
  end subroutine check_sequence

  !> Find the DOFs that GRID PS and a set of supports fix.
  subroutine find_held(deck, nodes, set, data, held, moved, found)
    type(deck_type), intent(in) :: deck
    type(card_index), intent(in) :: nodes
    integer, intent(in) :: set                 !! of SPC and SPC1, 0 if absent
    type(scene_type), intent(in) :: data       !! with the rotating master nodes
    logical, allocatable, intent(out) :: held(:, :)   !! [angle, nodes]
    type(set_displacement), allocatable, intent(inout) :: moved(:)   !! displacements other than 0 are added
    type(findings), intent(inout) :: found
    type(named_node), allocatable :: named(:)
    real(wp), allocatable :: prescribed(:, :)  ! as `held` [length]
    integer :: c, i, ps

    allocate (held(angle, deck%card(card_grid)%count), source=.false.)
    allocate (prescribed(angle, size(held, 2)), source=0.0_wp)
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
    do i = 1, size(held, 2)
      do c = 1, angle
        if (prescribed(c, i) /= 0.0_wp) moved = [moved, set_displacement(set, c, dof_node(data, c, i), &
                                                                         prescribed(c, i))]
      end do
    end do

  contains

    !> Fix the DOFs of a node that a card names. If one has another displacement already, that is reported.
    subroutine hold(named)
      type(named_node), intent(in) :: named
      integer :: c, conflict
      real(wp) :: displacement

      conflict = 0
      displacement = 0.0_wp
      associate (card => named%card, node => named%node, &
                 value => deck%card(named%card(1))%value(:, named%card(2)))
        if (card(1) /= card_grid .and. nint(value(1)) /= set) return
        if (card(1) == card_spc) displacement = value(named%digits + 1)
        if (displacement /= 0.0_wp) call check_directions(deck, data, node, value(named%digits), &
                                                          [card(:2), named%digits], found)
        do c = 1, angle
          if (.not. names(value(named%digits), digit(c)) .or. dof_node(data, c, node) == 0) cycle
          if (held(c, node) .and. prescribed(c, node) /= displacement) conflict = c
          held(c, node) = .true.
          prescribed(c, node) = displacement
        end do
        if (conflict > 0) call found%add_error( &
          card(1), card(2), card(3), ': '//direction_text(deck, conflict, node)// &
          ' has another prescribed displacement already', 'give one displacement for each DOF')
      end associate
    end subroutine hold
  end subroutine find_held

  !> Check that each SPCD of a load case moves a DOF that the supports of the case fix, and that no DOF has
  !! two different displacements. Each SPCD is reported once.
  subroutine check_displacements(deck, data, cases, held, found)
    type(deck_type), intent(in) :: deck
    type(scene_type), intent(in) :: data
    type(load_cases), intent(in) :: cases
    logical, intent(in) :: held(:, :, :)      !! DOFs that are fixed, by direction or `angle`, node, pattern
    type(findings), intent(inout) :: found    !! errors are added
    logical :: reported(size(cases%moved))
    integer, allocatable :: before(:, :)      ! first displacement that each DOF has, 0 if absent
    integer :: i, k, node

    reported = .false.
    do k = 1, size(cases%case)
      before = spread(spread(0, 1, angle), 2, size(held, 2))
      do i = 1, size(reported)
        associate (at => cases%moved(i))
          if (all(cases%case(k)%set /= at%set) .or. reported(i)) cycle
          node = at%node
          if (at%c == angle) node = data%platen(at%node)%leader
          if (before(at%c, node) == 0) before(at%c, node) = i
          if (.not. held(at%c, node, cases%case(k)%pattern)) then
            call refuse(' is not fixed', 'fix this direction with SPC or SPC1, in the set of the load case')
          else if (displacement(i) /= displacement(before(at%c, node))) then
            call refuse(' has another displacement already', 'give one displacement for each direction')
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
        call found%add_error(card_spcd, at%card, at%field, ': '//direction_text(deck, at%c, node)//why// &
                             cases%case(k)%where_text(), remedy)
      end associate
    end subroutine refuse
  end subroutine check_displacements

  !> Read RBE2: ties, and dependent nodes of rotating master nodes.
  subroutine read_ties(deck, nodes, data, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    type(scene_type), intent(inout) :: data    !! gets the ties and dependent nodes
    type(findings), intent(inout) :: found     !! errors are added
    type(named_node), allocatable :: named(:)
    integer :: c, i, last, leader(deck%card(card_rbe2)%count), platen

    call resolve(deck, card_rbe2, 2, nodes, found, leader)
    call check_ties()
    named = nodes_of_lists(deck, card_rbe2, nodes, found)
    deallocate (data%tie)
    allocate (data%tie(directions*size(named)))
    last = 0
    do i = 1, size(named)
      associate (card => named(i)%card, node => named(i)%node)
        platen = findloc(data%platen%leader, leader(card(2)), dim=1)
        if (platen > 0) then
          data%platen(platen)%follower = [data%platen(platen)%follower, node]
          call found%add_origin([of_platen, platen, -size(data%platen(platen)%follower)], card)
          cycle
        end if
        do c = 1, directions
          if (leader(card(2)) == 0) exit
          if (.not. names(deck%card(card_rbe2)%value(named(i)%digits, card(2)), c)) cycle
          last = last + 1
          data%tie(last) = dof_tie(c, node, leader(card(2)))
          call found%add_origin([of_tie, last, 0], card)
        end do
      end associate
    end do
    data%tie = data%tie(:last)

  contains

    !> Check that an RBE2 ties direction 1 or 2; if its master node rotates, both.
    subroutine check_ties()
      logical :: tied(directions)
      integer :: i

      do i = 1, size(leader)
        tied = names(deck%card(card_rbe2)%value(3, i), [1, 2])
        if (all(tied) .or. leader(i) == 0) cycle
        if (any(data%platen%leader == leader(i))) then
          call found%add_note(card_rbe2, i, 3, ': '//deck%card(card_grid)%identity(leader(i))// &
                              ' rotates, so GM follow in directions 1 and 2')
        else if (.not. any(tied)) then
          call found%add_warning(card_rbe2, i, 3, ': field 4 (CM) ties neither direction 1 nor 2', &
                                 'give the directions in which GM move with GN, such as 12')
        end if
      end do
    end subroutine check_ties
  end subroutine read_ties

  !> Read SUPORT.
  subroutine read_references(deck, nodes, idle, data, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    logical, intent(in) :: idle(:, :)          !! DOFs that are fixed and have no effect [angle, nodes]
    type(scene_type), intent(inout) :: data    !! gets the SUPORT DOFs
    type(findings), intent(inout) :: found     !! errors are added
    type(named_node), allocatable :: named(:)
    integer :: at, c, i

    named = nodes_of_fields(deck, card_suport, [1, 3, 5, 7], nodes, found)
    do i = 1, size(named)
      associate (card => named(i)%card, node => named(i)%node, &
                 digits => deck%card(card_suport)%value(named(i)%digits, named(i)%card(2)))
        call check_directions(deck, data, node, digits, [card_suport, card(2), named(i)%digits], found)
        do c = 1, angle
          at = dof_node(data, c, node)
          if (at == 0 .or. idle(c, node) .or. .not. names(digits, digit(c))) cycle
          if (c == angle) data%platen(at)%reference = .true.
          if (c < angle) data%reference(c, node) = .true.
          call found%add_origin([of_reference, node, c], card)
        end do
      end associate
    end do
  end subroutine read_references
end module epcont_build_supports
