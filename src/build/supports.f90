!> Supports, ties and reference freedoms from GRID PS, SPC, SPC1, RBE2 and SUPORT.
module epcont_build_supports
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_build_reference, only: card_index, resolve
  use epcont_deck_card_kinds, only: card_grid, card_rbe2, card_spc, card_spc1, card_suport
  use epcont_deck_deck, only: deck_type
  use epcont_model_finding, only: findings
  use epcont_model_freedoms, only: follow_to_the_end, freedom, set_reference, tie
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_supports

contains

  !> Supports of a set; then ties, of which chains are followed to their end; then the reference
  !! freedoms, which must be free of both.
  subroutine build_supports(deck, nodes, support_set, model, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    integer, intent(in) :: support_set         !! of SPC and SPC1; 0: none
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found     !! what is wrong with it is added
    integer :: i, leader(deck%card(card_rbe2)%count), ps

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
  end subroutine build_supports
end module epcont_build_supports
