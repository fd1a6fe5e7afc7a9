!> Finds the outlines of all bodies from the elements, and from nothing else.
module epcont_contact_geometry_free_sides
  use epcont_base_partition, only: new_partition, partition
  use epcont_geometry_outline, only: outline_type
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_outline

  !> What is known of free sides before they are in order.
  type :: found_type
    integer :: count = 0
    integer, allocatable :: node(:, :)     !! [3, room]
    integer, allocatable :: element(:)
    integer, allocatable :: from(:, :)     !! node where the side before begins, and its element [2, room]
    integer, allocatable :: first(:)       !! those that begin at node i: first(i) to first(i + 1) - 1 [nodes + 1]
  end type found_type

  integer, parameter :: first_room = 64    !! free sides for which there is room at first

contains

  !> The outlines of a scene.
  pure function find_outline(model) result(outline)
    type(model_type), intent(in) :: model
    type(outline_type) :: outline
    type(found_type) :: found
    integer, allocatable :: before(:), after(:), order(:)
    integer :: k

    call find_free_sides(model, found)
    call find_parts(model, outline)
    allocate (before(found%count), after(found%count), source=0)
    do k = 1, found%count
      before(k) = side_at(found, found%from(1, k), found%node(1, k), found%from(2, k))
      if (before(k) > 0) after(before(k)) = k
    end do
    ! Only where elements lie on each other, and share a side the same way round, is there none: it begins anew.
    where (before == 0) before = [(k, k=1, found%count)]
    where (after == 0) after = [(k, k=1, found%count)]
    call put_in_order(outline, outline%part_of(found%node(1, :found%count)), after, order)
    outline%sides = found%count
    outline%node = found%node(:, order)
    outline%element = found%element(order)
    outline%part = outline%part_of(outline%node(1, :))
    call renumber(before, after, order, outline)
  end function find_outline

  !> All sides that one element alone has. Around a node the elements' sides to the next and from the former corner are
  !! compared: a side is shared where it is met both ways.
  pure subroutine find_free_sides(model, found)
    type(model_type), intent(in) :: model
    type(found_type), intent(out) :: found
    integer, allocatable :: element(:), from(:), to(:), side(:)
    integer :: corners, e, i, k, last, most, n, node

    most = maxval(model%around%start(2:) - model%around%start(:model%nodes))
    allocate (element(most), from(most), to(most), side(most))
    allocate (found%node(3, first_room), found%element(first_room), found%from(2, first_room))
    allocate (found%first(model%nodes + 1))
    do node = 1, model%nodes
      found%first(node) = found%count + 1
      n = 0
      do i = model%around%start(node), model%around%start(node + 1) - 1
        e = model%around%group(i)
        corners = model%corners(e)
        do k = corners, 1, -1
          if (model%connectivity(k, e) == node) exit
        end do
        if (k == 0) cycle   ! the middle of a side
        n = n + 1
        element(n) = e
        side(n) = k
        to(n) = model%connectivity(merge(k + 1, 1, k < corners), e)
        from(n) = model%connectivity(merge(k - 1, corners, k > 1), e)
      end do
      do i = 1, n
        if (place_of(to(i), from(:n)) > 0) cycle
        last = fan_end(from(:n), to(:n), i)
        call append(found, model%edge(element(i), side(i)), element(i), [from(last), element(last)])
      end do
    end do
    found%first(model%nodes + 1) = found%count + 1
  end subroutine find_free_sides

  !> Where in a list a node stands; 0: nowhere.
  pure integer function place_of(node, list) result(k)
    integer, intent(in) :: node, list(:)

    do k = size(list), 1, -1
      if (list(k) == node) return
    end do
  end function place_of

  !> From the element whose side to the next corner is free, round the node to the one whose side from the former is.
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

  !> The free side of an element from one node to another; 0: there is none.
  pure integer function side_at(found, from, to, element) result(side)
    type(found_type), intent(in) :: found
    integer, intent(in) :: from, to, element

    do side = found%first(from), found%first(from + 1) - 1
      if (found%node(2, side) == to .and. found%element(side) == element) return
    end do
    side = 0
  end function side_at

  !> Parts: the bodies, but for RBE2, numbered as their first nodes come.
  pure subroutine find_parts(model, outline)
    type(model_type), intent(in) :: model
    type(outline_type), intent(inout) :: outline
    type(partition) :: sets
    integer, allocatable :: number(:), set(:)
    integer :: e, i, k, sets_found

    if (all(model%leader(1, :) == [(i, i=1, model%nodes)]) .and. all(model%leader(2, :) == [(i, i=1, model%nodes)])) then
      set = model%body
      sets_found = model%bodies
    else
      sets = new_partition(model%nodes)
      do e = 1, model%elements
        do k = 2, model%order(e)
          call sets%join(model%connectivity(1, e), model%connectivity(k, e))
        end do
      end do
      call sets%numbers(set, sets_found)
    end if
    allocate (number(sets_found), outline%part_of(model%nodes), source=0)
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

  !> Which side is before and after each, by their new numbers.
  pure subroutine renumber(before, after, order, outline)
    integer, intent(in) :: before(:), after(:), order(:)
    type(outline_type), intent(inout) :: outline
    integer :: s, new(size(order))

    do s = 1, size(order)
      new(order(s)) = s
    end do
    outline%before = new(before(order))
    outline%after = new(after(order))
  end subroutine renumber
end module epcont_contact_geometry_free_sides
