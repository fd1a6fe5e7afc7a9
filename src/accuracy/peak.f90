!> The peak of a zone: error estimates from its pressures alone.
module epcont_accuracy_peak
  use epcont_accuracy_weights, only: estimate_weights
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: dependent, no_effect
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: off_parabola, oscillation, peak_type, zone_end, zone_error

  !> Number of pairs for the parabola.
  integer, parameter :: around_peak = 7
  !> Number of pairs on either side of the peak at which the pressures on the two lines are compared; number
  !! of edges on either side at which oscillations count.
  integer, parameter, public :: beside_peak = 3

  type :: zone_error
    integer :: peak = 0                  !! pair of the largest pressure
    logical :: unbounded = .false.       !! singular: the pressure diverges with mesh refinement (tip or sharp
                                         !! edge)
    logical :: resolved = .true.         !! there are enough pairs to locate the largest pressure
    !> Error of the largest pressure; negative: singular, or mesh too coarse [stress]
    real(wp) :: pressure = -1.0_wp
    real(wp) :: half_width = -1.0_wp     !! error of the half-width; negative: unknown [length]
    real(wp) :: largest_shear = 0.0_wp   !! largest shear traction; 0 without friction [stress]
    real(wp) :: shear = -1.0_wp          !! error of this traction; negative: unknown [stress]
    real(wp) :: resolution = 1.0_wp      !! spacing of the pairs divided by half the length of the zone
    real(wp) :: end_resolution = 1.0_wp  !! the same with the larger spacing at its ends
    real(wp) :: half_length = 0.0_wp     !! half length of the zone, to the points of zero pressure [length]
    real(wp) :: wave_height = 0.0_wp     !! amplitude of its gap oscillation [length]
    real(wp) :: waviness = 0.0_wp        !! pressure that flattens the oscillation, divided by the largest
                                         !! pressure
    !> Overclosure that contact on few pairs leaves unknown [length]
    real(wp) :: too_near = 0.0_wp
    type(estimate_weights) :: weights    !! of its element types
  end type zone_error

  !> End of a zone that is not on a line of symmetry.
  type :: zone_end
    !> Distance to the first open pair, or between the last two, the larger [length]
    real(wp) :: step = 0.0_wp
    !> The same, or most of the longest edge there, of either body; at most the zone's length [length]
    real(wp) :: unknown = 0.0_wp
    !> Pressure at the end minus its mean over the last edge [stress]
    real(wp) :: short = 0.0_wp
    logical :: edge = .false.       !! the geometry allows an edge, and the pressure does not fall towards it
    logical :: cut_off = .false.    !! the pressure is largest at the last pair, although contact ends there
  end type zone_end

  !> A zone and its peak, as input of the error estimates.
  type :: peak_type
    integer :: peak = 0               !! position of its pair in the zone
    integer :: n = 0                  !! number of pairs
    integer :: kind = 1               !! element type at the peak
    real(wp) :: largest = 0.0_wp      !! pressure at the peak [stress]
    real(wp) :: energy = 0.0_wp       !! mesh error of the whole model
    real(wp) :: flattening = 0.0_wp   !! pressure that flattens the gap oscillation [stress]
    real(wp) :: spacing = 0.0_wp      !! distance of pairs at the peak [length]
    !> Length of the zone (of a closed zone without a mean edge); length of a closed zone, else 0
    real(wp) :: long = 0.0_wp, around = 0.0_wp
    logical :: mirrored(2) = .false.  !! at its ends
    type(zone_end) :: ends(2)
    real(wp), allocatable :: p(:)     !! pressures of its pairs [stress]
    !> Distance from the peak, and pressure, of the pairs in order, with mirrored pairs. A closed zone has
    !! half of its pairs on either side of the peak [length], [stress] [2, any]
    real(wp), allocatable :: row(:, :)
  end type peak_type

contains

  !> Find the oscillation of the pressure near the peak [stress]. For two pairs an edge apart, one above the
  !! straight line between the pairs an edge before and after it, the other below its own line, it is the
  !! smaller distance; the result is the largest of all. The last pair of a zone does not count if contact
  !! ends within its edge.
  pure real(wp) function oscillation(model, seen)
    type(model_type), intent(in) :: model        !! model
    type(peak_type), intent(in) :: seen          !! of the zone
    real(wp) :: above(lbound(seen%row, 2):ubound(seen%row, 2))
    integer :: k, side

    above = 0.0_wp
    associate (first => lbound(seen%row, 2), last => ubound(seen%row, 2))
      side = model%mesh%kinds(seen%kind)%degree
      do k = max(seen%peak - side*beside_peak, first + side + 1), min(seen%peak + side*beside_peak, &
          last - side - 1)
        associate (x => seen%row(1, k - side:k + side:side), y => seen%row(2, k - side:k + side:side))
          if (x(3) > x(1)) above(k) = y(2) - (y(1)*(x(3) - x(2)) + y(3)*(x(2) - x(1)))/(x(3) - x(1))
        end associate
      end do
      associate (one => above(:last - side), next => above(first + side:))
        oscillation = max(0.0_wp, maxval(min(abs(one), abs(next)), mask=one*next < 0.0_wp))
      end associate
    end associate
  end function oscillation

  !> Find the distance of the peak from the least-squares parabola of p**2 through the nearest pairs (with
  !! mirrored pairs, and all of equal distance). With too few pairs: the decrease of Hertz's pressure over
  !! half a spacing [stress].
  pure real(wp) function off_parabola(seen, error) result(off)
    type(peak_type), intent(in) :: seen          !! of the zone
    type(zone_error), intent(in) :: error        !! errors found so far
    real(wp) :: m(0:4), reach, right(0:2), square, unit
    real(wp), dimension(size(seen%row, 2)) :: x, y
    logical :: left(size(seen%row, 2))
    integer :: i, k

    x = seen%row(1, :)/max(seen%spacing, tiny(1.0_wp))
    unit = scale(1.0_wp, exponent(seen%largest) - 1)   ! a power of two, so that no square overflows
    y = (seen%row(2, :)/unit)**2
    off = seen%largest*error%resolution**2/8.0_wp
    left = .true.
    if (size(left) <= 3) return
    m = 0.0_wp
    right = 0.0_wp
    reach = 0.0_wp
    do i = 1, size(left)
      k = minloc(abs(x), mask=left, dim=1)
      if (i > around_peak .and. abs(x(k)) > (1.0_wp + no_effect)*reach) exit
      reach = abs(x(k))
      left(k) = .false.
      m = m + [1.0_wp, x(k), x(k)**2, x(k)**3, x(k)**4]
      right = right + y(k)*[1.0_wp, x(k), x(k)**2]
    end do
    square = determinant(m, m(0:2))
    if (square <= dependent*m(0)*m(2)*m(4)) return
    off = abs(unit*sqrt(max(0.0_wp, determinant(m, right)/square)) - seen%largest)
  end function off_parabola

  !> Determinant of the normal equations of a parabola, with this first column.
  pure real(wp) function determinant(m, column)
    real(wp), intent(in) :: m(0:4)        !! moments
    real(wp), intent(in) :: column(0:2)

    determinant = column(0)*(m(2)*m(4) - m(3)**2) - m(1)*(column(1)*m(4) - column(2)*m(3)) &
                  + m(2)*(column(1)*m(3) - column(2)*m(2))
  end function determinant
end module epcont_accuracy_peak
