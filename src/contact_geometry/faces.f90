!> What the nodes of lines in contact face, by geometry alone: each node of the slave's sides against the
!> master, and in concave corners a second face of it.
module epcont_contact_geometry_faces
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_facing, only: facing_type, find_facing, node_of, same_face
  use epcont_model_model, only: line_contact
  implicit none
  private
  public :: face_list, faces_type, find_faces

  !> Nodes, and what each of them faces.
  type :: face_list
    integer :: count = 0
    integer, allocatable :: node(:)                !! [count or more]
    type(facing_type), allocatable :: facing(:)    !! [count or more]
  contains
    procedure :: append
    procedure :: has_node
    procedure :: has_face
  end type face_list

  !> What nodes face.
  type :: faces_type
    type(face_list) :: slave                       !! nodes of the slave, each of them a row
    !> Of the nodes of each side; 0: they face nothing [3, sides]
    integer, allocatable :: row_of(:, :)
    !> Nodes of the slave near sides that look the same way only
    integer :: same_way = 0
    integer :: left = 0                            !! nodes of sides that face nothing
    integer, allocatable :: left_out(:, :)         !! these: which side, which node of it [2, left or more]
    !> Nodes of the master, and where they stand on sides of the slave
    type(face_list) :: master
  end type faces_type

  integer, parameter :: first_room = 16   !! entries that a list holds before it first grows

contains

  !> Add a node and its face.
  pure subroutine append(self, node, facing)
    class(face_list), intent(inout) :: self
    integer, intent(in) :: node   !! its node
    type(facing_type), intent(in) :: facing   !! what it faces

    if (.not. allocated(self%node)) allocate (self%node(first_room), self%facing(first_room))
    if (self%count == size(self%node)) then   ! room for twice as many
      self%node = [self%node, self%node]
      self%facing = [self%facing, self%facing]
    end if
    self%count = self%count + 1
    self%node(self%count) = node
    self%facing(self%count) = facing
  end subroutine append

  !> Is a node in the list?
  pure logical function has_node(self, node)
    class(face_list), intent(in) :: self
    integer, intent(in) :: node   !! its node

    has_node = .false.
    if (self%count > 0) has_node = any(self%node(:self%count) == node)
  end function has_node

  !> Has a node a face like this one, that looks the same way?
  pure logical function has_face(self, node, facing)
    class(face_list), intent(in) :: self
    integer, intent(in) :: node   !! its node
    type(facing_type), intent(in) :: facing   !! what it faces
    integer :: k

    has_face = .true.
    do k = 1, self%count
      if (self%node(k) /= node) cycle
      if (dot_product(self%facing(k)%normal, facing%normal) > same_face) return
    end do
    has_face = .false.
  end function has_face

  !> What the nodes of the slave face of the master, in their order along its sides; then second faces, but
  !! where the node has one like them: its other side faces the same.
  pure subroutine find_faces(contact, obstacles, faces)
    type(line_contact), intent(in) :: contact   !! the contact of lines
    type(boundary_line), intent(in) :: obstacles   !! the outlines of all bodies
    type(faces_type), intent(out) :: faces   !! what they face
    type(face_list) :: seconds
    integer, parameter :: in_turn(3) = [1, 3, 2]   ! start, middle, end
    integer :: k, s

    associate (slave => contact%slave)
      allocate (faces%row_of(3, size(slave%element)), faces%left_out(2, 3*size(slave%element)), source=0)
      do s = 1, size(slave%element)
        do k = 1, 3
          if (slave%segment(in_turn(k), s) > 0) &
            call look_from_node(contact, obstacles, s, in_turn(k), faces, seconds)
        end do
      end do
    end associate
    do k = 1, seconds%count
      if (.not. faces%slave%has_face(seconds%node(k), seconds%facing(k))) &
        call faces%slave%append(seconds%node(k), seconds%facing(k))
    end do
  end subroutine find_faces

  !> What a node of a side faces, if that is not known from the side beside it.
  pure subroutine look_from_node(contact, obstacles, side, which, faces, seconds)
    type(line_contact), intent(in) :: contact
    type(boundary_line), intent(in) :: obstacles
    integer, intent(in) :: side, which
    type(faces_type), intent(inout) :: faces
    type(face_list), intent(inout) :: seconds
    type(facing_type) :: face, second, seen(2)
    integer :: beside, neighbour, row

    associate (slave => contact%slave, node => contact%slave%segment(which, side))
      neighbour = 0
      beside = 0
      if (which < 3) neighbour = slave%neighbour(which, side)
      if (neighbour > 0) beside = faces%row_of(3 - which, neighbour)
      row = beside
      if (beside > 0) then   ! where boundary and face are smooth, as looked at from there
        if (any(slave%normal(:, which, side) /= slave%normal(:, 3 - which, neighbour)) .or. &
            seconds%has_node(node)) row = 0
      end if
      if (row == 0) then
        seen = find_facing(contact%master, obstacles, node_of(slave, side, which), contact%search)
        face=seen(1)
        second=seen(2)
        if (face%same_way .and. (neighbour == 0 .or. neighbour > side)) faces%same_way = faces%same_way + 1
        if (second%found) call seconds%append(node, second)
        if (.not. face%found) then
          faces%left = faces%left + 1
          faces%left_out(:, faces%left) = [side, which]
          return
        end if
        ! Sides that meet in a hinge are not neighbours.
        if (which < 3 .and. neighbour == 0 .and. faces%slave%has_node(node)) &
          beside = findloc(faces%slave%node, node, dim=1)
        row = row_like(faces%slave, beside, face)
        if (row == 0) then
          call faces%slave%append(node, face)
          row = faces%slave%count
        end if
      end if
      faces%row_of(which, side) = row
    end associate
  end subroutine look_from_node

  !> The row, if it is of the same face: round a corner each side has a pair of its own. 0: it is not.
  pure integer function row_like(list, row, face)
    type(face_list), intent(in) :: list
    integer, intent(in) :: row               !! 0: there is none
    type(facing_type), intent(in) :: face

    row_like = row
    if (row == 0) return
    if (dot_product(face%normal, list%facing(row)%normal) <= same_face) row_like = 0
  end function row_like
end module epcont_contact_geometry_faces
