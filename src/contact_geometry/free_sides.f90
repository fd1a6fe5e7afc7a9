!> Finds the outlines of all bodies from the elements, and from nothing else.
module epcont_contact_geometry_free_sides
  use epcont_geometry_outline, only: outline_type
  use epcont_model_model, only: model_type
  use epcont_model_ties, only: join_nodes
  implicit none
  private
  public :: find_outline

  !> What is known of free sides before they are in order.
  type :: found_type
    integer :: count = 0
    integer, allocatable :: node(:, :)     !! [3, room]
    integer, allocatable :: element(:)     !! [room]
    integer, allocatable :: from(:, :)     !! the side before: which of its element, and that [2, room]
    integer, allocatable :: number(:, :)   !! of the sides of each element; 0: not free [corners, elements]
  end type found_type

  integer, parameter :: first_room = 64    !! free sides for which there is room at first

contains

  !> The outlines of a scene.
  pure function find_outline(model) result(outline)
    type(model_type), intent(in) :: model   !! the scene
    type(outline_type) :: outline
    type(found_type) :: found
    integer, allocatable :: before(:), after(:), order(:), place(:)
    integer :: k

    call find_free_sides(model, found)
    call find_parts(model, outline)
    before = [(found%number(found%from(1, k), found%from(2, k)), k=1, found%count)]
    ! Only where elements lie on each other, and share a side the same way round, is there none: it begins
    ! anew.
    after = [(k, k=1, found%count)]
    where (before == 0) before = after
    do k = 1, found%count
      if (before(k) /= k) after(before(k)) = k
    end do
    call put_in_order(outline, outline%part_of(found%node(1, :found%count)), after, order)
    outline%sides = found%count
    outline%node = found%node(:, order)
    outline%element = found%element(order)
    outline%part = outline%part_of(outline%node(1, :))
    allocate (place(found%count))
    place(order) = [(k, k=1, found%count)]
    outline%before = place(before(order))
    outline%after = place(after(order))
  end function find_outline

  !> All sides that one element alone has. Around a node the elements' sides to the next and from the former
  !! corner are compared: a side is shared where it is met both ways.
  pure subroutine find_free_sides(model, found)
    type(model_type), intent(in) :: model
    type(found_type), intent(out) :: found
    integer, allocatable :: element(:), from(:), to(:), side(:)
    integer :: corners, e, i, last, most, n, node

    most = maxval(model%around%start(2:) - model%around%start(:model%nodes))
    allocate (element(most), from(most), to(most), side(most))
    allocate (found%node(3, first_room), found%element(first_room), found%from(2, first_room))
    allocate (found%number(maxval(model%kinds%corners), model%elements), source=0)
    do node = 1, model%nodes
      n = 0
      do i = model%around%start(node), model%around%start(node + 1) - 1
        e = model%around%group(i)
        corners = model%corners(e)
        side(n + 1) = place_of(node, model%connectivity(:corners, e))
        if (side(n + 1) == 0) cycle   ! the middle of a side
        n = n + 1
        element(n) = e
        to(n) = model%connectivity(mod(side(n), corners) + 1, e)
        from(n) = model%connectivity(former(side(n), corners), e)
      end do
      do i = 1, n
        if (place_of(to(i), from(:n)) > 0) cycle
        last = fan_end(from(:n), to(:n), i)
        call append(found, model%edge(element(i), side(i)), element(i), &
                    [former(side(last), model%corners(element(last))), element(last)])
        found%number(side(i), element(i)) = found%count
      end do
    end do
  end subroutine find_free_sides

  !> The corner before one, and the side that begins there.
  pure integer function former(side, corners)
    integer, intent(in) :: side, corners

    former = mod(side + corners - 2, corners) + 1
  end function former

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

  pure subroutine append(found, node, element, from)
    type(found_type), intent(inout) :: found
    integer, intent(in) :: node(3), element, from(2)

    associate (n => found%count)
      if (n == size(found%element)) then   ! room for twice as many
        found%node = reshape([found%node, found%node], [3, 2*n])
        found%from = reshape([found%from, found%from], [2, 2*n])
        found%element = [found%element, found%element]
      end if
      n = n + 1
      found%node(:, n) = node
      found%element(n) = element
      found%from(:, n) = from
    end associate
  end subroutine append

  !> Parts: the bodies, but for RBE2, numbered as their first nodes come.
  pure subroutine find_parts(model, outline)
    type(model_type), intent(in) :: model
    type(outline_type), intent(inout) :: outline
    integer, allocatable :: number(:), set(:)
    integer :: i, sets

    if (model%is_tied([(i, i=1, model%nodes)])) then
      call join_nodes(model, .false., set, sets)
    else
      set = model%body
      sets = model%bodies
    end if
    allocate (number(sets), outline%part_of(model%nodes), source=0)
    do i = 1, model%nodes
      if (model%around%start(i) == model%around%start(i + 1)) cycle
      if (number(set(i)) == 0) then
        outline%parts = outline%parts + 1
        number(set(i)) = outline%parts
      end if
      outline%part_of(i) = number(set(i))
    end do
  end subroutine find_parts

  !> The sides part by part, and in each the one that begins where the last ended.
  pure subroutine put_in_order(outline, part, after, order)
    type(outline_type), intent(inout) :: outline
    integer, intent(in) :: part(:), after(:)   !! of each side
    integer, allocatable, intent(out) :: order(:)
    integer, allocatable :: next(:)
    logical :: done(size(part))
    integer :: k, s

    allocate (outline%first(outline%parts + 1), source=0)
    outline%first(1) = 1
    do s = 1, size(part)
      outline%first(part(s) + 1) = outline%first(part(s) + 1) + 1
    end do
    do k = 1, outline%parts
      outline%first(k + 1) = outline%first(k + 1) + outline%first(k)
    end do
    next = outline%first
    allocate (order(size(part)))
    done = .false.
    do s = 1, size(part)
      k = s
      do while (.not. done(k))
        done(k) = .true.
        order(next(part(s))) = k
        next(part(s)) = next(part(s)) + 1
        k = after(k)
      end do
    end do
  end subroutine put_in_order
end module epcont_contact_geometry_free_sides
