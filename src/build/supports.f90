!> Supports, ties and reference freedoms from GRID PS, SPC, SPC1, RBE2 and SUPORT.
module epcont_build_supports
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_build_reference, only: card_index, chosen_set, resolve, resolve_list
  use epcont_deck_card_kinds, only: card_grid, card_rbe2, card_spc, card_spc1, card_suport
  use epcont_deck_deck, only: deck_type
  use epcont_model_finding, only: findings, of_node
  use epcont_model_model, only: model_type
  use epcont_model_ties, only: follow_to_the_end, set_reference, tie
  implicit none
  private
  public :: build_supports, build_ties, build_references

contains

  !> GRID PS, SPC and SPC1 of the chosen set.
  pure subroutine build_supports(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck   !! its cards
    type(card_index), intent(in) :: nodes   !! ids of GRID
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: i, item, k, ps, set
    integer, allocatable :: node(:)

    associate (grid => deck%card(card_grid), spc => deck%card(card_spc), spc1 => deck%card(card_spc1))
      ps = grid%column('PS')
      do i = 1, grid%count
        if (grid%given(ps, i)) call hold(model, i, nint(grid%value(ps, i)), 0.0_wp, [card_grid, i, ps], found)
      end do
      call chosen_set(deck, [card_spc, card_spc1], deck%spc, 'SPC', found, set)
      allocate (node(spc%count))
      do k = 2, 5, 3
        call resolve(deck, card_spc, k, nodes, found, node)
        do i = 1, spc%count
          if (node(i) > 0 .and. nint(spc%value(1, i)) == set) &
            call hold(model, node(i), nint(spc%value(k + 1, i)), spc%value(k + 2, i), [card_spc, i, k], found)
        end do
      end do
      do i = 1, spc1%count
        do item = spc1%list_start(i), spc1%list_start(i + 1) - 1
          call resolve_list(deck, card_spc1, i, item, nodes, found, node)
          if (nint(spc1%value(1, i)) /= set) cycle
          do k = 1, size(node)
            call hold(model, node(k), nint(spc1%value(2, i)), 0.0_wp, [card_spc1, i, -item], found)
          end do
        end do
      end do
    end associate
  end subroutine build_supports

  !> Hold the freedoms of a node that `digits` names; of freedoms that are held at another displacement
  !! already one is told.
  pure subroutine hold(model, node, digits, displacement, card, found)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: node, digits
    real(wp), intent(in) :: displacement   !! [length]
    integer, intent(in) :: card(3)         !! table, card and field that say so
    type(findings), intent(inout) :: found
    integer :: c, conflict

    conflict = 0
    do c = 1, 2
      if (.not. has_component(digits, c)) cycle
      if (model%held(c, node) .and. model%prescribed(c, node) /= displacement) conflict = c
      model%held(c, node) = .true.
      model%prescribed(c, node) = displacement
    end do
    if (conflict > 0) &
      call found%add_error(card(1), card(2), card(3), ': direction '//text_of(conflict)//' of '// &
                           model%name_of(of_node, node)// &
                           ' is held at another displacement already', 'one displacement for each freedom')
  end subroutine hold

  !> Whether the digits (12, 2, 123456) name component c.
  pure logical function has_component(digits, c)
    integer, intent(in) :: digits, c
    integer :: rest

    rest = digits
    do while (rest > 0 .and. mod(rest, 10) /= c)
      rest = rest/10
    end do
    has_component = rest > 0
  end function has_component

  !> RBE2: freedoms that follow a leader. Chains are followed to their end.
  pure subroutine build_ties(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck   !! its cards
    type(card_index), intent(in) :: nodes   !! ids of GRID
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer, allocatable :: node(:)
    integer :: c, i, item, k
    integer :: leader(deck%card(card_rbe2)%count)

    call resolve(deck, card_rbe2, 2, nodes, found, leader)
    associate (rbe2 => deck%card(card_rbe2))
      do i = 1, rbe2%count
        do item = rbe2%list_start(i), rbe2%list_start(i + 1) - 1
          call resolve_list(deck, card_rbe2, i, item, nodes, found, node)
          if (leader(i) == 0) cycle
          do k = 1, size(node)
            do c = 1, 2
              if (has_component(nint(rbe2%value(3, i)), c)) &
                call tie(model, c, node(k), leader(i), [card_rbe2, i, -item], found)
            end do
          end do
        end do
      end do
    end associate
    call follow_to_the_end(model%leader)
  end subroutine build_ties

  !> SUPORT.
  pure subroutine build_references(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck   !! its cards
    type(card_index), intent(in) :: nodes   !! ids of GRID
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: c, i, k
    integer :: node(deck%card(card_suport)%count)

    associate (suport => deck%card(card_suport))
      do k = 1, 7, 2
        call resolve(deck, card_suport, k, nodes, found, node)
        do i = 1, suport%count
          if (node(i) == 0) cycle
          do c = 1, 2
            if (has_component(nint(suport%value(k + 1, i)), c)) &
              call set_reference(model, c, node(i), [card_suport, i, k], found)
          end do
        end do
      end do
    end associate
  end subroutine build_references
end module epcont_build_supports
