!> Pressures along sides of elements.
module epcont_model_pressure
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_geometry_edge, only: edge_point, edge_point_count, edge_points
  use epcont_geometry_plane, only: turned
  use epcont_model_arrays, only: side_pressure
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: add_pressure, find_side

contains

  !> The side of a pressure.
  pure subroutine find_side(model, given, ends, behind)
    type(model_type), intent(in) :: model      !! the scene
    type(side_pressure), intent(in) :: given   !! the pressure
    !> Nodes of the side, counter-clockwise, and its middle, 0 where it has none; 0: there is no such side
    integer, intent(out) :: ends(3)
    integer, intent(out) :: behind   !! the element that has the side too; 0: none
    integer, allocatable :: beside(:)
    integer :: k

    ends = model%mesh%edge_between(given%element, given%corner(1), given%corner(2))
    behind = 0
    if (ends(1) == 0 .or. model%mesh%section(given%element) == 0) return
    beside = model%mesh%with_side(ends(1), ends(2))
    do k = size(beside), 1, -1   ! the element behind goes the other way along the side
      if (all(model%mesh%edge_between(beside(k), ends(1), ends(2)) == ends([2, 1, 3]))) behind = beside(k)
    end do
  end subroutine find_side

  !> Add the nodal forces of a pressure along a side.
  pure subroutine add_pressure(model, given, share)
    type(model_type), intent(inout) :: model   !! the scene
    type(side_pressure), intent(in) :: given   !! the pressure; its element has a section, and the side
    real(wp), intent(in) :: share              !! factor of the pressure
    type(edge_point) :: point(edge_point_count)
    real(wp) :: depth, direction(directions), at_ends(2), value
    integer :: ends(3), k, p

    ends = model%mesh%edge_between(given%element, given%corner(1), given%corner(2))
    at_ends = share*merge(given%pressure, given%pressure([2, 1]), ends(1) == given%corner(1))
    point = edge_points(model%mesh%edge_coordinates(ends))
    do p = 1, edge_point_count
      ! From inward: the element lies to the left
      direction = turned([-point(p)%tangent(2), point(p)%tangent(1)], given%theta)
      depth = model%depth(given%element, point(p)%x(1))
      value = at_ends(1) + (at_ends(2) - at_ends(1))*point(p)%along
      do k = 1, size(ends)
        if (ends(k) > 0) model%loads%load(:, ends(k)) = model%loads%load(:, ends(k)) + &
            value*depth*point(p)%values(k)*direction
      end do
    end do
  end subroutine add_pressure
end module epcont_model_pressure
