!> Edges of elements along the boundary of a body, and projections of points on them.
!>
!> The body is on the left of its edges, so the outward normal is on the right. Nodal normals are computed
!> from the two edges that meet there, and are exact on a circle (epcont_geometry_corners). Along an edge,
!> shape functions interpolate them, so that every point has one projection, and on a circle of chords or
!> parabolas all normals pass through the centre. If the edges are chords, the true boundary is the smooth
!> curve through their ends: the gap is measured to this curve (an arc over each chord), because the facets of
!> chords would show in the pressures. Force and reaction are still collinear, with their line through the
!> chord.
module epcont_geometry_boundary_line
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_geometry_box_tree, only: box_tree, new_box_tree
  use epcont_geometry_plane, only: cross_product, right_of, unit
  implicit none
  private
  public :: boundary_line, facing_type

  !> Distance beyond the end of an edge, divided by its length, that still counts as on the edge; more than
  !! the rounding of coordinates with eight columns.
  real(wp), parameter, public :: beyond = 1.0e-5_wp
  !> Steps of Newton's method (it needs five), and the change that ends it.
  integer, parameter :: most_steps = 30
  !> Largest distance of a projection along an edge [lengths of the edge].
  real(wp), parameter :: farthest = 10.0_wp
  real(wp), parameter :: converged = 1.0e-14_wp
  !> Positions whose normals show on which side of an edge a point is: beyond both ends, and the middle.
  real(wp), parameter :: tried(3) = [-10.0_wp*beyond, 1.0_wp + 10.0_wp*beyond, 0.5_wp]

  type :: boundary_line
    integer, allocatable :: segment(:, :)      !! start, end, mid-side node (or 0) of each edge [3, sides]
    integer, allocatable :: element(:)         !! element of each edge [sides]
    integer, allocatable :: neighbour(:, :)    !! previous and next edge; 0 at an end of the line [2, sides]
    real(wp), allocatable :: x(:, :, :)        !! coordinates of the nodes [length] [2, 3, sides]
    real(wp), allocatable :: normal(:, :, :)   !! outward, at start, end and middle of each edge [2, 3, sides]
    logical, allocatable :: corner(:, :)       !! start and end are corners of the boundary [2, sides]
    logical, allocatable :: tip(:, :)          !! start and end are convex corners [2, sides]
    !> Start and end lie on a line of symmetry, and the normal along that line, also if the end is a corner
    logical, allocatable :: mirrored(:, :)     !! [2, sides]
    real(wp), allocatable :: end_normal(:, :, :)   !! [2, 2, sides]
    type(box_tree), private :: tree            !! boxes of the edges
  contains
    procedure :: set_boxes
    procedure :: in_box
    procedure :: pick
    procedure :: chord_length
    procedure :: own_normal
    procedure :: face
    procedure :: at
  end type boundary_line

  !> Projection of a point on a line.
  type :: facing_type
    logical :: found = .false.
    integer :: segment = 0           !! the edge
    real(wp) :: s = 0.0_wp           !! from 0 at the start of the edge to 1 at its end, or slightly beyond
    real(wp) :: share(3) = 0.0_wp    !! shape functions of start, end and middle of the edge [-]
    real(wp) :: normal(2) = 0.0_wp   !! outward
    real(wp) :: gap = 0.0_wp         !! distance from the curve to the point along the normal [length]
    logical :: at_corner = .false.   !! projection on a corner of the boundary
  contains
    procedure :: cosine
  end type facing_type

  !> An edge with coordinates relative to its start, which are exact differences even far from the origin.
  type :: side_type
    logical :: curved = .false.             !! has a mid-side node
    real(wp) :: x(2, 3) = 0.0_wp            !! start, end and middle [length]
    real(wp) :: normal(2, 3) = 0.0_wp       !! normals there
  end type side_type

contains

  !> Compute the boxes of the edges, enlarged by half their lengths because of the curves over them.
  pure subroutine set_boxes(self)
    class(boundary_line), intent(inout) :: self
    real(wp), dimension(2, size(self%element)) :: half, middle
    integer :: i

    do i = 1, size(self%element)
      half(:, i) = self%chord_length(i)
      middle(:, i) = 0.5_wp*(self%x(:, 1, i) + self%x(:, 2, i))
    end do
    self%tree = new_box_tree(middle - half, middle + half)
  end subroutine set_boxes

  !> Edges whose boxes meet a box, in their order.
  pure function in_box(self, low, high) result(sides)
    class(boundary_line), intent(in) :: self
    real(wp), intent(in) :: low(2), high(2)   !! corners of the box [length]
    integer, allocatable :: sides(:)

    sides = self%tree%meeting(low, high)
    sides = sides(sorted_order(sides))   ! not in the order of the tree: of equal edges the first is used
  end function in_box

  !> Take some edges in the given order. Neighbours that are not among them are dropped, but their normals
  !! stay.
  pure function pick(self, sides) result(part)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: sides(:)   !! numbers of the edges
    type(boundary_line) :: part
    integer :: end, k
    integer :: number(minval(sides):maxval(sides))   ! each of many lines has its own table

    number = 0
    number(sides) = [(k, k=1, size(sides))]
    part%segment = self%segment(:, sides)
    part%element = self%element(sides)
    part%neighbour = reshape([((numbered(self%neighbour(end, sides(k))), end=1, 2), k=1, size(sides))], &
                             [2, size(sides)])
    part%x = self%x(:, :, sides)
    part%normal = self%normal(:, :, sides)
    part%corner = self%corner(:, sides)
    part%tip = self%tip(:, sides)
    part%mirrored = self%mirrored(:, sides)
    part%end_normal = self%end_normal(:, :, sides)
    call part%set_boxes()

  contains

    !> New number of an edge; 0 if it is not taken.
    pure integer function numbered(side)
      integer, intent(in) :: side

      numbered = 0
      if (side >= lbound(number, 1) .and. side <= ubound(number, 1)) numbered = number(side)
    end function numbered
  end function pick

  !> Length of an edge, from end to end [length].
  pure real(wp) function chord_length(self, segment)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! number of the edge

    chord_length = norm2(self%x(:, 2, segment) - self%x(:, 1, segment))
  end function chord_length

  !> Outward normal of an edge itself (not interpolated) at a position.
  pure function own_normal(self, segment, s) result(normal)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! number of the edge
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: normal(2)

    normal = unit(right_of(tangent_at(side_of(self, segment), s)))
  end function own_normal

  !> Project a point on an edge: find the position whose normal leads to the point.
  pure function face(self, segment, point) result(place)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! number of the edge
    real(wp), intent(in) :: point(2)    !! [length]
    type(facing_type) :: place
    type(side_type) :: side
    real(wp) :: from(2)
    integer :: end

    place%segment = segment
    side = side_of(self, segment)
    from = point - self%x(:, 1, segment)
    call find_foot(place%s, place%found)
    associate (s => place%s)
      place%found = place%found .and. s >= -beyond .and. s <= 1.0_wp + beyond
      if (.not. place%found) return
      if (s > beyond .and. s < 1.0_wp - beyond) then
        place%share = values(side, s)
        place%normal = unit(matmul(side%normal, place%share))
        place%gap = dot_product(place%normal, from - matmul(side%x, place%share)) - rise(side, s)
        return
      end if
      end = merge(1, 2, s <= beyond)
    end associate
    associate (mirrored => self%mirrored(end, segment))
      place%share(end) = 1.0_wp
      place%normal = merge(self%end_normal(:, end, segment), self%normal(:, end, segment), mirrored)
      place%gap = dot_product(place%normal, point - self%x(:, end, segment))
      place%at_corner = self%corner(end, segment) .and. .not. mirrored
    end associate

  contains

    !> Find the position whose normal leads to the point, with Newton's method. Most edges have none: the
    !! point is on one side of the normals at both ends and in the middle.
    pure subroutine find_foot(s, found)
      real(wp), intent(out) :: s      !! from 0 to 1, or beyond
      logical, intent(out) :: found   !! there is a position
      real(wp) :: away(2), normal(2), rate, step
      real(wp) :: aside(3)
      integer :: k

      associate (chord => side%x(:, 2))
        s = dot_product(from, chord)/dot_product(chord, chord)
      end associate
      found = .false.
      do k = 1, 3
        associate (n => values(side, tried(k)))
          aside(k) = cross_product(matmul(side%normal, n), from - matmul(side%x, n))
        end associate
      end do
      if (all(aside > 0.0_wp) .or. all(aside < 0.0_wp)) return
      do k = 1, most_steps
        if (abs(s) > farthest) return
        away = from - matmul(side%x, values(side, s))
        normal = matmul(side%normal, values(side, s))
        rate = cross_product(matmul(side%normal, slopes(side, s)), away) - &
               cross_product(normal, tangent_at(side, s))
        if (rate == 0.0_wp) return
        step = -cross_product(normal, away)/rate
        s = s + step
        found = abs(step) <= converged*max(1.0_wp, abs(s))
        if (found) return
      end do
      found = abs(step) <= beyond
    end subroutine find_foot
  end function face

  !> Cosine of the angle between two normals.
  elemental real(wp) function cosine(self, other)
    class(facing_type), intent(in) :: self
    class(facing_type), intent(in) :: other   !! projection on any line

    cosine = dot_product(self%normal, other%normal)
  end function cosine

  !> Shape functions, point on the smooth curve and tangent at a position of an edge.
  pure subroutine at(self, segment, s, share, x, tangent)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! number of the edge
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp), intent(out) :: share(3), x(2), tangent(2)   !! shape functions; [length]; [length]
    type(side_type) :: side

    side = side_of(self, segment)
    share = values(side, s)
    tangent = tangent_at(side, s)
    x = matmul(self%x(:, :, segment), share) + rise(side, s)*unit(matmul(side%normal, share))
  end subroutine at

  pure type(side_type) function side_of(line, segment) result(side)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: segment

    side%curved = line%segment(3, segment) > 0
    side%x = line%x(:, :, segment) - spread(line%x(:, 1, segment), 2, 3)
    if (.not. side%curved) side%x(:, 3) = 0.0_wp
    side%normal = line%normal(:, :, segment)
  end function side_of

  !> Height of the smooth curve above a chord, along its normal; exact for an arc [length].
  pure real(wp) function rise(self, s)
    type(side_type), intent(in) :: self
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: along(2), lean

    rise = 0.0_wp
    if (self%curved) return
    along = unit(self%x(:, 2))
    ! An arc of radius r is inclined by asin(chord/(2 r)) at its ends, and its height is r - sqrt(r**2 -
    ! chord**2 s (1 - s)).
    lean = s*dot_product(self%normal(:, 2), along) - (1.0_wp - s)*dot_product(self%normal(:, 1), along)
    associate (w => s*(1.0_wp - s))
      rise = 2.0_wp*norm2(self%x(:, 2))*w*lean/(1.0_wp + sqrt(max(0.0_wp, 1.0_wp - 4.0_wp*w*lean**2)))
    end associate
  end function rise

  !> Shape functions of start, end and middle.
  pure function values(self, s)
    type(side_type), intent(in) :: self
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: values(3)

    values = [1.0_wp - s, s, 0.0_wp]
    if (self%curved) values = [(1.0_wp - s)*(1.0_wp - 2.0_wp*s), s*(2.0_wp*s - 1.0_wp), 4.0_wp*s*(1.0_wp - s)]
  end function values

  !> Derivatives of the shape functions.
  pure function slopes(self, s)
    type(side_type), intent(in) :: self
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: slopes(3)

    slopes = [-1.0_wp, 1.0_wp, 0.0_wp]
    if (self%curved) slopes = [4.0_wp*s - 3.0_wp, 4.0_wp*s - 1.0_wp, 4.0_wp - 8.0_wp*s]
  end function slopes

  !> Derivative of the position with respect to s [length].
  pure function tangent_at(self, s) result(tangent)
    type(side_type), intent(in) :: self
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: tangent(2)

    tangent = matmul(self%x, slopes(self, s))
  end function tangent_at
end module epcont_geometry_boundary_line
