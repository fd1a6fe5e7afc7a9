!> Sides of elements along the boundary of a body, and where a point faces them.
!>
!> Sides are walked with the body to the left, so that outward is to the right. Normals at the nodes come from
!> the two sides that meet there, exact on a circle (epcont_geometry_corners); along a side they turn from one
!> to the other, so that none is met twice and none left out. Where sides are chords, the boundary that is
!> meant is the smooth curve through their ends: the gap is measured to it (an arc over each chord) and not to
!> the chord, whose facets would show in the pressures. Force and counterforce still lie on one line, through
!> the chord.
module epcont_geometry_boundary_line
  use epcont_base_kinds, only: wp
  use epcont_geometry_plane, only: cross_product
  implicit none
  private
  public :: boundary_line, facing_place, unit

  !> Part of a side by which a point may stand beyond its end, more than the rounding of coordinates in eight
  !! columns.
  real(wp), parameter, public :: beyond = 1.0e-5_wp
  !> Steps of Newton's method, which needs five, and the change that ends it.
  integer, parameter :: most_steps = 30
  real(wp), parameter :: converged = 1.0e-14_wp

  type :: boundary_line
    integer, allocatable :: segment(:, :)      !! nodes of each side: start, end, and middle or 0 [3, sides]
    integer, allocatable :: element(:)         !! whose sides they are [sides]
    integer, allocatable :: neighbour(:, :)    !! the sides before and after each, 0: there is none [2, sides]
    real(wp), allocatable :: x(:, :, :)        !! coordinates of the nodes [length] [2, 3, sides]
    real(wp), allocatable :: normal(:, :, :)   !! outward, at start and end of each side [2, 2, sides]
    logical, allocatable :: corner(:, :)       !! its start, its end is a corner of the boundary [2, sides]
    logical, allocatable :: tip(:, :)          !! and a convex one [2, sides]
    !> Its start, its end lies on a line of symmetry, and the normal there: within that line, though it be a
    !! corner.
    logical, allocatable :: mirrored(:, :)     !! [2, sides]
    real(wp), allocatable :: end_normal(:, :, :)   !! [2, 2, sides]
  contains
    procedure :: pick
    procedure :: longest
    procedure :: chord_length
    procedure :: own_normal
    procedure :: outward
    procedure :: face
    procedure :: foot
    procedure :: at
  end type boundary_line

  !> Where a point faces a line.
  type :: facing_place
    logical :: found = .false.
    real(wp) :: share(3) = 0.0_wp    !! of start, end and middle of the side in the place [-]
    real(wp) :: normal(2) = 0.0_wp   !! outward
    real(wp) :: gap = 0.0_wp         !! from the curve to the point, along the normal [length]
    logical :: at_corner = .false.   !! the place is a corner of the boundary
  end type facing_place

contains

  !> Some of the sides, in the order given; what lies beyond the ends is forgotten, but for the normals.
  pure function pick(self, sides) result(part)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: sides(:)   !! their numbers
    type(boundary_line) :: part
    integer :: k, number(0:size(self%element))

    number = 0
    number(sides) = [(k, k=1, size(sides))]
    part%segment = self%segment(:, sides)
    part%element = self%element(sides)
    part%neighbour = reshape(number([self%neighbour(:, sides)]), [2, size(sides)])
    part%x = self%x(:, :, sides)
    part%normal = self%normal(:, :, sides)
    part%corner = self%corner(:, sides)
    part%tip = self%tip(:, sides)
    part%mirrored = self%mirrored(:, sides)
    part%end_normal = self%end_normal(:, :, sides)
  end function pick

  !> Outward normal of a side itself, at a place from 0 to 1.
  pure function own_normal(self, segment, s) result(normal)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! which side
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp) :: normal(2), tangent(2)

    tangent = matmul(local(self, segment), slopes(self%segment(3, segment) > 0, s))
    normal = unit([tangent(2), -tangent(1)])
  end function own_normal

  !> Length of a side, from end to end [length].
  pure real(wp) function chord_length(self, segment)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! which side

    chord_length = norm2(self%x(:, 2, segment) - self%x(:, 1, segment))
  end function chord_length

  !> Length of the longest side, from end to end [length].
  pure real(wp) function longest(self)
    class(boundary_line), intent(in) :: self
    integer :: i

    longest = 0.0_wp
    do i = 1, size(self%element)
      longest = max(longest, chord_length(self, i))
    end do
  end function longest

  !> Outward normal at a node of a side: 1 its start, 2 its end, 3 its middle; at a corner the side's own.
  pure function outward(self, segment, which) result(normal)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment, which   !! side; 1 its start, 2 its end, 3 its middle
    real(wp) :: normal(2)

    if (which == 3) then
      normal = self%own_normal(segment, 0.5_wp)
    else
      normal = self%normal(:, which, segment)
    end if
  end function outward

  !> Where a point faces a side: the place whose normal leads to it.
  pure function face(self, segment, point) result(place)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! which side
    real(wp), intent(in) :: point(2)    !! [length]
    type(facing_place) :: place
    real(wp) :: s
    logical :: curved, found

    curved = self%segment(3, segment) > 0
    call find_foot(self, segment, point, s, found)
    if (.not. found .or. s < -beyond .or. s > 1.0_wp + beyond) return
    place%found = .true.
    if (s <= beyond) then
      call face_end(self, segment, 1, point, place)
    else if (s >= 1.0_wp - beyond) then
      call face_end(self, segment, 2, point, place)
    else
      place%share = values(curved, s)
      place%normal = unit(scaled_normal(self, segment, s))
      place%gap = dot_product(place%normal, point - self%x(:, 1, segment) - &
                              matmul(local(self, segment), place%share))
      if (.not. curved) place%gap = place%gap - rise(self, segment, s)
    end if
  end function face

  !> A point faces the start (1) or the end (2) of a side.
  pure subroutine face_end(line, segment, which, point, place)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: segment, which
    real(wp), intent(in) :: point(2)
    type(facing_place), intent(inout) :: place

    place%share(which) = 1.0_wp
    place%normal = line%normal(:, which, segment)
    if (line%mirrored(which, segment)) place%normal = line%end_normal(:, which, segment)
    place%gap = dot_product(place%normal, point - line%x(:, which, segment))
    place%at_corner = line%corner(which, segment) .and. .not. line%mirrored(which, segment)
  end subroutine face_end

  !> The place of a side, from 0 to 1, that a point within a distance of it faces.
  pure subroutine foot(self, segment, point, distance, s, found)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! which side
    real(wp), intent(in) :: point(2), distance   !! [length]
    real(wp), intent(out) :: s   !! from 0 to 1
    logical, intent(out) :: found   !! there is one

    real(wp) :: share(3), tangent(2), x(2)

    found = .false.
    s = 0.0_wp
    associate (a => self%x(:, 1, segment), b => self%x(:, 2, segment))
      if (any(abs(point - 0.5_wp*(a + b)) > distance + norm2(b - a))) return
    end associate
    call find_foot(self, segment, point, s, found)
    found = found .and. s >= 0.0_wp .and. s <= 1.0_wp
    if (.not. found) return
    ! Not by boxes: how a scene is turned must not decide.
    call self%at(segment, s, share, x, tangent)
    found = norm2(point - x) <= distance*(1.0_wp + beyond)
  end subroutine foot

  !> Shape functions, place on the smooth curve and tangent at a place of a side.
  pure subroutine at(self, segment, s, share, x, tangent)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment   !! which side
    real(wp), intent(in) :: s   !! from 0 to 1
    real(wp), intent(out) :: share(3), x(2), tangent(2)   !! shape functions; [length]; [length]
    logical :: curved

    curved = self%segment(3, segment) > 0
    share = values(curved, s)
    x = matmul(self%x(:, :, segment), share)
    tangent = matmul(local(self, segment), slopes(curved, s))
    if (.not. curved) x = x + rise(self, segment, s)*unit(scaled_normal(self, segment, s))
  end subroutine at

  !> The place of a side whose normal leads to a point.
  pure subroutine find_foot(line, segment, point, s, found)
    type(boundary_line), intent(in) :: line
    integer, intent(in) :: segment
    real(wp), intent(in) :: point(2)
    real(wp), intent(out) :: s
    logical, intent(out) :: found
    real(wp) :: away(2), chord(2), from(2), normal(2), rate, slope(2), start(2), step, turn(2), x(2, 3)
    logical :: curved
    integer :: k

    curved = line%segment(3, segment) > 0
    x = local(line, segment)
    chord = x(:, 2)
    from = point - line%x(:, 1, segment)
    start = scaled_normal(line, segment, 0.0_wp)
    turn = scaled_normal(line, segment, 1.0_wp) - start
    s = dot_product(from, chord)/dot_product(chord, chord)
    found = .false.
    do k = 1, most_steps
      if (abs(s) > 10.0_wp) return
      away = from - matmul(x, values(curved, s))
      slope = matmul(x, slopes(curved, s))
      normal = start + s*turn
      rate = cross_product(turn, away) - cross_product(normal, slope)
      if (rate == 0.0_wp) return
      step = -cross_product(normal, away)/rate
      s = s + step
      found = abs(step) <= converged*max(1.0_wp, abs(s))
      if (found) return
    end do
    found = abs(step) <= beyond
  end subroutine find_foot

  !> Coordinates of a side's nodes from its start: far from the origin they are exact differences.
  pure function local(line, segment) result(x)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: segment
    real(wp) :: x(2, 3)

    x = line%x(:, :, segment) - spread(line%x(:, 1, segment), 2, 3)
    if (line%segment(3, segment) == 0) x(:, 3) = 0.0_wp
  end function local

  !> Normal within a side, as long as the tangent there: between those at its ends. (A parabola's own is
  !! linear between them.)
  pure function scaled_normal(line, segment, s) result(normal)
    type(boundary_line), intent(in) :: line
    integer, intent(in) :: segment
    real(wp), intent(in) :: s
    real(wp) :: normal(2)
    real(wp) :: length(2)
    integer :: k

    do k = 1, 2
      length(k) = norm2(matmul(local(line, segment), slopes(line%segment(3, segment) > 0, real(k - 1, wp))))
    end do
    normal = (1.0_wp - s)*length(1)*line%normal(:, 1, segment) + s*length(2)*line%normal(:, 2, segment)
  end function scaled_normal

  !> How far along its normal the smooth curve rises above the chord: exactly where the normals at the ends
  !! are those of an arc [length].
  pure real(wp) function rise(line, segment, s)
    type(boundary_line), intent(in) :: line
    integer, intent(in) :: segment
    real(wp), intent(in) :: s
    real(wp) :: across(2), along(2), lean

    across = line%own_normal(segment, s)
    along = [-across(2), across(1)]
    ! An arc of radius r leans by asin(chord/(2 r)) at its ends, and is r - sqrt(r**2 - chord**2 s (1 - s))
    ! above.
    lean = s*dot_product(line%normal(:, 2, segment), along) - &
           (1.0_wp - s)*dot_product(line%normal(:, 1, segment), along)
    associate (w => s*(1.0_wp - s))
      rise = 2.0_wp*chord_length(line, segment)*w*lean/(1.0_wp + sqrt(max(0.0_wp, 1.0_wp - 4.0_wp*w*lean**2)))
    end associate
  end function rise

  !> Shape functions of start, end and middle.
  pure function values(curved, s) result(share)
    logical, intent(in) :: curved
    real(wp), intent(in) :: s
    real(wp) :: share(3)

    share = [1.0_wp - s, s, 0.0_wp]
    if (curved) share = [(1.0_wp - s)*(1.0_wp - 2.0_wp*s), s*(2.0_wp*s - 1.0_wp), 4.0_wp*s*(1.0_wp - s)]
  end function values

  !> Their derivatives.
  pure function slopes(curved, s) result(slope)
    logical, intent(in) :: curved
    real(wp), intent(in) :: s
    real(wp) :: slope(3)

    slope = [-1.0_wp, 1.0_wp, 0.0_wp]
    if (curved) slope = [4.0_wp*s - 3.0_wp, 4.0_wp*s - 1.0_wp, 4.0_wp - 8.0_wp*s]
  end function slopes

  !> Zero of zero: a side without length, which its element is refused for.
  pure function unit(vector)
    real(wp), intent(in) :: vector(2)   !! any length
    real(wp) :: unit(2)

    unit = vector/max(norm2(vector), tiny(1.0_wp))
  end function unit
end module epcont_geometry_boundary_line
