!> Gaps whose bend alternates from node to node: sides of a curve drawn as chords, middle nodes between their
!> corners instead of on it, polygons of unlike divisions in each other. Such waves are no part of the scene
!> that is meant.
!>
!> Nodes that stand a above and a below the gap that is meant, by turns, a distance d apart, bend it by r = 8
!> a/d more at the one than at the other.
module epcont_accuracy_waves
  use epcont_accuracy_limits, only: corner
  use epcont_accuracy_surface_line, only: surface_line
  use epcont_accuracy_weights, only: waves_are_common, waves_flattened
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: alike
  implicit none
  private
  public :: find_waves

contains

  !> Of the pairs of a zone: the pressure that flattens all uneven bends, the largest; whether these are
  !! waves; how high they are then, the mean. A tip bends the gap once, where a fillet begins its curvature
  !! steps: these are uneven bends, and no waves.
  pure subroutine find_waves(line, pairs, pressure, are_waves, height)
    type(surface_line), intent(in) :: line    !! of all pairs
    integer, intent(in) :: pairs(:)           !! of the zone
    real(wp), intent(out) :: pressure         !! [stress]
    logical, intent(out) :: are_waves         !! where the gap bends by turns at enough pairs
    real(wp), intent(out) :: height           !! 0 where there are none [length]
    real(wp) :: angle, spacing
    logical :: alternates(size(pairs))
    integer :: k

    pressure = 0.0_wp
    height = 0.0_wp
    do k = 1, size(pairs)
      call uneven_bend(pairs(k), angle, spacing, alternates(k))
      associate (compliance => line%compliance(pairs(k)))
        if (compliance > 0.0_wp) pressure = max(pressure, waves_flattened*angle/compliance)
      end associate
      height = height + angle*spacing/8.0_wp/size(pairs)
    end do
    are_waves = count(alternates) >= waves_are_common*size(pairs)
    if (.not. are_waves) height = 0.0_wp

  contains

    !> How much more, or less, the gap bends at a pair than beside it: by its curvature there, since sides may
    !! grow along a line. Does it so by turns? Of four pairs in a row the first and the third bend it by more
    !! than the others, or by less.
    pure subroutine uneven_bend(pair, angle, spacing, alternates)
      integer, intent(in) :: pair
      real(wp), intent(out) :: angle     !! [rad]
      real(wp), intent(out) :: spacing   !! [length]
      logical, intent(out) :: alternates
      real(wp) :: curvature(5)
      integer :: k, run(5)   !! the pair in the middle of four others; 0: none
      logical :: known(5)

      angle = 0.0_wp
      spacing = 0.0_wp
      alternates = .false.
      if (.not. goes_on(pair)) return
      run(2:4) = [line%neighbour(1, pair), pair, line%neighbour(2, pair)]
      if (line%mirrored(pair)) run([2, 4]) = maxval(run([2, 4]))
      if (any(run([2, 4]) == 0)) return
      spacing = 0.5_wp*(line%distance(pair, run(2)) + line%distance(pair, run(4)))
      run([1, 5]) = [behind(run(2), pair), behind(run(4), pair)]
      known = [(goes_on(run(k)), k=1, 5)]
      curvature = line%curvature(max(run, 1))
      do k = 1, 5   ! beyond a corner a pair faces a step, or another side
        if (k /= 3) known(k) = known(k) .and. abs(line%bend(max(run(k), 1))) <= corner
      end do
      associate (beside => pack(curvature([2, 4]), known([2, 4])))
        if (size(beside) > 0) angle = spacing*abs(curvature(3) - sum(beside)/size(beside))
      end associate
      do k = 1, 2
        if (all(known(k:k + 3))) alternates = alternates .or. by_turns(curvature(k:k + 3))
      end do
    end subroutine uneven_bend

    !> The pair behind one, seen from its neighbour, as mirrored at a line of symmetry; 0: none.
    pure integer function behind(pair, from)
      integer, intent(in) :: pair, from

      behind = from
      if (.not. line%mirrored(pair)) behind = line%beyond(pair, from)
    end function behind

    !> Does the line go on to both sides of a pair? Else nothing is known of its bend.
    pure logical function goes_on(pair)
      integer, intent(in) :: pair   !! 0: none

      goes_on = .false.
      if (pair > 0) goes_on = all(line%neighbour(:, pair) > 0) .or. line%mirrored(pair)
    end function goes_on
  end subroutine find_waves

  !> Are the first and the third of four values above the others, or below?
  pure logical function by_turns(x)
    real(wp), intent(in) :: x(4)

    associate (odd => x([1, 3]), even => x([2, 4]), least => alike*maxval(abs(x)))
      by_turns = minval(odd) - maxval(even) > least .or. minval(even) - maxval(odd) > least
    end associate
  end function by_turns
end module epcont_accuracy_waves
