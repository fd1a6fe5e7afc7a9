!> What may touch: pairs of nodes from CGAP, PGAP and CORD2R, lines of nodes from BLSEG and BCONP.
module epcont_build_contacts
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_base_tolerances, only: lost_digits
  use epcont_build_reference, only: card_index, check_unique, index_of, resolve
  use epcont_deck_card_kinds, only: card_bconp, card_blseg, card_cgap, card_cord2r, card_pgap
  use epcont_deck_deck, only: deck_type
  use epcont_model_finding, only: findings
  use epcont_model_given, only: set_pairs
  use epcont_model_model, only: model_type
  use epcont_model_single_pairs, only: complete_pairs
  implicit none
  private
  public :: build_pairs, build_lines

  integer, parameter :: first_room = 16   !! nodes that a line holds before its array first grows

contains

  !> CGAP. A pair whose system cannot be found has any normal, and one without a system none, until its nodes
  !! give it.
  pure subroutine build_pairs(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck   !! its cards
    type(card_index), intent(in) :: nodes   !! ids of GRID
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer, dimension(deck%card(card_cgap)%count) :: property, system
    integer :: node(2, size(system))
    real(wp) :: gap(size(system)), normal(2, size(system))
    real(wp), allocatable :: axis(:, :)
    integer :: i, k

    call check_unique(deck, [card_pgap], found)
    call check_unique(deck, [card_cord2r], found)
    call read_systems(deck, axis, found)
    gap = 0.0_wp
    normal = 0.0_wp
    associate (cgap => deck%card(card_cgap), pgap => deck%card(card_pgap))
      call resolve(deck, card_cgap, 2, index_of(deck, card_pgap), found, property)
      do k = 1, 2
        call resolve(deck, card_cgap, 2 + k, nodes, found, node(k, :))
      end do
      k = cgap%column('CID')
      call resolve(deck, card_cgap, k, index_of(deck, card_cord2r), found, system)
      do i = 1, cgap%count
        if (property(i) > 0) gap(i) = pgap%value(pgap%column('U0'), property(i))
        if (cgap%given(k, i)) normal(:, i) = axis(:, system(i))
      end do
      call set_pairs(model, node, normal, gap)
      model%pair_id = nint(cgap%value(1, :))
    end associate
    call complete_pairs(model, deck%parameter_word('GAPGEOM', 'NO') == 'YES', found)
  end subroutine build_pairs

  !> x-axes in the plane of the systems: the basic one, number 0, and those of CORD2R.
  pure subroutine read_systems(deck, axis, found)
    type(deck_type), intent(in) :: deck
    real(wp), allocatable, intent(out) :: axis(:, :)   !! of a bad one that of the basic system [2, 0:systems]
    type(findings), intent(inout) :: found
    real(wp) :: x(3), z(3), to_c(3)
    integer :: a, i

    associate (card => deck%card(card_cord2r))
      allocate (axis(2, 0:card%count))
      axis(1, :) = 1.0_wp
      axis(2, :) = 0.0_wp
      a = card%column('A1')
      do i = 1, card%count
        if (.not. card%sound(i)) cycle
        z = card%value(a + 3:a + 5, i) - card%value(a:a + 2, i)
        to_c = card%value(a + 6:a + 8, i) - card%value(a:a + 2, i)
        x = 0.0_wp
        if (norm2(z) > 0.0_wp) x = to_c - z*(dot_product(z, to_c)/dot_product(z, z))
        if (norm2(x) <= lost_digits*norm2(to_c)) then
          call found%add_error(card_cord2r, i, 1, ': points A, B and C lie on one line: no x-axis', &
                               'three points that span a plane')
        else if (abs(x(3)) > lost_digits*norm2(x)) then
          call found%add_error(card_cord2r, i, 1, ': its x-axis points off the x-y plane', &
                               'point C in the plane, B - A along z')
        else
          axis(:, i) = x(:2)/norm2(x(:2))
        end if
      end do
    end associate
  end subroutine read_systems

  !> BLSEG, ranges and steps written out, and BCONP.
  pure subroutine build_lines(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck   !! its cards
    type(card_index), intent(in) :: nodes   !! ids of GRID
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: i, k

    call check_unique(deck, [card_blseg], found)
    call check_unique(deck, [card_bconp], found)
    associate (blseg => deck%card(card_blseg), bconp => deck%card(card_bconp))
      deallocate (model%line, model%couple)
      allocate (model%line(blseg%count), model%couple(bconp%count))
      model%line%id = nint(blseg%value(1, :))
      model%couple%id = nint(bconp%value(1, :))
      do i = 1, blseg%count
        call read_line(deck, i, nodes, model%line(i)%node, found)
      end do
      do k = 1, 2
        call resolve(deck, card_bconp, 1 + k, index_of(deck, card_blseg), found, model%couple%line(k))
      end do
    end associate
  end subroutine build_lines

  !> The nodes of a line; none where it is not sound.
  pure subroutine read_line(deck, i, nodes, node, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i                         !! which BLSEG
    type(card_index), intent(in) :: nodes
    integer, allocatable, intent(out) :: node(:)
    type(findings), intent(inout) :: found
    integer :: found_so_far, id, k
    logical :: sound

    allocate (node(first_room))
    found_so_far = 0
    associate (blseg => deck%card(card_blseg), n => found_so_far)
      sound = blseg%sound(i)
      do k = blseg%list_start(i), blseg%list_start(i + 1) - 1
        do id = blseg%list(k)%from, blseg%list(k)%to, blseg%list(k)%step
          if (n == size(node)) node = [node, node]   ! room for twice as many
          n = n + 1
          node(n) = nodes%find(id)
          if (node(n) > 0) cycle
          call found%add_error(card_blseg, i, -k, ': there is no GRID '//text_of(id), 'the id of a GRID')
          sound = .false.
          exit   ! of a range the first one
        end do
      end do
      node = node(:merge(n, 0, sound))
    end associate
  end subroutine read_line
end module epcont_build_contacts
