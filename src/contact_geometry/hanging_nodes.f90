!> Nodes that lie on a side of an element of their own body and are no nodes of it, though elements share the
!> side's ends: meshes of unlike fineness, or six-node elements beside others, put together. Nothing keeps
!> such a node on that side.
module epcont_contact_geometry_hanging_nodes
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_base_tolerances, only: coincident
  use epcont_geometry_outline_shape, only: near_place, new_outline_shape, outline_shape
  use epcont_model_finding, only: and_more, findings, of_element, of_node
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: warn_of_hanging_nodes

contains

  !> One warning, at the first of them.
  pure subroutine warn_of_hanging_nodes(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    ! Where each node hangs: the ends of the side and its element; 0: nowhere
    integer :: edge(3, model%nodes)
    integer :: first

    edge = 0
    call find_middles(model, edge)
    call find_chains(model, edge)
    if (all(edge(3, :) == 0)) return
    first = findloc(edge(3, :) > 0, .true., dim=1)
    call found%add_warning(of_node, first, 1, ': lies on side '//model%name_of(of_node, edge(1, first))// &
                           ' to '// &
                           text_of(model%node_id(edge(2, first)))//' of '// &
                           model%name_of(of_element, edge(3, first))// &
                           ' and is no node of it: the body may open there'// &
                           and_more(count(edge(3, :) > 0), '; so do ', ' more nodes'), &
                           'elements that share all nodes of their common sides')
  end subroutine warn_of_hanging_nodes

  !> Middles of sides that an element with another middle, or none, has too. A middle of two elements hangs
  !! nowhere.
  pure subroutine find_middles(model, edge)
    type(model_type), intent(in) :: model
    integer, intent(inout) :: edge(:, :)
    integer :: e, i, s, side(3)

    do i = 1, model%nodes
      associate (first => model%around%start(i), last => model%around%start(i + 1) - 1)
        if (first /= last .or. model%is_tied([i])) cycle
        e = model%around%group(first)
      end associate
      do s = 1, model%corners(e)
        side = model%edge(e, s)
        if (side(3) == i) edge(:, i) = [side(:2), other_of(model, e, side)]
      end do
    end do
  end subroutine find_middles

  !> Another element that has a side with these ends; 0: there is none.
  pure integer function other_of(model, element, side) result(other)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element, side(3)
    integer :: k

    do k = model%around%start(side(1)), model%around%start(side(1) + 1) - 1
      other = model%around%group(k)
      if (other /= element .and. model%side_between(other, side(1), side(2)) > 0) return
    end do
    other = 0
  end function other_of

  !> Sides of the outline that go back along a longer one, from its end to its start.
  pure subroutine find_chains(model, edge)
    type(model_type), intent(in) :: model
    integer, intent(inout) :: edge(:, :)
    type(outline_shape) :: drawn
    integer :: first(model%nodes), next(model%body_outline%sides)   ! of the sides that begin at a node
    integer :: s, t

    associate (outline => model%body_outline)
      first = 0
      do s = outline%sides, 1, -1
        next(s) = first(outline%node(1, s))
        first(outline%node(1, s)) = s
      end do
      do s = 1, outline%sides
        t = first(outline%node(2, s))
        do while (t > 0)
          if (goes_back(model, s, t)) then
            if (.not. allocated(drawn%x)) drawn = new_outline_shape(outline, model%x)
            call follow(model, drawn, s, t, edge)
          end if
          t = next(t)
        end do
      end do
    end associate
  end subroutine find_chains

  !> Is a side shorter than the one at whose end it begins, of another element, and leads back along it?
  pure logical function goes_back(model, side, beside)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side, beside
    real(wp) :: a(2), b(2)

    goes_back = model%body_outline%element(side) /= model%body_outline%element(beside)
    if (.not. goes_back) return   ! a sliver
    associate (node => model%body_outline%node, x => model%x)
      a = x(:, node(2, side)) - x(:, node(1, side))
      b = x(:, node(2, beside)) - x(:, node(1, beside))
    end associate
    goes_back = dot_product(a, b) < -0.5_wp*norm2(a)*norm2(b) .and. norm2(b) < norm2(a)
  end function goes_back

  !> From the end of a side back to its start: what lies on it between, and is no node of it, hangs.
  pure subroutine follow(model, drawn, side, from, edge)
    type(model_type), intent(in) :: model
    type(outline_shape), intent(in) :: drawn
    integer, intent(in) :: side, from
    integer, intent(inout) :: edge(:, :)
    type(near_place) :: place
    integer :: last, t

    associate (outline => model%body_outline)
      last = from
      do while (outline%node(2, last) /= outline%node(1, side))
        associate (node => outline%node(2, last))
          place = drawn%near_side(side, model%x(:, node))
          if (place%distance > coincident*norm2(drawn%chord(side)) .or. place%s <= 0.0_wp .or. &
              place%s >= 1.0_wp) return
        end associate
        last = outline%after(last)
        if (last == from) return
      end do
      t = from
      do while (t /= last)
        associate (node => outline%node(2, t))
          if (node /= outline%node(3, side) .and. .not. model%is_tied([node])) &
            edge(:, node) = [outline%node(:2, side), outline%element(side)]
        end associate
        t = outline%after(t)
      end do
    end associate
  end subroutine follow
end module epcont_contact_geometry_hanging_nodes
