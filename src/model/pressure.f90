!> Pressures on edges of elements.
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

  !> Find the edge of a pressure.
  pure subroutine find_side(model, given, ends, behind)
    type(model_type), intent(in) :: model      !! the model
    type(side_pressure), intent(in) :: given   !! the pressure
    !> Nodes of the edge, counter-clockwise, and its mid-side node, 0 if absent; all 0: no such edge
    integer, intent(out) :: ends(3)
    integer, intent(out) :: behind   !! the other element at this edge, 0 if absent
    integer, allocatable :: beside(:)
    integer :: k

    ends = model%mesh%edge_between(given%element, given%corner(1), given%corner(2))
    behind = 0
    if (ends(1) == 0 .or. model%mesh%section(given%element) == 0) return
    beside = model%mesh%with_side(ends(1), ends(2))
    do k = size(beside), 1, -1   ! the other element has the edge in the opposite direction
      if (all(model%mesh%edge_between(beside(k), ends(1), ends(2)) == ends([2, 1, 3]))) behind = beside(k)
    end do
  end subroutine find_side

  !> Add the nodal forces of a pressure on an edge.
  pure subroutine add_pressure(model, given, share)
    type(model_type), intent(inout) :: model   !! the model
    type(side_pressure), intent(in) :: given   !! the pressure; its element has a section, and the edge exists
    real(wp), intent(in) :: share              !! factor of the pressure
    type(edge_point) :: point(edge_point_count)
    real(wp) :: depth, direction(directions), at_ends(2), value
    integer :: ends(3), k, p

    ends = model%mesh%edge_between(given%element, given%corner(1), given%corner(2))
    at_ends = share*merge(given%pressure, given%pressure([2, 1]), ends(1) == given%corner(1))
    point = edge_points(model%mesh%edge_coordinates(ends))
    do p = 1, edge_point_count
      ! Relative to inward: the element is to the left
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
