!> Nodes at the same point as another part of the undeformed model without a connection to it: on an edge of
!> an element of their own body (non-matching meshes, or six-node elements beside linear
!> ones), or at a node of another body or inside it, without a pair or RBE2 (a
!> forgotten contact or common node).
module epcont_contact_geometry_loose_nodes
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_base_tolerances, only: coincident
  use epcont_contact_geometry_mates, only: find_mates, is_mate
  use epcont_geometry_box_tree, only: box_query
  use epcont_geometry_outline_shape, only: near_place, outline_shape
  use epcont_model_finding, only: and_more, findings, of_element, of_node
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: warn_of_hanging_nodes, warn_of_lying_together

  !> An overlap of less than this fraction of an edge may come from chords of a curve.
  real(wp), parameter :: deep = 0.1_wp

contains

  !> Give one warning, for the first hanging node.
  subroutine warn_of_hanging_nodes(model, drawn, found)
    type(model_type), intent(in) :: model       !! the model
    type(outline_shape), intent(in) :: drawn    !! its outlines
    type(findings), intent(inout) :: found      !! errors are added
    ! Edge of each hanging node: its ends and its element; 0 if absent
    integer :: edge(3, model%mesh%nodes)
    integer :: first

    edge = 0
    call find_middles()
    call find_chains()
    first = findloc(edge(3, :) > 0, .true., dim=1)
    if (first == 0) return
    call found%add_warning(of_node, first, 1, ': is on edge '//model%name_of(of_node, edge(1, first))// &
                           ' to '//text_of(model%mesh%node_id(edge(2, first)))//' of '// &
                           model%name_of(of_element, edge(3, first))//' '// &
                           trim(merge('and is a corner beside it', 'but not a node of it     ', &
                                      any(model%mesh%connectivity(:, edge(3, first)) == first)))// &
                           ': the body may open there'// &
                           and_more(count(edge(3, :) > 0), '; so do ', ' more nodes'), &
                           'let the elements share all nodes of their common edges')

  contains

    !> Find mid-side nodes of edges that another element has without this node. A node between two elements
    !! with the same mid-side node does not hang.
    subroutine find_middles()
      integer, allocatable :: near(:)
      integer :: i, s, side(3)

      do i = 1, model%mesh%nodes
        if (model%mesh%around%start(i + 1) - model%mesh%around%start(i) /= 1 .or. &
            model%constraints%is_tied([i])) cycle
        associate (e => model%mesh%around%group(model%mesh%around%start(i)))
          do s = 1, model%mesh%corners(e)
            side = model%mesh%edge(e, s)
            if (side(3) /= i) cycle
            near = model%mesh%with_side(side(1), side(2))
            associate (other => [pack(near, near /= e), 0])
              edge(:, i) = [side(:2), other(1)]
            end associate
          end do
        end associate
      end do
    end subroutine find_middles

    !> Find edges of the outline that go back along a longer one, from its end to its start.
    subroutine find_chains()
      type(incidence) :: beginning   ! edges that begin at each node
      integer, allocatable :: beside(:)
      integer :: k, s

      associate (node => model%mesh%body_outline%node)
        beginning = new_incidence(node(:1, :), model%mesh%nodes)
        do s = 1, model%mesh%body_outline%sides
          beside = beginning%of(node(2, s))
          do k = 1, size(beside)
            if (goes_back(s, beside(k))) call follow(s, beside(k))
          end do
        end do
      end associate
    end subroutine find_chains

    !> Is an edge shorter than the one at whose end it begins, of another element, and leads back along it?
    pure logical function goes_back(side, beside)
      integer, intent(in) :: side, beside

      goes_back = model%mesh%body_outline%element(side) /= model%mesh%body_outline%element(beside)
      if (.not. goes_back) return   ! a sliver
      associate (a => drawn%chord(side), b => drawn%chord(beside))
        goes_back = dot_product(a, b) < -0.5_wp*norm2(a)*norm2(b) .and. norm2(b) < norm2(a)
      end associate
    end function goes_back

    !> Go from the end of an edge back to its start: nodes between hang; so does its mid-side node, if
    !! the other edges end there.
    subroutine follow(side, from)
      integer, intent(in) :: side, from
      type(near_place) :: place
      integer :: last, t

      associate (outline => model%mesh%body_outline)
        last = from
        do while (outline%node(2, last) /= outline%node(1, side))
          place = drawn%near_side(side, model%mesh%x(:, outline%node(2, last)))
          if (place%distance > coincident*norm2(drawn%chord(side)) .or. place%s <= 0.0_wp .or. &
              place%s >= 1.0_wp) return
          last = outline%after(last)
          if (last == from) return
        end do
        t = from
        do while (t /= last)
          associate (node => outline%node(2, t))
            if (.not. model%constraints%is_tied([node])) edge(:, node) = &
              [outline%node(:2, side), outline%element(side)]
          end associate
          t = outline%after(t)
        end do
      end associate
    end subroutine follow
  end subroutine warn_of_hanging_nodes

  !> Give one warning for each two bodies with nodes at the same points: nodes of edges that coincide from
  !! end to end, and single nodes without any pair. The node of the earlier body is named. Give
  !! one warning of the node with the deepest penetration into another body.
  subroutine warn_of_lying_together(model, drawn, found)
    type(model_type), intent(in) :: model       !! the model
    type(outline_shape), intent(in) :: drawn    !! its outlines
    type(findings), intent(inout) :: found      !! errors are added
    !> For one body and each later one: number of coinciding nodes, and the first of them
    integer :: twins(model%mesh%body_outline%parts), first(2, model%mesh%body_outline%parts)
    integer, allocatable :: mate(:), met(:), near(:)
    type(near_place) :: deepest   ! of the nodes inside another body
    integer :: at, i, part, side, twin

    if (model%mesh%body_outline%parts < 2) return
    mate = find_mates(model)
    at = 0
    deepest%distance = 0.0_wp
    twins = 0
    do part = 1, model%mesh%body_outline%parts
      met = [integer ::]
      do side = model%mesh%body_outline%first(part), model%mesh%body_outline%first(part + 1) - 1
        associate (within => coincident*norm2(drawn%chord(side)))
          near = drawn%part_tree%meeting(box_query(drawn%low(:, side) - within, drawn%high(:, side) + within))
        end associate
        do i = 1, size(near)
          if (near(i) == part) cycle
          call look_inside(near(i))
          if (near(i) < part) cycle
          twin = twin_that_counts(side, near(i))
          if (twin == 0) cycle
          if (twins(near(i)) == 0) then
            met = [met, near(i)]
            first(:, near(i)) = [model%mesh%body_outline%node(1, side), twin]
          end if
          twins(near(i)) = twins(near(i)) + 1
        end do
      end do
      do i = 1, size(met)
        call found%add_warning(of_node, first(1, met(i)), 1, ': coincides with '// &
                               model%name_of(of_node, first(2, met(i)))// &
                               ' of another body, and no pair joins the two'// &
                               and_more(twins(met(i)), '; so do ', ' more of these two bodies'), &
                               'add a CGAP, or a BCONP between two lines, or use one GRID for both')
      end do
      twins(met) = 0
    end do
    if (at > 0) call found%add_warning(of_node, at, 1, ': is '//short_real(deepest%distance)// &
      ' inside the body of '//model%name_of(of_element, model%mesh%body_outline%element(deepest%side))// &
      ', with no pair there', 'move the bodies apart, or define a contact between them')

  contains

    !> Keep the node at which an edge begins, if it is deepest in an undeformed part, without a pair to it.
    subroutine look_inside(part)
      integer, intent(in) :: part
      type(near_place) :: place
      integer :: node(1)

      node = model%mesh%body_outline%node(1, side)
      if (is_mate(mate, node, part)) return
      place = drawn%nearest_place(part, model%mesh%x(:, node(1)))
      if (.not. place%inside .or. &
          place%distance <= max(deepest%distance, deep*norm2(drawn%chord(place%side)))) return
      deepest = place
      at = node(1)
    end subroutine look_inside

    !> Node of another part at the start of an edge, if both have no pairs, or if the edge that
    !! begins or the one that ends there coincides with that part, with its other end. 0 if absent.
    pure integer function twin_that_counts(side, part) result(twin)
      integer, intent(in) :: side, part

      associate (node => model%mesh%body_outline%node, before => model%mesh%body_outline%before(side))
        twin = loose_twin(node(1, side), side, part)
        if (twin == 0) return
        if (mate(node(1, side)) == 0 .and. mate(twin) == 0) return
        if (loose_twin(node(2, side), side, part) > 0 .and. lies_against(side, part)) return
        if (loose_twin(node(1, before), before, part) > 0 .and. lies_against(before, part)) return
      end associate
      twin = 0
    end function twin_that_counts

    !> Does the outline of a part have an edge in the opposite direction?
    pure logical function lies_against(side, part)
      integer, intent(in) :: side, part
      type(near_place) :: place

      place = drawn%nearest_place(part, drawn%at(side, 0.5_wp))
      lies_against = place%distance <= coincident*norm2(drawn%chord(side)) .and. &
                     dot_product(drawn%tangent(place%side, place%s), drawn%tangent(side, 0.5_wp)) < 0.0_wp
    end function lies_against

    !> Node of a part at the end of an edge, if nothing connects the two; 0 if
    !! absent.
    pure integer function loose_twin(node, side, part) result(twin)
      integer, intent(in) :: node, side, part
      type(near_place) :: place
      logical :: joined

      twin = 0
      place = drawn%nearest_place(part, model%mesh%x(:, node))
      associate (within => coincident*norm2(drawn%chord(side)), &
                 ends => model%mesh%body_outline%node(:2, place%side))
        if (place%distance > within) return
        twin = merge(ends(1), ends(2), place%s < 0.5_wp)
        joined = any(model%constraints%leader(:, twin) == model%constraints%leader(:, node)) .or. &
          is_mate(mate, [node], part) .or. &
                 is_mate(mate, [twin], model%mesh%body_outline%part_of(node)) .or. &
                   all(model%constraints%held(:, [node, twin]))
        if (joined .or. norm2(model%mesh%x(:, twin) - model%mesh%x(:, node)) > within) twin = 0
      end associate
    end function loose_twin
  end subroutine warn_of_lying_together
end module epcont_contact_geometry_loose_nodes
