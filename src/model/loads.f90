!> Nodal loads from FORCE and PLOADX1.
module epcont_model_loads
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index
  use epcont_base_text, only: text_of
  use epcont_deck_deck, only: card_ctria3, card_force, card_ploadx1, deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_model_model, only: model_type
  use epcont_model_reference, only: index_of_ids, resolve
  use epcont_model_sets, only: chosen_set
  implicit none
  private
  public :: build_loads

contains

  !> Sum the loads of the chosen set at the nodes.
  subroutine build_loads(deck, nodes, model, faults)
    type(deck_type), intent(in) :: deck
    type(id_index), intent(in) :: nodes
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    type(id_index) :: elements
    integer :: element, i, k, node(2), set

    allocate (model%load(2, model%nodes), source=0.0_wp)
    call chosen_set(deck, [card_force, card_ploadx1], deck%load, deck%load_place, 'LOAD', faults, set)
    associate (force => deck%card(card_force), pressure => deck%card(card_ploadx1))
      do i = 1, force%count
        call resolve(deck, card_force, i, 2, nodes, 'GRID', faults, node(1))
        if (node(1) == 0 .or. nint(force%value(1, i)) /= set) cycle
        k = force%column('N1')
        if (force%value(k + 2, i) /= 0.0_wp) &
          call faults%add_error(deck%place(card_force, i, k + 2), deck%identity(card_force, i)// &
                                ': field 8 (N3) points off the plane', '0.0: scenes lie in the x-y plane')
        model%load(:, node(1)) = model%load(:, node(1)) + force%value(k - 1, i)*force%value(k:k + 1, i)
      end do
      if (pressure%count > 0) elements = index_of_ids(deck, card_ctria3)
      do i = 1, pressure%count
        call resolve(deck, card_ploadx1, i, 2, elements, 'CTRIA3', faults, element)
        do k = 1, 2
          call resolve(deck, card_ploadx1, i, pressure%column('GA') + k - 1, nodes, 'GRID', faults, node(k))
        end do
        if (element == 0 .or. any(node == 0) .or. nint(pressure%value(1, i)) /= set) cycle
        if (any(model%corner(:, element) == 0)) cycle  ! said of the element
        if (node(1) == node(2) .or. count(model%corner(:, element) == node(1)) + &
            count(model%corner(:, element) == node(2)) /= 2) then
          call faults%add_error(deck%place(card_ploadx1, i, pressure%column('GA')), deck%identity(card_ploadx1, i)// &
                                ': GA and GB are not two corners of CTRIA3 '//text_of(model%element_id(element)), &
                                'two corners of the element')
        else if (model%section(element) > 0) then
          call add_pressure(pressure%value(3:4, i), pressure%value(pressure%column('THETA'), i), element, node, model)
        end if
      end do
    end associate
  end subroutine build_loads

  !> Nodal forces of a pressure that varies linearly along an edge: positive into the element, turned
  !! counter-clockwise by theta.
  subroutine add_pressure(pressure, theta, element, node, model)
    real(wp), intent(in) :: pressure(2)    !! at the two nodes [stress]
    real(wp), intent(in) :: theta          !! [degree]
    integer, intent(in) :: element, node(2)
    type(model_type), intent(inout) :: model
    real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
    real(wp) :: edge(2), inward(2), direction(2), to_third(2), force(2)
    integer :: third, k

    third = sum(model%corner(:, element)) - sum(node)
    edge = model%x(:, node(2)) - model%x(:, node(1))
    to_third = model%x(:, third) - model%x(:, node(1))
    inward = [-edge(2), edge(1)]            ! as long as the edge
    if (dot_product(inward, to_third) < 0.0_wp) inward = -inward
    direction = inward
    if (theta /= 0.0_wp) direction = [cos(theta*degree)*inward(1) - sin(theta*degree)*inward(2), &
                                      sin(theta*degree)*inward(1) + cos(theta*degree)*inward(2)]
    force = [2.0_wp*pressure(1) + pressure(2), pressure(1) + 2.0_wp*pressure(2)]/6.0_wp
    do k = 1, 2
      model%load(:, node(k)) = model%load(:, node(k)) + &
                               force(k)*model%thickness(model%section(element))*direction
    end do
  end subroutine add_pressure
end module epcont_model_loads
