!> Supports, ties and reference freedoms from GRID PS, SPC, SPC1, RBE2 and SUPORT.
module epcont_build_supports
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index
  use epcont_base_text, only: text_of
  use epcont_build_reference, only: resolve
  use epcont_build_sets, only: chosen_set
  use epcont_deck_card_kinds, only: card_grid, card_rbe2, card_spc, card_spc1, card_suport
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_supports, build_ties, build_references

  character(len=*), parameter :: one_displacement = 'one displacement for each freedom'

contains

  !> GRID PS, SPC and SPC1 of the chosen set.
  subroutine build_supports(deck, nodes, model, faults)
    type(deck_type), intent(in) :: deck
    type(id_index), intent(in) :: nodes
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    integer :: conflict, i, k, node, ps, set
    integer, allocatable :: found(:)

    allocate (model%held(2, model%nodes), source=.false.)
    allocate (model%prescribed(2, model%nodes), source=0.0_wp)
    associate (grid => deck%card(card_grid), spc => deck%card(card_spc), spc1 => deck%card(card_spc1))
      ps = grid%column('PS')
      do i = 1, grid%count
        if (grid%given(ps, i)) call hold(i, nint(grid%value(ps, i)), 0.0_wp, model, conflict)
      end do
      call chosen_set(deck, [card_spc, card_spc1], deck%spc, deck%spc_place, 'SPC', faults, set)
      do i = 1, spc%count
        do k = 2, 5, 3
          if (.not. spc%given(k, i)) cycle
          call resolve(deck, card_spc, i, k, nodes, 'GRID', faults, node)
          if (node == 0 .or. nint(spc%value(1, i)) /= set) cycle
          call hold(node, nint(spc%value(k + 1, i)), spc%value(k + 2, i), model, conflict)
          if (conflict > 0) call faults%add_error(deck%place(card_spc, i, k), &
                                 deck%identity(card_spc, i)//conflict_text(model, node, conflict), one_displacement)
        end do
      end do
      do i = 1, spc1%count
        do k = spc1%list_start(i), spc1%list_start(i + 1) - 1
          found = nodes%within(spc1%list(k)%from, spc1%list(k)%to)
          if (size(found) == 0) then
            call faults%add_error(deck%list_place(card_spc1, k), deck%identity(card_spc1, i)//': there is no GRID '// &
                                  range_text(spc1%list(k)%from, spc1%list(k)%to), 'the id of a GRID')
          end if
          if (nint(spc1%value(1, i)) /= set) cycle
          do node = 1, size(found)
            call hold(found(node), nint(spc1%value(2, i)), 0.0_wp, model, conflict)
            if (conflict > 0) call faults%add_error(deck%list_place(card_spc1, k), &
                                   deck%identity(card_spc1, i)//conflict_text(model, found(node), conflict), one_displacement)
          end do
        end do
      end do
    end associate
  end subroutine build_supports

  pure function range_text(first, last) result(text)
    integer, intent(in) :: first, last
    character(len=:), allocatable :: text

    text = text_of(first)
    if (last > first) text = text//' to '//text_of(last)
  end function range_text

  !> Hold the freedoms of a node that `digits` names. `conflict` is a direction that is held at another
  !! displacement already, 0 where there is none.
  pure subroutine hold(node, digits, displacement, model, conflict)
    integer, intent(in) :: node, digits
    real(wp), intent(in) :: displacement
    type(model_type), intent(inout) :: model
    integer, intent(out) :: conflict
    integer :: c

    conflict = 0
    do c = 1, 2
      if (.not. has_component(digits, c)) cycle
      if (model%held(c, node) .and. model%prescribed(c, node) /= displacement) conflict = c
      model%held(c, node) = .true.
      model%prescribed(c, node) = displacement
    end do
  end subroutine hold

  pure function conflict_text(model, node, c) result(text)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node, c
    character(len=:), allocatable :: text

    text = ': direction '//text_of(c)//' of GRID '//text_of(model%node_id(node))//' is held at another displacement already'
  end function conflict_text

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
  subroutine build_ties(deck, nodes, model, faults)
    type(deck_type), intent(in) :: deck
    type(id_index), intent(in) :: nodes
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: objection, remedy
    integer :: c, i, k, leader, node, steps

    model%leader = spread([(i, i=1, model%nodes)], 1, 2)
    associate (rbe2 => deck%card(card_rbe2))
      do i = 1, rbe2%count
        call resolve(deck, card_rbe2, i, 2, nodes, 'GRID', faults, leader)
        do k = rbe2%list_start(i), rbe2%list_start(i + 1) - 1
          node = nodes%find(rbe2%list(k)%from)
          if (node == 0) then
            call faults%add_error(deck%list_place(card_rbe2, k), deck%identity(card_rbe2, i)//': there is no GRID '// &
                                  text_of(rbe2%list(k)%from), 'the id of a GRID')
          else if (leader > 0) then
            do c = 1, 2
              objection = ''
              if (has_component(nint(rbe2%value(3, i)), c)) &
                call tie(c, node, leader, model, objection, remedy)
              if (len(objection) > 0) call faults%add_error(deck%list_place(card_rbe2, k), deck%identity(card_rbe2, i)// &
                                           ': direction '//text_of(c)//' of GRID '//text_of(model%node_id(node))//objection, &
                                           remedy)
            end do
          end if
        end do
      end do
    end associate
    do node = 1, model%nodes
      do c = 1, 2
        do steps = 1, model%nodes
          leader = model%leader(c, model%leader(c, node))
          if (leader == model%leader(c, node)) exit
          model%leader(c, node) = leader
        end do
      end do
    end do
  end subroutine build_ties

  !> Tie component c of a node to its leader; `objection` says why that cannot be, or is empty.
  pure subroutine tie(c, node, leader, model, objection, remedy)
    integer, intent(in) :: c, node, leader
    type(model_type), intent(inout) :: model
    character(len=:), allocatable, intent(out) :: objection, remedy
    integer :: at

    at = leader
    do while (model%leader(c, at) /= at .and. at /= node)
      at = model%leader(c, at)
    end do
    objection = ''
    remedy = ''
    if (at == node) then
      objection = ' would follow itself'
      remedy = 'nodes that follow GN, without GN'
    else if (model%leader(c, node) /= node) then
      objection = ' follows another RBE2 already'
      remedy = 'one leader for each freedom'
    else if (model%held(c, node)) then
      objection = ' is held by a support too'
      remedy = 'the support at GN '//text_of(model%node_id(leader))//' instead'
    else
      model%leader(c, node) = leader
    end if
  end subroutine tie

  !> SUPORT.
  subroutine build_references(deck, nodes, model, faults)
    type(deck_type), intent(in) :: deck
    type(id_index), intent(in) :: nodes
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    integer :: c, i, k, node

    allocate (model%reference(2, model%nodes), source=.false.)
    associate (suport => deck%card(card_suport))
      do i = 1, suport%count
        do k = 1, 7, 2
          if (.not. suport%given(k, i)) cycle
          call resolve(deck, card_suport, i, k, nodes, 'GRID', faults, node)
          if (node == 0) cycle
          do c = 1, 2
            if (.not. has_component(nint(suport%value(k + 1, i)), c)) cycle
            if (model%held(c, model%leader(c, node)) .or. model%leader(c, node) /= node) then
              call faults%add_error(deck%place(card_suport, i, k), deck%identity(card_suport, i)//': direction '// &
                                    text_of(c)//' of GRID '//text_of(model%node_id(node))// &
                                    ' is held by a support or follows an RBE2', 'a freedom that is free to move')
            end if
            model%reference(c, node) = .true.
          end do
        end do
      end do
    end associate
  end subroutine build_references
end module epcont_build_supports
