!> From the cards of a deck to the scene, and what is found of it to messages with their places in the deck.
module epcont_build_build
  use epcont_base_diagnostic, only: diagnostic, diagnostics
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_base_text, only: text_of
  use epcont_build_cases, only: build_cases
  use epcont_build_choices, only: check_once, read_controls
  use epcont_build_contacts, only: build_contacts
  use epcont_build_mesh, only: build_mesh, element_cards
  use epcont_build_reference, only: card_index, check_unique, chosen_sets, index_of, note_unnamed
  use epcont_build_supports, only: build_ties, check_displacements, hold_nodes
  use epcont_build_temperatures, only: build_temperatures
  use epcont_contact_geometry_complete, only: check_controls, finish_model
  use epcont_contact_geometry_line_contacts, only: find_line_contacts
  use epcont_deck_card_kinds, only: card_bconp, card_blseg, card_celas1, card_celas2, card_cgap, &
      card_cord2r, card_grav, card_grid, card_load, card_mat1, card_mats1, card_mpc, card_mpcadd, &
      card_nlparm, card_param, card_pelas, card_pgap, card_pshell, card_psolid, card_rbe2, card_rforce, &
      card_spc, card_spc1, card_tables1
  use epcont_deck_case_control, only: subcase_control
  use epcont_deck_deck, only: deck_type
  use epcont_deck_entry, only: least_cause
  use epcont_element_element_kind, only: element_kind
  use epcont_element_element_kinds, only: element_kinds
  use epcont_element_kinematics, only: directions
  use epcont_model_body_checks, only: check_body_loads
  use epcont_model_element_shapes, only: check_axis
  use epcont_model_arrays, only: angle
  use epcont_model_finding, only: and_more, findings, of_body, of_body_load, of_couple, of_element, &
      of_equation, of_line, of_node, of_pair, of_paper_ratio, of_scene, of_theory
  use epcont_model_load_cases, only: contact_all, contact_none, load_cases, put_case
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_model, tell

  !> Cards with ids of their own.
  integer, parameter :: own_ids(11) = [card_grid, card_mat1, card_mats1, card_tables1, card_pgap, &
      card_cord2r, card_blseg, card_bconp, card_load, card_mpcadd, card_nlparm]

contains

  !> Build the scene; whatever is wrong with it is added to `faults`, and the model serves only without
  !! errors.
  subroutine build_model(deck, model, faults, all_cases, of_pattern)
    type(deck_type), intent(in) :: deck          !! its cards
    type(model_type), intent(out) :: model       !! the scene, with the first load case of that pattern
    type(diagnostics), intent(inout) :: faults   !! of the deck; they are added to
    type(load_cases), intent(out), optional :: all_cases   !! of the deck
    integer, intent(in), optional :: of_pattern  !! of supports and contacts; else that of the first case
    type(card_index) :: nodes
    type(load_cases) :: cases
    integer :: chosen, pattern   ! contacts, and what of_pattern says
    logical, allocatable :: always_held(:, :)   ! by all patterns [angle, nodes]
    integer :: k

    pattern = 1
    if (present(of_pattern)) pattern = of_pattern
    model%kinds = element_kinds()
    do k = 1, size(own_ids)
      call check_unique(deck, own_ids(k:k), faults)
    end do
    call check_unique(deck, [card_pshell, card_psolid], faults)
    call check_unique(deck, [element_cards(deck, model%kinds), card_rbe2, card_cgap, card_celas1, &
                            card_celas2], faults)
    nodes = index_of(deck, card_grid)
    call build_mesh(deck, nodes, model, faults)
    model%controls = read_controls(deck)
    call build_cases(deck, nodes, model, cases, faults)
    call build_temperatures(deck, nodes, model, cases, faults)
    call hold_patterns()
    call build_ties(deck, nodes, always_held, model, faults)
    chosen = cases%case(findloc(cases%case%pattern, pattern, dim=1))%contact
    call check_axis(model, faults)
    ! What iterations of a mesher leave of zero. Sides are longer by far, but what it makes of gaps would load
    ! the scene.
    where (abs(model%x) < least_cause) model%x = 0.0_wp
    call build_contacts(deck, nodes, chosen, model, faults)
    model%contact_is_off = chosen /= contact_all
    call find_line_contacts(model, faults)
    call check_once(deck, model%controls%original, faults)
    call check_controls(model, faults)
    if (model%elements == 0 .and. faults%errors == 0) &
      call faults%add_error(of_scene, 0, 0, 'the deck has no elements', 'CTRIA3 cards')
    if (faults%errors == 0) then
      call put_case(cases, findloc(cases%case%pattern, pattern, dim=1), model)
      call check_body_loads(model, cases%body%given, faults)
      call finish_model(model, faults)
    end if
    call note_without_effect(deck, model, cases, faults)
    if (present(all_cases)) all_cases = cases
    call find_card_of_contact(deck, chosen, faults)
    call tell(deck, model%kinds, faults)

  contains

    !> The patterns of the load cases: of the freedoms that their supports hold, and of their contacts.
    subroutine hold_patterns()
      logical, allocatable :: held(:, :, :)   ! by each pattern, as `held_now` has them
      integer, allocatable :: first(:)        ! case of each pattern
      integer :: k

      allocate (held(angle, model%nodes, 0), first(0))
      do k = 1, size(cases%case)
        call take_pattern(k, held, first)
      end do
      cases%patterns = size(first)
      always_held = all(held, dim=3)
      call check_displacements(cases, model, held, faults)
      call hold(held(:, :, min(pattern, cases%patterns)))
    end subroutine hold_patterns

    !> The pattern of a load case.
    subroutine take_pattern(k, held, first)
      integer, intent(in) :: k
      logical, allocatable, intent(inout) :: held(:, :, :)
      integer, allocatable, intent(inout) :: first(:)
      integer :: before, p

      associate (case => cases%case)
        before = findloc(case(:k - 1)%supports, case(k)%supports, dim=1)
        if (before == 0) call hold_nodes(deck, nodes, case(k)%supports, model, faults)
        if (before > 0) call hold(held(:, :, case(before)%pattern))
        do p = 1, size(first)
          if (case(k)%contact == case(first(p))%contact .and. all(held(:, :, p) .eqv. held_now())) exit
        end do
        case(k)%pattern = p
      end associate
      if (p <= size(first)) return
      first = [first, k]
      held = reshape([held, held_now()], [angle, model%nodes, p])
    end subroutine take_pattern

    !> The freedoms of all nodes that are held, and the angles of those that lead and turn [angle, nodes].
    pure function held_now() result(held)
      logical, allocatable :: held(:, :)

      allocate (held(angle, model%nodes), source=.false.)
      held(:directions, :) = model%held
      held(angle, model%platen%leader) = model%platen%held
    end function held_now

    !> Hold them.
    subroutine hold(held)
      logical, intent(in) :: held(:, :)

      model%held = held(:directions, :)
      model%platen%held = held(angle, model%platen%leader)
    end subroutine hold
  end subroutine build_model

  !> Note the cards that nothing uses: no other card, or no load case.
  subroutine note_without_effect(deck, model, cases, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    type(load_cases), intent(in) :: cases
    type(diagnostics), intent(inout) :: faults
    integer, allocatable :: sections(:)
    integer :: c

    associate (elements => element_cards(deck, model%kinds), cid => deck%card(card_cgap)%column('CID'))
      sections = [(ids(elements(c), 2), c=1, size(elements))]
      call note_unnamed(deck, card_pshell, 1, sections, 'element', faults)
      call note_unnamed(deck, card_psolid, 1, sections, 'element', faults)
      call note_unnamed(deck, card_mat1, 1, [ids(card_pshell, 2), ids(card_psolid, 2)], &
                        'PSHELL or PSOLID', faults)
      call note_unnamed(deck, card_tables1, 1, ids(card_mats1, 2), 'MATS1', faults)
      call note_unnamed(deck, card_pgap, 1, ids(card_cgap, 2), 'CGAP', faults)
      call note_unnamed(deck, card_cord2r, 1, ids(card_cgap, cid), 'CGAP', faults)
      call note_unnamed(deck, card_pelas, 1, ids(card_celas1, 2), 'CELAS1', faults)
      call note_unnamed(deck, card_pelas, 5, ids(card_celas1, 2), 'CELAS1', faults)
    end associate
    if (all(cases%case%contact /= contact_all)) &
      call note_unnamed(deck, card_bconp, 1, cases%case%contact, 'BCONTACT', faults)
    if (all(cases%case%contact == contact_none) .and. deck%card(card_cgap)%count > 0) &
      call faults%add_note(card_cgap, 1, 1, &
        ': BCONTACT is NONE in all load cases'//and_more(deck%card(card_cgap)%count, ' (', ' more CGAPs)'))

  contains

    !> The ids in a column of a table.
    pure function ids(card, column)
      integer, intent(in) :: card, column
      integer :: ids(deck%card(card)%count)

      ids = nint(deck%card(card)%value(column, :))
    end function ids
  end subroutine note_without_effect

  !> Of contacts the only one is chosen: what is found of it is of its card.
  subroutine find_card_of_contact(deck, chosen, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: chosen
    type(diagnostics), intent(inout) :: faults
    integer :: i

    if (chosen <= 0) return
    do i = 1, faults%count
      if (faults%list(i)%of == of_couple) &
        faults%list(i)%which = findloc(nint(deck%card(card_bconp)%value(1, :)), chosen, dim=1)
    end do
  end subroutine find_card_of_contact

  !> Put the names of their cards before what was found of the scene, with the places of these.
  subroutine tell(deck, kinds, faults, case)
    type(deck_type), intent(in) :: deck          !! its cards
    type(element_kind), intent(in) :: kinds(:)   !! of elements
    type(diagnostics), intent(inout) :: faults   !! of the deck, and findings of the scene that it makes
    integer, intent(in), optional :: case        !! the first one with the supports of the scene
    integer, allocatable :: elements(:)   ! the cards of elements
    integer :: i

    elements = element_cards(deck, kinds)
    do i = 1, faults%count
      if (faults%list(i)%of /= of_scene) call name_card(faults%list(i))
    end do

  contains

    !> The same of one; it is then no finding any more.
    subroutine name_card(one)
      type(diagnostic), intent(inout) :: one
      integer :: card(3)

      if (allocated(one%node)) &
        one%remedy = one%remedy//': '//holding_cards(deck, nint(deck%card(card_grid)%value(1, one%node)))
      card = card_of(one)
      one%place = deck%place(card(1), card(2), card(3))
      if (one%of /= of_body) one%what = deck%card(card(1))%identity(card(2))//one%what
      if (one%of == of_body .and. present(case)) call name_supports(one, deck%subcase, case)
      one%of = of_scene
      one%which = 0
    end subroutine name_card

    !> The table, the card and the column, or the negative item of a list, that a finding is about.
    pure function card_of(one) result(card)
      type(diagnostic), intent(in) :: one
      integer :: card(3), c

      card = [one%of, one%which, one%item]
      select case (one%of)
      case (of_node, of_body)
        card(1) = card_grid
      case (of_element)
        do c = 1, size(elements)
          card(1) = elements(c)
          if (card(2) <= deck%card(card(1))%count) exit
          card(2) = card(2) - deck%card(card(1))%count
        end do
        if (card(3) < 0) &   ! a node: behind id and section
          card(3) = findloc(deck%card(card(1))%value(:, card(2)), &
                            deck%card(card_grid)%value(1, -card(3)), dim=1, back=.true.)
      case (of_pair)
        card(1) = card_cgap
      case (of_line)
        card(1) = card_blseg
        if (card(3) < 0) card(3) = -list_item(card(2), -card(3))
      case (of_couple)
        card(1) = card_bconp
      case (of_body_load)
        card(1) = card_grav
        if (card(2) > deck%card(card_grav)%count) &
          card(:2) = [card_rforce, card(2) - deck%card(card_grav)%count]
      case (of_equation)
        card(1) = card_mpc
      case (of_theory)
        card(:2) = [card_param, deck%parameter_row('THEORY')]
      case (of_paper_ratio)
        card(:2) = [card_param, max(deck%parameter_row('MUP'), deck%parameter_row('ORIGINAL'))]
      end select
    end function card_of

    !> The item of a BLSEG's list that names the k-th node of the line.
    pure integer function list_item(line, k) result(item)
      integer, intent(in) :: line, k
      integer :: nodes

      nodes = 0
      associate (blseg => deck%card(card_blseg))
        do item = blseg%list_start(line), blseg%list_start(line + 1) - 1
          nodes = nodes + (blseg%list(item)%to - blseg%list(item)%from)/blseg%list(item)%step + 1
          if (nodes >= k) return
        end do
      end associate
    end function list_item
  end subroutine tell

  !> Name the supports of a load case in a fault that depends on them, if other cases have other supports.
  subroutine name_supports(one, subcase, case)
    type(diagnostic), intent(inout) :: one
    type(subcase_control), intent(in) :: subcase(:)   !! [cases]
    integer, intent(in) :: case                       !! which of them
    character(len=:), allocatable :: name
    integer :: other

    other = findloc(subcase%spc%id /= subcase(case)%spc%id, .true., dim=1)
    if (other == 0) return
    name = 'SUBCASE '//text_of(subcase(case)%id)
    if (subcase(case)%spc%id > 0) then
      one%what = name//', SPC = '//text_of(subcase(case)%spc%id)//': '//one%what
    else
      one%what = name//' has no SPC: '//one%what
      one%remedy = 'SPC = '//text_of(subcase(other)%spc%id)//' in it; or '//one%remedy
      one%place = subcase(case)%place
    end if
  end subroutine name_supports

  !> The SPC1 cards, in free field, that hold some nodes in direction 1.
  pure function holding_cards(deck, ids) result(text)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: ids(:)
    character(len=:), allocatable :: text
    integer, parameter :: most_fields = 6   ! of a line with SPC1, its set and directions
    integer, allocatable :: id(:)
    integer :: fields, from, item, set(size(deck%subcase)), to
    type(findings) :: unheard

    call chosen_sets(deck, [card_spc1, card_spc], deck%subcase%spc, 'SPC', unheard, set)
    id = ids(sorted_order(ids))
    text = ''
    fields = most_fields
    from = 1
    do while (from <= size(id))
      do to = from, size(id) - 1
        if (id(to + 1) /= id(to) + 1) exit
      end do
      if (to == from + 1) to = from   ! two nodes are no range
      item = merge(3, 1, to > from)
      if (fields + item > most_fields) then
        if (len(text) > 0) text = text//' and '
        text = text//'SPC1,'//text_of(max(set(1), 1))//',1'
        fields = 0
      end if
      fields = fields + item
      text = text//','//text_of(id(from))
      if (to > from) text = text//',THRU,'//text_of(id(to))
      from = to + 1
    end do
  end function holding_cards
end module epcont_build_build
