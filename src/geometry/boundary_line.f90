!> Sides of elements along the boundary of a body, where a point faces them, and which of them lie near by.
!>
!> Sides are walked with the body to the left, so that outward is to the right. Normals at the nodes come from
!> the two sides that meet there, exact on a circle (epcont_geometry_corners); along a side they turn from one
!> to the other by its shape functions, so that none is met twice and none left out, and that on a circle, of
!> chords or of parabolas, all pass through its centre. Where sides are chords, the boundary that is
!> meant is the smooth curve through their ends: the gap is measured to it (an arc over each chord) and not to
!> the chord, whose facets would show in the pressures. Force and counterforce still lie on one line, through
!> the chord.
module epcont_geometry_boundary_line
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_geometry_box_tree, only: box_query, box_tree, new_box_tree
  use epcont_geometry_plane, only: cross_product, right_of, span_along, unit
  implicit none
  private
  public :: boundary_line, facing_type

  !> Part of a side by which a point may stand beyond its end, more than the rounding of coordinates in eight
  !! columns.
  real(wp), parameter, public :: beyond = 1.0e-5_wp
  !> Steps of Newton's method, which needs five, and the change that ends it.
  integer, parameter :: most_steps = 30
  !> So many sides away along a side nothing is faced.
  real(wp), parameter :: farthest = 10.0_wp
  real(wp), parameter :: converged = 1.0e-14_wp

  type :: boundary_line
    integer, allocatable :: segment(:, :)      !! nodes of each side: start, end, and middle or 0 [3, sides]
    integer, allocatable :: element(:)         !! whose sides they are [sides]
    integer, allocatable :: neighbour(:, :)    !! the sides before and after each, 0: there is none [2, sides]
    real(wp), allocatable :: x(:, :, :)        !! coordinates of the nodes [length] [2, 3, sides]
    real(wp), allocatable :: normal(:, :, :)   !! outward, at start, end and middle of each side [2, 3, sides]
    logical, allocatable :: corner(:, :)       !! its start, its end is a corner of the boundary [2, sides]
    logical, allocatable :: tip(:, :)          !! and a convex one [2, sides]
    !> Its start, its end lies on a line of symmetry, and the normal there: within that line, though it be a
    !! corner.
    logical, allocatable :: mirrored(:, :)     !! [2, sides]
    real(wp), allocatable :: end_normal(:, :, :)   !! [2, 2, sides]
    type(box_tree), private :: tree            !! of boxes round the sides, with their normals
  contains
    procedure :: set_boxes
    procedure :: in_box
    procedure :: box_of
    procedure :: normals_of
    procedure :: pick
    procedure :: chord_length
    procedure :: own_normal
    procedure :: face
    procedure :: at
  end type boundary_line

  !> Where a point faces a line.
  type :: facing_type
    logical :: found = .false.
    logical :: same_way = .false.    !! it does not, but a side near by looks the same way
    integer :: segment = 0           !! the side
    real(wp) :: s = 0.0_wp           !! from 0 at the start of the side to 1 at its end; or just beyond
    real(wp) :: share(3) = 0.0_wp    !! of start, end and middle of the side in the place [-]
    real(wp) :: normal(2) = 0.0_wp   !! outward
    real(wp) :: gap = 0.0_wp         !! from the curve to the point, along the normal [length]
    logical :: at_corner = .false.   !! the place is a corner of the boundary
  contains
    procedure :: cosine
  end type facing_type

  !> One side, seen from its start: far from the origin its coordinates are exact differences.
  type :: side_type
    logical :: curved = .false.             !! it has a middle node
    real(wp) :: x(2, 3) = 0.0_wp            !! of start, end and middle [length]
    real(wp) :: normal(2, 3) = 0.0_wp       !! there
  end type side_type

contains

  !> Put boxes round the sides.
  pure subroutine set_boxes(self)
    class(boundary_line), intent(inout) :: self
    real(wp), dimension(2, 2, size(self%element)) :: box, normals
    integer :: i

    do i = 1, size(self%element)
      box(:, :, i) = self%box_of(i)
      normals(:, :, i) = self%normals_of(i)
    end do
    self%tree = new_box_tree(box(:, 1, :), box(:, 2, :))
    call self%tree%set_spans(normals)
  end subroutine set_boxes

  !> Low and high corner of a side's box, beyond it by half of its length, as the curve over it may be.
  pure function box_of(self, side) result(box)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: side   !! which side
    real(wp) :: box(2, 2)   !! [length]

    box(:, 1) = 0.5_wp*(self%x(:, 1, side) + self%x(:, 2, side)) - self%chord_length(side)
    box(:, 2) = 0.5_wp*(self%x(:, 1, side) + self%x(:, 2, side)) + self%chord_length(side)
  end function box_of

  !> Least and largest components of the normals along a side, and somewhat beyond its ends.
  pure function normals_of(self, side) result(normals)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: side   !! which side
    real(wp) :: normals(2, 2)

    normals = span_along(self%normal(:, :, side), self%segment(3, side) > 0)
    normals = normals + 10.0_wp*beyond*spread([-1.0_wp, 1.0_wp], 1, 2)
  end function normals_of

  !> The sides whose boxes are looked for, in their order. Their vectors are their normals.
  pure function in_box(self, query) result(sides)
    class(boundary_line), intent(in) :: self
    class(box_query), intent(in) :: query   !! which boxes
    integer, allocatable :: sides(:)

    sides = self%tree%meeting(query)
    sides = sides(sorted_order(sides))   ! not by the tree's: of equal ones the first counts
  end function in_box

  !> Some of the sides, in the order given; what lies beyond the ends is forgotten, but for the normals.
  pure function pick(self, sides) result(part)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: sides(:)   !! their numbers
    type(boundary_line) :: part
    integer :: end, k
    integer :: number(minval(sides):maxval(sides))   ! of many lines each has its own

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

    !> The new number of a side; 0: it is none of them.
    pure integer function numbered(side)
      integer, intent(in) :: side

      numbered = 0
      if (side >= lbound(number, 1) .and. side <= ubound(number, 1)) numbered = number(side)
    end function numbered
  end function pick

  !> Length of a side, from end to end [length].
  pure real(wp) function chord_length(self, segment)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! which side

    chord_length = norm2(self%x(:, 2, segment) - self%x(:, 1, segment))
  end function chord_length

  !> Outward normal of a side itself, at a place from 0 to 1.
  pure function own_normal(self, segment, s) result(normal)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! which side
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: normal(2)

    normal = unit(right_of(tangent_at(side_of(self, segment), s)))
  end function own_normal

  !> Where a point faces a side: the place whose normal leads to it.
  pure function face(self, segment, point) result(place)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! which side
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

    !> The place whose normal leads to the point, by Newton's method.
    pure subroutine find_foot(s, found)
      real(wp), intent(out) :: s      !! from 0 to 1, or beyond
      logical, intent(out) :: found   !! there is one
      real(wp) :: away(2), normal(2), rate, step
      integer :: k

      associate (chord => side%x(:, 2))
        s = dot_product(from, chord)/dot_product(chord, chord)
      end associate
      found = .false.
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

  !> Cosine of the angle between the normals of two places.
  elemental real(wp) function cosine(self, other)
    class(facing_type), intent(in) :: self
    class(facing_type), intent(in) :: other   !! of whatever line

    cosine = dot_product(self%normal, other%normal)
  end function cosine

  !> Shape functions, place on the smooth curve and tangent at a place of a side.
  pure subroutine at(self, segment, s, share, x, tangent)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! which side
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

  !> How far along its normal the smooth curve rises above a chord: exactly where the normals at the ends are
  !! those of an arc [length].
  pure real(wp) function rise(self, s)
    type(side_type), intent(in) :: self
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: along(2), lean

    rise = 0.0_wp
    if (self%curved) return
    along = unit(self%x(:, 2))
    ! An arc of radius r leans by asin(chord/(2 r)) at its ends, and is r - sqrt(r**2 - chord**2 s (1 - s))
    ! above.
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

  !> What they change by along the side.
  pure function slopes(self, s)
    type(side_type), intent(in) :: self
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: slopes(3)

    slopes = [-1.0_wp, 1.0_wp, 0.0_wp]
    if (self%curved) slopes = [4.0_wp*s - 3.0_wp, 4.0_wp*s - 1.0_wp, 4.0_wp - 8.0_wp*s]
  end function slopes

  !> Along the side, as long as it would be if it were straight on from there [length].
  pure function tangent_at(self, s) result(tangent)
    type(side_type), intent(in) :: self
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: tangent(2)

    tangent = matmul(self%x, slopes(self, s))
  end function tangent_at
end module epcont_geometry_boundary_line
