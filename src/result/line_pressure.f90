!> Contact of two lines seen from both sides: the pressure on the slave line, and on the master line what its
!> nodes receive, over the boundary that belongs to them. How far one is from the other tells what the two
!> meshes make of it.
module epcont_result_line_pressure
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_area
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_edge, only: edge_point, edge_point_count, edge_points
  use epcont_model_model, only: line_contact, model_type
  implicit none
  private
  public :: line_pressure, compare_sides

  type :: line_pressure
    integer :: touching = 0             !! pairs
    real(wp) :: force = 0.0_wp          !! sum of their forces [force]
    real(wp) :: on_slave = 0.0_wp       !! largest pressure [stress]
    real(wp) :: on_master = 0.0_wp      !! largest pressure [stress]
    real(wp) :: difference = 0.0_wp     !! largest, at a touching pair, as a part of the largest on the slave line
  end type line_pressure

contains

  !> Each line contact from both sides.
  pure function compare_sides(model, touching, force, pressure) result(found)
    type(model_type), intent(in) :: model
    logical, intent(in) :: touching(:)
    real(wp), intent(in) :: force(:), pressure(:)   !! of the pairs
    type(line_pressure), allocatable :: found(:)
    integer :: c

    allocate (found(size(model%line_contact)))
    do c = 1, size(found)
      associate (contact => model%line_contact(c))
        found(c) = compare_one(model, contact, touching, force, pressure)
      end associate
    end do
  end function compare_sides

  pure function compare_one(model, contact, touching, force, pressure) result(found)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    logical, intent(in) :: touching(:)
    real(wp), intent(in) :: force(:), pressure(:)
    type(line_pressure) :: found
    real(wp), allocatable :: area(:), received(:)
    real(wp) :: there
    integer :: i, k

    area = node_areas(model, contact%master)
    allocate (received(model%nodes), source=0.0_wp)
    do k = contact%first, contact%first_of_master - 1
      do i = model%row_start(k) + 1, model%row_start(k + 1) - 1
        received(model%row_node(i)) = received(model%row_node(i)) - model%row_weight(i)*force(k)
      end do
    end do
    do k = contact%first_of_master, contact%last
      received(model%pair_node(2, k)) = received(model%pair_node(2, k)) + force(k)
    end do
    where (area > 0.0_wp) received = received/area
    call complete(contact%master, area, received)
    found%touching = count(touching(contact%first:contact%last))
    found%force = sum(force(contact%first:contact%last))
    found%on_slave = max(0.0_wp, maxval(pressure(contact%first:contact%last)))
    found%on_master = max(0.0_wp, maxval(received, mask=area > 0.0_wp))
    if (found%on_slave == 0.0_wp) return
    do k = contact%first, contact%first_of_master - 1
      if (.not. touching(k)) cycle
      there = 0.0_wp
      do i = model%row_start(k) + 1, model%row_start(k + 1) - 1
        there = there - model%row_weight(i)*received(model%row_node(i))
      end do
      found%difference = max(found%difference, abs(there - pressure(k))/found%on_slave)
    end do
  end function compare_one

  !> Corners on the axis of rings, which no boundary belongs to, have the pressure of the middle beside them.
  pure subroutine complete(line, area, received)
    class(boundary_line), intent(in) :: line
    real(wp), intent(in) :: area(:)
    real(wp), intent(inout) :: received(:)
    integer :: i, k

    do i = 1, size(line%element)
      associate (side => line%segment(:, i))
        do k = 1, 2
          if (side(3) > 0 .and. area(side(k)) == 0.0_wp) received(side(k)) = received(side(3))
        end do
      end associate
    end do
  end subroutine complete

  !> The boundary along a line that belongs to each of its nodes: what a pressure of 1 gives to it, 0 where
  !! that is rounding or curvature [length**2] [nodes].
  pure function node_areas(model, line) result(area)
    type(model_type), intent(in) :: model
    class(boundary_line), intent(in) :: line
    real(wp), allocatable :: area(:)
    type(edge_point) :: point(edge_point_count)
    real(wp) :: depth
    real(wp) :: share(3)
    integer :: i, k, p, side(3)

    allocate (area(model%nodes), source=0.0_wp)
    do i = 1, size(line%element)
      side = line%segment(:, i)
      point = edge_points(model%edge_coordinates(side))
      share = 0.0_wp
      do p = 1, edge_point_count
        depth = model%depth(line%element(i), point(p)%x(1))
        do k = 1, size(point(p)%values)
          share(k) = share(k) + depth*point(p)%values(k)*norm2(point(p)%tangent)
        end do
      end do
      do k = 1, 3
        if (side(k) > 0 .and. abs(share(k)) > no_area*sum(share)) area(side(k)) = area(side(k)) + share(k)
      end do
    end do
  end function node_areas
end module epcont_result_line_pressure
