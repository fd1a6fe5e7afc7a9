!> Makes the model from the cards of a deck, and messages with card and field from its findings.
module epcont_build_build
  use epcont_base_diagnostic, only: diagnostic, diagnostics
  use epcont_base_text, only: text_of
  use epcont_build_cases, only: read_cases
  use epcont_build_choices, only: check_once, read_controls
  use epcont_build_contacts, only: read_contacts
  use epcont_build_mesh_cards, only: read_mesh, take_ids
  use epcont_build_reference, only: card_index, check_unique, index_of, note_unnamed
  use epcont_build_supports, only: read_references, read_supports, read_ties
  use epcont_build_temperatures, only: read_temperatures
  use epcont_build_tie_cards, only: read_equations, read_springs
  use epcont_contact_geometry_complete, only: complete_model
  use epcont_deck_card_kinds, only: card_bconp, card_bfric, card_blseg, card_celas1, card_celas2, card_cgap, &
      card_cord2r, card_grav, card_grid, card_load, card_mat1, card_mats1, card_mpcadd, card_nlparm, &
      card_param, card_pelas, card_pgap, card_pshell, card_psolid, card_rbe2, card_rforce, card_tables1, &
      element_cards
  use epcont_deck_case_control, only: subcase_control
  use epcont_deck_deck, only: deck_type
  use epcont_model_arrays, only: scene_type
  use epcont_model_finding, only: and_more, of_body, of_body_load, of_couple, of_element, of_line, &
      of_node, of_pair, of_paper_ratio, of_scene, of_section, of_theory
  use epcont_model_load_cases, only: contact_all, contact_none, load_cases
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_model, tell

  !> Cards with ids of their own.
  integer, parameter :: own_ids(*) = [card_grid, card_mat1, card_mats1, card_tables1, card_pgap, &
      card_cord2r, card_blseg, card_bconp, card_load, card_mpcadd, card_nlparm, card_bfric]

  !> Fields of parts of a body load: item_acceleration, item_centre, item_spin_up.
  character(len=*), parameter :: body_load_field(3) = ['N1  ', 'G   ', 'RACC']

contains

  !> Build the model of a deck. All errors are added to `faults`; the model is complete only
  !! if there are no errors.
  subroutine build_model(deck, model, faults, all_cases, of_pattern)
    type(deck_type), intent(in) :: deck          !! its cards
    type(model_type), intent(out) :: model       !! the model, with the first load case of the pattern
    type(diagnostics), intent(inout) :: faults   !! of the deck; more are added
    type(load_cases), intent(out), optional :: all_cases   !! of the deck
    integer, intent(in), optional :: of_pattern  !! of supports and contacts; default: that of the first case
    type(load_cases) :: cases
    type(scene_type) :: data
    integer :: case, pattern   ! first case of the pattern, and value of of_pattern

    pattern = 1
    if (present(of_pattern)) pattern = of_pattern
    call check_ids(deck, faults)
    call read_data(deck, pattern, data, cases, faults)
    call take_ids(deck, data, model)
    case = findloc(cases%case%pattern, pattern, dim=1)
    call complete_model(data, cases, case, model, faults)
    call note_without_effect(deck, cases, faults)
    if (present(all_cases)) all_cases = cases
    call tell(deck, faults)
  end subroutine build_model

  !> Check that ids are unique.
  subroutine check_ids(deck, faults)
    type(deck_type), intent(in) :: deck
    type(diagnostics), intent(inout) :: faults
    integer :: k

    do k = 1, size(own_ids)
      call check_unique(deck, own_ids(k:k), [1], faults)
    end do
    call check_unique(deck, [card_pshell, card_psolid], [1], faults)
    call check_unique(deck, [card_pelas], [1, 5], faults)
    call check_unique(deck, [element_cards, card_rbe2, card_cgap, card_celas1, card_celas2], [1], faults)
  end subroutine check_ids

  !> Read the model data from the cards.
  subroutine read_data(deck, pattern, data, cases, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: pattern
    type(scene_type), intent(out) :: data
    type(load_cases), intent(out) :: cases
    type(diagnostics), intent(inout) :: faults
    type(card_index) :: nodes
    logical, allocatable :: idle(:, :)   ! DOFs that are fixed, but not in all patterns [angle, nodes]

    nodes = index_of(deck, card_grid)
    call read_mesh(deck, nodes, data, faults)
    data%controls = read_controls(deck)
    call check_once(deck, data%controls%original, faults)
    call read_cases(deck, nodes, data, cases, faults)
    call read_temperatures(deck, nodes, data, cases, faults)
    call read_supports(deck, nodes, pattern, data, cases, idle, faults)
    call read_ties(deck, nodes, data, faults)
    call read_references(deck, nodes, idle, data, faults)
    call read_equations(deck, nodes, data, faults)
    call read_springs(deck, nodes, data, faults)
    call read_contacts(deck, nodes, cases%case(findloc(cases%case%pattern, pattern, dim=1))%contact, data, &
                       faults)
  end subroutine read_data

  !> Note the cards that no other card or no load case uses.
  subroutine note_without_effect(deck, cases, faults)
    type(deck_type), intent(in) :: deck
    type(load_cases), intent(in) :: cases
    type(diagnostics), intent(inout) :: faults
    integer, allocatable :: sections(:)
    integer :: c

    associate (cid => deck%card(card_cgap)%column('CID'))
      sections = [(ids(element_cards(c), 2), c=1, size(element_cards))]
      call note_unnamed(deck, [card_pshell, card_psolid], [1], sections, 'element', faults)
      call note_unnamed(deck, [card_mat1], [1], [ids(card_pshell, 2), ids(card_psolid, 2)], &
                        'PSHELL or PSOLID', faults)
      call note_unnamed(deck, [card_tables1], [1], ids(card_mats1, 2), 'MATS1', faults)
      call note_unnamed(deck, [card_pgap], [1], ids(card_cgap, 2), 'CGAP', faults)
      call note_unnamed(deck, [card_bfric], [1], ids(card_bconp, 6), 'BCONP', faults)
      call note_unnamed(deck, [card_cord2r], [1], ids(card_cgap, cid), 'CGAP', faults)
      call note_unnamed(deck, [card_pelas], [1, 5], ids(card_celas1, 2), 'CELAS1', faults)
    end associate
    if (all(cases%case%contact /= contact_all)) &
      call note_unnamed(deck, [card_bconp], [1], cases%case%contact, 'BCONTACT', faults)
    if (all(cases%case%contact == contact_none) .and. deck%card(card_cgap)%count > 0) &
      call faults%add_note(card_cgap, 1, 1, &
        ': BCONTACT = NONE in all load cases'//and_more(deck%card(card_cgap)%count, ' (', ' more CGAPs)'))

  contains

    !> Ids in a column of a table.
    pure function ids(card, column)
      integer, intent(in) :: card, column
      integer :: ids(deck%card(card)%count)

      ids = nint(deck%card(card)%value(column, :))
    end function ids
  end subroutine note_without_effect

  !> Begin each finding of the model with the name of its card, and add the place of the card.
  subroutine tell(deck, faults, case)
    type(deck_type), intent(in) :: deck          !! its cards
    type(diagnostics), intent(inout) :: faults   !! of the deck, and findings of its model
    integer, intent(in), optional :: case        !! first case with the supports of the model
    integer :: i

    do i = 1, faults%count
      if (faults%list(i)%of /= of_scene) call name_card(faults%list(i))
    end do

  contains

    !> Do this for one finding, which then is an ordinary message.
    subroutine name_card(one)
      type(diagnostic), intent(inout) :: one
      integer :: card(3)

      card = card_of(one)
      one%place = deck%place(card(1), card(2), card(3))
      if (one%of /= of_body) one%what = deck%card(card(1))%identity(card(2))//one%what
      if (one%of == of_body .and. present(case)) call name_supports(one, deck%subcase, case)
      one%of = of_scene
      one%which = 0
    end subroutine name_card

    !> Table, card and column (if negative: item of a list) of a finding.
    pure function card_of(one) result(card)
      type(diagnostic), intent(in) :: one
      integer :: card(3), c

      card = faults%origin_of([one%of, one%which, one%item])
      select case (card(1))
      case (of_node, of_body)
        card(1) = card_grid
      case (of_element)
        do c = 1, size(element_cards)
          card(1) = element_cards(c)
          if (card(2) <= deck%card(card(1))%count) exit
          card(2) = card(2) - deck%card(card(1))%count
        end do
        if (card(3) < 0) &   ! a node: after id and section
          card(3) = findloc(deck%card(card(1))%value(:, card(2)), &
                            deck%card(card_grid)%value(1, -card(3)), dim=1, back=.true.)
      case (of_section)
        card(:2) = behind(card_pshell, card_psolid, card(2))
      case (of_pair)
        card(1) = card_cgap
      case (of_line)
        card(1) = card_blseg
        if (card(3) < 0) card(3) = -list_item(card(2), -card(3))
      case (of_couple)
        card(1) = card_bconp
      case (of_body_load)
        card(:2) = behind(card_grav, card_rforce, card(2))
        if (card(3) > 0) card(3) = deck%card(card(1))%column(body_load_field(card(3)))
      case (of_theory)
        card(:2) = [card_param, deck%parameter_row('THEORY')]
        ! The deck may have chosen the theory otherwise.
        if (card(2) == 0) card(2) = max(deck%parameter_row('METHOD'), deck%parameter_row('MUP'), &
                                        deck%parameter_row('ORIGINAL'))
      case (of_paper_ratio)
        card(:2) = [card_param, max(deck%parameter_row('MUP'), deck%parameter_row('ORIGINAL'))]
      end select
    end function card_of

    !> The k-th card of two tables, counted through both.
    pure function behind(first, second, k) result(card)
      integer, intent(in) :: first, second, k
      integer :: card(2)

      card = [first, k]
      if (k > deck%card(first)%count) card = [second, k - deck%card(first)%count]
    end function behind

    !> Item of a BLSEG's list that names the k-th node of the line.
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

  !> Name the load case in a fault that depends on its supports, if other cases have other supports.
  subroutine name_supports(one, subcase, case)
    type(diagnostic), intent(inout) :: one
    type(subcase_control), intent(in) :: subcase(:)   !! [cases]
    integer, intent(in) :: case                       !! index of the case
    character(len=:), allocatable :: supports

    if (all(subcase%spc%id == subcase(case)%spc%id)) return
    supports = ', SPC = '//text_of(subcase(case)%spc%id)
    if (subcase(case)%spc%id == 0) supports = ' without SPC'
    one%what = 'SUBCASE '//text_of(subcase(case)%id)//supports//': '//one%what
  end subroutine name_supports
end module epcont_build_build
