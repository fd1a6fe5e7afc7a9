!> Table of all tolerances: numbers that are treated as zero or equal, and points treated as one. Each is
!> relative to the quantity in its comment. Choices of methods (a corner's angle, a slow rate) are defined
!> where they are used.
!>
!> Tests (layer/name) keep each of them: those after > fail if it is a thousand times smaller, those after <
!> if it is a thousand times larger.
module epcont_base_tolerances
  use epcont_base_kinds, only: wp
  implicit none
  private

  ! Rounding of sums and coordinates.

  real(wp), parameter, public :: &
    !> Rounding left by a sum whose terms cancel, relative to the sum of their magnitudes (loads along a
    !! rigid-body mode, the gap between two points, prescribed displacements that are a rigid-body
    !! displacement): about a hundred terms, each rounded once.
    !! > contact/test_bounds, test_random, model/test_facing, test_travel; < model/test_facing, test_travel
    cancelled = 100*epsilon(1.0_wp), &

    ! Rounding of solutions.

    !> Numbers below this part of the largest of their kind are rounding: in a column of a table, among the
    !! weights of a row, gaps, and areas over the square of an element's extent.
    !! > and < report/test_columns, and all listings
    rounded_off = 1.0e-12_wp, &
    !> In scaled units (loads and gaps of size one), entries of at most this are zero, ratios that differ by
    !! at most this are equal, and iterative refinement ends with this change. If it is smaller, rounding is
    !! treated as a force; if it is larger, forces that are not unique are treated as unique.
    !! > contact/test_answers, test_random, test_ties; < contact/test_uniqueness
    negligible = 1.0e-11_wp, &
    !> Part of the largest force by which forces and gaps may have the wrong sign, in scaled units: the limit
    !! for ill-conditioned flexibilities (1e10: tests/contact/hard_problem). Stresses this close to their
    !! curve are on it. Gaps that a rigid-body mode closes by this part of its displacement stay as they are.
    !! > found/a_force_that_drives_nothing, and contact/test_random from 1e-14 on; < contact/test_answers,
    !! extremes/test_motions
    solved_to = 1.0e-10_wp, &
    !> Equal numbers differ by at most this part of the largest of their kind (shape functions, distances,
    !! stresses, strains, pressures); errors of at most this are rounding.
    !! > and < report/test_columns; < listing_ring_joint
    least_difference = 1.0e-9_wp, &
    !> Largest residual, penetration or tensile contact force of a valid answer, relative to the largest
    !! force or length, as stated in input/README.md.
    !! > and < certificate/test_limits
    valid_to = 1.0e-9_wp, &
    !> Pivots and singular values of at most this part of the largest entry of their row or column are zero;
    !! far below the rounding of a deck's digits.
    !! > and < model/test_motion_faults
    dependent = 1.0e-9_wp, &
    !> Components of a null vector or of a ray (largest about 1) of at most this are zero, because they have
    !! the rounding of a long path. If it is smaller, rounding is treated as a force that can change; if it
    !! is larger, two points that support a body are treated as one.
    !! > contact/test_uniqueness; < contact/test_answers
    null_component = 1.0e-7_wp, &

    ! Rounding of the digits of a deck: eight in its short fields.

    !> Part of the largest force or pivot that such digits, or rounding, may produce from zero. If it is
    !! smaller, they are treated as a support.
    !! > contact/test_answers, report/test_outcome; < certificate/test_certificate, report/test_outcome
    lost_digits = 1.0e-8_wp, &
    !> Points within this part of the extent of the model or body are one point: smaller gaps and lever arms
    !! are zero.
    !! > certificate/test_beyond; > and < certificate/test_scene, test_allowance
    same_place = 1.0e-8_wp, &
    !> Values and differences of at most this part of the largest of their kind (forces, gaps, pressures,
    !! curvatures, errors of elements, rotations) have no effect.
    !! > and < accuracy/test_waves
    no_effect = 1.0e-6_wp, &
    !> Points within this part of an edge are one point or on one line; lines within this part of a radius
    !! meet.
    !! > model/test_body_outline, extremes/test_motions; < model/test_body_outline,
    !! certificate/test_allowance, extremes/test_motions
    coincident = 1.0e-4_wp, &
    !> Area of a corner on the axis due to rounding and curvature alone, relative to the area of its edge: for
    !! a ball whose edges are at most a fifth of its radius.
    !! > result/test_pressures; < result/test_pressures, model/test_line_invariance
    no_area = 1.0e-3_wp
end module epcont_base_tolerances
