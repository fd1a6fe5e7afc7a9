!> Gaps whose bend alternates from node to node: sides of a curve drawn as chords, middle nodes between their corners instead of on
!> it, polygons of unlike divisions in each other. Such waves are no part of the scene that is meant.
!>
!> Nodes that stand a above and a below the gap that is meant, by turns, a distance d apart, bend it by r = 8 a/d more at the one
!> than at the other. Flattened, waves 2 d long take a pressure of pi E* a/(2 d) (Westergaard 1939), which is pi/16 E* r.
module epcont_accuracy_waves
  use epcont_accuracy_contact_stress, only: surface_compliance
  use epcont_accuracy_limits, only: bend_at
  use epcont_accuracy_patches, only: patch_table
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_result_contact_line, only: contact_line, distance
  implicit none
  private
  public :: find_waves

  real(wp), parameter :: flattened = acos(-1.0_wp)/16.0_wp

contains

  !> Of the pairs of a zone: the pressure that flattens their waves, the largest, and how high they are, the mean.
  pure subroutine find_waves(model, table, line, pairs, pressure, height)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pairs(:)
    real(wp), intent(out) :: pressure   !! [stress]
    real(wp), intent(out) :: height     !! [length]
    real(wp) :: angle, compliance, spacing
    integer :: k

    pressure = 0.0_wp
    height = 0.0_wp
    do k = 1, size(pairs)
      call alternating_bend(model, line, pairs(k), angle, spacing)
      compliance = surface_compliance(model, table, pairs(k))
      if (compliance > 0.0_wp) pressure = max(pressure, flattened*angle/compliance)
      height = height + angle*spacing/8.0_wp/size(pairs)
    end do
  end subroutine find_waves

  !> How much more the gap bends at a pair than beside it, or less: by its curvature there, since sides may grow along a line.
  pure subroutine alternating_bend(model, line, pair, angle, spacing)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair
    real(wp), intent(out) :: angle     !! [rad]
    real(wp), intent(out) :: spacing   !! [length]
    real(wp) :: bend, beside, curvature, other
    integer :: k, near

    angle = 0.0_wp
    spacing = 0.0_wp
    if (.not. bends(line, pair)) return
    call bend_at(model, line, pair, bend, curvature)
    beside = 0.0_wp
    near = 0
    do k = 1, 2
      associate (next => line%neighbour(k, pair))
        if (next == 0) cycle
        if (.not. bends(line, next)) cycle
        call bend_at(model, line, next, bend, other)
        beside = beside + other
        near = near + 1
        spacing = spacing + distance(model, line, pair, next)
      end associate
    end do
    if (near == 0) return
    spacing = spacing/near
    angle = abs(curvature - beside/near)*spacing
  end subroutine alternating_bend

  !> Does the line go on to both sides of a pair? Else nothing is known of its bend.
  pure logical function bends(line, pair)
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair

    bends = all(line%neighbour(:, pair) > 0) .or. line%mirrored(pair)
  end function bends
end module epcont_accuracy_waves
