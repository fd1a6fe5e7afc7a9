!> Nodes displaced beyond a line at which their body ends: the axis of rings, or a line of symmetry.
module epcont_certificate_beyond
  use epcont_base_kinds, only: wp
  use epcont_certificate_findings, only: beyond_place
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: farthest_beyond_axis, farthest_beyond_mirror

  !> Nodes lie on one line within this part of their body.
  real(wp), parameter :: on_line = 1.0e-6_wp

  !> Where a part ends in one direction.
  type :: end_type
    real(wp) :: line = huge(1.0_wp), farthest = huge(1.0_wp)   !! as drawn, and displaced [length]
    integer :: node = 0            !! which is farthest
    logical :: mirrors = .true.    !! all that lies on the line as drawn is held there ...
    logical :: guides = .false.    !! ... and free to slide along it somewhere
  end type end_type

contains

  !> Of rings: the node of least radius, if that is below 0.
  pure type(beyond_place) function farthest_beyond_axis(model, displacement, least) result(place)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp), intent(in) :: least                !! less is rounding [length]
    integer :: node

    if (.not. model%has_rings()) return
    node = minloc(model%x(1, :) + displacement(1, :), dim=1, mask=model%body_outline%part_of > 0)
    if (node == 0) return
    associate (radius => model%x(1, node) + displacement(1, node))
      if (radius < -least) place = beyond_place(-radius, 0.0_wp, 1, node)
    end associate
  end function farthest_beyond_axis

  !> The node farthest beyond a line along which all of an end of its body is held across and somewhere free.
  pure type(beyond_place) function farthest_beyond_mirror(model, displacement, least) result(place)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp), intent(in) :: least                !! less is rounding [length]
    type(end_type) :: part_end(model%body_outline%parts)
    integer :: c, p, way

    do c = 1, 2
      do way = -1, 1, 2
        part_end = ends_of_parts(model, displacement, least, c, way)
        do p = 1, size(part_end)
          associate (one => part_end(p))
            if (.not. (one%mirrors .and. one%guides)) cycle
            if (one%line - one%farthest <= max(least, place%depth)) cycle
            place = beyond_place(one%line - one%farthest, way*one%line, c, one%node)
          end associate
        end do
      end do
    end do
  end function farthest_beyond_mirror

  !> The ends of all parts towards lower coordinates (`way` 1), or higher ones, which then have the other sign (-1).
  pure function ends_of_parts(model, displacement, least, c, way) result(part_end)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :), least
    integer, intent(in) :: c, way
    type(end_type) :: part_end(model%body_outline%parts)
    real(wp) :: high(model%body_outline%parts)
    integer :: s

    high = -huge(1.0_wp)
    associate (outline => model%body_outline)
      do s = 1, outline%sides
        associate (node => outline%node(1, s), one => part_end(outline%part(s)))
          one%line = min(one%line, way*model%x(c, node))
          high(outline%part(s)) = max(high(outline%part(s)), way*model%x(c, node))
          if (way*(model%x(c, node) + displacement(c, node)) < one%farthest) then
            one%farthest = way*(model%x(c, node) + displacement(c, node))
            one%node = node
          end if
        end associate
      end do
      do s = 1, outline%sides
        associate (node => outline%node(:2, s), p => outline%part(s))
          call look_at_end(node, on_line*(high(p) - part_end(p)%line), part_end(p))
        end associate
      end do
    end associate

  contains

    !> A side: does it begin on the line, is it held there, and does the side lie along it?
    pure subroutine look_at_end(node, within, one)
      integer, intent(in) :: node(2)
      real(wp), intent(in) :: within
      type(end_type), intent(inout) :: one

      if (way*model%x(c, node(1)) > one%line + within) return
      one%mirrors = one%mirrors .and. is_held(c, node(1)) .and. abs(displacement(c, node(1))) <= least
      if (way*model%x(c, node(2)) <= one%line + within) &
        one%guides = one%guides .or. .not. (is_held(3 - c, node(1)) .and. is_held(3 - c, node(2)))
    end subroutine look_at_end

    pure logical function is_held(direction, node)
      integer, intent(in) :: direction, node

      is_held = model%held(direction, model%leader(direction, node))
    end function is_held
  end function ends_of_parts
end module epcont_certificate_beyond
