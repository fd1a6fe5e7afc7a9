!> Outlines of the bodies in one state, undeformed or displaced: nearest point of an outline, and whether a
!> point is inside. Edges of six-node elements are parabolas.
module epcont_geometry_outline_shape
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference
  use epcont_geometry_box_tree, only: box_tree, most_waiting, new_box_tree
  use epcont_geometry_plane, only: crossing, right_of, span_along, unit
  implicit none
  private
  public :: outline_type, outline_shape, near_place, new_outline_shape

  !> Points of a curved edge that are tried first, and steps of Newton's method from the nearest of them.
  integer, parameter :: tried = 4, most_steps = 8

  !> Larger than all distances; its square does not overflow.
  real(wp), parameter :: far = 1.0e150_wp

  !> Outlines of all bodies: the edges that belong to one element only, with the body on the left, also along
  !! holes. Nodes without elements have no outline. Part 1 has the edges first(1) to first(2) - 1, and so on.
  type :: outline_type
    integer :: sides = 0
    integer :: parts = 0                   !! sets of connected elements; RBE2 does not connect
    integer, allocatable :: node(:, :)     !! start, end, and mid-side node or 0 of each edge [3, sides]
    integer, allocatable :: element(:)     !! element of each edge [sides]
    integer, allocatable :: before(:)      !! edge that ends at its start [sides]
    integer, allocatable :: after(:)       !! edge that starts at its end [sides]
    integer, allocatable :: part(:)        !! [sides]
    integer, allocatable :: first(:)       !! [parts + 1]
    integer, allocatable :: part_of(:)     !! part of each node; 0 if it has no elements [nodes]
  end type outline_type

  type :: outline_shape
    type(outline_type) :: outline
    !> Start, end and middle of each edge [length] [2, 3, sides]
    real(wp), allocatable :: x(:, :, :)
    real(wp), allocatable :: low(:, :), high(:, :)  !! box of each edge [length] [2, sides]
    type(box_tree), allocatable :: side_tree(:)  !! tree of each part; edges are counted from its first
    type(box_tree) :: part_tree                  !! tree of the boxes of the parts
  contains
    procedure :: at
    procedure :: tangent
    procedure :: chord
    procedure :: arch
    procedure :: near_side
    procedure :: nearest_place
    procedure :: is_inside
    procedure :: crossings
    procedure :: sides_meeting
  end type outline_shape

  !> Point of a part's outline that is nearest to a given point.
  type :: near_place
    integer :: side = 0                       !! 0 if not found
    real(wp) :: s = 0.0_wp                    !! position on the edge, from 0 to 1
    real(wp) :: x(2) = 0.0_wp                 !! [length]
    real(wp) :: distance = far                !! [length]
    logical :: inside = .false.               !! the given point is inside the body there
  end type near_place

contains

  !> Make the outlines with the nodes at `x`.
  pure function new_outline_shape(outline, x) result(shape)
    type(outline_type), intent(in) :: outline
    real(wp), intent(in) :: x(:, :)   !! [length] [2, nodes]
    type(outline_shape) :: shape
    real(wp) :: box(2, 2)
    integer :: p, s

    shape%outline = outline
    allocate (shape%x(2, 3, outline%sides), shape%low(2, outline%sides), shape%high(2, outline%sides))
    do s = 1, outline%sides
      associate (node => outline%node(:, s), own => shape%x(:, :, s))
        own(:, :2) = x(:, node(:2))
        own(:, 3) = 0.5_wp*(own(:, 1) + own(:, 2))
        if (node(3) > 0) own(:, 3) = x(:, node(3))
        box = span_along(own, node(3) > 0)
        shape%low(:, s) = box(:, 1)
        shape%high(:, s) = box(:, 2)
      end associate
    end do
    allocate (shape%side_tree(outline%parts))
    do p = 1, outline%parts
      associate (first => outline%first(p), last => outline%first(p + 1) - 1)
        shape%side_tree(p) = new_box_tree(shape%low(:, first:last), shape%high(:, first:last))
      end associate
    end do
    associate (tree => shape%side_tree, n => outline%parts)
      shape%part_tree = new_box_tree(reshape([(tree(p)%low(:, 1), p=1, n)], [2, n]), &
          reshape([(tree(p)%high(:, 1), p=1, n)], [2, n]))
    end associate
  end function new_outline_shape

  !> Point of an edge.
  pure function at(self, side, s) result(x)
    class(outline_shape), intent(in) :: self
    integer, intent(in) :: side   !! number of the edge
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: x(2)

    x = self%x(:, 1, side) + s*self%chord(side) + 4.0_wp*s*(1.0_wp - s)*self%arch(side)
  end function at

  !> Derivative of the position on an edge with respect to s [length].
  pure function tangent(self, side, s) result(along)
    class(outline_shape), intent(in) :: self
    integer, intent(in) :: side   !! number of the edge
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: along(2)

    along = self%chord(side) + 4.0_wp*(1.0_wp - 2.0_wp*s)*self%arch(side)
  end function tangent

  !> Vector from start to end of an edge [length].
  pure function chord(self, side)
    class(outline_shape), intent(in) :: self
    integer, intent(in) :: side   !! number of the edge
    real(wp) :: chord(2)

    chord = self%x(:, 2, side) - self%x(:, 1, side)
  end function chord

  !> Vector from the middle of the chord to the middle of the edge; zero if the edge is straight [length].
  pure function arch(self, side)
    class(outline_shape), intent(in) :: self
    integer, intent(in) :: side   !! number of the edge
    real(wp) :: arch(2)

    arch = 0.0_wp
    if (self%outline%node(3, side) > 0) &
      arch = self%x(:, 3, side) - 0.5_wp*(self%x(:, 1, side) + self%x(:, 2, side))
  end function arch

  !> Nearest point of a part's outline: branch and bound in its tree.
  pure function nearest_place(self, part, point) result(best)
    class(outline_shape), intent(in) :: self
    integer, intent(in) :: part   !! number of the part
    real(wp), intent(in) :: point(2)   !! [length]
    type(near_place) :: best
    type(near_place) :: place
    real(wp) :: away(2), bound(most_waiting)
    integer :: child(2), i, waiting(most_waiting), waits

    waiting(1) = 1
    bound(1) = 0.0_wp
    waits = 1
    associate (tree => self%side_tree(part))
      do while (waits > 0)
        i = waiting(waits)
        waits = waits - 1
        if (bound(waits + 1) > best%distance*best%distance) cycle
        if (tree%item(i) > 0) then
          place = self%near_side(self%outline%first(part) + tree%item(i) - 1, point)
          if (is_better()) best = place
          cycle
        end if
        away = [tree%away(2*i, point), tree%away(2*i + 1, point)]
        child = merge([2, 1], [1, 2], away(1) <= away(2))   ! the nearer child first
        waiting(waits + 1:waits + 2) = 2*i - 1 + child
        bound(waits + 1:waits + 2) = away(child)
        waits = waits + 2
      end do
    end associate
    best%inside = self%is_inside(best, point)

  contains

    !> Is the point nearer? If it is as near on the other edge of a slit: is the given point inside its body?
    pure logical function is_better()
      is_better = place%side /= best%side .and. place%distance <= best%distance*(1.0_wp + least_difference)
      if (.not. is_better .or. place%distance < best%distance*(1.0_wp - least_difference)) return
      is_better = self%is_inside(place, point) .and. .not. self%is_inside(best, point)
    end function is_better
  end function nearest_place

  !> Nearest point of an edge; `inside` is not set.
  pure function near_side(self, side, point) result(place)
    class(outline_shape), intent(in) :: self
    integer, intent(in) :: side   !! number of the edge
    real(wp), intent(in) :: point(2)   !! [length]
    type(near_place) :: place

    place%side = side
    if (self%outline%node(3, side) > 0) then
      place%s = near_curve()
    else
      associate (start => self%x(:, 1, side), along => self%chord(side))
        place%s = dot_product(point - start, along)/max(dot_product(along, along), tiny(1.0_wp))
        place%s = min(1.0_wp, max(0.0_wp, place%s))
      end associate
    end if
    if (place%s < least_difference) place%s = 0.0_wp
    if (1.0_wp - place%s < least_difference) place%s = 1.0_wp
    place%x = self%at(side, place%s)
    place%distance = norm2(point - place%x)

  contains

    !> Position of the nearest point on a parabola: the nearest of a few points, then Newton's method.
    pure real(wp) function near_curve() result(s)
      real(wp) :: along(2), away(2), bend(2), rate, step
      integer :: k

      k = minloc([(norm2(point - self%at(side, real(k, wp)/tried)), k=0, tried)], dim=1) - 1
      s = real(k, wp)/tried
      bend = -8.0_wp*self%arch(side)
      do k = 1, most_steps
        away = self%at(side, s) - point
        along = self%tangent(side, s)
        rate = dot_product(along, along) + dot_product(away, bend)
        if (rate <= 0.0_wp) rate = dot_product(along, along)
        if (rate == 0.0_wp) return
        step = min(1.0_wp, max(0.0_wp, s - dot_product(away, along)/rate)) - s
        s = s + step
        if (abs(step) <= epsilon(s)) return
      end do
    end function near_curve
  end function near_side

  !> Is a point inside the body, seen from the nearest point of the outline? At a node, both edges must say
  !! so.
  pure logical function is_inside(self, place, point)
    class(outline_shape), intent(in) :: self
    type(near_place), intent(in) :: place   !! nearest point of the outline
    real(wp), intent(in) :: point(2)   !! [length]
    real(wp) :: outward(2)

    outward = normal(place%side, place%s)
    if (place%s <= 0.0_wp) outward = outward + normal(self%outline%before(place%side), 1.0_wp)
    if (place%s >= 1.0_wp) outward = outward + normal(self%outline%after(place%side), 0.0_wp)
    is_inside = dot_product(outward, point - place%x) < 0.0_wp

  contains

    pure function normal(side, s)
      integer, intent(in) :: side
      real(wp), intent(in) :: s
      real(wp) :: normal(2)

      normal = unit(right_of(self%tangent(side, s)))
    end function normal
  end function is_inside

  !> Find the crossings of a straight line with the chords of a part, in ascending order.
  pure function crossings(self, part, start, along) result(s)
    class(outline_shape), intent(in) :: self
    integer, intent(in) :: part                 !! number of the part
    real(wp), intent(in) :: start(2), along(2)  !! start of the line, and vector to its end [length]
    real(wp), allocatable :: s(:)               !! along the line, from 0 to 1
    real(wp) :: at(2)   ! along the line and the chord
    integer, allocatable :: near(:)
    integer :: k

    allocate (s(0))
    near = self%sides_meeting(part, min(start, start + along), max(start, start + along))
    do k = 1, size(near)
      at = crossing(start, along, self%x(:, 1, near(k)), self%chord(near(k)))
      if (all(at >= 0.0_wp .and. at <= 1.0_wp)) s = [pack(s, s <= at(1)), at(1), pack(s, s > at(1))]
    end do
  end function crossings

  !> Find the edges of a part that meet a box.
  pure function sides_meeting(self, part, low, high) result(side)
    class(outline_shape), intent(in) :: self
    integer, intent(in) :: part             !! number of the part
    real(wp), intent(in) :: low(2), high(2)   !! of the box [length]
    integer, allocatable :: side(:)

    side = self%side_tree(part)%meeting(low, high)
    side = side + (self%outline%first(part) - 1)
  end function sides_meeting
end module epcont_geometry_outline_shape
