!> From the cards of a deck to the scene.
module epcont_build_build
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_base_sorting, only: id_index
  use epcont_build_choices, only: build_controls
  use epcont_build_elements, only: build_elements, check_axis, element_cards
  use epcont_build_hanging_nodes, only: warn_of_hanging_nodes
  use epcont_build_line_contacts, only: build_line_contacts
  use epcont_build_lines, only: build_lines
  use epcont_build_loads, only: build_loads
  use epcont_build_lying_together, only: warn_of_lying_together
  use epcont_build_mesh, only: build_nodes, build_sections
  use epcont_build_pair_checks, only: check_pairs
  use epcont_build_pairs, only: build_pairs
  use epcont_build_reference, only: check_unique, index_of_ids
  use epcont_build_supports, only: build_references, build_supports, build_ties
  use epcont_build_twice, only: refuse_pairs_twice, warn_of_elements_twice
  use epcont_contact_geometry_free_sides, only: find_outline
  use epcont_deck_card_kinds, only: card_cgap, card_grid, card_rbe2
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics, place_type
  use epcont_deck_entry, only: least_cause
  use epcont_model_model, only: model_type
  use epcont_model_travel, only: find_travels
  implicit none
  private
  public :: build_model

contains

  !> Build the scene; whatever is wrong with it is added to `faults`, and the model serves only without errors.
  subroutine build_model(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(out) :: model
    type(diagnostics), intent(inout) :: faults
    type(id_index) :: nodes

    call build_nodes(deck, model, faults)
    nodes = index_of_ids(deck, card_grid)
    call build_sections(deck, model, faults)
    call build_elements(deck, nodes, model, faults)
    call check_unique(deck, [element_cards, card_rbe2, card_cgap], faults)
    call build_supports(deck, nodes, model, faults)
    call build_ties(deck, nodes, model, faults)
    call check_axis(deck, model, faults)
    call build_references(deck, nodes, model, faults)
    call build_loads(deck, nodes, model, faults)
    ! What iterations of a mesher leave of zero. Sides are longer by far, but what it makes of gaps would load the scene.
    where (abs(model%x) < least_cause) model%x = 0.0_wp
    call build_pairs(deck, nodes, model, faults)
    ! Lines are sides of the outlines, and only sound elements have outlines.
    if (faults%error_count() == 0) then
      call find_bodies(model)
      model%body_outline = find_outline(model)
    end if
    call build_lines(deck, nodes, model, faults)
    call build_line_contacts(deck, model, faults)
    call build_controls(deck, model, faults)
    if (model%elements == 0 .and. faults%error_count() == 0) &
      call faults%add_error(place_type(), 'the deck has no elements', 'CTRIA3 cards')
    if (faults%error_count() > 0) return
    call refuse_pairs_twice(deck, model, faults)
    call warn_of_elements_twice(deck, model, faults)
    call check_pairs(deck, model, faults)
    call find_travels(model)
    call warn_of_hanging_nodes(deck, model, faults)
    call warn_of_lying_together(deck, model, faults)
  end subroutine build_model

  !> Bodies: nodes joined by elements or RBE2.
  subroutine find_bodies(model)
    type(model_type), intent(inout) :: model
    type(partition) :: sets
    integer :: c, i

    sets = new_partition(model%nodes)
    do i = 1, model%elements
      do c = 2, model%order(i)
        call sets%join(model%connectivity(1, i), model%connectivity(c, i))
      end do
    end do
    do i = 1, model%nodes
      do c = 1, 2
        call sets%join(i, model%leader(c, i))
      end do
    end do
    call sets%numbers(model%body, model%bodies)
  end subroutine find_bodies
end module epcont_build_build
