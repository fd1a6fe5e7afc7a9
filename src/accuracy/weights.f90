!> THE table of what the parts of an estimate count, and from where on something counts. Those that differ
!> from kind to kind are measured on scenes whose answers are known (tests/accuracy/score.py, its sets `tuned`
!> to `third`) and on scenes drawn by chance (score_by_chance.py), and scored on others (`unseen`); each has a
!> say in a figure of tests/accuracy/estimates.csv, but for that of the parabola's top: that has one in
!> tests/figures/test_found.py. Of the others, each line says whence it comes.
module epcont_accuracy_weights
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: by_linear_triangles, by_quadrilaterals
  implicit none
  private
  public :: estimate_weights, weights_of

  !> Weights that differ from one kind of elements to another.
  type :: estimate_weights
    !> Of the largest pressure
    real(wp) :: parabola, rise, stress, smaller, spacing, square, graded, pressure_energy
    real(wp) :: step, width_energy                                                    !! of the half-width
    real(wp) :: product, between, end                                                 !! of the approach
  end type estimate_weights

  !> They, in thousandths, of linear triangles, quadrilaterals, quadratic elements, rings of linear triangles
  !! and of quadratic elements: each in elastic scenes, then in those with something beyond yield.
  integer, parameter :: thousandths(10, 13) = reshape([ &
    ! Largest pressure: its distance from a parabola through the nearest pairs
    500, 1300, 1050, 1200, 400, 500, 1300, 1500, 1200, 700, &
    ! in it, what that parabola rises by to its top between two pairs: forces over sides are means, short of
    ! what is in their middle by a third of it (of the others, and beyond yield, the rest tells enough)
    0, 0, 1333, 0, 0, 0, 0, 0, 0, 0, &
    ! that from the smooth stress
    0, 100, 20, 350, 40, 800, 0, 0, 20, 170, &
    ! the smaller of the two
    1200, 100, 1100, 0, 1300, 500, 300, 200, 500, 800, &
    ! h/b, the spacing of the pairs over half of the zone (sides of six-node elements are two spacings long)
    100, 20, 6, 20, 24, 6, 200, 30, 3, 0, &
    ! (h/b)**2
    0, 0, 0, 0, 0, 0, 0, 0, 360, 200, &
    ! how much larger h/b is over the zone and into the bodies than at the peak
    600, 400, 80, 120, 160, 60, 600, 450, 50, 50, &
    ! the part of the energy that the mesh is off by
    200, 1600, 450, 700, 0, 2500, 300, 1200, 2800, 3200, &
    ! Half-width: the spacing at its end
    50, 80, 300, 270, 290, 300, 200, 160, 310, 330, &
    ! the same part of the energy
    3200, 3400, 100, 800, 200, 500, 750, 650, 500, 500, &
    ! Approach: the product of two fields of errors, whose parts may cancel
    1600, 2600, 1600, 1500, 1800, 1700, 1400, 1300, 1400, 2100, &
    ! of pressure (h/b)**2 b/E*, by which bodies come too near since their nodes touch and not the line
    ! between
    0, 0, 300, 400, 0, 0, 0, 0, 0, 0, &
    ! the same for contact that ends at a node: a distance d from the true end counts as d**2
    100, 400, 150, 300, 140, 750, 200, 120, 350, 400], [10, 13])

  ! Weights that all kinds have.

  real(wp), parameter, public :: &
    !> Largest pressure: an element so many times deeper than its side is wide is not graded
    !! (score_curved.py, elements that grow by a power).
    stretched = 1.8_wp, &
    !> At the last candidate: of what it is above the next pair. The last has half a side, and its own is the
    !! mean over that, short of the pressure at the end: of a straight rise by half of it, of a steeper one by
    !! more (columns pressed at a corner: score_by_chance.py, "stack").
    beyond_mean = 0.625_wp, &
    !> Largest pressure: of the largest difference between the pressures on the two lines near the peak, and
    !! of how much the pressure oscillates from side to side there. If the slave line is finer than the master
    !! line, or quadratic on a linear one, its pressure oscillates from master node to master node (crowned
    !! punches on plates: score_crowned.py).
    lines_differ = 0.6_wp, oscillates = 0.2_wp, &
    !> Parts of the largest pressure up to which neither counts: on six-node sides nodal forces swing by a per
    !! cent, though the force on each side is right (score.py, pins in lugs).
    tolerated = 0.01_wp, &
    !> What flattens waves of the gap, over E* r: waves 2 d long take a pressure of pi E* a/(2 d). Theory
    !! (Westergaard 1939); tests/accuracy/test_waves.
    waves_flattened = acos(-1.0_wp)/16.0_wp, &
    !> Approach: height of waves from the gap that is meant. They are as high above as below it
    !! (score_curved.py, sides of chords).
    wave_height = 2.0_wp, &
    !> Part of the products of elements that may not be trusted to cancel (set with that of the total
    !! contact force; no measurement on record).
    uncancelled = 1.0_wp/3.0_wp, &
    !> Errors are so much larger where a zone has too few pairs to see its pressures (no measurement on
    !! record).
    unresolved = 1.4_wp, &
    !> Force on one pair, a contact narrower than a side: by each three times finer mesh the bodies come
    !! nearer by this times the force over depth and modulus. Theory: (2/pi) log 3 of the half-plane.
    finer = 0.7_wp, &
    !> Forces that pairs or bodies share, over an approach of the same products (no measurement on record).
    of_shares = 1.3_wp, &
    !> Force that turns with the node's own normal: the place where the bodies touch is farther from a pair
    !! than the normals there tell, by this at most (tests/accuracy/test_narrow_zone).
    askew = 1.25_wp, &

    ! From where on something counts.

    !> Part of the energy that a mesh has at least for its errors to be measured by it (a choice).
    least_energy = 0.5_wp, &
    !> Part of the resultant at one node of the mesh from which on it is a point load (a choice; not a half,
    !! which the node between two sides under pressure has).
    concentrated = 0.51_wp, &
    !> A tip's curvature is so many times that of the nodes around it (test_limits.py).
    tip_stands_out = 4.0_wp, &
    !> The pressure that its bend adds, E* times its angle, is at least this part of the largest
    !! (test_limits.py).
    tip_matters = 0.1_wp, &
    !> Part of the longest side at the end of a zone, of either body, that counts there: not all, so that
    !! sides that are alike change nothing (round fronts on unlike meshes, drawn by chance).
    other_side = 0.8_wp, &
    !> Part of a zone's pairs at which the gap bends by turns from which on that is waves
    !! (tests/accuracy/test_waves).
    waves_are_common = 1.0_wp/3.0_wp, &
    !> Part of the largest pressure from which on that is one of the waves (score_curved.py,
    !! polygons of unlike divisions).
    waves_alone = 0.5_wp, &
    !> A zone whose normals are across what stays the same, but for this part, does not bear it (a disc in
    !! a V, beams on posts).
    bears_on = 0.3_wp

contains

  !> Those of some kinds of elements: of each weight the largest.
  pure type(estimate_weights) function weights_of(estimated_as, rings, yielded) result(weights)
    integer, intent(in) :: estimated_as(:)   !! as the table of elements says
    logical, intent(in) :: rings             !! the elements are
    logical, intent(in) :: yielded           !! something in the scene has
    integer :: kind(size(estimated_as))

    kind = estimated_as
    where (rings .and. kind /= by_quadrilaterals) kind = merge(4, 5, kind == by_linear_triangles)
    weights = transfer(maxval(thousandths(2*kind - merge(0, 1, yielded), :), dim=1)/1000.0_wp, weights)
  end function weights_of
end module epcont_accuracy_weights
