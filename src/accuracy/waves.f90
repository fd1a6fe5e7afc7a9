!> Gaps whose bend alternates from node to node: sides of a curve drawn as chords, middle nodes between their corners instead of on
!> it, polygons of unlike divisions in each other. Such waves are no part of the scene that is meant.
!>
!> Nodes that stand a above and a below the gap that is meant, by turns, a distance d apart, bend it by r = 8 a/d more at the one
!> than at the other. Flattened, waves 2 d long take a pressure of pi E* a/(2 d) (Westergaard 1939), which is pi/16 E* r.
module epcont_accuracy_waves
  use epcont_accuracy_contact_stress, only: surface_compliance
  use epcont_accuracy_limits, only: bend_at, corner
  use epcont_accuracy_patches, only: patch_table
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_result_contact_line, only: contact_line, distance
  implicit none
  private
  public :: find_waves

  real(wp), parameter :: flattened = acos(-1.0_wp)/16.0_wp

contains

  !> Of the pairs of a zone: the pressure that flattens all uneven bends, and that of waves, the largest; how high waves are, the
  !! mean. A tip bends the gap once, where a fillet begins its curvature steps: these are uneven bends, and no waves.
  pure subroutine find_waves(model, table, line, pairs, bends, waves, height)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pairs(:)
    real(wp), intent(out) :: bends, waves   !! [stress]
    real(wp), intent(out) :: height         !! [length]
    real(wp) :: angle, compliance, spacing, uneven
    integer :: k

    bends = 0.0_wp
    waves = 0.0_wp
    height = 0.0_wp
    do k = 1, size(pairs)
      call alternating_bend(model, line, pairs(k), uneven, angle, spacing)
      compliance = surface_compliance(model, table, pairs(k))
      if (compliance > 0.0_wp) then
        bends = max(bends, flattened*uneven/compliance)
        waves = max(waves, flattened*angle/compliance)
      end if
      height = height + angle*spacing/8.0_wp/size(pairs)
    end do
  end subroutine find_waves

  !> How much more, or less, the gap bends at a pair than beside it: by its curvature there, since sides may grow along a line. Of
  !! waves it does so by turns: of four pairs in a row the first and the third bend it by more than the others, or by less.
  pure subroutine alternating_bend(model, line, pair, uneven, angle, spacing)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair
    real(wp), intent(out) :: uneven    !! [rad]
    real(wp), intent(out) :: angle     !! that of waves [rad]
    real(wp), intent(out) :: spacing   !! [length]
    real(wp) :: bend, curvature(5)
    integer :: k, run(5)   !! the pair in the middle of four others; 0: none

    uneven = 0.0_wp
    angle = 0.0_wp
    spacing = 0.0_wp
    if (.not. goes_on(line, pair)) return
    run(2:4) = [line%neighbour(1, pair), pair, line%neighbour(2, pair)]
    if (line%mirrored(pair)) run([2, 4]) = maxval(run([2, 4]))
    run(1) = behind(line, run(2), pair)
    run(5) = behind(line, run(4), pair)
    spacing = 0.5_wp*(distance(model, line, pair, run(2)) + distance(model, line, pair, run(4)))
    do k = 1, 5
      if (run(k) == 0) cycle
      if (.not. goes_on(line, run(k))) run(k) = 0
      if (run(k) == 0) cycle
      call bend_at(model, line, run(k), bend, curvature(k))
      if (abs(bend) > corner .and. k /= 3) run(k) = 0   ! there it faces a step, or another side
    end do
    associate (beside => pack(curvature([2, 4]), run([2, 4]) > 0))
      if (size(beside) > 0) uneven = spacing*abs(curvature(3) - sum(beside)/size(beside))
    end associate
    do k = 1, 2
      if (all(run(k:k + 3) > 0)) angle = max(angle, spacing*turns(curvature(k:k + 3)))
    end do
  end subroutine alternating_bend

  !> Does the line go on to both sides of a pair? Else nothing is known of its bend.
  pure logical function goes_on(line, pair)
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair

    goes_on = all(line%neighbour(:, pair) > 0) .or. line%mirrored(pair)
  end function goes_on

  !> By how much four values alternate; 0: they do not.
  pure real(wp) function turns(x)
    real(wp), intent(in) :: x(4)

    turns = max(0.0_wp, minval(x([1, 3])) - maxval(x([2, 4])), minval(x([2, 4])) - maxval(x([1, 3])))
  end function turns

  !> The pair behind one, seen from its neighbour, as mirrored at a line of symmetry; 0: none.
  pure integer function behind(line, pair, from)
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair, from

    behind = 0
    if (pair == 0) return
    behind = sum(line%neighbour(:, pair)) - from
    if (behind == 0 .and. line%mirrored(pair)) behind = from
  end function behind
end module epcont_accuracy_waves
