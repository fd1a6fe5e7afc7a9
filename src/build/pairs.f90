!> Contact pairs from CGAP, PGAP and CORD2R.
module epcont_build_pairs
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index
  use epcont_base_text, only: short_real, text_of
  use epcont_build_reference, only: check_unique, index_of_ids, resolve
  use epcont_deck_card_kinds, only: card_cgap, card_cord2r, card_pgap
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_pairs

  !> Nodes closer than this part of the nearest edge are at one place: they give no direction.
  real(wp), parameter :: coincident = 1.0e-4_wp
  !> A system's x-axis out of the plane by more than this is a fault.
  real(wp), parameter :: flat = 1.0e-8_wp

contains

  subroutine build_pairs(deck, nodes, model, faults)
    type(deck_type), intent(in) :: deck
    type(id_index), intent(in) :: nodes
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    type(id_index) :: properties, systems
    real(wp), allocatable :: axis(:, :), edge(:)
    logical :: geometry
    integer :: i, k, property

    call check_unique(deck, [card_pgap], faults)
    call check_unique(deck, [card_cord2r], faults)
    call read_systems(deck, axis, faults)
    properties = index_of_ids(deck, card_pgap)
    systems = index_of_ids(deck, card_cord2r)
    geometry = deck%parameter_word('GAPGEOM', 'NO') == 'YES'
    associate (cgap => deck%card(card_cgap), pgap => deck%card(card_pgap))
      model%pairs = cgap%count
      model%pair_id = nint(cgap%value(1, :))
      allocate (model%pair_node(2, cgap%count), source=0)
      allocate (model%normal(2, cgap%count), model%initial_gap(cgap%count), source=0.0_wp)
      do i = 1, cgap%count
        call resolve(deck, card_cgap, i, 2, properties, 'PGAP', faults, property)
        do k = 1, 2
          call resolve(deck, card_cgap, i, 2 + k, nodes, 'GRID', faults, model%pair_node(k, i))
        end do
        if (any(model%pair_node(:, i) == 0)) cycle
        if (model%pair_node(1, i) == model%pair_node(2, i)) then
          call faults%add_error(deck%place(card_cgap, i, 4), deck%identity(card_cgap, i)//': GA and GB are the same GRID', &
                                'a node on each side of the gap')
          cycle
        end if
        call find_normal(deck, i, systems, axis, edge, model, faults)
        if (property > 0) model%initial_gap(i) = pgap%value(pgap%column('U0'), property)
        if (geometry) model%initial_gap(i) = model%initial_gap(i) + dot_product(model%normal(:, i), &
                                             model%x(:, model%pair_node(2, i)) - model%x(:, model%pair_node(1, i)))
      end do
      model%row_start = [(2*i - 1, i=1, cgap%count + 1)]
      model%row_node = reshape(model%pair_node([2, 1], :), [2*cgap%count])
      model%row_weight = [(1.0_wp, -1.0_wp, i=1, cgap%count)]
    end associate
    call warn_of_overlap(deck, model, faults)
  end subroutine build_pairs

  !> One warning for all overlaps: shrink fits have many.
  subroutine warn_of_overlap(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: others
    integer :: first, overlaps

    overlaps = count(model%initial_gap < 0.0_wp)
    if (overlaps == 0) return
    first = findloc(model%initial_gap < 0.0_wp, .true., dim=1)
    others = ''
    if (overlaps > 1) others = '; '//text_of(overlaps)//' pairs overlap, by up to '//short_real(-minval(model%initial_gap))
    call faults%add_warning(deck%place(card_cgap, first, 1), deck%identity(card_cgap, first)//': the initial gap is '// &
                            short_real(model%initial_gap(first))//others, 'a gap of 0.0 or more, unless a fit is meant')
  end subroutine warn_of_overlap

  !> Normal of a pair: x-axis of its system, else from A to B.
  subroutine find_normal(deck, i, systems, axis, edge, model, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(id_index), intent(in) :: systems
    real(wp), intent(in) :: axis(:, :)
    real(wp), allocatable, intent(inout) :: edge(:)   !! the shortest at each node, found when a pair first needs it
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    real(wp) :: between(2)
    integer :: cid, system

    cid = deck%card(card_cgap)%column('CID')
    if (deck%card(card_cgap)%given(cid, i)) then
      if (nint(deck%card(card_cgap)%value(cid, i)) == 0) then
        model%normal(:, i) = [1.0_wp, 0.0_wp]
        return
      end if
      call resolve(deck, card_cgap, i, cid, systems, 'CORD2R', faults, system)
      if (system > 0) model%normal(:, i) = axis(:, system)
      return
    end if
    if (.not. allocated(edge)) edge = shortest_edge(model)
    associate (a => model%pair_node(1, i), b => model%pair_node(2, i))
      between = model%x(:, b) - model%x(:, a)
      if (norm2(between) <= coincident*min(edge(a), edge(b))) then
        call faults%add_error(deck%place(card_cgap, i, cid), deck%identity(card_cgap, i)// &
                              ': GA and GB are at one place and field 9 (CID) is blank: no direction', &
                              'the id of a CORD2R whose x-axis is the normal')
      else
        model%normal(:, i) = between/norm2(between)
      end if
    end associate
  end subroutine find_normal

  !> Shortest edge at each node; 0 at nodes without elements, which say nothing of the mesh's size.
  pure function shortest_edge(model) result(edge)
    type(model_type), intent(in) :: model
    real(wp), allocatable :: edge(:)
    real(wp) :: length
    integer :: e, i, k, side(3)

    allocate (edge(model%nodes), source=huge(1.0_wp))
    do e = 1, model%elements
      if (any(model%connectivity(:model%order(e), e) == 0)) cycle
      do k = 1, model%corners(e)
        side = model%edge(e, k)
        length = norm2(model%x(:, side(1)) - model%x(:, side(2)))
        if (side(3) > 0) length = 0.5_wp*length
        do i = 1, merge(3, 2, side(3) > 0)
          edge(side(i)) = min(edge(side(i)), length)
        end do
      end do
    end do
    where (edge == huge(1.0_wp)) edge = maxval(edge, mask=edge < huge(1.0_wp))
    where (edge < 0.0_wp) edge = 0.0_wp
  end function shortest_edge

  !> x-axes of the CORD2R systems in the plane.
  subroutine read_systems(deck, axis, faults)
    type(deck_type), intent(in) :: deck
    real(wp), allocatable, intent(out) :: axis(:, :)
    type(diagnostics), intent(inout) :: faults
    real(wp) :: x(3), z(3), to_c(3)
    integer :: a, i

    associate (card => deck%card(card_cord2r))
      allocate (axis(2, card%count), source=0.0_wp)
      a = card%column('A1')
      do i = 1, card%count
        if (.not. card%sound(i)) cycle
        z = card%value(a + 3:a + 5, i) - card%value(a:a + 2, i)
        to_c = card%value(a + 6:a + 8, i) - card%value(a:a + 2, i)
        x = 0.0_wp
        if (norm2(z) > 0.0_wp) x = to_c - z*(dot_product(z, to_c)/dot_product(z, z))
        if (norm2(x) <= flat*norm2(to_c)) then
          call faults%add_error(deck%place(card_cord2r, i, 1), deck%identity(card_cord2r, i)// &
                                ': points A, B and C lie on one line: no x-axis', 'three points that span a plane')
        else if (abs(x(3)) > flat*norm2(x)) then
          call faults%add_error(deck%place(card_cord2r, i, 1), deck%identity(card_cord2r, i)// &
                                ': its x-axis points off the x-y plane', 'point C in the plane, B - A along z')
        else
          axis(:, i) = x(:2)/norm2(x(:2))
        end if
      end do
    end associate
  end subroutine read_systems
end module epcont_build_pairs
