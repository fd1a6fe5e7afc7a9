!> A line of element sides along the boundary of a body, and where a point faces it.
!>
!> The line is walked with the body to the left, so that outward is to the right. Normals at the nodes come from the two
!> sides that meet there, exact on a circle; along a side they turn from one to the other, so that none is met twice and
!> none left out. Where sides are chords, the boundary that is meant is the smooth curve through their ends: the gap is
!> measured to it (a cubic over each chord) and not to the chord, whose facets would show in the pressures. Force and
!> counterforce still lie on one line, through the chord.
module epcont_model_boundary_line
  use epcont_base_geometry, only: cross_product
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: boundary_line, facing_place, find_normals

  !> Sides that turn by more than this meet at a corner: beyond the 30 degrees of a circle of 12 sides, or of a chamfer.
  real(wp), parameter :: corner_angle = 35.0_wp*acos(-1.0_wp)/180.0_wp
  !> Part of a side by which a point may stand beyond its end: rounding of coordinates in eight columns.
  real(wp), parameter :: beyond = 1.0e-6_wp
  !> A point so near to a node, as a part of the side, faces the node.
  real(wp), parameter :: at_node = 1.0e-9_wp
  !> Steps of Newton's method, which needs five, and the change that ends it.
  integer, parameter :: most_steps = 30
  real(wp), parameter :: converged = 1.0e-14_wp

  type :: boundary_line
    integer :: id = 0
    logical :: closed = .false.
    integer, allocatable :: segment(:, :)      !! nodes of each side: start, end, and middle or 0 [3, segments]
    integer, allocatable :: element(:)         !! whose sides they are [segments]
    real(wp), allocatable :: x(:, :, :)        !! their coordinates [length] [2, 3, segments]
    real(wp), allocatable :: normal(:, :, :)   !! outward, at start and end of each side [2, 2, segments]
    !> At the first and the last node, on a line of symmetry: within that line, though it be a corner there [2, 2]
    real(wp) :: end_normal(2, 2) = 0.0_wp
    logical :: mirrored(2) = .false.           !! it is one
  contains
    procedure :: longest
    procedure :: chord_length
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
  end type facing_place

contains

  !> Normals at the ends of the sides. `mirror` is the direction held at the first and the last node, if the line ends
  !! there on a line of symmetry, else 0.
  pure subroutine find_normals(line, mirror)
    type(boundary_line), intent(inout) :: line
    integer, intent(in) :: mirror(2)
    logical :: known(2, size(line%element))
    real(wp) :: chord(2), here(2), there(2)
    integer :: i, next, n

    n = size(line%element)
    allocate (line%normal(2, 2, n))
    known = .false.
    do i = 1, n
      next = i + 1
      if (next > n .and. .not. line%closed) exit
      if (next > n) next = 1
      here = own_normal(line, i, 1.0_wp)
      there = own_normal(line, next, 0.0_wp)
      if (dot_product(here, there) < cos(corner_angle)) cycle
      here = unit(chord_length(line, next)*here + chord_length(line, i)*there)
      line%normal(:, 2, i) = here
      line%normal(:, 1, next) = here
      known(2, i) = .true.
      known(1, next) = .true.
    end do
    if (.not. line%closed) then
      call reflect(line, 1, mirror(1), 1, known(1, 1))
      call reflect(line, n, mirror(2), 2, known(2, n))
    end if
    do i = 1, n
      chord = own_normal(line, i, 0.5_wp)
      do next = 1, 2
        if (known(next, i)) cycle
        line%normal(:, next, i) = own_normal(line, i, real(next - 1, wp))
        if (line%segment(3, i) > 0 .or. .not. known(3 - next, i)) cycle
        ! Of a circle through both ends the one normal mirrors the other.
        associate (other => line%normal(:, 3 - next, i))
          line%normal(:, next, i) = 2.0_wp*dot_product(other, chord)*chord - other
        end associate
      end do
    end do
  end subroutine find_normals

  !> On a line of symmetry the normal lies in it; the side that mirrors the last one joins it smoothly or at a corner.
  pure subroutine reflect(line, segment, direction, end, smooth)
    type(boundary_line), intent(inout) :: line
    integer, intent(in) :: segment
    integer, intent(in) :: direction       !! across the line of symmetry; 0: there is none
    integer, intent(in) :: end             !! of the side: 1 or 2
    logical, intent(inout) :: smooth
    real(wp) :: own(2)

    if (direction == 0) return
    own = own_normal(line, segment, real(end - 1, wp))
    if (abs(own(3 - direction)) < abs(own(direction))) return
    line%mirrored(end) = .true.
    line%end_normal(3 - direction, end) = sign(1.0_wp, own(3 - direction))
    smooth = abs(own(direction)) <= sin(0.5_wp*corner_angle)
    if (smooth) line%normal(:, end, segment) = line%end_normal(:, end)
  end subroutine reflect

  !> Outward normal of a side itself, at a place from 0 to 1.
  pure function own_normal(line, segment, s) result(normal)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: segment
    real(wp), intent(in) :: s
    real(wp) :: normal(2), tangent(2)

    tangent = matmul(local(line, segment), slopes(line%segment(3, segment) > 0, s))
    normal = unit([tangent(2), -tangent(1)])
  end function own_normal

  !> Length of a side, from end to end [length].
  pure real(wp) function chord_length(self, segment)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment

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
    integer, intent(in) :: segment, which
    real(wp) :: normal(2)

    if (which == 3) then
      normal = own_normal(self, segment, 0.5_wp)
    else
      normal = self%normal(:, which, segment)
    end if
  end function outward

  !> Where a point faces a side: the place whose normal leads to it.
  pure function face(self, segment, point) result(place)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment
    real(wp), intent(in) :: point(2)    !! [length]
    type(facing_place) :: place
    real(wp) :: s
    logical :: curved, found

    curved = self%segment(3, segment) > 0
    call find_foot(self, segment, point, s, found)
    if (.not. found .or. s < -beyond .or. s > 1.0_wp + beyond) return
    place%found = .true.
    if (s <= at_node) then
      place%share = [1.0_wp, 0.0_wp, 0.0_wp]
      place%normal = self%normal(:, 1, segment)
      if (segment == 1 .and. self%mirrored(1)) place%normal = self%end_normal(:, 1)
      place%gap = dot_product(place%normal, point - self%x(:, 1, segment))
    else if (s >= 1.0_wp - at_node) then
      place%share = [0.0_wp, 1.0_wp, 0.0_wp]
      place%normal = self%normal(:, 2, segment)
      if (segment == size(self%element) .and. self%mirrored(2)) place%normal = self%end_normal(:, 2)
      place%gap = dot_product(place%normal, point - self%x(:, 2, segment))
    else
      place%share = values(curved, s)
      place%normal = unit(scaled_normal(self, segment, s))
      place%gap = dot_product(place%normal, point - self%x(:, 1, segment) - matmul(local(self, segment), place%share))
      if (.not. curved) place%gap = place%gap - rise(self, segment, s)
    end if
  end function face

  !> The place of a side, from 0 to 1, that a point within a distance faces.
  pure subroutine foot(self, segment, point, distance, s, found)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment
    real(wp), intent(in) :: point(2), distance
    real(wp), intent(out) :: s
    logical, intent(out) :: found

    found = .false.
    s = 0.0_wp
    associate (a => self%x(:, 1, segment), b => self%x(:, 2, segment))
      if (any(abs(point - 0.5_wp*(a + b)) > distance + norm2(b - a))) return
    end associate
    call find_foot(self, segment, point, s, found)
    found = found .and. s >= 0.0_wp .and. s <= 1.0_wp
  end subroutine foot

  !> Shape functions, place on the smooth curve and tangent at a place of a side.
  pure subroutine at(self, segment, s, share, x, tangent)
    class(boundary_line), intent(in) :: self
    integer, intent(in) :: segment
    real(wp), intent(in) :: s
    real(wp), intent(out) :: share(3), x(2), tangent(2)
    logical :: curved

    curved = self%segment(3, segment) > 0
    share = values(curved, s)
    x = matmul(self%x(:, :, segment), share)
    tangent = matmul(local(self, segment), slopes(curved, s))
    if (.not. curved) x = x + rise(self, segment, s)*own_normal(self, segment, s)
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
    found = abs(step) <= at_node
  end subroutine find_foot

  !> Coordinates of a side's nodes from its start: far from the origin they are exact differences.
  pure function local(line, segment) result(x)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: segment
    real(wp) :: x(2, 3)

    x = line%x(:, :, segment) - spread(line%x(:, 1, segment), 2, 3)
    if (line%segment(3, segment) == 0) x(:, 3) = 0.0_wp
  end function local

  !> Normal within a side, as long as the tangent there: between those at its ends. (A parabola's own is linear between them.)
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

  !> How far the smooth curve rises outwards above the chord: the cubic with the normals at its ends [length].
  pure real(wp) function rise(line, segment, s)
    type(boundary_line), intent(in) :: line
    integer, intent(in) :: segment
    real(wp), intent(in) :: s
    real(wp) :: across(2), along(2), slope(2)
    integer :: k

    across = own_normal(line, segment, s)
    along = [-across(2), across(1)]
    do k = 1, 2
      slope(k) = -dot_product(line%normal(:, k, segment), along)/dot_product(line%normal(:, k, segment), across)
    end do
    rise = chord_length(line, segment)*s*(1.0_wp - s)*((1.0_wp - s)*slope(1) - s*slope(2))
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
    real(wp), intent(in) :: vector(2)
    real(wp) :: unit(2)

    unit = vector/max(norm2(vector), tiny(1.0_wp))
  end function unit
end module epcont_model_boundary_line
