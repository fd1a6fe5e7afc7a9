!> The outline of all bodies: the sides that one element alone has, walked end to end.
module epcont_model_outline
  use epcont_base_kinds, only: wp
  use epcont_model_boundary_line, only: boundary_line
  use epcont_model_corners, only: find_normals
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_outline

contains

  !> All sides of the boundary, with the body to the left, in the order in which they are walked; with their normals.
  pure function find_outline(model, angle) result(outline)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: angle            !! of PARAM CORNER [degree]; 0: not given
    type(boundary_line) :: outline
    integer, allocatable :: side(:, :)       !! element, which of its sides, and the free side after it [3, sides]
    integer, allocatable :: order(:), number(:)
    integer :: i, k, n

    call find_free_sides(model, side)
    n = size(side, 2)
    call walk(side(3, :), order)
    allocate (number(0:n), source=0)
    number(order) = [(i, i=1, n)]
    outline%element = side(1, order)
    allocate (outline%segment(3, n), outline%neighbour(2, n), source=0)
    allocate (outline%x(2, 3, n), source=0.0_wp)
    do i = 1, n
      outline%segment(:, i) = model%edge(side(1, order(i)), side(2, order(i)))
      outline%neighbour(2, i) = number(side(3, order(i)))
      outline%neighbour(1, outline%neighbour(2, i)) = i
      do k = 1, 3
        if (outline%segment(k, i) > 0) outline%x(:, k, i) = model%x(:, outline%segment(k, i))
      end do
    end do
    call find_normals(outline, reshape([(held_direction(model, outline%segment(:2, i)), i=1, n)], [2, n]), angle)
  end function find_outline

  !> The one direction in which each node, or what it is tied to, is held without the other; else 0.
  pure function held_direction(model, node) result(direction)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node(2)
    integer :: direction(2)
    logical :: held(2)
    integer :: c, k

    direction = 0
    do k = 1, 2
      held = [(model%held(c, model%leader(c, node(k))), c=1, 2)]
      if (count(held) == 1) direction(k) = findloc(held, .true., dim=1)
    end do
  end function held_direction

  !> Sides without an element on the other side, each with the one that follows it.
  pure subroutine find_free_sides(model, side)
    type(model_type), intent(in) :: model
    integer, allocatable, intent(out) :: side(:, :)
    integer, allocatable :: at(:, :)   !! number of each side of each element, 0: not free
    integer :: e, k, n

    allocate (at(maxval(model%order), model%elements), source=0)
    allocate (side(3, 64), source=0)
    n = 0
    do e = 1, model%elements
      do k = 1, model%corners(e)
        if (next_around(model, e, k) > 0) cycle
        if (n == size(side, 2)) side = reshape([side, 0*side], [3, 2*n])   ! room for twice as many
        n = n + 1
        side(:, n) = [e, k, 0]
        at(k, e) = n
      end do
    end do
    side = side(:, :n)
    do n = 1, size(side, 2)
      side(3, n) = following(model, at, side(1, n), side(2, n))
    end do
  end subroutine find_free_sides

  !> The free side behind another: from element to element round the node at its end, within the body there.
  pure integer function following(model, at, element, which)
    type(model_type), intent(in) :: model
    integer, intent(in) :: at(:, :), element, which
    integer :: e, k, last, turn

    e = element
    k = which
    do turn = 1, model%elements
      k = mod(k, model%corners(e)) + 1   ! the next side of the element, which begins where the last ended
      following = at(k, e)
      if (following > 0) return
      last = e
      e = next_around(model, last, k)
      k = findloc(model%connectivity(:model%corners(e), e), model%connectivity(k, last), dim=1)   ! begins there
      ! Of the element beyond, the side they share ends at the node.
      k = modulo(k - 2, model%corners(e)) + 1
    end do
    following = at(which, element)   ! elements that lie on each other: no way round
  end function following

  !> The element on the other side of a side; 0: there is none.
  pure integer function next_around(model, element, which) result(other)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element, which
    integer :: i, k

    associate (n => model%corners(element), node => model%connectivity(:, element))
      associate (a => node(which), b => node(mod(which, n) + 1))
        do i = model%around%start(a), model%around%start(a + 1) - 1
          other = model%around%group(i)
          do k = 1, model%corners(other)
            if (model%connectivity(k, other) /= b) cycle
            if (model%connectivity(mod(k, model%corners(other)) + 1, other) == a) return
          end do
        end do
      end associate
    end associate
    other = 0
  end function next_around

  !> Loop after loop, each from its first side.
  pure subroutine walk(next, order)
    integer, intent(in) :: next(:)
    integer, allocatable, intent(out) :: order(:)
    logical :: met(size(next))
    integer :: i, k, n

    allocate (order(size(next)))
    met = .false.
    n = 0
    do i = 1, size(next)
      k = i
      do while (.not. met(k))
        met(k) = .true.
        n = n + 1
        order(n) = k
        k = next(k)
      end do
    end do
  end subroutine walk
end module epcont_model_outline
