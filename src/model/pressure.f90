!> Pressures along sides of elements.
module epcont_model_pressure
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_geometry_edge, only: edge_point, edge_point_count, edge_points
  use epcont_geometry_plane, only: turned
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: add_pressure, element_behind

contains

  !> Add the nodal forces of a pressure that varies linearly along a side, from one node to the other:
  !! positive into the element, turned counter-clockwise by theta.
  pure subroutine add_pressure(model, element, side, from, pressure, theta)
    type(model_type), intent(inout) :: model   !! the scene
    integer, intent(in) :: element, side   !! the side, by its number in the element
    integer, intent(in) :: from            !! the node of the first pressure
    real(wp), intent(in) :: pressure(2)    !! at the two nodes [stress]
    real(wp), intent(in) :: theta          !! [degree]
    type(edge_point) :: point(edge_point_count)
    real(wp) :: depth, direction(directions), at_ends(2), value
    integer :: ends(3), k, p

    ends = model%edge(element, side)
    at_ends = merge(pressure, pressure([2, 1]), ends(1) == from)
    point = edge_points(model%edge_coordinates(ends))
    do p = 1, edge_point_count
      ! From inward: the element lies to the left
      direction = turned([-point(p)%tangent(2), point(p)%tangent(1)], theta)
      depth = model%depth(element, point(p)%x(1))
      value = at_ends(1) + (at_ends(2) - at_ends(1))*point(p)%along
      do k = 1, size(ends)
        if (ends(k) > 0) model%load(:, ends(k)) = model%load(:, ends(k)) + &
                                                  value*depth*point(p)%values(k)*direction
      end do
    end do
  end subroutine add_pressure

  !> The element on the other side of an element's side; 0: it is of the boundary.
  pure integer function element_behind(model, element, side) result(other)
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: element, side   !! the side, by its number in the element
    integer :: ends(3), i, k, there(3)

    ends = model%edge(element, side)
    do i = model%around%start(ends(1)), model%around%start(ends(1) + 1) - 1
      other = model%around%group(i)
      k = model%side_between(other, ends(1), ends(2))
      if (k == 0) cycle
      there = model%edge(other, k)
      if (there(1) == ends(2)) return
    end do
    other = 0
  end function element_behind
end module epcont_model_pressure
