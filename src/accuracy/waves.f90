!> Gaps whose bend alternates from node to node: sides of a curve drawn as chords, middle nodes between their
!> corners instead of on it, polygons of unlike divisions in each other. Such waves are no part of the scene
!> that is meant.
!>
!> Nodes that stand a above and a below the gap that is meant, by turns, a distance d apart, bend it by r = 8
!> a/d more at the one than at the other. Flattened, waves 2 d long take a pressure of pi E* a/(2 d)
!> (Westergaard 1939), which is pi/16 E* r.
module epcont_accuracy_waves
  use epcont_accuracy_contact_stress, only: surface_compliance
  use epcont_accuracy_limits, only: bend_at, beyond, corner
  use epcont_accuracy_patches, only: patch_table
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: alike
  use epcont_model_model, only: model_type
  use epcont_result_contact_line, only: contact_line
  implicit none
  private
  public :: find_waves

  real(wp), parameter :: flattened = acos(-1.0_wp)/16.0_wp
  !> Part of a zone's pairs at which the gap bends by turns from which on that is waves.
  real(wp), parameter :: common = 1.0_wp/3.0_wp

contains

  !> Of the pairs of a zone: the pressure that flattens all uneven bends, the largest; whether these are
  !! waves; how high they are then, the mean. A tip bends the gap once, where a fillet begins its curvature
  !! steps: these are uneven bends, and no waves.
  pure subroutine find_waves(model, table, line, pairs, pressure, are_waves, height)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pairs(:)
    real(wp), intent(out) :: pressure     !! [stress]
    logical, intent(out) :: are_waves
    real(wp), intent(out) :: height       !! [length]
    real(wp) :: angle, compliance, spacing
    logical :: alternates(size(pairs))
    integer :: k

    pressure = 0.0_wp
    height = 0.0_wp
    do k = 1, size(pairs)
      call uneven_bend(model, line, pairs(k), angle, spacing, alternates(k))
      compliance = surface_compliance(model, table, pairs(k))
      if (compliance > 0.0_wp) pressure = max(pressure, flattened*angle/compliance)
      height = height + angle*spacing/8.0_wp/size(pairs)
    end do
    are_waves = count(alternates) >= common*size(pairs)
    if (.not. are_waves) height = 0.0_wp
  end subroutine find_waves

  !> How much more, or less, the gap bends at a pair than beside it: by its curvature there, since sides may
  !! grow along a line. Does it so by turns? Of four pairs in a row the first and the third bend it by more
  !! than the others, or by less.
  pure subroutine uneven_bend(model, line, pair, angle, spacing, alternates)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair
    real(wp), intent(out) :: angle     !! [rad]
    real(wp), intent(out) :: spacing   !! [length]
    logical, intent(out) :: alternates
    real(wp) :: bend, curvature(5)
    integer :: k, run(5)   !! the pair in the middle of four others; 0: none

    angle = 0.0_wp
    spacing = 0.0_wp
    alternates = .false.
    if (.not. goes_on(line, pair)) return
    run(2:4) = [line%neighbour(1, pair), pair, line%neighbour(2, pair)]
    if (line%mirrored(pair)) run([2, 4]) = maxval(run([2, 4]))
    if (any(run([2, 4]) == 0)) return
    spacing = 0.5_wp*(line%distance(pair, run(2)) + line%distance(pair, run(4)))
    run(1) = behind(line, run(2), pair)
    run(5) = behind(line, run(4), pair)
    do k = 1, 5
      if (run(k) == 0) cycle
      if (goes_on(line, run(k))) then
        call bend_at(model, line, run(k), bend, curvature(k))
        if (abs(bend) > corner .and. k /= 3) run(k) = 0   ! there it faces a step, or another side
      else
        run(k) = 0
      end if
    end do
    associate (beside => pack(curvature([2, 4]), run([2, 4]) > 0))
      if (size(beside) > 0) angle = spacing*abs(curvature(3) - sum(beside)/size(beside))
    end associate
    do k = 1, 2
      if (all(run(k:k + 3) > 0)) alternates = alternates .or. by_turns(curvature(k:k + 3))
    end do
  end subroutine uneven_bend

  !> The pair behind one, seen from its neighbour, as mirrored at a line of symmetry; 0: none.
  pure integer function behind(line, pair, from)
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair, from

    behind = 0
    if (pair == 0) return
    behind = beyond(line, pair, from)
    if (line%mirrored(pair)) behind = from
  end function behind

  !> Does the line go on to both sides of a pair? Else nothing is known of its bend.
  pure logical function goes_on(line, pair)
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair

    goes_on = all(line%neighbour(:, pair) > 0) .or. line%mirrored(pair)
  end function goes_on

  !> Are the first and the third of four values above the others, or below?
  pure logical function by_turns(x)
    real(wp), intent(in) :: x(4)

    associate (odd => x([1, 3]), even => x([2, 4]), least => alike*maxval(abs(x)))
      by_turns = minval(odd) - maxval(even) > least .or. minval(even) - maxval(odd) > least
    end associate
  end function by_turns
end module epcont_accuracy_waves
