!> Boundary lines from BLSEG: sides of the bodies' outlines, end to end.
module epcont_build_lines
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index
  use epcont_base_text, only: text_of
  use epcont_build_elements, only: element_name
  use epcont_build_reference, only: check_unique
  use epcont_contact_geometry_boundary, only: find_boundary
  use epcont_deck_card_kinds, only: card_blseg
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_geometry_boxed_line, only: new_boxed_line
  use epcont_model_model, only: model_type, named_line
  implicit none
  private
  public :: build_lines

  integer, parameter :: first_room = 16   !! nodes that a line holds before its arrays first grow

  !> What a line is read into.
  type :: walk_type
    integer, allocatable :: node(:)       !! as the card lists them; 0: there is none of that id
    integer, allocatable :: item(:)       !! of the card's list, where each node is named
    integer, allocatable :: side(:, :)    !! nodes of the sides found, as the elements turn [3, sides]
    integer, allocatable :: element(:)
    logical :: sound = .true.
  end type walk_type

contains

  !> All lines; one that is not sound has no sides.
  subroutine build_lines(deck, nodes, model, faults)
    type(deck_type), intent(in) :: deck
    type(id_index), intent(in) :: nodes
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    type(walk_type) :: walk
    integer, allocatable :: starting(:)
    integer :: i
    logical :: sound

    call check_unique(deck, [card_blseg], faults)
    associate (blseg => deck%card(card_blseg))
      allocate (model%line(blseg%count))
      if (blseg%count == 0) return
      ! Without sound elements there is no boundary to look at.
      sound = faults%error_count() == 0
      if (sound) then
        model%boundary = new_boxed_line(find_boundary(model, deck%parameter_value('CORNER', 0.0_wp)))
        allocate (starting(model%nodes), source=0)
        starting(model%boundary%segment(1, :)) = [(i, i=1, size(model%boundary%element))]
      end if
      do i = 1, blseg%count
        model%line(i)%id = nint(blseg%value(1, i))
        call read_nodes(deck, i, nodes, walk, faults)
        if (walk%sound) call check_repeated(deck, i, model, walk, faults)
        if (walk%sound) call find_sides(deck, i, model, walk, faults)
        if (walk%sound .and. sound) then
          call set_line(model, walk, starting, model%line(i))
        else
          allocate (model%line(i)%side(0))
        end if
      end do
    end associate
  end subroutine build_lines

  !> The nodes of a card, ranges and steps written out.
  subroutine read_nodes(deck, i, nodes, walk, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(id_index), intent(in) :: nodes
    type(walk_type), intent(out) :: walk
    type(diagnostics), intent(inout) :: faults
    integer :: found, id, k

    allocate (walk%node(first_room), walk%item(first_room))
    found = 0
    associate (blseg => deck%card(card_blseg))
      do k = blseg%list_start(i), blseg%list_start(i + 1) - 1
        do id = blseg%list(k)%from, blseg%list(k)%to, blseg%list(k)%step
          if (found == size(walk%node)) walk%node = [walk%node, walk%node]   ! room for twice as many
          if (found == size(walk%item)) walk%item = [walk%item, walk%item]
          found = found + 1
          walk%node(found) = nodes%find(id)
          walk%item(found) = k
          if (walk%node(found) > 0) cycle
          call faults%add_error(deck%list_place(card_blseg, k), deck%identity(card_blseg, i)//': there is no GRID '// &
                                text_of(id), 'the id of a GRID')
          walk%sound = .false.
          exit   ! of a range the first one
        end do
      end do
      walk%node = walk%node(:found)
      walk%item = walk%item(:found)
      walk%sound = walk%sound .and. blseg%sound(i)
      if (walk%sound .and. size(walk%node) < 2) then
        call faults%add_error(deck%place(card_blseg, i, 0), deck%identity(card_blseg, i)//': one node is no line', &
                              'two nodes or more')
        walk%sound = .false.
      end if
    end associate
  end subroutine read_nodes

  !> A node is passed once; but a closed line ends with its first.
  subroutine check_repeated(deck, i, model, walk, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(in) :: model
    type(walk_type), intent(inout) :: walk
    type(diagnostics), intent(inout) :: faults
    logical, allocatable :: met(:)
    integer :: k, n

    allocate (met(model%nodes), source=.false.)
    n = size(walk%node)
    do k = 1, n
      associate (node => walk%node(k))
        if (met(node) .and. .not. (k == n .and. node == walk%node(1) .and. n > 3)) then
          call faults%add_error(deck%list_place(card_blseg, walk%item(k)), deck%identity(card_blseg, i)//': GRID '// &
                                text_of(model%node_id(node))//' stands in it before', &
                                'each node once; a closed line ends with its first node')
          walk%sound = .false.
          return
        end if
        met(node) = .true.
      end associate
    end do
  end subroutine check_repeated

  !> The sides between consecutive nodes; a middle node between two corners may be listed or left out.
  subroutine find_sides(deck, i, model, walk, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(in) :: model
    type(walk_type), intent(inout) :: walk
    type(diagnostics), intent(inout) :: faults
    integer :: element(2), found, k, side(3), sides

    allocate (walk%side(3, size(walk%node)), walk%element(size(walk%node)))
    found = 0
    k = 1
    do while (k < size(walk%node))
      call side_between(model, walk%node(k), walk%node(k + 1), side, element, sides)
      if (sides == 0 .and. k + 2 <= size(walk%node)) then
        call side_between(model, walk%node(k), walk%node(k + 2), side, element, sides)
        if (sides > 0 .and. side(3) == walk%node(k + 1)) then
          k = k + 1
        else
          sides = 0
        end if
      end if
      if (sides == 1) then
        found = found + 1
        walk%side(:, found) = side
        walk%element(found) = element(1)
        k = k + 1
        cycle
      end if
      walk%sound = .false.
      call say_what_is_wrong()
      return
    end do
    walk%side = walk%side(:, :found)
    walk%element = walk%element(:found)

  contains

    subroutine say_what_is_wrong()
      character(len=:), allocatable :: between

      associate (a => model%node_id(walk%node(k)), b => model%node_id(walk%node(k + 1)), &
                 place => deck%list_place(card_blseg, walk%item(k + 1)))
        between = text_of(a)//' and '//text_of(b)
        if (sides == 0) then
          call faults%add_error(place, deck%identity(card_blseg, i)//': GRID '//between// &
                                ' are not the ends of a side of an element', 'nodes in the order of the boundary')
        else
          call faults%add_error(place, deck%identity(card_blseg, i)//': the side between GRID '//between// &
                                ' lies inside a body, between '//element_name(model, element(1))//' and '// &
                                element_name(model, element(2)), 'sides that one element has')
        end if
      end associate
    end subroutine say_what_is_wrong
  end subroutine find_sides

  !> The side that ends at two corners, and how many elements have it.
  pure subroutine side_between(model, a, b, found, element, sides)
    type(model_type), intent(in) :: model
    integer, intent(in) :: a, b
    integer, intent(out) :: found(3)     !! of the first of them
    integer, intent(out) :: element(2)   !! the first and the last
    integer, intent(out) :: sides
    integer :: e, i, k, side(3)

    sides = 0
    found = 0
    element = 0
    do i = model%around%start(a), model%around%start(a + 1) - 1
      e = model%around%group(i)
      do k = 1, model%corners(e)
        side = model%edge(e, k)
        if (.not. (all(side(:2) == [a, b]) .or. all(side(:2) == [b, a]))) cycle
        sides = sides + 1
        if (sides == 1) found = side
        element(min(sides, 2)) = e
      end do
    end do
  end subroutine side_between

  !> Its sides of the outline, walked with the body to the left.
  pure subroutine set_line(model, walk, starting, line)
    type(model_type), intent(in) :: model
    type(walk_type), intent(in) :: walk
    integer, intent(in) :: starting(:)       !! the last side of the outline that starts at each node
    type(named_line), intent(inout) :: line
    integer :: i, k

    allocate (line%side(size(walk%element)))
    do i = 1, size(walk%element)
      k = starting(walk%side(1, i))
      do while (model%boundary%element(k) /= walk%element(i) .or. any(model%boundary%segment(:, k) /= walk%side(:, i)))
        k = k - 1   ! the only one, but where boundaries meet in a node
      end do
      line%side(i) = k
    end do
    if (walk%side(1, 1) /= walk%node(1)) line%side = line%side(size(line%side):1:-1)
    line%box = reshape([minval(model%x(:, walk%node), dim=2), maxval(model%x(:, walk%node), dim=2)], [2, 2])
  end subroutine set_line
end module epcont_build_lines
