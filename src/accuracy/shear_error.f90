!> Error of the largest shear traction of a contact zone with friction.
!>
!> Where pairs slip, the traction has the error of its limit, mu times the pressure. It is largest at the end
!> of a part that sticks: there it reaches the limit with an infinite slope, between two pairs.
module epcont_accuracy_shear_error
  use epcont_accuracy_surface_line, only: surface_line
  use epcont_accuracy_peak, only: zone_error
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_effect
  use epcont_model_model, only: model_type
  use epcont_result_answer, only: answer_type, pair_slips
  implicit none
  private
  public :: add_shear_errors

  !> Sticking ends somewhere between two pairs, and the limit there is unknown by this part of the difference
  !! of their limits (tests/accuracy/score_shear.py).
  real(wp), parameter :: unknown_part = 0.3_wp

  !> Friction of all pairs.
  type :: friction_line
    real(wp), allocatable :: shear(:), limit(:)          !! [stress] [pairs]
    logical, allocatable :: sticks(:), slips(:)          !! [pairs]
  contains
    procedure :: beyond
  end type friction_line

contains

  !> Find the largest shear traction of each zone, and its error.
  pure subroutine add_shear_errors(model, line, answer, errors)
    type(model_type), intent(in) :: model
    type(surface_line), intent(in) :: line            !! of its pairs
    type(answer_type), intent(in) :: answer
    type(zone_error), intent(inout) :: errors(:)      !! of its zones
    type(friction_line) :: friction
    integer :: z

    friction = friction_of(model, answer)
    do z = 1, size(errors)
      call add_shear_error(friction, line, answer, answer%zones(z)%pairs, errors(z))
      if (errors(z)%shear >= 0.0_wp) errors(z)%shear = errors(z)%shear + &
        maxval(model%contact%friction(answer%zones(z)%pairs))*errors(z)%pressure
    end do
  end subroutine add_shear_errors

  !> Find the largest shear traction of a zone, and its error beyond that of the limit; negative: unknown,
  !! because there is no shear, or no estimate for the pressure, or because a pair that sticks beside an open
  !! one has the largest shear.
  pure subroutine add_shear_error(friction, line, answer, pairs, error)
    type(friction_line), intent(in) :: friction
    type(surface_line), intent(in) :: line       !! of all pairs
    type(answer_type), intent(in) :: answer
    integer, intent(in) :: pairs(:)              !! of the zone
    type(zone_error), intent(inout) :: error     !! with that of its largest pressure
    real(wp) :: largest, more                    ! [stress]
    integer :: e, i, other

    largest = maxval(abs(friction%shear(pairs)))
    error%largest_shear = largest
    if (error%pressure < 0.0_wp .or. largest <= no_effect*maxval(friction%limit(pairs))) return
    more = 0.0_wp
    do i = 1, size(pairs)
      associate (pair => pairs(i))
        if (.not. friction%sticks(pair)) cycle
        do e = 1, 2
          other = line%neighbour(e, pair)
          if (other == 0) cycle
          if (friction%sticks(other)) cycle
          if (.not. answer%contact%touching(other) .and. &
              abs(friction%shear(pair)) >= (1.0_wp - no_effect)*largest) return
          more = max(more, friction%beyond(line, line%neighbour(3 - e, pair), pair, other, largest))
        end do
      end associate
    end do
    error%shear = more
  end subroutine add_shear_error

  !> Collect tractions and states. Pairs that supports hold on a line of symmetry stick.
  pure type(friction_line) function friction_of(model, answer) result(friction)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer

    associate (sliding => model%contact%sliding, touching => answer%contact%touching)
      friction%limit = merge(model%contact%friction*max(answer%pressure, 0.0_wp), 0.0_wp, touching)
      friction%shear = 0.0_wp*friction%limit
      friction%shear(sliding) = answer%shear(sliding)
      friction%slips = spread(.false., 1, size(touching))
      friction%slips(sliding) = answer%friction_states(sliding) == pair_slips
      friction%sticks = touching .and. model%contact%friction > 0.0_wp .and. .not. friction%slips
    end associate
  end function friction_of

  !> How far does the traction between a pair that sticks and its neighbour exceed the largest one? The
  !! traction missing up to the limit squared falls linearly towards the end of sticking [stress].
  pure real(wp) function beyond(self, line, inner, pair, outer, largest)
    class(friction_line), intent(in) :: self
    type(surface_line), intent(in) :: line
    integer, intent(in) :: inner, pair, outer   !! neighbours; the first may be 0
    real(wp), intent(in) :: largest             !! [stress]
    real(wp) :: missing(2), part, way

    way = sign(1.0_wp, merge(self%shear(outer), self%shear(pair), self%slips(outer)))
    part = 1.0_wp
    if (inner > 0) then
      missing = self%limit([inner, pair]) - way*self%shear([inner, pair])
      if (self%sticks(inner) .and. missing(2) < missing(1)) part = min(1.0_wp, (missing(2)/missing(1))**2/ &
        (1.0_wp - (missing(2)/missing(1))**2)*line%distance(pair, inner)/line%distance(pair, outer))
    end if
    associate (change => self%limit(outer) - self%limit(pair))
      beyond = max(0.0_wp, self%limit(pair) + part*change - largest) + unknown_part*abs(change)
    end associate
  end function beyond
end module epcont_accuracy_shear_error
