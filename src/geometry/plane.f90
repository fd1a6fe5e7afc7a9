!> Plane geometry.
module epcont_geometry_plane
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: angle_between, cross_product, crossing, extent_of, right_of, span_along, turned, unit

contains

  !> Width and height of the box around some points [length].
  pure function extent_of(x) result(extent)
    real(wp), intent(in) :: x(:, :)   !! [length] [2, points]
    real(wp) :: extent(2)

    extent = maxval(x, dim=2) - minval(x, dim=2)
  end function extent_of

  !> Component of a x b perpendicular to the plane: positive if b is to the left of a.
  pure real(wp) function cross_product(a, b)
    real(wp), intent(in) :: a(2), b(2)

    cross_product = a(1)*b(2) - a(2)*b(1)
  end function cross_product

  !> Counter-clockwise angle from one vector to another [rad].
  pure real(wp) function angle_between(a, b)
    real(wp), intent(in) :: a(2), b(2)

    angle_between = atan2(cross_product(a, b), dot_product(a, b))
  end function angle_between

  !> Intersection of two straight lines: positions as fractions of both vectors; far outside both if they are
  !! parallel.
  pure function crossing(a, along, b, other) result(part)
    real(wp), intent(in) :: a(2), along(2)   !! start and vector of the first line [length]
    real(wp), intent(in) :: b(2), other(2)   !! start and vector of the second line [length]
    real(wp) :: area, part(2)

    area = cross_product(along, other)
    part = huge(area)
    if (area /= 0.0_wp) part = [cross_product(b - a, other), cross_product(b - a, along)]/area
  end function crossing

  !> Least and largest components along an edge: on a parabola, between those of its ends and of its control
  !! point.
  pure function span_along(vector, curved) result(span)
    real(wp), intent(in) :: vector(2, 3)   !! at start, end and middle
    logical, intent(in) :: curved          !! has a middle
    real(wp) :: control(2), span(2, 2)

    control = vector(:, 1)
    if (curved) control = 2.0_wp*vector(:, 3) - 0.5_wp*(vector(:, 1) + vector(:, 2))
    span(:, 1) = min(vector(:, 1), vector(:, 2), control)
    span(:, 2) = max(vector(:, 1), vector(:, 2), control)
  end function span_along

  !> A vector rotated clockwise by a right angle.
  pure function right_of(vector)
    real(wp), intent(in) :: vector(2)
    real(wp) :: right_of(2)

    right_of = [vector(2), -vector(1)]
  end function right_of

  !> Unit vector along another vector; zero for a zero vector: an edge without length, whose element is
  !! rejected.
  pure function unit(vector)
    real(wp), intent(in) :: vector(2)
    real(wp) :: unit(2)

    unit = vector/max(norm2(vector), tiny(1.0_wp))
  end function unit

  !> Rotate a vector counter-clockwise: exact for multiples of a right angle, also after full rotations.
  pure function turned(vector, angle)
    real(wp), intent(in) :: vector(2)
    real(wp), intent(in) :: angle       !! [degree]
    real(wp) :: turned(2)
    real(wp), parameter :: quarter = 90.0_wp, degree = acos(-1.0_wp)/180.0_wp
    real(wp) :: rest
    integer :: k, quarters

    rest = modulo(angle, 4.0_wp*quarter)
    quarters = nint(rest/quarter)
    rest = (rest - quarters*quarter)*degree
    turned = vector
    do k = 1, quarters
      turned = [-turned(2), turned(1)]
    end do
    turned = [cos(rest)*turned(1) - sin(rest)*turned(2), sin(rest)*turned(1) + cos(rest)*turned(2)]
  end function turned
end module epcont_geometry_plane
