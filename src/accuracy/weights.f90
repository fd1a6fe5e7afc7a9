!> THE table of what the parts of an estimate count, measured on scenes whose answers are known (tests/accuracy).
module epcont_accuracy_weights
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: estimate_weights, weights_of

  type :: estimate_weights
    !> Of the largest pressure: its distance from a parabola through the nearest pairs, from the smooth stress, the smaller of
    !! these two, and h/b of it.
    real(wp) :: parabola, stress, smaller, spacing
    !> Of the half-width: what three pairs say of the end less what two say, and the spacing there.
    real(wp) :: ends, step
    !> Of the approach: the product of two fields of errors, whose parts may cancel; of pressure (h/b)**2 b/E*, by which bodies
    !! come too near since their nodes touch and not the line between them; and the same for contact that ends at a node.
    real(wp) :: product, between, end
  end type estimate_weights

  !> Elastic, then with something beyond yield.
  type(estimate_weights), parameter :: tria3(2) = [ &
    estimate_weights(0.0_wp, 0.0_wp, 2.0_wp, 0.12_wp, 1.0_wp, 0.25_wp, 1.35_wp, 0.0_wp, 0.04_wp), &
    estimate_weights(0.0_wp, 0.0_wp, 2.0_wp, 0.12_wp, 1.0_wp, 0.25_wp, 1.35_wp, 0.0_wp, 0.2_wp)]
  type(estimate_weights), parameter :: quad4(2) = [ &
    estimate_weights(4.0_wp, 0.0_wp, 0.0_wp, 0.018_wp, 1.0_wp, 0.25_wp, 1.35_wp, 0.2_wp, 0.04_wp), &
    estimate_weights(4.0_wp, 0.0_wp, 0.0_wp, 0.018_wp, 1.0_wp, 0.25_wp, 1.35_wp, 0.2_wp, 0.2_wp)]
  type(estimate_weights), parameter :: tria6(2) = [ &
    estimate_weights(0.2_wp, 1.0_wp, 0.0_wp, 0.016_wp, 1.0_wp, 0.18_wp, 1.35_wp, 0.0_wp, 0.16_wp), &
    estimate_weights(0.2_wp, 1.0_wp, 0.0_wp, 0.016_wp, 1.0_wp, 0.18_wp, 1.35_wp, 0.0_wp, 0.8_wp)]
  type(estimate_weights), parameter :: trax3(2) = tria3, trax6(2) = tria6

contains

  !> Those of elements with so many nodes.
  pure type(estimate_weights) function weights_of(order, rings, yielded) result(weights)
    integer, intent(in) :: order      !! 3, 4 or 6
    logical, intent(in) :: rings
    logical, intent(in) :: yielded    !! something in the scene has
    integer :: state

    state = merge(2, 1, yielded)
    select case (order)
    case (3)
      weights = tria3(state)
      if (rings) weights = trax3(state)
    case (4)
      weights = quad4(state)
    case default
      weights = tria6(state)
      if (rings) weights = trax6(state)
    end select
  end function weights_of
end module epcont_accuracy_weights
