!> The peak of a zone: what its pressures alone tell of its error.
module epcont_accuracy_peak
  use epcont_accuracy_weights, only: estimate_weights
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: dependent, no_effect
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: off_parabola, oscillation, peak_type, zone_end, zone_error

  !> Pairs that the parabola goes through.
  integer, parameter :: around_peak = 7
  !> Pairs on either side of the peak at which the pressures on the two lines are compared; sides on either
  !! side of it on which oscillations count.
  integer, parameter, public :: beside_peak = 3

  type :: zone_error
    integer :: peak = 0                  !! pair of the largest pressure
    logical :: unbounded = .false.       !! the pressure grows with every finer mesh: a tip, a sharp edge
    logical :: resolved = .true.         !! there are pairs enough to see where it is largest
    !> Of the largest pressure; negative: unbounded, or not resolved [stress]
    real(wp) :: pressure = -1.0_wp
    real(wp) :: half_width = -1.0_wp     !! negative: unknown [length]
    real(wp) :: resolution = 1.0_wp      !! spacing of the pairs over half of the zone's length
    real(wp) :: end_resolution = 1.0_wp  !! the same of the larger spacing at its ends
    real(wp) :: half_length = 0.0_wp     !! of the zone, to where the pressure vanishes [length]
    real(wp) :: wave_height = 0.0_wp     !! of waves of its gap [length]
    real(wp) :: waviness = 0.0_wp        !! what flattens these waves, of the largest pressure
    !> What contact on few pairs leaves open of how near the bodies come [length]
    real(wp) :: too_near = 0.0_wp
    type(estimate_weights) :: weights    !! of the elements there
  end type zone_error

  !> What is seen at an end of a zone that is no line of symmetry.
  type :: zone_end
    !> To the first open pair, or between the last two, if that is more [length]
    real(wp) :: step = 0.0_wp
    !> The same, or nearly as much as the longest side there, of either body; at most the zone [length]
    real(wp) :: unknown = 0.0_wp
    !> What a mean over the last side is short of the pressure at its end [stress]
    real(wp) :: short = 0.0_wp
    logical :: edge = .false.       !! the candidates do, and the pressure does not fall towards it
    logical :: cut_off = .false.    !! the pressure is largest at the last pair, though contact ends there
  end type zone_end

  !> A zone and its peak, as its errors see them.
  type :: peak_type
    integer :: peak = 0               !! which of its pairs
    integer :: n = 0                  !! how many these are
    integer :: kind = 1               !! of the elements at the peak
    real(wp) :: largest = 0.0_wp      !! pressure there [stress]
    real(wp) :: energy = 0.0_wp       !! error of the mesh over all of it
    real(wp) :: flattening = 0.0_wp   !! pressure that flattens waves of the gap [stress]
    real(wp) :: spacing = 0.0_wp      !! of the pairs at the peak [length]
    !> Length of all of it, but for a mean side of one that goes all around; of that the whole way, else 0
    real(wp) :: long = 0.0_wp, around = 0.0_wp
    logical :: mirrored(2) = .false.  !! at its ends
    type(zone_end) :: ends(2)
    real(wp), allocatable :: p(:)     !! pressures of its pairs [stress]
    !> Distance from the peak and pressure of the pairs in their order, with those beyond a line of symmetry;
    !! of a closed zone half of it on either side of the peak [length], [stress] [2, any]
    real(wp), allocatable :: row(:, :)
  end type peak_type

contains

  !> How much the pressure oscillates near the peak: of two pairs a side apart, one above the straight line
  !! between the pairs a side before and after it, the other below its own, the smaller of both distances;
  !! the largest of all. At the last pair of the zone, where contact ends within a side, it says nothing.
  !! [stress]
  pure real(wp) function oscillation(model, seen)
    type(model_type), intent(in) :: model        !! the model
    type(peak_type), intent(in) :: seen          !! its peak
    real(wp) :: above(lbound(seen%row, 2):ubound(seen%row, 2))
    integer :: k, side

    above = 0.0_wp
    associate (first => lbound(seen%row, 2), last => ubound(seen%row, 2))
      side = model%kinds(seen%kind)%degree
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

  !> How far the peak is off the least-squares parabola of p**2 through the pairs nearest to it, or short of
  !! its top, if that is more; mirrored ones and those the other way around too; of those that are as near
  !! all. Of too few pairs for one: what Hertz's pressure falls by over half a spacing [stress].
  pure real(wp) function off_parabola(seen, error) result(off)
    type(peak_type), intent(in) :: seen          !! its peak
    type(zone_error), intent(in) :: error        !! as far as known
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
    associate (here => max(0.0_wp, determinant(m, right)/square))
      off = unit*sqrt(here) - seen%largest
      off = max(-off, off + error%weights%rise*unit*rise(m, right, here))
    end associate
  end function off_parabola

  !> What the root of a parabola rises by from the peak to its top, if that is no farther than a spacing.
  pure real(wp) function rise(m, right, here)
    real(wp), intent(in) :: m(0:4)       !! moments
    real(wp), intent(in) :: right(0:2)   !! right-hand side of its normal equations
    real(wp), intent(in) :: here         !! its value at the peak
    real(wp) :: bend, slope              !! times a determinant above 0

    slope = (right(1) - m(1)*here)*m(4) - (right(2) - m(2)*here)*m(3)
    bend = (right(2) - m(2)*here)*m(2) - (right(1) - m(1)*here)*m(3)
    rise = 0.0_wp
    if (bend < 0.0_wp .and. abs(slope) <= -2.0_wp*bend) &
      rise = sqrt(here - slope**2/(4.0_wp*bend*(m(2)*m(4) - m(3)**2))) - sqrt(here)
  end function rise

  !> Of the normal equations of a parabola, with this first column.
  pure real(wp) function determinant(m, column)
    real(wp), intent(in) :: m(0:4)        !! moments
    real(wp), intent(in) :: column(0:2)

    determinant = column(0)*(m(2)*m(4) - m(3)**2) - m(1)*(column(1)*m(4) - column(2)*m(3)) &
                  + m(2)*(column(1)*m(3) - column(2)*m(2))
  end function determinant
end module epcont_accuracy_peak
