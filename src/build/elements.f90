!> Elements from their cards, turned counter-clockwise and checked.
module epcont_build_elements
  use epcont_base_incidence, only: new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index, sorted_order
  use epcont_base_text, only: short_real, text_of
  use epcont_build_reference, only: index_of_ids, resolve
  use epcont_deck_card_kinds, only: card_cquad4, card_ctrax3, card_ctrax6, card_ctria3, card_ctria6, card_grid, card_pshell, &
                                    card_psolid, card_spc, card_spc1
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics, place_type
  use epcont_element_element_kinds, only: element_kinds
  use epcont_element_kinematics, only: axisymmetric
  use epcont_geometry_plane, only: cross_product, polygon_area
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_elements, check_axis, element_cards, element_name, element_place

  !> The cards of elements, in the order in which they are read.
  integer, parameter :: element_cards(5) = [card_ctria3, card_ctria6, card_cquad4, card_ctrax3, card_ctrax6]
  logical, parameter :: is_ring(5) = [.false., .false., .false., .true., .true.]

  !> An area up to this part of the square of the longest side is rounding: the corners lie on one line.
  real(wp), parameter :: sliver = 1.0e-12_wp
  !> Shorter sides have areas and stiffnesses that are hardly numbers.
  real(wp), parameter :: shortest_side = 1.0e-30_wp

contains

  !> All elements, card by card.
  subroutine build_elements(deck, nodes, model, faults)
    type(deck_type), intent(in) :: deck
    type(id_index), intent(in) :: nodes
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    type(id_index) :: shells, solids
    integer :: c, e, i, kind_of(size(element_cards))

    model%kinds = element_kinds()
    model%elements = sum(deck%card(element_cards)%count)
    do c = 1, size(element_cards)
      kind_of(c) = kind_named(model, deck%card(element_cards(c))%entry%name)
    end do
    allocate (model%element_id(model%elements), model%kind(model%elements), model%order(model%elements))
    allocate (model%section(model%elements))
    allocate (model%connectivity(maxval(model%kinds(kind_of)%nodes, mask=deck%card(element_cards)%count > 0), &
                                 model%elements), source=0)
    allocate (model%first_point(model%elements + 1))
    model%first_point(1) = 1
    shells = index_of_ids(deck, card_pshell)
    solids = index_of_ids(deck, card_psolid)
    e = 0
    do c = 1, size(element_cards)
      do i = 1, deck%card(element_cards(c))%count
        e = e + 1
        model%element_id(e) = int(deck%card(element_cards(c))%value(1, i))
        model%kind(e) = kind_of(c)
        model%order(e) = model%kinds(kind_of(c))%nodes
        model%first_point(e + 1) = model%first_point(e) + model%kinds(kind_of(c))%points
        if (is_ring(c)) then
          call resolve(deck, element_cards(c), i, 2, solids, 'PSOLID', faults, model%section(e))
          if (model%section(e) > 0) model%section(e) = model%section(e) + deck%card(card_pshell)%count
        else
          call resolve(deck, element_cards(c), i, 2, shells, 'PSHELL', faults, model%section(e))
        end if
        call read_nodes(deck, element_cards(c), i, nodes, model%connectivity(:model%order(e), e), faults)
        if (element_cards(c) == card_ctrax6) model%connectivity(:, e) = model%connectivity([1, 3, 5, 2, 4, 6], e)
        if (all(model%connectivity(:model%order(e), e) > 0)) call check_shape(deck, element_cards(c), i, e, model, faults)
      end do
    end do
    model%points = model%first_point(model%elements + 1) - 1
    allocate (model%point_element(model%points))
    do e = 1, model%elements
      model%point_element(model%first_point(e):model%first_point(e + 1) - 1) = e
    end do
    model%around = new_incidence(model%connectivity, model%nodes)
    call check_kinds(deck, faults)
  end subroutine build_elements

  !> The kind of elements that a card is of.
  pure integer function kind_named(model, card) result(kind)
    type(model_type), intent(in) :: model
    character(len=*), intent(in) :: card

    kind = findloc(model%kinds%plane_card == card .or. model%kinds%ring_card == card, .true., dim=1)
  end function kind_named

  subroutine read_nodes(deck, card, i, nodes, node, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card, i
    type(id_index), intent(in) :: nodes
    integer, intent(out) :: node(:)
    type(diagnostics), intent(inout) :: faults
    integer :: k

    do k = 1, size(node)
      call resolve(deck, card, i, 2 + k, nodes, 'GRID', faults, node(k))
    end do
  end subroutine read_nodes

  !> Turn the element counter-clockwise; a shape that is none is a fault.
  subroutine check_shape(deck, card, i, e, model, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card, i, e
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    real(wp) :: area, extent, longest, side(2), x(2, 4)
    integer :: k, n

    n = model%corners(e)
    do k = 1, n
      x(:, k) = model%x(:, model%connectivity(k, e))
    end do
    extent = 0.0_wp
    longest = 0.0_wp
    do k = 1, n
      side = x(:, k) - x(:, mod(k, n) + 1)
      extent = max(extent, abs(side(1)), abs(side(2)))
      longest = max(longest, side(1)**2 + side(2)**2)
    end do
    if (extent > 0.0_wp .and. extent < shortest_side) then
      call faults%add_error(deck%place(card, i, 3), deck%identity(card, i)//': its sides are shorter than '// &
                            short_real(shortest_side), 'other units')
      return
    end if
    area = polygon_area(x(:, :n))
    if (n == 3 .and. abs(area) <= sliver*longest) then
      call faults%add_error(deck%place(card, i, 4), deck%identity(card, i)//': its corners '//corner_ids(model, e)// &
                            ' lie on one line', 'corners that span an area')
      return
    end if
    if (n == 4 .and. .not. bends_one_way(x(:, :n), sign(1.0_wp, area), sliver*longest)) then
      call faults%add_error(deck%place(card, i, 3), deck%identity(card, i)//': its corners '//corner_ids(model, e)// &
                            ' cross over, bend inwards or lie on one line', 'four corners in turn, each bending the same way')
      return
    end if
    if (area < 0.0_wp) call turn(model%connectivity(:n, e), model%connectivity(n + 1:model%order(e), e))
    if (model%order(e) > n) call check_middles(deck, card, i, n, model%coordinates(e), faults)
  end subroutine check_shape

  !> Does a boundary bend by more than `least` at each corner, to the left where `way` is 1, else to the right?
  pure logical function bends_one_way(x, way, least)
    real(wp), intent(in) :: x(:, :)   !! corners [2, any]
    real(wp), intent(in) :: way       !! 1 or -1
    real(wp), intent(in) :: least     !! [length**2]
    integer :: k, n

    n = size(x, 2)
    bends_one_way = .false.
    do k = 1, n
      if (way*cross_product(x(:2, k) - x(:2, mod(k + n - 2, n) + 1), x(:2, mod(k, n) + 1) - x(:2, k)) <= least) return
    end do
    bends_one_way = .true.
  end function bends_one_way

  !> The ids of an element's corners.
  pure function corner_ids(model, e) result(ids)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    character(len=:), allocatable :: ids
    integer :: k, n

    n = model%corners(e)
    ids = text_of(model%node_id(model%connectivity(1, e)))
    do k = 2, n - 1
      ids = ids//', '//text_of(model%node_id(model%connectivity(k, e)))
    end do
    ids = ids//' and '//text_of(model%node_id(model%connectivity(n, e)))
  end function corner_ids

  !> The same nodes the other way round.
  pure subroutine turn(corner, middle)
    integer, intent(inout) :: corner(:), middle(:)   !! middle nodes of the sides, of some kinds

    corner(2:) = corner(size(corner):2:-1)
    middle = middle(size(middle):1:-1)
  end subroutine turn

  !> A side's middle node may leave the middle as long as the element does not fold over at a corner; a side that bulges more
  !! than half a circle does is hardly meant.
  subroutine check_middles(deck, card, i, corners, x, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card, i, corners
    real(wp), intent(in) :: x(:, :)   !! [2, nodes]
    type(diagnostics), intent(inout) :: faults
    integer :: after, before, k

    do k = 1, corners
      after = mod(k, corners) + 1
      before = mod(k + corners - 2, corners) + 1
      ! Tangents of the two sides at the corner.
      if (cross_product(4.0_wp*x(:, corners + k) - 3.0_wp*x(:, k) - x(:, after), &
                        4.0_wp*x(:, corners + before) - 3.0_wp*x(:, k) - x(:, before)) > 0.0_wp) cycle
      call faults%add_error(deck%place(card, i, 3), deck%identity(card, i)// &
                            ': a middle node is so far from the middle of its side that the element folds over', &
                            'nodes near the middles of the sides')
      return
    end do
    do k = 1, corners
      after = mod(k, corners) + 1
      if (norm2(2.0_wp*x(:, corners + k) - x(:, k) - x(:, after)) <= norm2(x(:, after) - x(:, k))) cycle
      call faults%add_warning(deck%place(card, i, 3), deck%identity(card, i)// &
                              ': a middle node is farther from the middle of its side than half of that side is long', &
                              'nodes near the middles of the sides')
      return
    end do
  end subroutine check_middles

  !> A scene is plane, or it is of rings.
  subroutine check_kinds(deck, faults)
    type(deck_type), intent(in) :: deck
    type(diagnostics), intent(inout) :: faults
    integer :: c, plane

    plane = findloc(deck%card(element_cards)%count > 0 .and. .not. is_ring, .true., dim=1)
    c = findloc(deck%card(element_cards)%count > 0 .and. is_ring, .true., dim=1)
    if (plane == 0 .or. c == 0) return
    call faults%add_error(deck%place(element_cards(c), 1, 0), deck%identity(element_cards(c), 1)// &
                          ': a ring in a deck of plane elements ('//deck%identity(element_cards(plane), 1)//')', &
                          'plane elements only, or rings only')
  end subroutine check_kinds

  !> Rings lie at x >= 0, and their nodes on the axis cannot leave it.
  subroutine check_axis(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    type(diagnostics), intent(inout) :: faults
    logical, allocatable :: in_ring(:), loose(:)
    character(len=:), allocatable :: others
    integer :: e, i

    allocate (in_ring(model%nodes), loose(model%nodes), source=.false.)
    do e = 1, model%elements
      if (model%section(e) == 0 .or. any(model%connectivity(:model%order(e), e) == 0)) cycle
      if (model%kinematics(model%section(e)) == axisymmetric) in_ring(model%connectivity(:model%order(e), e)) = .true.
    end do
    do i = 1, model%nodes
      if (.not. in_ring(i)) cycle
      if (model%x(1, i) < 0.0_wp) then
        call faults%add_error(deck%place(card_grid, i, 3), deck%identity(card_grid, i)// &
                              ': belongs to a ring and lies at a negative radius', 'X1 of at least 0.0: x is the radius')
      else
        loose(i) = model%x(1, i) == 0.0_wp .and. .not. model%held(1, model%leader(1, i))
      end if
    end do
    if (.not. any(loose)) return
    i = findloc(loose, .true., dim=1)
    others = ''
    if (count(loose) > 1) others = '; so could '//text_of(count(loose) - 1)//' more'
    call faults%add_error(deck%place(card_grid, i, 3), deck%identity(card_grid, i)// &
                          ': lies on the axis of rings and could leave it'//others, &
                          'direction 1 held: '//holding_cards(deck, pack(model%node_id, loose)))
  end subroutine check_axis

  !> The SPC1 cards, in free field, that hold some nodes in direction 1.
  pure function holding_cards(deck, ids) result(text)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: ids(:)
    character(len=:), allocatable :: text, item
    integer, parameter :: most_fields = 6   ! of a line with SPC1, its set and directions
    integer, allocatable :: id(:)
    integer :: fields, from, set, to

    set = deck%spc
    if (set == 0 .and. deck%card(card_spc1)%count > 0) set = nint(deck%card(card_spc1)%value(1, 1))
    if (set == 0 .and. deck%card(card_spc)%count > 0) set = nint(deck%card(card_spc)%value(1, 1))
    id = ids(sorted_order(ids))
    text = ''
    fields = most_fields
    from = 1
    do while (from <= size(id))
      to = from
      do while (to < size(id))
        if (id(to + 1) /= id(to) + 1) exit
        to = to + 1
      end do
      item = ','//text_of(id(from))
      if (to > from + 1) item = item//',THRU,'//text_of(id(to))
      fields = fields + merge(3, 1, to > from + 1)
      if (fields > most_fields) then
        if (len(text) > 0) text = text//' and '
        text = text//'SPC1,'//text_of(max(set, 1))//',1'
        fields = merge(3, 1, to > from + 1)
      end if
      text = text//item
      from = merge(to + 1, from + 1, to > from + 1)
    end do
  end function holding_cards

  !> Where the card of an element stands.
  function element_place(deck, e) result(place)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: e
    type(place_type) :: place
    integer :: c, i

    i = e
    do c = 1, size(element_cards) - 1
      if (i <= deck%card(element_cards(c))%count) exit
      i = i - deck%card(element_cards(c))%count
    end do
    place = deck%place(element_cards(c), i, 1)
  end function element_place

  !> The card and the id of an element, as messages name it.
  pure function element_name(model, e) result(name)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    character(len=:), allocatable :: name
    logical :: ring

    ring = .false.
    if (model%section(e) > 0) ring = model%kinematics(model%section(e)) == axisymmetric
    associate (kind => model%kinds(model%kind(e)))
      name = trim(merge(kind%ring_card, kind%plane_card, ring))//' '//text_of(model%element_id(e))
    end associate
  end function element_name
end module epcont_build_elements
