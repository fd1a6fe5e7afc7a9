!> Contact of two lines from both sides: the pressure on the slave line, and the nodal forces on the master
!> line over the boundary that belongs to each node. Their difference is a measure of mesh error.
module epcont_result_line_pressure
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_area
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_model, only: model_type
  use epcont_result_contact_line, only: shares_of_nodes
  implicit none
  private
  public :: line_pressure, compare_sides

  type :: line_pressure
    integer :: touching = 0             !! number of pairs
    real(wp) :: force = 0.0_wp          !! sum of their forces [force]
    real(wp) :: on_slave = 0.0_wp       !! largest pressure [stress]
    real(wp) :: on_master = 0.0_wp      !! largest pressure [stress]
    !> Largest difference at a pair in contact / largest pressure on the slave line
    real(wp) :: difference = 0.0_wp
  end type line_pressure

contains

  !> Compare both sides of each line contact.
  pure subroutine compare_sides(model, touching, force, pressure, found, apart)
    type(model_type), intent(in) :: model           !! model
    logical, intent(in) :: touching(:)              !! [pairs]
    real(wp), intent(in) :: force(:), pressure(:)   !! [force], [stress] [pairs]
    type(line_pressure), allocatable, intent(out) :: found(:)
    !> Pressure on the master line minus pressure on the slave line; 0 at open pairs, and at pairs of CGAPs
    !! [stress] [pairs]
    real(wp), allocatable, intent(out) :: apart(:)
    integer :: c

    apart = spread(0.0_wp, 1, model%contact%pairs)
    allocate (found(size(model%contact%line_contact)))
    do c = 1, size(found)
      call compare(model%contact%line_contact(c), found(c), apart)
    end do

  contains

    pure subroutine compare(contact, found, apart)
      type(line_contact), intent(in) :: contact
      type(line_pressure), intent(out) :: found
      real(wp), intent(inout) :: apart(:)   !! [pairs]
      !> Of the master nodes: area and force, in the end pressure
      real(wp), allocatable :: area(:), received(:)
      integer :: corner(2), first, i, k, last, middle

      associate (row => model%contact%row_node, from => model%contact%row_start(contact%first), &
                 to => model%contact%row_start(contact%last + 1) - 1)
        call find_areas(contact%master, &
                        [row(from:to), pack(contact%master%segment, contact%master%segment > 0)], area)
      end associate
      allocate (received, mold=area)
      received = 0.0_wp
      do k = contact%first, contact%first_of_master - 1
        do i = model%contact%row_start(k) + 1, model%contact%row_start(k + 1) - 1
          received(model%contact%row_node(i)) = received(model%contact%row_node(i)) - &
            model%contact%row_weight(i)*force(k)
        end do
      end do
      do k = contact%first_of_master, contact%last
        received(model%contact%pair_node(2, k)) = received(model%contact%pair_node(2, k)) + force(k)
      end do
      where (area > 0.0_wp) received = received/area
      do i = 1, size(contact%master%element)
        ! Corners on the axis have no boundary; they get the pressure of the mid-side node beside them.
        corner = contact%master%segment(:2, i)
        middle = contact%master%segment(3, i)
        if (middle == 0) cycle
        where (area(corner) == 0.0_wp) received(corner) = received(middle)
      end do
      found%touching = count(touching(contact%first:contact%last))
      found%force = sum(force(contact%first:contact%last))
      found%on_slave = max(0.0_wp, maxval(pressure(contact%first:contact%last)))
      found%on_master = max(0.0_wp, maxval(received, mask=area > 0.0_wp))
      if (found%on_slave == 0.0_wp) return
      do k = contact%first, contact%first_of_master - 1
        if (.not. touching(k)) cycle
        first = model%contact%row_start(k) + 1
        last = model%contact%row_start(k + 1) - 1
        apart(k) = -dot_product(model%contact%row_weight(first:last), &
                                received(model%contact%row_node(first:last))) &
                   - pressure(k)
        found%difference = max(found%difference, abs(apart(k))/found%on_slave)
      end do
    end subroutine compare

    !> Find the area of each node of a line: the nodal force of a unit pressure, 0 if that is rounding or
    !! curvature [length**2] [nodes from the first to the last of some].
    pure subroutine find_areas(line, nodes, area)
      class(boundary_line), intent(in) :: line
      integer, intent(in) :: nodes(:)   !! define the range of nodes
      real(wp), allocatable, intent(out) :: area(:)
      real(wp) :: share(3)
      integer :: i, k

      allocate (area(minval(nodes):maxval(nodes)), source=0.0_wp)
      do i = 1, size(line%element)
        associate (side => line%segment(:, i))
          share = shares_of_nodes(model, line%element(i), side)
          do k = 1, 3
            if (side(k) > 0 .and. abs(share(k)) > no_area*sum(share)) area(side(k)) = area(side(k)) + share(k)
          end do
        end associate
      end do
    end subroutine find_areas
  end subroutine compare_sides
end module epcont_result_line_pressure
