!> Ids of cards: unique among cards that share ids, and resolved on cards that name them; and the used sets of
!> supports or loads.
module epcont_build_reference
  use epcont_base_sorting, only: id_index, new_id_index, sorted_order
  use epcont_base_text, only: text_of
  use epcont_deck_card_kinds, only: card_blseg
  use epcont_deck_case_control, only: set_choice
  use epcont_deck_deck, only: deck_type
  use epcont_deck_table, only: list_item
  use epcont_model_finding, only: findings
  implicit none
  private
  public :: card_index, index_of, check_combinations, check_unique, resolve, chosen_sets
  public :: check_choices, named_node, nodes_of_fields, nodes_of_lists, note_unnamed

  !> The ids that fields may name, and their type.
  type, extends(id_index) :: card_index
    character(len=8) :: noun = ''    !! GRID, or `element`
    logical :: whole = .true.        !! false if cards with errors may have other ids
  end type card_index

  !> An id in a field of a card.
  type :: given_id
    integer :: id = 0
    integer :: card(3) = 0   !! table, card, field
  end type given_id

  !> A node that a card names, with some of its DOFs.
  type :: named_node
    integer :: card(3) = 0   !! table, card, field or item of its list that names the node
    integer :: node = 0      !! its index
    integer :: digits = 0    !! field that names the DOFs
  end type named_node

contains

  !> Ids in the first fields of all correct cards of a table; of all BLSEGs, also those with errors.
  pure type(card_index) function index_of(deck, card) result(index)
    type(deck_type), intent(in) :: deck   !! its cards
    integer, intent(in) :: card           !! table

    associate (table => deck%card(card))
      index = card_index(new_id_index(merge(int(table%value(1, :)), -1, &
                                            table%sound .or. card == card_blseg)), &
                         table%entry%name, deck%whole .and. all(table%sound))
    end associate
  end function index_of

  !> Ids in fields of cards that are not blank.
  pure function ids_in(deck, cards, columns) result(given)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: cards(:), columns(:)   !! tables, and fields of each card
    type(given_id), allocatable :: given(:)
    integer :: c, i, k, last

    allocate (given(size(columns)*sum(deck%card(cards)%count)))
    last = 0
    do c = 1, size(cards)
      associate (table => deck%card(cards(c)))
        do i = 1, table%count
          do k = 1, size(columns)
            if (.not. table%given(columns(k), i)) cycle
            last = last + 1
            given(last) = given_id(int(table%value(columns(k), i)), [cards(c), i, columns(k)])
          end do
        end do
      end associate
    end do
    given = given(:last)
  end function ids_in

  !> Check that each id is used once in these fields, which share their ids.
  pure subroutine check_unique(deck, cards, columns, found)
    type(deck_type), intent(in) :: deck           !! its cards
    integer, intent(in) :: cards(:), columns(:)   !! tables, and fields of each card
    type(findings), intent(inout) :: found        !! errors are added
    type(given_id), allocatable :: given(:)
    integer :: k

    given = ids_in(deck, cards, columns)
    given = given(sorted_order(given%id))
    do k = 2, size(given)
      associate (card => given(k)%card, earlier => given(k - 1)%card)
        if (given(k)%id == given(k - 1)%id) &
          call found%add_error(card(1), card(2), card(3), ': the id is taken by '// &
                               deck%card(earlier(1))%identity(earlier(2)), 'give it an id of its own')
      end associate
    end do
  end subroutine check_unique

  !> Find the positions that a field of each card names; 0 if the id does not exist or the field is blank.
  !! The former is an error, except for id 0, the basic system, and if unread cards may have the id.
  subroutine resolve(deck, card, column, index, found, position)
    type(deck_type), intent(in) :: deck      !! its cards
    integer, intent(in) :: card              !! table
    integer, intent(in) :: column            !! the field that holds the id
    type(card_index), intent(in) :: index    !! ids that may be named
    type(findings), intent(inout) :: found   !! errors are added
    integer, intent(out) :: position(:)      !! [cards]

    associate (table => deck%card(card))
      position = 0
      where (table%given(column, :)) position = index%find(int(table%value(column, :)))
    end associate
    if (index%whole .and. any(position == 0)) &
      call report_missing(deck, card, column, index%noun, position == 0, found)
  end subroutine resolve

  !> Report each missing id once, at the first card that names it. The reader has reported required fields.
  pure subroutine report_missing(deck, card, column, noun, lacking, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card, column
    character(len=*), intent(in) :: noun     !! of the missing cards
    logical, intent(in) :: lacking(:)        !! cards that name no position
    type(findings), intent(inout) :: found   !! errors are added
    character(len=:), allocatable :: what
    integer, allocatable :: id(:), row(:)
    integer :: first, i

    associate (table => deck%card(card))
      row = pack([(i, i=1, table%count)], lacking .and. table%given(column, :) .and. table%sound)
      row = row(sorted_order(int(table%value(column, row))))
      id = int(table%value(column, row))
      first = 1
      do i = 1, size(id)
        if (any(id(i + 1:min(i + 1, size(id))) == id(i))) cycle   ! not the last one of equal ids
        what = ': '//table%entry%field_text(column)//': there is no '//trim(noun)//' '//text_of(id(i))
        if (i > first) &
          what = what//'; '//text_of(i - first + 1)//' '//trim(table%entry%name)//' cards refer to it'
        if (id(i) /= 0) call found%add_error(card, row(first), column, what, 'give the id of '// &
                                             trim(merge('an', 'a ', noun == 'element'))//' '//trim(noun))
        first = i + 1
      end do
    end associate
  end subroutine report_missing

  !> Find the set that SPC =, MPC = or LOAD = names in each load case. Without a choice, the only set is used;
  !! a set of loads only if the deck has at most one case.
  pure subroutine chosen_sets(deck, cards, choice, word, found, set)
    type(deck_type), intent(in) :: deck      !! its cards
    integer, intent(in) :: cards(:)          !! tables whose first field is the set
    type(set_choice), intent(in) :: choice(:)   !! [cases]
    character(len=*), intent(in) :: word     !! SPC, MPC or LOAD
    type(findings), intent(inout) :: found   !! errors are added
    integer, intent(out) :: set(:)           !! 0 if absent [cases]
    type(given_id), allocatable :: given(:)
    integer :: i

    given = ids_in(deck, cards, [1])
    set = choice%id
    ! Without LOAD, a SUBCASE has no loads at its end; so has a deck that continues earlier loads.
    if (all(choice%id == 0) .and. (size(choice) == 1 .and. deck%restart == '' .or. word /= 'LOAD') .and. &
        size(given) > 0) then
      set = given(1)%id
      i = findloc(given%id /= set(1), .true., dim=1)
      if (i > 0) then
        call found%add_error(given(i)%card(1), given(i)%card(2), 1, ': the deck has several sets, '// &
                             text_of(set(1))//' and '//text_of(given(i)%id)//', and chooses none', &
                             'write '//word//' = '//text_of(set(1))//' before BEGIN BULK')
        return
      end if
    end if
    if (size(given) == sum(deck%card(cards)%count)) &
      call check_choices(deck, choice, given%id, word, 'the deck has no such set', &
                         'give a set of the deck, or add its cards', found)
  end subroutine chosen_sets

  !> Report once each choice of case control that no card matches.
  pure subroutine check_choices(deck, choice, ids, word, what, remedy, found)
    type(deck_type), intent(in) :: deck            !! its cards
    type(set_choice), intent(in) :: choice(:)      !! of the load cases
    integer, intent(in) :: ids(:)                  !! of the cards
    character(len=*), intent(in) :: word           !! word of case control: SPC
    character(len=*), intent(in) :: what, remedy   !! fault and remedy
    type(findings), intent(inout) :: found         !! errors are added
    integer :: k

    do k = 1, size(choice)
      if (choice(k)%id <= 0 .or. any(ids == choice(k)%id) .or. .not. deck%whole) cycle
      if (any(choice(:k - 1)%id == choice(k)%id)) cycle
      call found%add_error(choice(k)%place, word//' = '//text_of(choice(k)%id)//': '//what, remedy)
    end do
  end subroutine check_choices

  !> Check the cards that combine sets under one id, LOAD or MPCADD: their id must not be that of a set, and
  !! their sets must exist on other cards.
  subroutine check_combinations(deck, card, members, noun, remedy, found)
    type(deck_type), intent(in) :: deck           !! its cards
    integer, intent(in) :: card                   !! table of the combining cards
    integer, intent(in) :: members(:)             !! tables of the cards in the sets
    character(len=*), intent(in) :: noun, remedy  !! name of the sets; cards that they contain
    type(findings), intent(inout) :: found        !! errors are added
    character(len=:), allocatable :: what
    integer, allocatable :: id(:)                 ! ids of the sets
    integer :: i, item, set

    id = [(nint(deck%card(members(i))%value(1, :)), i=1, size(members))]
    associate (combined => deck%card(card))
      do i = 1, combined%count
        if (.not. (combined%sound(i) .and. deck%whole)) cycle
        if (any(id == nint(combined%value(1, i)))) &
          call found%add_error(card, i, 1, ': the id is that of a set of '//noun, 'give it an id of its own')
        do item = combined%list_start(i), combined%list_start(i + 1) - 1
          set = member_of(combined%list(item))
          if (any(id == set)) cycle
          what = ': there is no set '//text_of(set)//' of '//noun
          if (any(nint(combined%value(1, :)) == set)) what = ': set '//text_of(set)// &
            ' combines sets itself ('//trim(combined%entry%name)//'), and such sets do not nest'
          call found%add_error(card, i, -item, what, remedy)
        end do
      end do
    end associate
  end subroutine check_combinations

  !> Set of an item of the list of LOAD or MPCADD: after its factor, or alone.
  pure integer function member_of(item) result(set)
    type(list_item), intent(in) :: item

    set = item%from
    if (set == 0) set = nint(item%number(2))
  end function member_of

  !> Note each id once that no other card and no load case names.
  pure subroutine note_unnamed(deck, cards, columns, names, by, found)
    type(deck_type), intent(in) :: deck           !! its cards
    integer, intent(in) :: cards(:), columns(:)   !! tables that may be named, and fields of their ids
    integer, intent(in) :: names(:)               !! ids that are named
    character(len=*), intent(in) :: by            !! what could name it: `CGAP`; `load case` for sets
    type(findings), intent(inout) :: found        !! notes are added
    type(given_id), allocatable :: given(:)
    type(id_index) :: first, named
    integer :: k

    if (by == 'load case' .and. deck%is_part()) return   ! other parts of the history may name it
    named = new_id_index(names)
    given = ids_in(deck, cards, columns)
    first = new_id_index(given%id)
    do k = 1, size(given)
      if (named%find(given(k)%id) > 0 .or. first%find(given(k)%id) /= k) cycle
      associate (card => given(k)%card)
        call found%add_note(card(1), card(2), card(3), ': no '//by//' names '//text_of(given(k)%id))
      end associate
    end do
  end subroutine note_unnamed

  !> Read SPC and SUPORT: nodes, each with its directions in the next field.
  function nodes_of_fields(deck, card, columns, nodes, found) result(named)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card, columns(:)   !! table, fields of its nodes
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

  !> Read SPC1 and RBE2: directions, then a list of nodes. Nodes of a range may be missing.
  function nodes_of_lists(deck, card, nodes, found) result(named)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card   !! table
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
          do while (last + size(node) > size(named))   ! doubled if too small
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

    !> Report that these nodes do not exist.
    subroutine refuse(i, item)
      integer, intent(in) :: i, item
      character(len=:), allocatable :: ids

      associate (from => deck%card(card)%list(item)%from, to => deck%card(card)%list(item)%to)
        ids = text_of(from)
        if (to > from) ids = ids//' to '//text_of(to)
      end associate
      call found%add_error(card, i, -item, ': there is no GRID '//ids, 'give the id of a GRID')
    end subroutine refuse
  end function nodes_of_lists
end module epcont_build_reference
