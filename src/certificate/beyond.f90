!> Nodes displaced beyond a line at which their body ends: the axis of rings, or a line of symmetry.
module epcont_certificate_beyond
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: same_place
  use epcont_certificate_findings, only: beyond_place, scene_type
  use epcont_element_kinematics, only: directions
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: look_beyond

contains

  !> Of rings: the node of least radius, if that is below 0. Of all bodies: the node farthest beyond a line
  !> along which all of an end of its body is held across and somewhere free.
  pure subroutine look_beyond(model, displacement, least, scene)
    type(model_type), intent(in) :: model        !! the scene
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp), intent(in) :: least                !! less is rounding [length]
    type(scene_type), intent(inout) :: scene     !! its places beyond the axis and beyond a mirror are set
    type(beyond_place) :: found
    integer :: c, node, part, way

    if (model%has_rings()) then
      node = minloc(model%x(1, :) + displacement(1, :), dim=1, mask=model%body_outline%part_of > 0)
      found = beyond_place(-(model%x(1, node) + displacement(1, node)), 0.0_wp, 1, node)
      if (found%depth > least) scene%axis = found
    end if
    do c = 1, directions
      do way = -1, 1, 2
        do part = 1, model%body_outline%parts
          found = beyond_end(part, c, way)
          if (found%depth > max(least, scene%mirror%depth)) scene%mirror = found
        end do
      end do
    end do

  contains

    !> The node farthest beyond the end of a part towards lower coordinates (`way` 1), or towards higher ones
    !! (-1), where all that was drawn on that line is held there, and is free to slide along it somewhere;
    !! else none, 0 deep.
    pure type(beyond_place) function beyond_end(part, c, way) result(place)
      integer, intent(in) :: part, c, way
      real(wp), allocatable :: u(:), x(:)
      real(wp) :: edge

      associate (first => model%body_outline%first(part), last => model%body_outline%first(part + 1) - 1)
        associate (node => model%body_outline%node(1, first:last), &
                   next => model%body_outline%node(2, first:last))
          x = way*model%x(c, node)
          u = way*displacement(c, node)
          edge = minval(x) + same_place*(maxval(x) - minval(x))
          if (.not. all(x > edge .or. is_held(c, node) .and. abs(u) <= least)) return
          if (all(x > edge .or. way*model%x(c, next) > edge &
                  .or. is_held(3 - c, node) .and. is_held(3 - c, next))) return
          associate (farthest => minloc(x + u, dim=1))
            place = beyond_place(minval(x) - (x(farthest) + u(farthest)), way*minval(x), c, node(farthest))
          end associate
        end associate
      end associate
    end function beyond_end

    !> Does a support hold a node?
    elemental logical function is_held(direction, node)
      integer, intent(in) :: direction, node

      is_held = model%held(direction, model%leader(direction, node))
    end function is_held
  end subroutine look_beyond
end module epcont_certificate_beyond
