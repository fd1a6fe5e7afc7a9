!> THE table of tolerances: what counts as nothing, as equal, as at one place. Each is relative to what its
!> line names; what is a choice of method or of taste (a corner's angle, a slow rate) stands where it is used.
!>
!> Tests hold each, layer/name: those behind > fail where it is a thousandth, those behind < where it is a
!> thousand times as large.
module epcont_base_tolerances
  use epcont_base_kinds, only: wp
  implicit none
  private

  ! Rounding of sums and coordinates.

  real(wp), parameter, public :: &
    !> Part of the magnitudes that a sum is made of that rounding leaves where it should cancel (loads along a
    !! motion, the gap between two places, a support's travel and the motion that it follows): some hundred
    !! terms, each rounded once.
    !! > contact/test_random, model/test_facing, test_travel; < model/test_facing, test_travel
    cancelled = 100*epsilon(1.0_wp), &

    ! Rounding of what has been solved for.

    !> Part of the largest of its kind below which a number is rounding: of a table's column, of a row's
    !! weights, of gaps, of the square of an element's extent.
    !! > and < report/test_columns, and all listings
    rounded_off = 1.0e-12_wp, &
    !> In scaled units, where what drives the contact is of size one, an entry up to this is zero, and ratios
    !! this near are tied; refinement ends with such a change. Less takes rounding for forces, more takes
    !! forces for unique that are not.
    !! > contact/test_answers, test_random, test_ties; < contact/test_uniqueness
    negligible = 1.0e-11_wp, &
    !> Part of the largest force by which forces and gaps may have the wrong sign, in scaled units: all that
    !! can be asked where the flexibility is badly conditioned (1e10: tests/contact/hard_problem). Stresses
    !! this near to their curves are on them; gaps that a motion closes by such a part of it are not closed.
    !! > found/a_force_that_drives_nothing, and contact/test_random from 1e-14 on; < contact/test_answers,
    !! extremes/test_motions
    solved_to = 1.0e-10_wp, &
    !> Part of the largest of its kind (shares, distances, stresses, strains, pressures) by which equal
    !! figures differ; errors up to this are rounding.
    !! > and < report/test_columns; < listing_ring_joint
    least_difference = 1.0e-9_wp, &
    !> Largest imbalance, penetration or pull of a valid answer, as a part of the largest of each: what
    !! input/README.md promises.
    !! > and < certificate/test_limits
    valid_to = 1.0e-9_wp, &
    !> Part of the largest entry of its row or column up to which a pivot or a singular value is none, far
    !! below what a deck's digits leave.
    !! > and < model/test_motion_faults
    dependent = 1.0e-9_wp, &
    !> Components of a null vector or of a ray (largest about 1) up to this are zero: it comes off the end of
    !! a long path. Less takes rounding for a force that can change, more takes two points that hold a body
    !! for one.
    !! > contact/test_uniqueness; < contact/test_answers
    null_component = 1.0e-7_wp, &

    ! What the digits of a deck decide: eight in its short fields.

    !> Part of the largest force or pivot that such digits, or rounding, may make of nothing: less takes them
    !! for a support.
    !! > contact/test_answers, report/test_outcome; < certificate/test_certificate, report/test_outcome
    lost_digits = 1.0e-8_wp, &
    !> Part of an extent, of the scene or a body, within which places are one: less is no gap, and no lever.
    !! > certificate/test_beyond; > and < certificate/test_scene, test_allowance
    same_place = 1.0e-8_wp, &
    !> Part of the largest of its kind (forces, gaps, pressures, curvatures, errors of elements, turns) up to
    !! which one has no effect, nor by how much two differ.
    !! > and < accuracy/test_waves
    no_effect = 1.0e-6_wp, &
    !> Part of a side within which places are one, or on one line; of a radius, within which lines meet.
    !! > model/test_body_outline, test_pair_faults, extremes/test_motions; < model/test_body_outline,
    !! certificate/test_allowance, extremes/test_motions
    coincident = 1.0e-4_wp, &
    !> Part of its side's area that a corner on the axis has from rounding and curvature alone: of a ball,
    !! where the side is up to a fifth of its radius.
    !! > result/test_pressures; < result/test_pressures, model/test_line_invariance
    no_area = 1.0e-3_wp
end module epcont_base_tolerances
