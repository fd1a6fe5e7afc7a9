!> Finds the outlines of all bodies from the elements, and from nothing else.
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

  !> The outlines of a scene: all sides that one element alone has, part by part, and in each the one behind
  !! the other that begins where that ended.
  function find_outline(model, found) result(outline)
    type(model_type), intent(in) :: model    !! the scene
    type(findings), intent(inout) :: found   !! elements that overlap are added
    type(outline_type) :: outline
    !> Free sides as they are found, and those before them: which one of which element
    integer, dimension(2, size(model%mesh%around%group)) :: free, former
    !> The elements around a node; which of their corners it is, the next and the former one
    integer, dimension(maxval(model%mesh%around%start(2:) - model%mesh%around%start(:model%mesh%nodes))) :: &
      element, own, next, last
    !> Of the sides of each element; 0: not free
    integer :: number(maxval(model%mesh%kinds%corners), model%mesh%elements)
    integer, allocatable :: after(:), before(:), chain(:), order(:), place(:)
    integer :: over(model%mesh%elements)   ! an element with a side of it the same way round; 0: there is none
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
    ! Only where elements lie on each other, and share a side the same way round, is there none: it begins
    ! anew.
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

    !> Free sides that begin at a node. The elements' sides to the next and from the former corner are
    !! compared: a side is shared where it is met both ways; where it is met twice one way, elements overlap.
    subroutine look_around()
      integer :: corners, i, k, n

      n = 0
      do i = model%mesh%around%start(node), model%mesh%around%start(node + 1) - 1
        associate (e => model%mesh%around%group(i))
          corners = model%mesh%corners(e)
          k = place_of(node, model%mesh%connectivity(:corners, e))
          if (k == 0) cycle   ! the middle of a side
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

    !> Parts: the bodies, but for RBE2, numbered as their first nodes come.
    subroutine find_parts()
      integer, allocatable :: part(:), set(:)
      integer :: i, sets

      if (model%constraints%is_tied([(i, i=1, model%mesh%nodes)])) then
        call join_nodes(model, .false., set, sets)
      else
        set = model%mesh%body
        sets = model%mesh%bodies
      end if
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

    !> The sides, each behind the one before it, as the first of them come.
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

  !> Where in a list a node stands; 0: nowhere.
  pure integer function place_of(node, list) result(k)
    integer, intent(in) :: node, list(:)

    do k = size(list), 1, -1
      if (list(k) == node) return
    end do
  end function place_of

  !> From the element whose side to the next corner is free, round the node to the one whose side from the
  !! former is.
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
