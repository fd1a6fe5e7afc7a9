!> From the cards of a deck to the scene, and what is found of it to messages with their places in the deck.
module epcont_build_build
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_base_text, only: text_of
  use epcont_build_choices, only: check_once, read_controls
  use epcont_build_contacts, only: build_lines, build_pairs
  use epcont_build_loads, only: build_loads
  use epcont_build_mesh, only: build_elements, build_nodes, build_sections, element_cards
  use epcont_build_reference, only: card_index, check_unique, index_of
  use epcont_build_supports, only: build_references, build_supports, build_ties
  use epcont_contact_geometry_complete, only: check_controls, finish_model
  use epcont_contact_geometry_line_contacts, only: find_contacts
  use epcont_deck_card_kinds, only: card_bconp, card_blseg, card_cgap, card_grid, card_param, card_rbe2, &
                                    card_spc, card_spc1
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics, place_type
  use epcont_deck_entry, only: least_cause
  use epcont_model_element_shapes, only: check_axis
  use epcont_model_finding, only: finding, findings, found_error, found_warning, of_body, of_couple, of_element, &
                                  of_line, of_node, of_pair, of_paper_ratio, of_scene
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_model, tell

contains

  !> Build the scene; whatever is wrong with it is added to `faults`, and the model serves only without
  !! errors.
  subroutine build_model(deck, model, faults)
    type(deck_type), intent(in) :: deck   !! its cards
    type(model_type), intent(out) :: model   !! the scene
    type(diagnostics), intent(inout) :: faults   !! of the deck; they are added to
    type(findings) :: found

    found%errors = faults%error_count()
    call read_cards(deck, model, found)
    if (model%elements == 0 .and. found%errors == 0) &
      call found%add_error(of_scene, 0, 0, 'the deck has no elements', 'CTRIA3 cards')
    if (found%errors == 0) call finish_model(model, found)
    call tell(deck, found, faults)
  end subroutine build_model

  !> The scene but for what is looked at as a whole.
  subroutine read_cards(deck, model, found)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(inout) :: model
    type(findings), intent(inout) :: found
    type(card_index) :: nodes

    call build_nodes(deck, model, found)
    model%controls = read_controls(deck)
    nodes = index_of(deck, card_grid)
    call build_sections(deck, model, found)
    call build_elements(deck, nodes, model, found)
    call check_unique(deck, [element_cards(deck), card_rbe2, card_cgap], found)
    call build_supports(deck, nodes, model, found)
    call build_ties(deck, nodes, model, found)
    call check_axis(model, found)
    call build_references(deck, nodes, model, found)
    call build_loads(deck, nodes, model, found)
    ! What iterations of a mesher leave of zero. Sides are longer by far, but what it makes of gaps would load
    ! the scene.
    where (abs(model%x) < least_cause) model%x = 0.0_wp
    call build_pairs(deck, nodes, model, found)
    call build_lines(deck, nodes, model, found)
    call find_contacts(model, found)
    call check_once(deck, found)
    call check_controls(model, found)
  end subroutine read_cards

  !> What was found as messages: with the cards, and where these stand.
  subroutine tell(deck, found, faults)
    type(deck_type), intent(in) :: deck          !! its cards
    type(findings), intent(in) :: found          !! of the scene that they make
    type(diagnostics), intent(inout) :: faults   !! of the deck; they are added to
    integer :: i

    do i = 1, found%count
      call tell_one(deck, found%list(i), faults)
    end do
  end subroutine tell

  subroutine tell_one(deck, found, faults)
    type(deck_type), intent(in) :: deck
    type(finding), intent(in) :: found
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: remedy, what
    integer :: card(3)
    type(place_type) :: place

    what = found%what
    remedy = found%remedy
    if (allocated(found%node)) remedy = remedy//': '// &
                                        holding_cards(deck, nint(deck%card(card_grid)%value(1, found%node)))
    card = card_of(deck, found)
    if (found%of /= of_scene) then
      place = place_of(deck, card)
      if (found%of /= of_body) what = deck%identity(card(1), card(2))//what
    else if (found%which > 0) then
      place = deck%load_place
      if (found%which == card_spc) place = deck%spc_place
    end if
    select case (found%severity)
    case (found_error)
      call faults%add_error(place, what, remedy)
    case (found_warning)
      call faults%add_warning(place, what, remedy)
    case default
      call faults%add_note(place, what)
    end select
  end subroutine tell_one

  !> The table, the card and the column, or the negative item of a list, that a finding is about.
  pure function card_of(deck, found) result(card)
    type(deck_type), intent(in) :: deck
    type(finding), intent(in) :: found
    integer :: card(3)
    integer, allocatable :: cards(:)
    integer :: c

    card = [found%of, found%which, found%item]
    select case (found%of)
    case (of_node, of_body)
      card(1) = card_grid
    case (of_element)
      cards = element_cards(deck)
      do c = 1, size(cards)
        card(1) = cards(c)
        if (card(2) <= deck%card(card(1))%count) exit
        card(2) = card(2) - deck%card(card(1))%count
      end do
    case (of_pair)
      card(1) = card_cgap
    case (of_line)
      card(1) = card_blseg
      if (card(3) < 0) card(3) = -list_item(deck, card(2), -card(3))
    case (of_couple)
      card(1) = card_bconp
    case (of_paper_ratio)
      card(:2) = [card_param, deck%parameter_row('MUP')]
    end select
  end function card_of

  !> The item of a BLSEG's list that names the k-th node of the line.
  pure integer function list_item(deck, line, k) result(item)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: line, k
    integer :: before

    before = 0
    associate (blseg => deck%card(card_blseg))
      do item = blseg%list_start(line), blseg%list_start(line + 1) - 1
        associate (ids => blseg%list(item))
          before = before + (ids%to - ids%from)/ids%step + 1
        end associate
        if (before >= k) return
      end do
    end associate
  end function list_item

  function place_of(deck, card) result(place)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card(3)
    type(place_type) :: place

    if (card(3) < 0) then
      place = deck%list_place(card(1), -card(3))
    else
      place = deck%place(card(1), card(2), card(3))
    end if
  end function place_of

  !> The SPC1 cards, in free field, that hold some nodes in direction 1.
  pure function holding_cards(deck, ids) result(text)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: ids(:)
    character(len=:), allocatable :: text, item
    integer, parameter :: most_fields = 6   ! of a line with SPC1, its set and directions
    integer, allocatable :: id(:)
    integer :: fields, from, set, to

    set = deck%spc
    if (set == 0 .and. deck%card(card_spc1)%count > 0) set = nint(deck%card(card_spc1)%value(1, 1))
    if (set == 0 .and. deck%card(card_spc)%count > 0) set = nint(deck%card(card_spc)%value(1, 1))
    id = ids(sorted_order(ids))
    text = ''
    fields = most_fields
    from = 1
    do while (from <= size(id))
      to = from
      do while (to < size(id))
        if (id(to + 1) /= id(to) + 1) exit
        to = to + 1
      end do
      item = ','//text_of(id(from))
      if (to > from + 1) item = item//',THRU,'//text_of(id(to))
      fields = fields + merge(3, 1, to > from + 1)
      if (fields > most_fields) then
        if (len(text) > 0) text = text//' and '
        text = text//'SPC1,'//text_of(max(set, 1))//',1'
        fields = merge(3, 1, to > from + 1)
      end if
      text = text//item
      from = merge(to + 1, from + 1, to > from + 1)
    end do
  end function holding_cards
end module epcont_build_build
