!> Pairs of a contact of lines, by geometry alone: each node of the slave's sides against what it faces of the master's, and
!> each corner of the master that stands on a side of the slave, between its nodes. Gap and normal are those at the node; what
!> the master's nodes share in it comes from epcont_contact_geometry_mortar.
module epcont_contact_geometry_line_pairs
  use epcont_base_kinds, only: wp
  use epcont_contact_geometry_mortar, only: mortar_rows
  use epcont_element_kinematics, only: axisymmetric
  use epcont_geometry_boundary_line, only: beyond
  use epcont_geometry_boxed_line, only: boxed_line
  use epcont_geometry_facing, only: facing_type, find_facing, node_of, same_face
  use epcont_model_model, only: line_contact, model_type
  implicit none
  private
  public :: faces_type, find_faces, forget_pairs, add_pairs

  !> A node's normals on the two lines differ by less (cosine) where it has a pair there: 35 degrees, of coarse curves.
  real(wp), parameter :: opposite = 0.816_wp

  !> What nodes face.
  type :: faces_type
    integer :: same_way = 0                        !! nodes of the slave near sides that look the same way only
    integer, allocatable :: node(:)                !! those that face something [rows]
    type(facing_type), allocatable :: facing(:)    !! what [rows]
    integer, allocatable :: row_of(:, :)           !! of the nodes of each side; 0: they face nothing [3, sides]
    integer, allocatable :: left_out(:, :)         !! of sides that face nothing at a node: which, and which node of it [2, any]
    integer, allocatable :: tip(:)                 !! nodes of the master that stand on a side of the slave [tips]
    type(facing_type), allocatable :: on(:)        !! where [tips]
  end type faces_type

contains

  !> What the nodes of the slave face of the master, in their order along its sides.
  pure subroutine find_faces(contact, obstacles, faces)
    type(line_contact), intent(in) :: contact
    type(boxed_line), intent(in) :: obstacles   !! the outlines of all bodies
    type(faces_type), intent(out) :: faces
    type(facing_type) :: face, second
    integer, parameter :: in_turn(3) = [1, 3, 2]   ! start, middle, end
    integer :: beside, left, n, s, seconds, sides, turn, which
    integer, allocatable :: second_node(:)
    type(facing_type), allocatable :: second_face(:)

    associate (slave => contact%slave)
      sides = size(slave%element)
      allocate (faces%facing(4*sides), faces%node(4*sides), second_node(3*sides), second_face(3*sides))
      allocate (faces%row_of(3, sides), faces%left_out(2, 3*sides), source=0)
      n = 0
      seconds = 0
      left = 0
      do s = 1, sides
        do turn = 1, 3
          which = in_turn(turn)
          if (slave%segment(which, s) == 0) cycle
          beside = row_beside(contact, faces%row_of, s, which)
          if (beside > 0) then
            if (all(slave%normal(:, which, s) == slave%normal(:, 3 - which, slave%neighbour(which, s))) .and. &
                .not. has_second(beside)) then   ! looked at from the side beside it
              faces%row_of(which, s) = beside
              cycle
            end if
          end if
          call find_facing(contact%master, obstacles, node_of(slave, s, which), contact%search, face, second)
          if (face%same_way .and. is_new()) faces%same_way = faces%same_way + 1
          if (.not. face%place%found) then
            left = left + 1
            faces%left_out(:, left) = [s, which]
          else
            faces%row_of(which, s) = row_like(contact, s, which, beside, face, faces, n)
            if (faces%row_of(which, s) == 0) then
              n = n + 1
              faces%facing(n) = face
              faces%node(n) = slave%segment(which, s)
              faces%row_of(which, s) = n
            end if
          end if
          if (.not. second%place%found) cycle
          seconds = seconds + 1
          second_node(seconds) = slave%segment(which, s)
          second_face(seconds) = second
        end do
      end do
    end associate
    faces%left_out = faces%left_out(:, :left)
    call take_seconds(second_node(:seconds), second_face(:seconds), n, faces)

  contains

    !> Is the node met for the first time?
    pure logical function is_new()
      is_new = which == 3
      if (is_new) return
      is_new = contact%slave%neighbour(which, s) == 0
      if (.not. is_new) is_new = contact%slave%neighbour(which, s) > s
    end function is_new

    pure logical function has_second(row)
      integer, intent(in) :: row

      has_second = any(second_node(:seconds) == faces%node(row))
    end function has_second
  end subroutine find_faces

  !> The row that the side before or behind has found for a node; 0: it has found none, or was not looked at yet.
  pure integer function row_beside(contact, row_of, side, which) result(row)
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: row_of(:, :), side, which

    row = 0
    if (which == 3) return
    if (contact%slave%neighbour(which, side) > 0) row = row_of(3 - which, contact%slave%neighbour(which, side))
  end function row_beside

  !> The row that a node has for the same face, 0 where it has none: round a corner each side has a pair of its own. Sides that
  !! meet in a hinge are not neighbours.
  pure integer function row_like(contact, side, which, beside, face, faces, rows) result(row)
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: side, which
    integer, intent(in) :: beside            !! the row from the side beside it; 0: none
    type(facing_type), intent(in) :: face
    type(faces_type), intent(in) :: faces
    integer, intent(in) :: rows              !! so far

    row = beside
    if (row == 0 .and. which < 3) then
      if (contact%slave%neighbour(which, side) == 0) row = findloc(faces%node(:rows), contact%slave%segment(which, side), dim=1)
    end if
    if (row == 0) return
    if (dot_product(face%place%normal, faces%facing(row)%place%normal) <= same_face) row = 0
  end function row_like

  !> Second faces, in concave corners, become rows but where the node has one like them: its other side faces the same.
  pure subroutine take_seconds(node, face, n, faces)
    integer, intent(in) :: node(:)
    type(facing_type), intent(in) :: face(:)
    integer, intent(in) :: n               !! rows so far
    type(faces_type), intent(inout) :: faces
    integer :: i, k, rows

    rows = n
    do i = 1, size(node)
      do k = 1, rows
        if (faces%node(k) /= node(i)) cycle
        if (dot_product(faces%facing(k)%place%normal, face(i)%place%normal) > same_face) exit
      end do
      if (k <= rows) cycle
      rows = rows + 1
      if (rows > size(faces%node)) then
        faces%node = [faces%node, faces%node]
        faces%facing = [faces%facing, faces%facing]
      end if
      faces%node(rows) = node(i)
      faces%facing(rows) = face(i)
    end do
    faces%node = faces%node(:rows)
    faces%facing = faces%facing(:rows)
  end subroutine take_seconds

  !> Corners of the master that stand on a side of the slave which does not face the master all along (where two masters
  !> lie flush, the side's own nodes hold both), and nodes that came near.
  pure subroutine find_tips(contact, obstacles, covered, faces)
    type(line_contact), intent(in) :: contact
    type(boxed_line), intent(in) :: obstacles
    logical, intent(in) :: covered(:)           !! sides of the slave
    type(faces_type), intent(inout) :: faces
    type(facing_type) :: second, there
    integer :: i, which
    logical :: near

    allocate (faces%tip(0), faces%on(0))
    associate (master => contact%master)
      do i = 1, size(master%element)
        do which = 1, 3
          associate (node => master%segment(which, i))
            if (node == 0) cycle
            near = any(contact%came_near == node)
            if (.not. near) then
              if (which == 3) cycle
              if (.not. master%tip(which, i)) cycle
            end if
            call find_facing(contact%slave, obstacles, node_of(master, i, which), contact%search, there, second)
            if (near .or. .not. covered(max(there%segment, 1))) call take_place(contact, node, there, faces)
            if (near .or. .not. covered(max(second%segment, 1))) call take_place(contact, node, second, faces)
          end associate
        end do
      end do
    end associate
  end subroutine find_tips

  !> A place for a node of the master, but where the node has one on the same face, or stands at a node with a pair.
  pure subroutine take_place(contact, node, there, faces)
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: node
    type(facing_type), intent(in) :: there
    type(faces_type), intent(inout) :: faces
    integer :: k

    if (.not. there%place%found) return
    if (stands_at_node(contact, faces, there)) return
    do k = 1, size(faces%tip)
      if (faces%tip(k) /= node) cycle
      if (dot_product(faces%on(k)%place%normal, there%place%normal) > same_face) return
    end do
    faces%tip = [faces%tip, node]
    faces%on = [faces%on, there]
  end subroutine take_place

  !> Does a place on the slave lie at a node that has a pair there, of whichever of its sides? (At a corner rounding tells which
  !! of them is faced.)
  pure logical function stands_at_node(contact, faces, place)
    type(line_contact), intent(in) :: contact
    type(faces_type), intent(in) :: faces
    type(facing_type), intent(in) :: place
    integer :: k, row

    stands_at_node = .false.
    k = maxloc(place%place%share, dim=1)
    if (place%place%share(k) < 1.0_wp - beyond) return
    do row = 1, size(faces%node)
      if (faces%node(row) /= contact%slave%segment(k, place%segment)) cycle
      stands_at_node = dot_product(faces%facing(row)%place%normal, place%place%normal) < -opposite
      if (stands_at_node) return
    end do
  end function stands_at_node

  !> Forget the pairs of all contacts of lines.
  pure subroutine forget_pairs(model)
    type(model_type), intent(inout) :: model
    integer :: n

    n = model%line_contact(1)%first - 1
    model%pairs = n
    model%row_start = model%row_start(:n + 1)
    model%pair_node = model%pair_node(:, :n)
    model%pair_id = model%pair_id(:n)
    model%normal = model%normal(:, :n)
    model%initial_gap = model%initial_gap(:n)
    model%row_node = model%row_node(:model%row_start(n + 1) - 1)
    model%row_weight = model%row_weight(:model%row_start(n + 1) - 1)
  end subroutine forget_pairs

  !> Append pairs, with their rows of N. The node that stands on a side is B, the nodes of that side are A.
  pure subroutine add_pairs(faces, model, contact)
    type(faces_type), intent(inout) :: faces
    type(model_type), intent(inout) :: model
    type(line_contact), intent(inout) :: contact
    logical, allocatable :: covered(:)
    integer, allocatable :: b(:), most(:), node(:), nodes(:), row_end(:), start(:)
    real(wp), allocatable :: weight(:), weights(:)
    type(facing_type), allocatable :: facing(:)
    integer :: i, k, n, tips

    n = size(faces%node)
    allocate (covered(size(contact%slave%element)))
    call mortar_rows(contact, model%boundary, faces%row_of, faces%facing, &
                     model%kinematics(model%section(contact%slave%element(1))) == axisymmetric, start, node, weight, covered)
    call find_tips(contact, model%boundary, covered, faces)
    tips = size(faces%tip)
    contact%came_near = pack(contact%came_near, [(any(faces%tip == contact%came_near(i)), i=1, size(contact%came_near))])
    contact%stands_on = faces%on%segment
    do i = 1, tips
      do k = 1, 3
        if (faces%on(i)%place%share(k) == 0.0_wp) cycle
        node = [node, contact%slave%segment(k, contact%stands_on(i))]
        weight = [weight, faces%on(i)%place%share(k)]
      end do
      start = [start, size(node) + 1]
    end do
    b = [faces%node, faces%tip]
    facing = [faces%facing, faces%on]
    allocate (nodes(n + tips + size(node)), weights(n + tips + size(node)), most(n + tips), row_end(n + tips))
    do i = 1, n + tips
      associate (first => start(i), last => start(i + 1) - 1)
        nodes(first + i - 1:last + i) = [b(i), node(first:last)]
        weights(first + i - 1:last + i) = [1.0_wp, -weight(first:last)]
        most(i) = node(first - 1 + maxloc(weight(first:last), dim=1))
        row_end(i) = last + i
      end associate
    end do
    contact%first = model%pairs + 1
    contact%first_of_master = contact%first + n
    contact%last = model%pairs + n + tips
    contact%left_out = faces%left_out
    contact%nodes_left_out = count_left_out(contact%slave%segment, faces)
    model%row_start = [model%row_start, size(model%row_node) + row_end + 1]
    model%pair_node = reshape([model%pair_node, (most(i), b(i), i=1, n + tips)], [2, contact%last])
    model%pair_id = [model%pair_id, model%node_id(b)]
    model%normal = reshape([model%normal, (facing(i)%place%normal, i=1, n + tips)], [2, contact%last])
    model%initial_gap = [model%initial_gap, facing%place%gap]
    model%row_node = [model%row_node, nodes]
    model%row_weight = [model%row_weight, weights]
    model%pairs = contact%last
  end subroutine add_pairs

  !> Nodes of the slave without a pair.
  pure integer function count_left_out(segment, faces) result(nodes)
    integer, intent(in) :: segment(:, :)
    type(faces_type), intent(in) :: faces
    logical, allocatable :: without(:)
    integer :: i

    allocate (without(maxval(segment)), source=.false.)
    do i = 1, size(faces%left_out, 2)
      without(segment(faces%left_out(2, i), faces%left_out(1, i))) = .true.
    end do
    without(faces%node) = .false.
    nodes = count(without)
  end function count_left_out
end module epcont_contact_geometry_line_pairs
