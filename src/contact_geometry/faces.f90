!> What the nodes of lines in contact face, by geometry alone: each node of the slave's sides against the
!> master, and in concave corners a second face of it.
module epcont_contact_geometry_faces
  use epcont_base_kinds, only: wp
  use epcont_geometry_boundary_line, only: boundary_line, facing_type
  use epcont_geometry_facing, only: find_facing, node_of, same_face
  use epcont_model_contact_rows, only: line_contact
  implicit none
  private
  public :: faces_type, find_faces, has_face, node_face

  !> A node and what it faces.
  type, extends(facing_type) :: node_face
    integer :: node = 0
  end type node_face

  !> What nodes of the slave face.
  type :: faces_type
    type(node_face), allocatable :: row(:)   !! each of them a row [any]
    !> Of the nodes of each side; 0: they face nothing [3, sides]
    integer, allocatable :: row_of(:, :)
    integer :: same_way = 0                  !! nodes near sides that look the same way only
  end type faces_type

contains

  !> Has a node a face whose normal is near another?
  pure logical function has_face(faces, node, normal, least_cosine)
    type(node_face), intent(in) :: faces(:)    !! of these nodes [any]
    integer, intent(in) :: node                !! which one
    real(wp), intent(in) :: normal(2)          !! the other
    real(wp), intent(in) :: least_cosine       !! of the angle between near ones

    has_face = any(faces%node == node .and. &
                   faces%normal(1)*normal(1) + faces%normal(2)*normal(2) > least_cosine)
  end function has_face

  !> What the nodes of the slave face of the master, in their order along its sides; then second faces, but
  !! where the node has one like them: its other side faces the same.
  subroutine find_faces(contact, obstacles, faces)
    type(line_contact), intent(inout) :: contact    !! the contact of lines: nodes are left out of it
    type(boundary_line), intent(in) :: obstacles    !! the outlines of all bodies
    type(faces_type), intent(out) :: faces          !! what they face
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

    !> What a node of a side faces, if that is not known from the side beside it.
    subroutine look_from_node(side, which)
      integer, intent(in) :: side, which
      type(facing_type) :: face(2)
      integer :: neighbour

      associate (slave => contact%slave, node => contact%slave%segment(which, side), &
                 row => faces%row_of(which, side))
        neighbour = 0
        if (which < 3) neighbour = slave%neighbour(which, side)
        if (neighbour > 0) row = faces%row_of(3 - which, neighbour)
        if (row > 0) then   ! where boundary and face are smooth, as looked at from there
          if (all(slave%normal(:, which, side) == slave%normal(:, 3 - which, neighbour)) .and. &
              all(second(:seconds)%node /= node)) return
        end if
        face = find_facing(contact%master, obstacles, node_of(slave, side, which), contact%search)
        if (face(1)%same_way .and. (neighbour == 0 .or. neighbour > side)) faces%same_way = faces%same_way + 1
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
        ! Sides that meet in a hinge are not neighbours.
        if (which < 3 .and. neighbour == 0) row = findloc(first(:rows)%node, node, dim=1)
        if (row > 0) then   ! round a corner each side has a pair of its own
          if (face(1)%cosine(first(row)) > same_face) return
        end if
        rows = rows + 1
        row = rows
        first(row) = node_face(facing_type=face(1), node=node)
      end associate
    end subroutine look_from_node
  end subroutine find_faces
end module epcont_contact_geometry_faces
