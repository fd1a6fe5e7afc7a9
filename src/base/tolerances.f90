!> THE table of tolerances: what counts as nothing, as equal, as at one place. Each is relative to what its
!> line names; what is a choice of method or of taste (a corner's angle, a slow rate) stands where it is used.
module epcont_base_tolerances
  use epcont_base_kinds, only: wp
  implicit none
  private

  ! Rounding of sums and coordinates.

  !> Part of the magnitudes that a sum is made of that rounding leaves where it should cancel: some hundred
  !! terms, each rounded once. One rounding is too little (tests/contact/test_random).
  real(wp), parameter, public :: cancelled = 100*epsilon(1.0_wp)
  !> Part of the largest coordinate by which places differ from rounding alone.
  real(wp), parameter, public :: coordinate_rounding = 16*epsilon(1.0_wp)
  !> Part of the sum of its terms that rounding leaves of the slope of an energy.
  real(wp), parameter, public :: slope_rounding = 1.0e3_wp*epsilon(1.0_wp)
  !> Part of a prescribed displacement that a motion which follows it exactly leaves.
  real(wp), parameter, public :: travel_rounding = 64*epsilon(1.0_wp)

  ! Rounding of what has been solved for.

  !> Part of the largest of its kind below which a number is rounding: of a table's column, of a row's
  !! weights, of gaps, of the square of an element's extent.
  real(wp), parameter, public :: rounded_off = 1.0e-12_wp
  !> In scaled units, where what drives the contact is of size one, an entry up to this is zero, and ratios
  !! this near are tied; refinement ends with such a change. Between 1e-9, which takes forces for unique that
  !! are not (tests/contact/test_uniqueness), and 1e-13, which takes rounding for forces (test_answers).
  real(wp), parameter, public :: negligible = 1.0e-11_wp
  !> Part of the largest force by which forces and gaps may have the wrong sign, in scaled units: all that can
  !! be asked where the flexibility is badly conditioned (1e10: tests/contact/hard_problem). Stresses this
  !! near to their curves are on them.
  real(wp), parameter, public :: solved_to = 1.0e-10_wp
  !> Part of the largest of its kind (shares, distances, stresses, strains, pressures) by which equal figures
  !! differ; errors up to this are rounding.
  real(wp), parameter, public :: least_difference = 1.0e-9_wp
  !> Largest imbalance, penetration or pull of a valid answer, as a part of the largest of each.
  real(wp), parameter, public :: valid_to = 1.0e-9_wp
  !> Part of the largest entry of its row or column up to which a pivot or a singular value is none, far below
  !! what a deck's digits leave (tests/contact pass from 1e-11 to 1e-7).
  real(wp), parameter, public :: dependent = 1.0e-9_wp
  !> Components of a null vector or of a ray (largest about 1) up to this are zero: it comes off the end of a
  !! long path (tests/contact pass from 1e-9 to 1e-5; below, rounding counts as a force that can change:
  !! test_uniqueness).
  real(wp), parameter, public :: null_component = 1.0e-7_wp

  ! What the digits of a deck decide: eight in its short fields.

  !> Part of the largest force or pivot that such digits, or rounding, may make of nothing (1e-10 takes them
  !! for a support: tests/contact/test_answers).
  real(wp), parameter, public :: lost_digits = 1.0e-8_wp
  !> Part of the scene's extent below which a gap is none.
  real(wp), parameter, public :: no_gap = 1.0e-8_wp
  !> Part of a side or of a body's extent within which places are one, or on one line.
  real(wp), parameter, public :: same_place = 1.0e-6_wp
  !> Part of the largest of its kind (gaps, pressures, curvatures, errors of elements) by which figures differ
  !! that are as large.
  real(wp), parameter, public :: alike = 1.0e-6_wp
  !> Part of the largest force, displacement or turn of its kind up to which there is none.
  real(wp), parameter, public :: no_effect = 1.0e-6_wp
  !> Part of a side within which nodes are at one place.
  real(wp), parameter, public :: coincident = 1.0e-4_wp
  !> Part of its side's area that a corner on the axis has from rounding and curvature alone.
  real(wp), parameter, public :: no_area = 1.0e-3_wp
end module epcont_base_tolerances
