!> Projections of nodes of contact lines, by geometry alone: each node of the slave edges on the
!> master, and in concave corners a second projection.
module epcont_contact_geometry_faces
  use epcont_base_kinds, only: wp
  use epcont_geometry_boundary_line, only: boundary_line, facing_type
  use epcont_geometry_facing, only: find_facing, node_of, same_face
  use epcont_model_contact_rows, only: line_contact
  implicit none
  private
  public :: faces_type, find_faces, has_face, node_face

  !> A node and its projection.
  type, extends(facing_type) :: node_face
    integer :: node = 0
  end type node_face

  !> Projections of the slave nodes.
  type :: faces_type
    type(node_face), allocatable :: row(:)   !! one row for each projection [any]
    !> Rows of the nodes of each edge; 0: no projection [3, edges]
    integer, allocatable :: row_of(:, :)
  end type faces_type

contains

  !> Has a node a projection with nearly the same normal?
  pure logical function has_face(faces, node, normal, least_cosine)
    type(node_face), intent(in) :: faces(:)    !! projections of these nodes [any]
    integer, intent(in) :: node                !! index of the node
    real(wp), intent(in) :: normal(2)          !! normal to compare with
    real(wp), intent(in) :: least_cosine       !! cosine of the largest angle between them

    has_face = any(faces%node == node .and. &
                   faces%normal(1)*normal(1) + faces%normal(2)*normal(2) > least_cosine)
  end function has_face

  !> Project the slave nodes on the master, in their order along the edges; then find second projections,
  !! unless they have the normal of another projection of the node.
  subroutine find_faces(contact, obstacles, faces)
    type(line_contact), intent(inout) :: contact    !! the contact; nodes left out are added
    type(boundary_line), intent(in) :: obstacles    !! the outlines of all bodies
    type(faces_type), intent(out) :: faces          !! the projections
    integer, parameter :: in_turn(3) = [1, 3, 2]    ! start, middle, end
    type(node_face), dimension(3*size(contact%slave%element)) :: first, second
    integer :: left_out(2, 3*size(contact%slave%element))
    integer :: k, left, rows, s, seconds

    allocate (faces%row_of(3, size(contact%slave%element)), source=0)
    rows = 0
    seconds = 0
    left = 0
    do s = 1, size(contact%slave%element)
      do k = 1, 3
        if (contact%slave%segment(in_turn(k), s) > 0) call look_from_node(s, in_turn(k))
      end do
    end do
    faces%row = first(:rows)
    do k = 1, seconds
      if (.not. has_face(faces%row, second(k)%node, second(k)%normal, same_face)) &
        faces%row = [faces%row, second(k)]
    end do
    contact%left_out = left_out(:, :left)

  contains

    !> Project a node of an edge, unless the neighbouring edge has done so.
    subroutine look_from_node(side, which)
      integer, intent(in) :: side, which
      type(facing_type) :: face(2)
      integer :: neighbour

      associate (slave => contact%slave, node => contact%slave%segment(which, side), &
                 row => faces%row_of(which, side))
        neighbour = 0
        if (which < 3) neighbour = slave%neighbour(which, side)
        if (neighbour > 0) row = faces%row_of(3 - which, neighbour)
        if (row > 0) then   ! if boundary and master are smooth, use the neighbour's projection
          if (all(slave%normal(:, which, side) == slave%normal(:, 3 - which, neighbour)) .and. &
              all(second(:seconds)%node /= node)) return
        end if
        face = find_facing(contact%master, obstacles, node_of(slave, side, which), contact%search)
        if (face(2)%found) then
          seconds = seconds + 1
          second(seconds) = node_face(facing_type=face(2), node=node)
        end if
        if (.not. face(1)%found) then
          row = 0
          left = left + 1
          left_out(:, left) = [side, which]
          return
        end if
        ! Edges that meet in a hinge are not neighbours.
        if (which < 3 .and. neighbour == 0) row = findloc(first(:rows)%node, node, dim=1)
        if (row > 0) then   ! around a corner, each edge has its own pair
          if (face(1)%cosine(first(row)) > same_face) return
        end if
        rows = rows + 1
        row = rows
        first(row) = node_face(facing_type=face(1), node=node)
      end associate
    end subroutine look_from_node
  end subroutine find_faces
end module epcont_contact_geometry_faces
