!> THE table of weights and thresholds of the estimates. Weights that depend on the element type are fitted to
!> models with known solutions (tests/accuracy/score.py, sets `tuned` to `third`) and to random models
!> (score_by_chance.py), and scored on others (`unseen`). Each affects a value in
!> tests/accuracy/estimates.csv. For the others each line names its source.
module epcont_accuracy_weights
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: by_linear_triangles, by_quadrilaterals
  implicit none
  private
  public :: estimate_weights, weights_of

  !> Weights that depend on the element type.
  type :: estimate_weights
    !> For the largest pressure
    real(wp) :: parabola, stress, smaller, spacing, square, graded, pressure_energy
    real(wp) :: step, width_energy                                                    !! for the half-width
    real(wp) :: product, between, end                                                 !! for the approach
  end type estimate_weights

  !> Weights in thousandths. Columns: linear triangles, quadrilaterals, quadratic elements, axisymmetric
  !! linear triangles, axisymmetric quadratic elements; each for elastic models, then for yielded models.
  integer, parameter :: thousandths(10, 12) = reshape([ &
    ! Largest pressure: distance from a parabola through the nearest pairs
    500, 1300, 1050, 1200, 400, 500, 1300, 1500, 1200, 700, &
    ! distance from the recovered stress
    0, 100, 20, 350, 40, 800, 0, 0, 20, 170, &
    ! the smaller of these two distances
    1200, 100, 1100, 0, 1300, 500, 300, 200, 500, 800, &
    ! h/b: spacing of the pairs over half the length of the zone (edges of six-node elements have two
    ! spacings)
    100, 20, 6, 20, 24, 6, 200, 30, 3, 0, &
    ! (h/b)**2
    0, 0, 0, 0, 0, 0, 0, 0, 360, 200, &
    ! ratio of h/b along the zone and into the bodies to h/b at the peak
    600, 400, 80, 120, 160, 60, 600, 450, 50, 50, &
    ! relative mesh error of the energy
    200, 1600, 450, 700, 0, 2500, 300, 1200, 2800, 3200, &
    ! Half-width: the spacing at its end
    50, 80, 300, 270, 290, 300, 200, 160, 310, 330, &
    ! relative mesh error of the energy
    3200, 3400, 100, 800, 200, 500, 750, 650, 500, 500, &
    ! Approach: product of two error fields, whose parts may cancel
    1600, 2600, 1600, 1500, 1800, 1700, 1400, 1300, 1400, 2100, &
    ! pressure (h/b)**2 b/E*: overclosure, since nodes are in contact and not the line between them
    0, 0, 300, 400, 0, 0, 0, 0, 0, 0, &
    ! the same for contact that ends at a node: a distance d from the true end counts as d**2
    100, 400, 150, 300, 140, 750, 200, 120, 350, 400], [10, 12])

  ! Weights of all element types.

  real(wp), parameter, public :: &
    !> Largest pressure: an element that is this many times deeper than its edge is wide does not count as
    !! graded (score_curved.py, elements that grow by a power).
    stretched = 1.8_wp, &
    !> At the last candidate: factor of its excess over the next pair. The last pair has half an edge, and its
    !! pressure is the mean over this half, below the pressure at the end: for a linear rise by half of the
    !! excess, for a steeper one by more (columns pressed at a corner: score_by_chance.py, "stack").
    beyond_mean = 0.625_wp, &
    !> Largest pressure: factors of the largest difference between the pressures on the two lines near the
    !! peak, and of the oscillation from edge to edge. If the slave line is finer than the master line, or
    !! quadratic on a linear one, its pressure oscillates from master node to master node (crowned punches on
    !! plates: score_crowned.py).
    lines_differ = 0.6_wp, oscillates = 0.2_wp, &
    !> Below this part of the largest pressure neither counts: on six-node edges nodal forces oscillate by one
    !! per cent, although the force of each edge is right (score.py, pins in lugs).
    tolerated = 0.01_wp, &
    !> Pressure that flattens gap oscillation, over E* r: waves of length 2 d need pi E* a/(2 d). Theory
    !! (Westergaard 1939); tests/accuracy/test_waves.
    waves_flattened = acos(-1.0_wp)/16.0_wp, &
    !> Approach: height of the oscillation. It is as high above the intended gap as below it (score_curved.py,
    !! edges as chords).
    wave_height = 2.0_wp, &
    !> Part of the products of elements that is not assumed to cancel (chosen with the weight of the total
    !! contact force; no measurement on record).
    uncancelled = 1.0_wp/3.0_wp, &
    !> Factor of errors if a zone has too few pairs for its pressures (no measurement on record).
    unresolved = 1.4_wp, &
    !> Force on one pair, for a contact narrower than an edge: on a three times finer mesh the bodies come
    !! nearer by this times the force over depth and modulus. Theory: (2/pi) log 3 of the half-plane.
    finer = 0.7_wp, &
    !> Factor of errors of forces that pairs or bodies share, relative to an approach (no measurement on
    !! record).
    of_shares = 1.3_wp, &
    !> Factor of the force change by the node's own normal: the contact point is at most this much farther
    !! from a pair than the normals there indicate (tests/accuracy/test_narrow_zone).
    askew = 1.25_wp, &

    ! Thresholds.

    !> Smallest part of the energy by which errors are divided (a choice).
    least_energy = 0.5_wp, &
    !> A node with at least this part of the resultant carries a point load (a choice; not a half, which the
    !! node between two edges under pressure has).
    concentrated = 0.51_wp, &
    !> The curvature at a tip is at least this many times that of the nodes around it (test_limits.py).
    tip_stands_out = 4.0_wp, &
    !> The pressure of its bend, E* times its angle, is at least this part of the largest (test_limits.py).
    tip_matters = 0.1_wp, &
    !> Part of the longest edge at the end of a zone, of either body, that counts; below one, so that equal
    !! edges change nothing (round fronts on non-matching meshes, random models).
    other_side = 0.8_wp, &
    !> Gap oscillation needs at least this part of a zone's pairs with alternating bend
    !! (tests/accuracy/test_waves).
    waves_are_common = 1.0_wp/3.0_wp, &
    !> Above this part of the largest pressure, the largest pressure is one of the waves (score_curved.py,
    !! polygons of unlike divisions).
    waves_alone = 0.5_wp, &
    !> A zone whose normal force has less than this part along the given resultant does not carry it (a disc
    !! in a V, beams on posts).
    bears_on = 0.3_wp

contains

  !> Choose the weights of some element types: the largest of each weight.
  pure type(estimate_weights) function weights_of(estimated_as, rings, yielded) result(weights)
    integer, intent(in) :: estimated_as(:)   !! columns of the table, from the table of elements
    logical, intent(in) :: rings             !! the model is axisymmetric
    logical, intent(in) :: yielded           !! the model yields somewhere
    integer :: kind(size(estimated_as))

    kind = estimated_as
    where (rings .and. kind /= by_quadrilaterals) kind = merge(4, 5, kind == by_linear_triangles)
    weights = transfer(maxval(thousandths(2*kind - merge(0, 1, yielded), :), dim=1)/1000.0_wp, weights)
  end function weights_of
end module epcont_accuracy_weights
