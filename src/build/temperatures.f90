!> Temperatures of the nodes from TEMP and TEMPD, for the sets that load cases choose.
module epcont_build_temperatures
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_build_reference, only: card_index, check_choices, named_node, nodes_of_fields, note_unnamed
  use epcont_deck_card_kinds, only: card_grid, card_temp, card_tempd
  use epcont_deck_deck, only: deck_type
  use epcont_model_arrays, only: scene_type
  use epcont_model_finding, only: and_more, findings, of_node
  use epcont_model_load_cases, only: load_cases
  implicit none
  private
  public :: read_temperatures

contains

  !> Read the temperatures of each chosen set. All nodes of elements that expand must have one.
  subroutine read_temperatures(deck, nodes, data, cases, found)
    type(deck_type), intent(in) :: deck          !! its cards
    type(card_index), intent(in) :: nodes        !! ids of GRID
    type(scene_type), intent(in) :: data         !! elements and sections
    type(load_cases), intent(inout) :: cases     !! sets of temperatures are added
    type(findings), intent(inout) :: found       !! errors are added
    type(named_node), allocatable :: named(:)   ! by TEMP
    integer :: named_by(2, deck%card(card_grid)%count)   ! TEMP card and field that name a node, 0 if absent
    integer :: default_by                 ! TEMPD of all other nodes, 0 if absent
    integer :: k

    named = nodes_of_fields(deck, card_temp, [2, 4, 6], nodes, found)
    call choose_sets()
    do k = 1, size(cases%heat)
      call read_default(cases%heat(k)%set, cases%heat(k)%temperature)
      call read_nodes(cases%heat(k)%set, cases%heat(k)%temperature)
      if (default_by > 0 .or. any(named_by > 0)) &
        call check_nodes(deck, data, named_by, default_by, cases%heat(k)%set, found)
    end do
    associate (temp => deck%card(card_temp), tempd => deck%card(card_tempd))
      if (all(temp%sound) .and. all(tempd%sound)) &
        call check_choices(deck, deck%subcase%temperature, nint([temp%value(1, :), tempd%value(1::2, :)]), &
                           'TEMPERATURE', 'the deck has no such set', &
                           'give the set of TEMP or TEMPD cards in the deck', found)
    end associate
    call note_unnamed(deck, [card_temp], [1], cases%heat%set, 'load case', found)
    call note_unnamed(deck, [card_tempd], [1, 3, 5, 7], cases%heat%set, 'load case', found)

  contains

    !> Find the set of each load case, and the list of all chosen sets.
    subroutine choose_sets()
      logical :: is_first(size(deck%subcase))   ! first case with this set
      integer :: i

      associate (set => cases%case%temperatures)
        set = deck%subcase%temperature%id
        is_first = [(set(i) > 0 .and. all(set(:i - 1) /= set(i)), i=1, size(set))]
        allocate (cases%heat(count(is_first)))
        cases%heat%set = pack(set, is_first)
      end associate
    end subroutine choose_sets

    !> Read TEMPD.
    subroutine read_default(set, temperature)
      integer, intent(in) :: set
      real(wp), allocatable, intent(out) :: temperature(:)
      integer :: i, k

      default_by = 0
      allocate (temperature(deck%card(card_grid)%count), source=0.0_wp)
      associate (tempd => deck%card(card_tempd))
        do i = 1, tempd%count
          do k = 1, size(tempd%value, 1), 2
            if (tempd%given(k, i) .and. nint(tempd%value(k, i)) == set) &
              call take(card_tempd, i, k, default_by, temperature)
          end do
        end do
      end associate
    end subroutine read_default

    !> Read TEMP.
    subroutine read_nodes(set, temperature)
      integer, intent(in) :: set
      real(wp), intent(inout) :: temperature(:)
      integer :: i

      named_by = 0
      do i = 1, size(named)
        associate (card => named(i)%card, node => named(i)%node)
          if (nint(deck%card(card_temp)%value(1, card(2))) /= set) cycle
          named_by(2, node) = card(3)
          call take(card_temp, card(2), card(3), named_by(1, node), temperature(node:node))
        end associate
      end do
    end subroutine read_nodes

    !> Take the temperature of a card for its nodes; a second one is an error.
    subroutine take(card, i, column, by, temperature)
      integer, intent(in) :: card, i, column   !! the card, and the field before the temperature
      integer, intent(inout) :: by             !! an earlier card with these nodes
      real(wp), intent(inout) :: temperature(:)

      associate (said => deck%card(card)%value(column + 1, i))
        if (by > 0 .and. any(temperature < said .or. temperature > said)) &
          call found%add_error(card, i, column, ': another temperature than '// &
                               deck%card(card)%identity(by)//' has for the same', 'give one temperature')
        by = i
        temperature = said
      end associate
    end subroutine take
  end subroutine read_temperatures

  !> Check that exactly the nodes of elements that expand have temperatures.
  subroutine check_nodes(deck, data, named_by, default_by, set, found)
    type(deck_type), intent(in) :: deck
    type(scene_type), intent(in) :: data
    integer, intent(in) :: named_by(:, :), default_by, set
    type(findings), intent(inout) :: found
    logical, dimension(size(named_by, 2)) :: expands, unnamed, vain
    integer :: k

    expands = expanding_nodes(data)
    unnamed = expands .and. named_by(1, :) == 0
    k = findloc(unnamed, .true., dim=1)
    if (k > 0 .and. default_by == 0) call found%add_error(of_node, k, 1, &
      ': has no temperature in set '//text_of(set)//and_more(count(unnamed), '; nor have ', ' more'), &
      'add TEMP or TEMPD')
    if (found%errors > 0) return   ! a wrong card may have it
    vain = named_by(1, :) > 0 .and. .not. expands
    k = findloc(vain, .true., dim=1)
    if (k > 0) then
      call found%add_warning(card_temp, named_by(1, k), named_by(2, k), ': no material expands at '// &
                             deck%card(card_grid)%identity(k)// &
                             and_more(count(vain), ', nor at ', ' more nodes'), 'give A on its MAT1')
    else if (.not. any(expands)) then
      call found%add_warning(card_tempd, default_by, 1, ': no material expands', 'give A on MAT1')
    end if
  end subroutine check_nodes

  !> Find the nodes with elements whose material expands [nodes].
  pure function expanding_nodes(data) result(expands)
    type(scene_type), intent(in) :: data
    logical :: expands(size(data%x, 2))
    integer :: b, e

    expands = .false.
    do b = 1, size(data%block)
      do e = 1, size(data%block(b)%section)
        associate (s => data%block(b)%section(e), node => data%block(b)%node(:, e))
          if (s == 0) cycle
          if (data%expansion(s) /= 0.0_wp) expands(pack(node, node > 0)) = .true.
        end associate
      end do
    end do
  end function expanding_nodes
end module epcont_build_temperatures
