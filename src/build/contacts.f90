!> Contact: pairs of nodes from CGAP, PGAP and CORD2R, lines of nodes from BLSEG and BCONP.
module epcont_build_contacts
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_base_tolerances, only: lost_digits
  use epcont_build_reference, only: card_index, index_of, resolve
  use epcont_deck_card_kinds, only: card_bconp, card_bfric, card_blseg, card_cgap, card_cord2r, card_pgap
  use epcont_deck_deck, only: deck_type
  use epcont_model_arrays, only: line_couple, scene_type, set_pairs
  use epcont_model_finding, only: findings, of_couple
  use epcont_model_load_cases, only: contact_all, contact_none
  implicit none
  private
  public :: read_contacts

contains

  !> Read pairs, then lines.
  subroutine read_contacts(deck, nodes, chosen, data, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    integer, intent(in) :: chosen              !! the only BCONP; contact_all or contact_none
    type(scene_type), intent(inout) :: data    !! gets pairs, lines and couples
    type(findings), intent(inout) :: found     !! errors are added
    !> x-axes in the plane of the systems: the basic one, number 0, and those of CORD2R
    real(wp) :: axis(2, 0:deck%card(card_cord2r)%count)
    logical :: has_friction   ! PARAM FRICTION
    integer :: i, k

    has_friction = deck%parameter_word('FRICTION') /= 'NO'
    axis = spread([1.0_wp, 0.0_wp], 2, size(axis, 2))
    do i = 1, deck%card(card_cord2r)%count
      if (deck%card(card_cord2r)%sound(i)) call read_system()
    end do
    call read_pairs()
    deallocate (data%line, data%couple)
    allocate (data%line(deck%card(card_blseg)%count), data%couple(deck%card(card_bconp)%count))
    data%line%id = nint(deck%card(card_blseg)%value(1, :))
    data%couple%id = nint(deck%card(card_bconp)%value(1, :))
    do k = 1, 2
      call resolve(deck, card_bconp, 1 + k, index_of(deck, card_blseg), found, data%couple%line(k))
    end do
    if (has_friction) call read_friction(deck, data%couple, found)
    do i = 1, size(data%line)
      data%line(i)%is_named = any(data%couple%line(1) == i .or. data%couple%line(2) == i)
      call read_line()
    end do
    data%contact_is_off = chosen /= contact_all
    if (chosen == contact_all) return
    do k = 1, 3
      call found%add_origin([of_couple, 1, k], [card_bconp, findloc(data%couple%id, chosen, dim=1), k])
    end do
    data%couple = pack(data%couple, data%couple%id == chosen)

  contains

    !> Read the x-axis of a CORD2R. If the card is wrong, the axis of the basic system stays.
    subroutine read_system()
      real(wp) :: point(3, 3), x(3), z(3), to_c(3)
      integer :: a

      a = deck%card(card_cord2r)%column('A1')
      point = reshape(deck%card(card_cord2r)%value(a:a + 8, i), [3, 3])
      z = point(:, 2) - point(:, 1)
      to_c = point(:, 3) - point(:, 1)
      x = 0.0_wp
      if (norm2(z) > 0.0_wp) x = to_c - z*(dot_product(z, to_c)/dot_product(z, z))
      if (norm2(x) <= lost_digits*norm2(to_c)) then
        call found%add_error(card_cord2r, i, 1, ': points A, B and C lie on one line: no x-axis', &
                             'give three points that span a plane')
      else if (abs(x(3)) > lost_digits*norm2(x)) then
        call found%add_error(card_cord2r, i, 1, ': its x-axis points off the x-y plane', &
                             'put point C in the plane, and B - A along z')
      else
        axis(:, i) = x(:2)/norm2(x(:2))
      end if
    end subroutine read_system

    !> Read CGAP. A pair whose system was not found has an arbitrary normal; one without a system has a zero
    !! normal until its nodes define it.
    subroutine read_pairs()
      integer, dimension(deck%card(card_cgap)%count) :: property, system
      integer :: i, k, node(2, size(system))
      real(wp) :: friction(size(system)), gap(size(system)), normal(2, size(system))

      friction = 0.0_wp
      gap = 0.0_wp
      normal = 0.0_wp
      associate (cgap => deck%card(card_cgap))
        call resolve(deck, card_cgap, 2, index_of(deck, card_pgap), found, property)
        do k = 1, 2
          call resolve(deck, card_cgap, 2 + k, nodes, found, node(k, :))
        end do
        call resolve(deck, card_cgap, cgap%column('CID'), index_of(deck, card_cord2r), found, system)
        do i = 1, cgap%count
          if (property(i) > 0) then
            gap(i) = deck%card(card_pgap)%number('U0', property(i))
            if (has_friction) friction(i) = deck%card(card_pgap)%number('MU1', property(i))
          end if
          if (cgap%has('CID', i)) normal(:, i) = axis(:, system(i))
        end do
        associate (pairs => merge(0, cgap%count, chosen == contact_none))
          call set_pairs(data, node(:, :pairs), normal(:, :pairs), gap(:pairs))
          data%friction = friction(:pairs)
        end associate
      end associate
      data%gap_by_geometry = deck%parameter_word('GAPGEOM') == 'YES'
    end subroutine read_pairs

    !> Expand the nodes of a BLSEG, with ranges and steps; not allocated if the card is wrong.
    subroutine read_line()
      integer :: id, k
      logical :: sound

      associate (blseg => deck%card(card_blseg), first => deck%card(card_blseg)%list_start(i), &
                 last => deck%card(card_blseg)%list_start(i + 1) - 1)
        sound = blseg%sound(i)
        do k = first, last
          do id = blseg%list(k)%from, blseg%list(k)%to, blseg%list(k)%step
            if (nodes%find(id) > 0) cycle
            if (nodes%whole) &
              call found%add_error(card_blseg, i, -k, ': there is no GRID '//text_of(id), &
                                   'give the id of a GRID')
            sound = .false.
            exit   ! the first node of a range
          end do
        end do
        data%line(i)%node = [integer ::]
        if (sound) data%line(i)%node = [((nodes%find(id), id=blseg%list(k)%from, blseg%list(k)%to, &
            blseg%list(k)%step), k=first, last)]
      end associate
    end subroutine read_line
  end subroutine read_contacts

  !> Read the friction of BCONP. Pairs stick and slip with the same coefficient; PGAP is checked for it.
  subroutine read_friction(deck, couple, found)
    type(deck_type), intent(in) :: deck
    type(line_couple), intent(inout) :: couple(:)
    type(findings), intent(inout) :: found
    integer :: bfric(size(couple)), i

    associate (pgap => deck%card(card_pgap))
      do i = 1, pgap%count
        if (.not. pgap%has('MU2', i)) cycle
        if (abs(pgap%number('MU2', i) - pgap%number('MU1', i)) <= 0.0_wp) cycle
        call found%add_error(card_pgap, i, pgap%column('MU2'), &
          ': '//pgap%entry%field_text(pgap%column('MU2'))//' differs from MU1', &
          'leave MU2 blank: pairs stick and slip with the same coefficient')
      end do
    end associate
    associate (bconp => deck%card(card_bconp))
      call resolve(deck, card_bconp, bconp%column('FRICID'), index_of(deck, card_bfric), found, bfric)
    end associate
    do i = 1, size(bfric)
      if (bfric(i) > 0) couple(i)%friction = deck%card(card_bfric)%number('MU1', bfric(i))
    end do
  end subroutine read_friction
end module epcont_build_contacts
