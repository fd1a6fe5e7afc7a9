!> THE table of what the parts of an estimate count, measured on scenes whose answers are known
!> (tests/accuracy).
module epcont_accuracy_weights
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: by_linear_triangles, by_quadrilaterals
  implicit none
  private
  public :: estimate_weights, weights_of

  type :: estimate_weights
    !> Of the largest pressure: its distance from a parabola through the nearest pairs, that from the smooth
    !! stress, the smaller of the two; h/b, (h/b)**2, how much larger that is over the zone and into the
    !! bodies than at the peak, and the part of the energy that the mesh is off by, of it.
    real(wp) :: parabola, stress, smaller, spacing, square, graded, pressure_energy
    !> Of the half-width: the spacing at its end, and the same part of the energy of it.
    real(wp) :: step, width_energy
    !> Of the approach: the product of two fields of errors, whose parts may cancel; of pressure (h/b)**2
    !! b/E*, by which bodies come too near since their nodes touch and not the line between them; and the same
    !! for contact that ends at a node: a distance d from the true end counts as d**2.
    real(wp) :: product, between, end
  end type estimate_weights

  !> Each for elastic scenes, then for those with something beyond yield. Sides of six-node elements are two
  !! spacings long.
  ! Of p_max: parabola, stress, smaller, spacing, square, graded, energy; of b: step, energy; of the approach:
  ! product, between, end.
  type(estimate_weights), parameter :: tria3(2) = [ &
    estimate_weights(0.5_wp, 0.0_wp, 1.2_wp, 0.1_wp, 0.0_wp, 0.6_wp, 0.2_wp, 0.05_wp, 3.2_wp, 1.6_wp, 0.0_wp, 0.1_wp), &
    estimate_weights(1.3_wp, 0.1_wp, 0.1_wp, 0.02_wp, 0.0_wp, 0.4_wp, 1.6_wp, 0.08_wp, 3.4_wp, 2.6_wp, 0.0_wp, 0.4_wp)]
  type(estimate_weights), parameter :: quad4(2) = [ &
    estimate_weights(1.05_wp, 0.02_wp, 1.1_wp, 0.006_wp, 0.0_wp, 0.08_wp, 0.45_wp, 0.3_wp, 0.1_wp, 1.6_wp, 0.3_wp, 0.15_wp), &
    estimate_weights(1.2_wp, 0.35_wp, 0.0_wp, 0.02_wp, 0.0_wp, 0.12_wp, 0.7_wp, 0.27_wp, 0.8_wp, 1.5_wp, 0.4_wp, 0.3_wp)]
  type(estimate_weights), parameter :: tria6(2) = [ &
    estimate_weights(0.4_wp, 0.04_wp, 1.3_wp, 0.024_wp, 0.0_wp, 0.16_wp, 0.0_wp, 0.29_wp, 0.2_wp, 1.8_wp, 0.0_wp, 0.14_wp), &
    estimate_weights(0.5_wp, 0.8_wp, 0.5_wp, 0.006_wp, 0.0_wp, 0.06_wp, 2.5_wp, 0.3_wp, 0.5_wp, 1.7_wp, 0.0_wp, 0.75_wp)]
  type(estimate_weights), parameter :: trax3(2) = [ &
    estimate_weights(1.3_wp, 0.0_wp, 0.3_wp, 0.2_wp, 0.0_wp, 0.6_wp, 0.3_wp, 0.2_wp, 0.75_wp, 1.4_wp, 0.0_wp, 0.2_wp), &
    estimate_weights(1.5_wp, 0.0_wp, 0.2_wp, 0.03_wp, 0.0_wp, 0.45_wp, 1.2_wp, 0.16_wp, 0.65_wp, 1.3_wp, 0.0_wp, 0.12_wp)]
  type(estimate_weights), parameter :: trax6(2) = [ &
    estimate_weights(1.2_wp, 0.02_wp, 0.5_wp, 0.003_wp, 0.36_wp, 0.05_wp, 2.8_wp, 0.31_wp, 0.5_wp, 1.4_wp, 0.0_wp, 0.35_wp), &
    estimate_weights(0.7_wp, 0.17_wp, 0.8_wp, 0.0_wp, 0.2_wp, 0.05_wp, 3.2_wp, 0.33_wp, 0.5_wp, 2.1_wp, 0.0_wp, 0.4_wp)]

contains

  !> Those of a kind of elements.
  pure type(estimate_weights) function weights_of(estimated_as, rings, yielded) result(weights)
    integer, intent(in) :: estimated_as   !! as the table of elements says
    logical, intent(in) :: rings
    logical, intent(in) :: yielded    !! something in the scene has
    integer :: state

    state = merge(2, 1, yielded)
    select case (estimated_as)
    case (by_linear_triangles)
      weights = tria3(state)
      if (rings) weights = trax3(state)
    case (by_quadrilaterals)
      weights = quad4(state)
    case default
      weights = tria6(state)
      if (rings) weights = trax6(state)
    end select
  end function weights_of
end module epcont_accuracy_weights
