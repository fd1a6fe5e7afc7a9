!> Pairs of a contact of lines, by geometry alone: each node of the slave's sides against what it faces of the
!> master's, and each corner of the master that stands on a side of the slave, between its nodes. Gap and
!> normal are those at the node; what the master's nodes share in it comes from
!> epcont_contact_geometry_mortar.
module epcont_contact_geometry_line_pairs
  use epcont_base_kinds, only: wp
  use epcont_contact_geometry_faces, only: face_list, faces_type
  use epcont_contact_geometry_mortar, only: find_mortar_rows, mortar_rows
  use epcont_geometry_boundary_line, only: beyond, boundary_line
  use epcont_geometry_facing, only: facing_type, find_facing, node_of
  use epcont_model_model, only: line_contact, model_type
  implicit none
  private
  public :: forget_pairs, add_pairs

  !> A node's normals on the two lines differ by less (cosine) where it has a pair there: 35 degrees, of
  !! coarse curves.
  real(wp), parameter :: opposite = 0.816_wp

contains

  !> Corners of the master that stand on a side of the slave which does not face the master all along (where
  !! two masters
  !> lie flush, the side's own nodes hold both), and nodes that came near.
  pure subroutine find_tips(contact, obstacles, covered, faces)
    type(line_contact), intent(in) :: contact
    type(boundary_line), intent(in) :: obstacles
    logical, intent(in) :: covered(:)           !! sides of the slave
    type(faces_type), intent(inout) :: faces
    type(facing_type) :: on(2)
    integer :: k, side, which
    logical :: near

    associate (master => contact%master)
      do side = 1, size(master%element)
        do which = 1, 3
          associate (node => master%segment(which, side))
            if (node == 0) cycle
            near = any(contact%came_near == node)
            if (.not. near) then
              if (which == 3) cycle
              if (.not. master%tip(which, side)) cycle
            end if
            on = find_facing(contact%slave, obstacles, node_of(master, side, which), contact%search)
            do k = 1, 2
              if (.not. on(k)%found .or. (covered(max(on(k)%segment, 1)) .and. .not. near)) cycle
              if (stands_at_node(contact, faces%slave, on(k)) .or. faces%master%has_face(node, on(k))) cycle
              call faces%master%append(node, on(k))
            end do
          end associate
        end do
      end do
    end associate
  end subroutine find_tips

  !> Does a place on the slave lie at a node that has a pair there, of whichever of its sides? (At a corner
  !! rounding tells which of them is faced.)
  pure logical function stands_at_node(contact, rows, on)
    type(line_contact), intent(in) :: contact
    type(face_list), intent(in) :: rows     !! of the slave's nodes
    type(facing_type), intent(in) :: on
    integer :: k, row

    stands_at_node = .false.
    k = maxloc(on%share, dim=1)
    if (on%share(k) < 1.0_wp - beyond) return
    do row = 1, rows%count
      if (rows%node(row) /= contact%slave%segment(k, on%segment)) cycle
      stands_at_node = dot_product(rows%facing(row)%normal, on%normal) < -opposite
      if (stands_at_node) return
    end do
  end function stands_at_node

  !> Forget the pairs of all contacts of lines.
  pure subroutine forget_pairs(model)
    type(model_type), intent(inout) :: model   !! the scene
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
    !> What nodes of the slave face; those of the master are found here
    type(faces_type), intent(inout) :: faces
    type(model_type), intent(inout) :: model   !! the scene
    type(line_contact), intent(inout) :: contact   !! the contact of lines
    logical :: covered(size(contact%slave%element))
    type(mortar_rows) :: rows
    type(face_list) :: on   ! what all nodes B face
    integer :: k

    call find_mortar_rows(contact, model%boundary, faces, model%has_rings(), rows, covered)
    call find_tips(contact, model%boundary, covered, faces)
    on = faces%slave
    contact%stands_on = [(faces%master%facing(k)%segment, k=1, faces%master%count)]
    do k = 1, faces%master%count
      associate (facing => faces%master%facing(k))
        associate (share => facing%share)
          call rows%append(pack(contact%slave%segment(:, facing%segment), share /= 0.0_wp), &
                           pack(share, share /= 0.0_wp))
        end associate
        call on%append(faces%master%node(k), facing)
      end associate
    end do
    contact%came_near = pack(contact%came_near, &
                             [(faces%master%has_node(contact%came_near(k)), k=1, size(contact%came_near))])
    contact%first = model%pairs + 1
    contact%first_of_master = contact%first + faces%slave%count
    contact%last = model%pairs + on%count
    contact%left_out = faces%left_out(:, :faces%left)
    contact%nodes_left_out = count_left_out(contact%slave%segment, faces)
    if (on%count > 0) call append_pairs(rows, on%node(:on%count), on%facing(:on%count), model)
  end subroutine add_pairs

  !> Pairs behind those that there are. In their rows of N node B has weight 1, the others have theirs, less
  !! than zero; of these the largest is A.
  pure subroutine append_pairs(rows, b, facing, model)
    type(mortar_rows), intent(in) :: rows
    integer, intent(in) :: b(:)                       !! [rows]
    type(facing_type), intent(in) :: facing(:)        !! what they face [rows]
    type(model_type), intent(inout) :: model
    integer :: a(size(b)), i, node(size(b) + size(rows%node)), pairs
    real(wp) :: weight(size(node))

    pairs = size(b)
    do i = 1, pairs
      associate (first => rows%start(i), last => rows%start(i + 1) - 1)
        node(first + i - 1:last + i) = [b(i), rows%node(first:last)]
        weight(first + i - 1:last + i) = [1.0_wp, -rows%weight(first:last)]
        a(i) = rows%node(first - 1 + maxloc(rows%weight(first:last), dim=1))
      end associate
    end do
    model%pairs = model%pairs + pairs
    model%row_start = [model%row_start, size(model%row_node) + rows%start(2:) + [(i, i=1, pairs)]]
    model%row_node = [model%row_node, node]
    model%row_weight = [model%row_weight, weight]
    model%pair_id = [model%pair_id, model%node_id(b)]
    model%pair_node = reshape([model%pair_node, (a(i), b(i), i=1, pairs)], [2, model%pairs])
    model%normal = reshape([model%normal, (facing(i)%normal, i=1, pairs)], [2, model%pairs])
    model%initial_gap = [model%initial_gap, facing%gap]
  end subroutine append_pairs

  !> Nodes of the slave without a pair.
  pure integer function count_left_out(segment, faces) result(nodes)
    integer, intent(in) :: segment(:, :)
    type(faces_type), intent(in) :: faces
    logical :: without(maxval(segment))
    integer :: i

    without = .false.
    do i = 1, faces%left
      without(segment(faces%left_out(2, i), faces%left_out(1, i))) = .true.
    end do
    if (faces%slave%count > 0) without(faces%slave%node(:faces%slave%count)) = .false.
    nodes = count(without)
  end function count_left_out
end module epcont_contact_geometry_line_pairs
