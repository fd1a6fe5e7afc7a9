!> Loads of a scene from FORCE and PLOADX1.
module epcont_build_loads
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: new_id_index
  use epcont_base_text, only: short_real
  use epcont_build_reference, only: card_index, chosen_set, resolve
  use epcont_deck_card_kinds, only: card_force, card_ploadx1
  use epcont_deck_deck, only: deck_type
  use epcont_deck_entry, only: farthest, least_cause
  use epcont_model_arrays, only: side_pressure
  use epcont_model_finding, only: and_more, findings, of_element
  use epcont_model_model, only: model_type
  use epcont_model_pressure, only: add_pressure
  implicit none
  private
  public :: build_loads

contains

  !> The loads of the chosen set, summed at the nodes.
  subroutine build_loads(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found     !! what is wrong with it is added
    integer :: load_set

    call chosen_set(deck, [card_force, card_ploadx1], deck%load, 'LOAD', found, load_set)
    call add_forces()
    if (deck%card(card_ploadx1)%count > 0) call add_pressures()

  contains

    !> FORCE.
    subroutine add_forces()
      integer :: i, node(deck%card(card_force)%count)
      real(wp) :: direction(2), factor, largest

      call resolve(deck, card_force, 2, nodes, found, node)
      associate (force => deck%card(card_force))
        do i = 1, force%count
          if (node(i) == 0 .or. nint(force%value(1, i)) /= load_set) cycle
          factor = force%number('F', i)
          direction = [force%number('N1', i), force%number('N2', i)]
          largest = maxval(abs(direction))
          if (force%number('N3', i) /= 0.0_wp) &
            call found%add_error(card_force, i, force%column('N3'), ': field 8 (N3) points off the plane', &
                                 '0.0: scenes lie in the x-y plane')
          ! Not zero, but of a size that no field may give it.
          if (factor /= 0.0_wp .and. largest > 0.0_wp .and. &
              (abs(factor)*largest < least_cause .or. abs(factor)*largest > farthest)) &
            call found%add_error(card_force, i, force%column('F'), &
                                 ': field 5 (F) times the vector of N1 and N2 is too far from 1.0', &
                                 'other units: forces from '//short_real(least_cause)//' to '// &
                                 short_real(farthest)//', or 0.0')
          ! What rounding has left of a right angle, such as the cosine of 90 degrees, is no direction.
          where (abs(direction) < epsilon(1.0_wp)*largest) direction = 0.0_wp
          model%load(:, node(i)) = model%load(:, node(i)) + factor*direction
        end do
      end associate
    end subroutine add_forces

    !> PLOADX1; one warning for all that press inside a body.
    subroutine add_pressures()
      integer, dimension(deck%card(card_ploadx1)%count) :: a, b, behind, element
      type(card_index) :: elements
      integer :: ga, i

      elements = card_index(new_id_index(model%element_id), 'element', found%errors == 0)
      behind = 0
      associate (pressure => deck%card(card_ploadx1))
        ga = pressure%column('GA')
        call resolve(deck, card_ploadx1, 2, elements, found, element)
        call resolve(deck, card_ploadx1, ga, nodes, found, a)
        call resolve(deck, card_ploadx1, ga + 1, nodes, found, b)
        do i = 1, pressure%count
          if (element(i) == 0 .or. a(i) == 0 .or. b(i) == 0 .or. nint(pressure%value(1, i)) /= load_set) cycle
          if (any(model%connectivity(:model%node_count(element(i)), element(i)) == 0)) cycle
          call add_pressure(model, side_pressure(element(i), [a(i), b(i)], pressure%value(3:4, i), &
              pressure%number('THETA', i)), behind(i))
          if (behind(i) < 0) &
            call found%add_error(card_ploadx1, i, ga, ': GA and GB are not the ends of a side of '// &
                                 model%name_of(of_element, element(i)), &
                                 'two neighbouring corners of the element')
        end do
      end associate
      if (all(behind <= 0)) return
      i = findloc(behind > 0, .true., dim=1)
      call found%add_warning(card_ploadx1, i, ga, ': presses inside a body, between '// &
                             model%name_of(of_element, element(i))//' and '// &
                             model%name_of(of_element, behind(i))// &
                             and_more(count(behind > 0), '; so do ', ' more'), &
                             'a side that one element alone has')
    end subroutine add_pressures
  end subroutine build_loads
end module epcont_build_loads
