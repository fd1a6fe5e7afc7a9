!> Nodes of the undeformed outlines that are not joined to what they touch: hanging nodes on an edge of their
!> own part (non-matching meshes, or six-node elements beside linear ones), and nodes at a node of another
!> part or inside it (a forgotten contact or common node).
module epcont_contact_geometry_loose_nodes
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_base_tolerances, only: coincident
  use epcont_contact_geometry_mates, only: find_mates, is_mate
  use epcont_geometry_outline_shape, only: near_place, new_outline_shape, outline_shape
  use epcont_model_finding, only: and_more, findings, of_element, of_node
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: warn_of_loose_nodes

  !> An overlap of less than this fraction of an edge may come from chords of a curve.
  real(wp), parameter :: deep = 0.1_wp

  !> What each node touches.
  type :: loose_nodes
    integer, allocatable :: edge(:, :)   !! edge with a hanging node: ends and element; 0 if absent [3, nodes]
    integer, allocatable :: twin(:)      !! node of a later part at the same point; 0 if absent [nodes]
    integer :: inside = 0                !! node with the deepest penetration into another part; 0 if absent
    type(near_place) :: deepest          !! its nearest point on the outline of that part
  end type loose_nodes

contains

  !> Give one warning for all hanging nodes, one for all nodes at a node of another part, and one for the
  !! deepest node inside another part.
  subroutine warn_of_loose_nodes(model, found)
    type(model_type), intent(in) :: model      !! the model
    type(findings), intent(inout) :: found     !! warnings are added
    type(loose_nodes) :: loose
    integer :: i

    loose = find_loose_nodes(model)
    i = findloc(loose%edge(3, :) > 0, .true., dim=1)
    if (i > 0) call found%add_warning(of_node, i, 1, ': hangs on edge '// &
      model%name_of(of_node, loose%edge(1, i))//' to '//text_of(model%mesh%node_id(loose%edge(2, i)))// &
      ' of '//model%name_of(of_element, loose%edge(3, i))//': the body may open there'// &
      and_more(count(loose%edge(3, :) > 0), '; so do ', ' more nodes'), &
      'let the elements share all nodes of their common edges')
    i = findloc(loose%twin > 0, .true., dim=1)
    if (i > 0) call found%add_warning(of_node, i, 1, ': coincides with '// &
      model%name_of(of_node, loose%twin(i))//' of another body, and no pair joins the two'// &
      and_more(count(loose%twin > 0), '; so do ', ' more'), &
      'add a CGAP, or a BCONP between two lines, or use one GRID for both')
    if (loose%inside > 0) call found%add_warning(of_node, loose%inside, 1, &
      ': is '//short_real(loose%deepest%distance)//' inside the body of '// &
      model%name_of(of_element, model%mesh%body_outline%element(loose%deepest%side))// &
      ', with no pair there', 'move the bodies apart, or define a contact between them')
  end subroutine warn_of_loose_nodes

  !> Search around each node of the outlines, at the start and the middle of each edge.
  function find_loose_nodes(model) result(loose)
    type(model_type), intent(in) :: model
    type(loose_nodes) :: loose
    type(outline_shape) :: drawn
    integer, allocatable :: mate(:), part(:)
    logical :: paired(model%mesh%nodes)
    integer :: i, k, side

    allocate (loose%edge(3, model%mesh%nodes), loose%twin(model%mesh%nodes), source=0)
    loose%deepest%distance = 0.0_wp
    mate = find_mates(model)
    paired = .false.
    paired(model%contact%row_node) = .true.
    drawn = new_outline_shape(model%mesh%body_outline, model%mesh%x)
    call find_middles(model, loose)
    do side = 1, drawn%outline%sides
      do k = 1, 3, 2
        associate (node => drawn%outline%node(k, side), x => drawn%x(:, k, side), &
                   within => coincident*norm2(drawn%chord(side)))
          if (node == 0) cycle
          part = drawn%part_tree%meeting(x - within, x + within)
          do i = 1, size(part)
            if (part(i) /= drawn%outline%part(side)) then
              call look_at_other_part(model, drawn, part(i), node, within, mate, loose)
            else if (.not. paired(node)) then
              call look_at_own_part(model, drawn, side, node, within, loose)
            end if
          end do
        end associate
      end do
    end do
  end function find_loose_nodes

  !> Find mid-side nodes that hang: inside a body, but of one element only.
  pure subroutine find_middles(model, loose)
    type(model_type), intent(in) :: model
    type(loose_nodes), intent(inout) :: loose
    logical :: on_outline(0:model%mesh%nodes)
    integer, allocatable :: beside(:)
    integer :: e, i, side(3)

    on_outline = .false.
    on_outline([model%mesh%body_outline%node]) = .true.
    do i = 1, model%mesh%nodes
      if (model%mesh%around%start(i + 1) - model%mesh%around%start(i) /= 1 .or. on_outline(i) .or. &
          model%constraints%is_tied([i])) cycle
      e = model%mesh%around%group(model%mesh%around%start(i))
      side = model%mesh%edge(e, findloc(model%mesh%connectivity(:, e), i, dim=1) - model%mesh%corners(e))
      beside = [0, model%mesh%with_side(side(1), side(2))]
      loose%edge(:, i) = [side(:2), maxval(beside, mask=beside /= e)]
    end do
  end subroutine find_middles

  !> Does a node hang on an edge of its own part: between the nodes of that edge, or as its mid-side node
  !! where other elements have a corner?
  subroutine look_at_own_part(model, drawn, own, node, within, loose)
    type(model_type), intent(in) :: model
    type(outline_shape), intent(in) :: drawn
    integer, intent(in) :: own, node      !! the node and an edge of it
    real(wp), intent(in) :: within        !! [length]
    type(loose_nodes), intent(inout) :: loose
    type(near_place) :: place
    integer, allocatable :: side(:)
    integer :: i

    if (model%constraints%is_tied([node])) return
    associate (outline => drawn%outline, x => model%mesh%x)
      side = drawn%sides_meeting(outline%part(own), x(:, node) - within, x(:, node) + within)
      do i = 1, size(side)
        associate (ends => outline%node(:2, side(i)), middle => outline%node(3, side(i)))
          if (outline%element(side(i)) == outline%element(own) .or. any(ends == node)) cycle
          place = drawn%near_side(side(i), x(:, node))
          if (place%distance > within) cycle
          if (any(norm2(x(:, ends) - spread(x(:, node), 2, 2), dim=1) <= within)) cycle
          if (middle /= 0 .and. middle /= node) then   ! the other face of a slit, with matching nodes
            if (norm2(x(:, middle) - x(:, node)) <= within) cycle
          end if
          loose%edge(:, node) = [ends, outline%element(side(i))]
        end associate
      end do
    end associate
  end subroutine look_at_own_part

  !> Is a node at a node of another part, or deep inside that part? RBE2 may join the two nodes, and supports
  !! may fix both.
  subroutine look_at_other_part(model, drawn, part, node, within, mate, loose)
    type(model_type), intent(in) :: model
    type(outline_shape), intent(in) :: drawn
    integer, intent(in) :: part, node     !! the other part; the node
    real(wp), intent(in) :: within        !! [length]
    integer, intent(in) :: mate(:)        !! part with which pairs join each node [nodes]
    type(loose_nodes), intent(inout) :: loose
    type(near_place) :: place
    integer :: twin

    place = drawn%nearest_place(part, model%mesh%x(:, node))
    if (place%distance > within) then
      if (.not. place%inside .or. is_mate(mate, [node], part)) return
      if (place%distance <= max(loose%deepest%distance, deep*norm2(drawn%chord(place%side)))) return
      loose%deepest = place
      loose%inside = node
    else if (part > drawn%outline%part_of(node) .and. mate(node) == 0) then
      twin = drawn%outline%node(merge(1, 2, place%s < 0.5_wp), place%side)
      associate (constraints => model%constraints)
        if (norm2(model%mesh%x(:, twin) - model%mesh%x(:, node)) <= within .and. .not. (mate(twin) /= 0 .or. &
            any(constraints%leader(:, twin) == constraints%leader(:, node)) .or. &
            all(constraints%held(:, [node, twin])))) loose%twin(node) = twin
      end associate
    end if
  end subroutine look_at_other_part
end module epcont_contact_geometry_loose_nodes
