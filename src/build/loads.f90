!> Nodal loads from FORCE and PLOADX1.
module epcont_build_loads
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index, new_id_index
  use epcont_base_text, only: short_real, text_of
  use epcont_build_elements, only: element_name
  use epcont_build_reference, only: resolve
  use epcont_build_sets, only: chosen_set
  use epcont_deck_card_kinds, only: card_force, card_ploadx1
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_entry, only: farthest, least_cause
  use epcont_geometry_edge, only: edge_point, edge_point_count, edge_points
  use epcont_geometry_plane, only: turned
  use epcont_model_model, only: model_type
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
    character(len=:), allocatable :: which
    integer :: element, first_inside, i, inside, k, node(2), other, set, side

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
        if (out_of_reach(force%value(k - 1, i), force%value(k:k + 1, i))) &
          call faults%add_error(deck%place(card_force, i, k - 1), deck%identity(card_force, i)// &
                                ': field 5 (F) times the vector of N1 and N2 is too far from 1.0', &
                                'other units: forces from '//short_real(least_cause)//' to '//short_real(farthest)//', or 0.0')
        model%load(:, node(1)) = model%load(:, node(1)) + force%value(k - 1, i)*along_axes(force%value(k:k + 1, i))
      end do
      if (pressure%count > 0) elements = new_id_index(model%element_id)
      inside = 0
      do i = 1, pressure%count
        call resolve(deck, card_ploadx1, i, 2, elements, 'element', faults, element)
        do k = 1, 2
          call resolve(deck, card_ploadx1, i, pressure%column('GA') + k - 1, nodes, 'GRID', faults, node(k))
        end do
        if (element == 0 .or. any(node == 0) .or. nint(pressure%value(1, i)) /= set) cycle
        if (any(model%connectivity(:model%order(element), element) == 0)) cycle  ! said of the element
        side = side_between(model, element, node)
        if (side == 0) then
          call faults%add_error(deck%place(card_ploadx1, i, pressure%column('GA')), deck%identity(card_ploadx1, i)// &
                                ': GA and GB are not the ends of a side of '//element_name(model, element), &
                                'two neighbouring corners of the element')
        else if (model%section(element) > 0) then
          call add_pressure(pressure%value(3:4, i), pressure%value(pressure%column('THETA'), i), element, side, node(1), model)
          other = behind(model, model%edge(element, side))
          if (other == 0) cycle
          inside = inside + 1
          if (inside > 1) cycle
          first_inside = i
          which = element_name(model, element)//' and '//element_name(model, other)
        end if
      end do
      if (inside == 0) return
      if (inside > 1) which = which//'; so do '//text_of(inside - 1)//' more'
      call faults%add_warning(deck%place(card_ploadx1, first_inside, pressure%column('GA')), &
                              deck%identity(card_ploadx1, first_inside)//': presses inside a body, between '//which, &
                              'a side that one element alone has')
    end associate
  end subroutine build_loads

  !> The element on the other side of an element's side; 0: it is of the boundary.
  pure integer function behind(model, ends) result(element)
    type(model_type), intent(in) :: model
    integer, intent(in) :: ends(3)   !! of the side, the element to the left
    integer :: i, side, there(3)

    do i = model%around%start(ends(1)), model%around%start(ends(1) + 1) - 1
      element = model%around%group(i)
      do side = 1, model%corners(element)
        there = model%edge(element, side)
        if (all(there(:2) == ends([2, 1]))) return
      end do
    end do
    element = 0
  end function behind

  !> Is a force not zero, but of a size that no field may give it?
  pure logical function out_of_reach(factor, direction)
    real(wp), intent(in) :: factor          !! [force]
    real(wp), intent(in) :: direction(2)
    real(wp) :: largest

    largest = abs(factor)*maxval(abs(direction))
    out_of_reach = factor /= 0.0_wp .and. any(direction /= 0.0_wp) .and. (largest < least_cause .or. largest > farthest)
  end function out_of_reach

  !> The side of an element that ends at two nodes; 0 where there is none.
  pure integer function side_between(model, element, node) result(side)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element, node(2)
    integer :: ends(3)

    do side = 1, model%corners(element)
      ends = model%edge(element, side)
      if (all(ends(:2) == node) .or. all(ends(:2) == node([2, 1]))) return
    end do
    side = 0
  end function side_between

  !> A direction without what rounding has left of a right angle, such as the cosine of 90 degrees.
  pure function along_axes(direction)
    real(wp), intent(in) :: direction(2)
    real(wp) :: along_axes(2)

    along_axes = merge(0.0_wp, direction, abs(direction) < epsilon(1.0_wp)*maxval(abs(direction)))
  end function along_axes

  !> Nodal forces of a pressure that varies linearly along a side, from one node to the other: positive into the
  !! element, turned counter-clockwise by theta.
  subroutine add_pressure(pressure, theta, element, side, from, model)
    real(wp), intent(in) :: pressure(2)    !! at the two nodes [stress]
    real(wp), intent(in) :: theta          !! [degree]
    integer, intent(in) :: element, side
    integer, intent(in) :: from            !! the node of the first pressure
    type(model_type), intent(inout) :: model
    type(edge_point) :: point(edge_point_count)
    real(wp) :: depth, direction(2), at_ends(2), value
    integer :: ends(3), k, p

    ends = model%edge(element, side)
    at_ends = merge(pressure, pressure([2, 1]), ends(1) == from)
    point = edge_points(model%edge_coordinates(ends))
    do p = 1, edge_point_count
      direction = turned([-point(p)%tangent(2), point(p)%tangent(1)], theta)   ! from inward: the element lies to the left
      depth = model%depth(element, point(p)%x(1))
      value = at_ends(1) + (at_ends(2) - at_ends(1))*point(p)%along
      do k = 1, size(ends)
        if (ends(k) > 0) model%load(:, ends(k)) = model%load(:, ends(k)) + value*depth*point(p)%values(k)*direction
      end do
    end do
  end subroutine add_pressure
end module epcont_build_loads
