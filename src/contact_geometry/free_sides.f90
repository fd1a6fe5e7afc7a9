!> Outlines of all bodies, found from the elements alone.
module epcont_contact_geometry_free_sides
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_geometry_outline_shape, only: outline_type
  use epcont_model_element_shapes, only: check_overlaps
  use epcont_model_finding, only: findings
  use epcont_model_model, only: model_type
  use epcont_model_freedoms, only: join_nodes
  implicit none
  private
  public :: find_outline

contains

  !> Find the outlines of a model: all edges that belong to one element only, part by part, each followed by
  !! the edge that begins at its end.
  function find_outline(model, found) result(outline)
    type(model_type), intent(in) :: model    !! the model
    type(findings), intent(inout) :: found   !! elements that overlap are added
    type(outline_type) :: outline
    !> Free edges, and their predecessors: number of the edge, element
    integer, dimension(2, size(model%mesh%around%group)) :: free, former
    !> Elements around a node; index of the node among their corners, and the next and the former corner
    integer, dimension(maxval(model%mesh%around%start(2:) - model%mesh%around%start(:model%mesh%nodes))) :: &
      element, own, next, last
    !> Numbers of the edges of each element; 0: not free
    integer :: number(maxval(model%mesh%kinds%corners), model%mesh%elements)
    integer, allocatable :: after(:), before(:), chain(:), order(:), place(:)
    integer :: over(model%mesh%elements)   ! an element with an edge in the same direction, 0 if absent
    type(incidence) :: by_part
    integer :: k, node, sides

    over = 0
    number = 0
    sides = 0
    do node = 1, model%mesh%nodes
      call look_around()
    end do
    call check_overlaps(model, over, found)
    before = [(number(former(1, k), former(2, k)), k=1, sides)]
    ! If elements overlap and share an edge in the same direction, an edge may have no successor: it begins
    ! a new chain.
    after = [(k, k=1, sides)]
    where (before == 0) before = after
    do k = 1, sides
      if (before(k) /= k) after(before(k)) = k
    end do
    chain = chained()
    call find_parts()
    outline%sides = sides
    outline%node = reshape([(model%mesh%edge(free(2, k), free(1, k)), k=1, sides)], [3, sides])
    outline%part = outline%part_of(outline%node(1, :))
    by_part = new_incidence(reshape(outline%part(chain), [1, sides]), outline%parts)
    order = chain(by_part%group)
    outline%first = by_part%start
    outline%node = outline%node(:, order)
    outline%part = outline%part(order)
    outline%element = free(2, order)
    allocate (place(sides))
    place(order) = [(k, k=1, sides)]
    outline%before = place(before(order))
    outline%after = place(after(order))

  contains

    !> Find free edges that begin at a node. The elements' edges to the next and from the former corner are
    !! compared: an inner edge occurs in both directions; if one direction occurs twice, elements overlap.
    subroutine look_around()
      integer :: corners, i, k, n

      n = 0
      do i = model%mesh%around%start(node), model%mesh%around%start(node + 1) - 1
        associate (e => model%mesh%around%group(i))
          corners = model%mesh%corners(e)
          k = place_of(node, model%mesh%connectivity(:corners, e))
          if (k == 0) cycle   ! a mid-side node
          n = n + 1
          element(n) = e
          own(n) = k
          next(n) = model%mesh%connectivity(mod(k, corners) + 1, e)
          last(n) = model%mesh%connectivity(mod(k + corners - 2, corners) + 1, e)
        end associate
      end do
      do i = 1, n
        k = place_of(next(i), next(:i - 1))
        if (k > 0) over(element(i)) = element(k)
        if (place_of(next(i), last(:n)) > 0) cycle
        k = fan_end(last(:n), next(:n), i)
        corners = model%mesh%corners(element(k))
        sides = sides + 1
        free(:, sides) = [own(i), element(i)]
        former(:, sides) = [mod(own(k) + corners - 2, corners) + 1, element(k)]
        number(own(i), element(i)) = sides
      end do
    end subroutine look_around

    !> Find parts: bodies without the effect of RBE2, numbered by their first nodes.
    subroutine find_parts()
      integer, allocatable :: part(:), set(:)
      integer :: i, sets

      call join_nodes(model, .false., set, sets)
      allocate (part(sets), outline%part_of(model%mesh%nodes), source=0)
      do i = 1, model%mesh%nodes
        if (model%mesh%around%start(i) == model%mesh%around%start(i + 1)) cycle
        if (part(set(i)) == 0) then
          outline%parts = outline%parts + 1
          part(set(i)) = outline%parts
        end if
        outline%part_of(i) = part(set(i))
      end do
    end subroutine find_parts

    !> List the edges, each after its predecessor, in the order of first edges.
    pure function chained() result(chain)
      integer :: chain(sides), k, n, s
      logical :: done(sides)

      done = .false.
      n = 0
      do s = 1, sides
        k = s
        do while (.not. done(k))
          done(k) = .true.
          n = n + 1
          chain(n) = k
          k = after(k)
        end do
      end do
    end function chained
  end function find_outline

  !> Position of a node in a list; 0 if absent.
  pure integer function place_of(node, list) result(k)
    integer, intent(in) :: node, list(:)

    do k = size(list), 1, -1
      if (list(k) == node) return
    end do
  end function place_of

  !> From the element whose edge to the next corner is free, go around the node to the element whose edge from
  !! the former corner is free.
  pure integer function fan_end(from, to, first) result(last)
    integer, intent(in) :: from(:), to(:)
    integer, intent(in) :: first
    integer :: beside, step

    last = first
    do step = 1, size(from)
      beside = place_of(from(last), to)
      if (beside == 0) return
      last = beside
    end do
  end function fan_end
end module epcont_contact_geometry_free_sides
