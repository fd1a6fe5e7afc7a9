!> Supports, ties, reference freedoms and loads from GRID PS, SPC, SPC1, RBE2, SUPORT, FORCE and PLOADX1.
module epcont_build_conditions
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: new_id_index
  use epcont_base_text, only: short_real, text_of
  use epcont_build_reference, only: card_index, chosen_set, resolve
  use epcont_deck_card_kinds, only: card_force, card_grid, card_ploadx1, card_rbe2, card_spc, card_spc1, &
      card_suport
  use epcont_deck_deck, only: deck_type
  use epcont_deck_entry, only: farthest, least_cause
  use epcont_model_arrays, only: side_pressure
  use epcont_model_finding, only: and_more, findings, of_element
  use epcont_model_freedoms, only: follow_to_the_end, freedom, set_reference, tie
  use epcont_model_model, only: model_type
  use epcont_model_pressure, only: add_pressure
  implicit none
  private
  public :: build_conditions

contains

  !> Supports of the chosen set; then ties, of which chains are followed to their end; then the reference
  !! freedoms, which must be free of both; and the loads of the chosen set, summed at the nodes.
  subroutine build_conditions(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found     !! what is wrong with it is added
    integer :: i, leader(deck%card(card_rbe2)%count), load_set, ps, support_set

    call chosen_set(deck, [card_spc, card_spc1], deck%spc, 'SPC', found, support_set)
    associate (grid => deck%card(card_grid))
      ps = grid%column('PS')
      do i = 1, grid%count
        if (grid%given(ps, i)) call take([card_grid, i, ps], i, ps)
      end do
    end associate
    call read_fields(card_spc, [2, 5])
    call read_lists(card_spc1)
    call resolve(deck, card_rbe2, 2, nodes, found, leader)
    call read_lists(card_rbe2)
    call follow_to_the_end(model%leader)
    call read_fields(card_suport, [1, 3, 5, 7])
    call chosen_set(deck, [card_force, card_ploadx1], deck%load, 'LOAD', found, load_set)
    call add_forces()
    if (deck%card(card_ploadx1)%count > 0) call add_pressures()

  contains

    !> SPC and SUPORT: nodes, each with its directions in the next field.
    subroutine read_fields(card, columns)
      integer, intent(in) :: card, columns(:)   !! which table, the fields of its nodes
      integer :: i, k, node(deck%card(card)%count)

      do k = 1, size(columns)
        call resolve(deck, card, columns(k), nodes, found, node)
        do i = 1, size(node)
          if (node(i) > 0) call take([card, i, columns(k)], node(i), columns(k) + 1)
        end do
      end do
    end subroutine read_fields

    !> SPC1 and RBE2: directions, then a list of nodes. Of a range some may be missing.
    subroutine read_lists(card)
      integer, intent(in) :: card   !! which table
      character(len=:), allocatable :: ids
      integer :: i, item, k
      integer, allocatable :: node(:)

      associate (table => deck%card(card))
        do i = 1, table%count
          do item = table%list_start(i), table%list_start(i + 1) - 1
            associate (from => table%list(item)%from, to => table%list(item)%to)
              node = nodes%within(from, to)
              if (size(node) == 0 .and. nodes%whole) then
                ids = text_of(from)
                if (to > from) ids = ids//' to '//text_of(to)
                call found%add_error(card, i, -item, ': there is no GRID '//ids, 'the id of a GRID')
              end if
            end associate
            do k = 1, size(node)
              call take([card, i, -item], node(k), table%entry%list_slot - 1)
            end do
          end do
        end do
      end associate
    end subroutine read_lists

    !> What a card says of the freedoms of a node. Of those that are held at another displacement already one
    !! is told.
    subroutine take(card, node, digits)
      integer, intent(in) :: card(3)        !! table, card, field or item of its list that names the node
      integer, intent(in) :: node, digits   !! and the field that names the freedoms
      integer :: c, conflict
      real(wp) :: displacement

      conflict = 0
      displacement = 0.0_wp
      associate (value => deck%card(card(1))%value(:, card(2)))
        if (any(card(1) == [card_spc, card_spc1]) .and. nint(value(1)) /= support_set) return
        if (card(1) == card_spc) displacement = value(digits + 1)
        do c = 1, 2
          if (all(mod(nint(value(digits))/10**[0, 1, 2, 3, 4, 5], 10) /= c)) cycle
          select case (card(1))
          case (card_rbe2)
            if (leader(card(2)) > 0) call tie(model, c, node, leader(card(2)), card, found)
          case (card_suport)
            call set_reference(model, c, node, card, found)
          case default
            if (model%held(c, node) .and. model%prescribed(c, node) /= displacement) conflict = c
            model%held(c, node) = .true.
            model%prescribed(c, node) = displacement
          end select
        end do
      end associate
      if (conflict > 0) &
        call found%add_error(card(1), card(2), card(3), ': '//freedom(model, conflict, node)// &
                             ' is held at another displacement already', 'one displacement for each freedom')
    end subroutine take

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
  end subroutine build_conditions
end module epcont_build_conditions
