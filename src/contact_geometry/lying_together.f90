!> Bodies that lie against each other as drawn, with nodes at one place, though neither a pair nor RBE2 joins
!> these: a contact, or a common node, that was forgotten.
module epcont_contact_geometry_lying_together
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: coincident
  use epcont_contact_geometry_mates, only: find_mates, is_mate
  use epcont_geometry_outline_shape, only: near_place, new_outline_shape, outline_shape
  use epcont_model_finding, only: and_more, findings, of_node
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: warn_of_lying_together

  !> A node and the one of another body at its place.
  type :: twin_type
    integer :: node = 0, other = 0
    integer :: count = 0   !! of those of its two bodies, at the first of them
  end type twin_type

contains

  !> One warning for each two bodies.
  pure subroutine warn_of_lying_together(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    type(twin_type), allocatable :: twin(:)
    integer, allocatable :: first(:)   ! of an earlier body, with each other one
    integer :: i

    twin = find_twins(model)
    associate (part => model%body_outline%part_of)
      allocate (first(model%body_outline%parts), source=0)
      do i = 1, size(twin)   ! one earlier body after the other
        associate (k => first(part(twin(i)%other)))
          if (k == 0) then
            k = i
          else if (part(twin(k)%node) /= part(twin(i)%node)) then
            k = i
          end if
          twin(k)%count = twin(k)%count + 1
        end associate
      end do
    end associate
    do i = 1, size(twin)
      if (twin(i)%count > 0) &
        call found%add_warning(of_node, twin(i)%node, 1, ': lies where '// &
                               model%name_of(of_node, twin(i)%other)// &
                               ' of another body does, and no pair joins the two'// &
                               and_more(twin(i)%count, '; so do ', ' more of these two bodies'), &
                               'a CGAP, lines with a BCONP between them, or one GRID for both')
    end do
  end subroutine warn_of_lying_together

  !> Nodes of outlines with one of another body at their place, that nothing joins: those of sides that lie
  !! against each other from end to end, and single ones that are in no pair at all. Of two twins the one of
  !! the earlier body is named.
  pure function find_twins(model) result(twin)
    type(model_type), intent(in) :: model
    type(twin_type), allocatable :: twin(:)
    type(outline_shape) :: drawn
    integer, allocatable :: mate(:), near(:)
    integer :: found, i, n, other, side
    real(wp) :: within

    allocate (twin(16), near(16))
    found = 0
    if (model%body_outline%parts > 1) then
      drawn = new_outline_shape(model%body_outline, model%x)
      mate = find_mates(model)
      do side = 1, model%body_outline%sides
        within = coincident*norm2(drawn%chord(side))
        near = drawn%part_tree%meeting(drawn%low(:, side) - within, drawn%high(:, side) + within)
 n=size(near)
        do i = 1, n
          if (near(i) <= model%body_outline%part(side)) cycle
          other = twin_that_counts(model, drawn, mate, side, near(i))
          if (other == 0) cycle
          if (found == size(twin)) twin = [twin, twin]
          found = found + 1
          twin(found) = twin_type(model%body_outline%node(1, side), other)
        end do
      end do
    end if
    twin = twin(:found)
  end function find_twins

  !> The twin, in another part, of the node where a side begins: neither is in a pair, or the side that begins
  !! or the one that ends there lies against that part, its other end a twin too. 0: none.
  pure integer function twin_that_counts(model, drawn, mate, side, part) result(other)
    type(model_type), intent(in) :: model
    type(outline_shape), intent(in) :: drawn
    integer, intent(in) :: mate(:), side, part

    associate (outline => model%body_outline)
      other = loose_twin(model, drawn, mate, [outline%node(1, side), side], part)
      if (other == 0) return
      if (mate(outline%node(1, side)) == 0 .and. mate(other) == 0) return
      associate (before => outline%before(side))
        if (loose_twin(model, drawn, mate, [outline%node(2, side), side], part) > 0 .and. &
            lies_against(drawn, side, part)) return
        if (loose_twin(model, drawn, mate, [outline%node(1, before), before], part) > 0 .and. &
            lies_against(drawn, before, part)) return
      end associate
    end associate
    other = 0
  end function twin_that_counts

  !> Goes the outline of a part the other way along a side?
  pure logical function lies_against(drawn, side, part)
    type(outline_shape), intent(in) :: drawn
    integer, intent(in) :: side, part
    type(near_place) :: place

    place = drawn%nearest_place(part, drawn%at(side, 0.5_wp))
    lies_against = place%distance <= coincident*norm2(drawn%chord(side)) .and. &
                   dot_product(drawn%tangent(place%side, place%s), drawn%tangent(side, 0.5_wp)) < 0.0_wp
  end function lies_against

  !> The node of a part at the place of one at the end of a side, if nothing joins the two; 0: there is none.
  pure integer function loose_twin(model, drawn, mate, end, part) result(twin)
    type(model_type), intent(in) :: model
    type(outline_shape), intent(in) :: drawn
    integer, intent(in) :: mate(:)
    integer, intent(in) :: end(2)      !! the node and the side
    integer, intent(in) :: part
    type(near_place) :: place
    logical :: joined

    place = drawn%nearest_place(part, model%x(:, end(1)))
    associate (within => coincident*norm2(drawn%chord(end(2))), node => end(1), &
               ends => model%body_outline%node(:2, place%side))
      twin = 0
      if (place%distance > within) return
      twin = merge(ends(1), ends(2), place%s < 0.5_wp)
      joined = any(model%leader(:, twin) == model%leader(:, node)) .or. is_mate(mate, [node], part) .or. &
               is_mate(mate, [twin], model%body_outline%part_of(node)) .or. all(model%held(:, [node, twin]))
      if (joined .or. norm2(model%x(:, twin) - model%x(:, node)) > within) twin = 0
    end associate
  end function loose_twin
end module epcont_contact_geometry_lying_together
