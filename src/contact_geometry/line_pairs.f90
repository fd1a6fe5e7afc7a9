!> Pairs of a contact of lines, by geometry alone: each node of the slave's sides against what it faces of the
!> master's, and each corner of the master that stands on a side of the slave, between its nodes. Gap and
!> normal are those at the node; what the master's nodes share in it comes from
!> epcont_contact_geometry_mortar.
module epcont_contact_geometry_line_pairs
  use epcont_base_kinds, only: wp
  use epcont_contact_geometry_faces, only: faces_type, find_faces, has_face, node_face
  use epcont_contact_geometry_mortar, only: find_mortar_rows, mortar_row
  use epcont_geometry_boundary_line, only: beyond, facing_type
  use epcont_geometry_facing, only: find_facing, looking_point, node_of, same_face
  use epcont_model_model, only: line_contact, model_type
  implicit none
  private
  public :: add_pairs

  !> A node's normals on the two lines differ by less (cosine) where it has a pair there: 35 degrees, of
  !! coarse curves.
  real(wp), parameter :: opposite = 0.816_wp

contains

  !> Append the pairs of a contact, with their rows of N. The node that stands on a side is B, the nodes of
  !! that side are A.
  subroutine add_pairs(model, contact, faces)
    type(model_type), intent(inout) :: model       !! the scene
    type(line_contact), intent(inout) :: contact   !! the contact of lines
    type(faces_type), intent(out) :: faces         !! what nodes of the slave face
    type(mortar_row), allocatable :: rows(:)
    type(node_face), allocatable :: tips(:)        ! nodes of the master, and what they face of the slave
    logical :: covered(size(contact%slave%element)), without(model%nodes)
    integer :: k

    call find_faces(contact, model%boundary, faces)
    call find_mortar_rows(contact, model%boundary, faces, model%has_rings(), rows, covered)
    call find_tips()
    contact%stands_on = tips%segment
    contact%came_near = pack(contact%came_near, [(any(tips%node == contact%came_near(k)), &
        k=1, size(contact%came_near))])
    contact%first = model%pairs + 1
    contact%first_of_master = contact%first + size(faces%row)
    call append_pairs(faces%row, rows)
    call append_pairs(tips, rows_of_tips())
    contact%last = model%pairs
    without = .false.
    associate (side => contact%left_out(1, :), which => contact%left_out(2, :))
      without([(contact%slave%segment(which(k), side(k)), k=1, size(side))]) = .true.
    end associate
    without(faces%row%node) = .false.
    contact%nodes_left_out = count(without)

  contains

    !> Corners of the master that stand on a side of the slave which does not face the master all along (where
    !! two masters lie flush, the side's own nodes hold both), and nodes that came near.
    subroutine find_tips()
      type(facing_type) :: on(2)
      type(looking_point) :: from
      integer :: i, side, which
      logical :: near

      allocate (tips(0))
      do side = 1, size(contact%master%element)
        do which = 1, 3
          from = node_of(contact%master, side, which)
          near = any(contact%came_near == from%node)
          if (.not. (near .or. from%at_tip)) cycle
          on = find_facing(contact%slave, model%boundary, from, contact%search)
          do i = 1, 2
            if (.not. on(i)%found) cycle
            if (covered(on(i)%segment) .and. .not. near) cycle
            if (.not. (stands_at_node(on(i)) .or. has_face(tips, from%node, on(i)%normal, same_face))) &
              tips = [tips, node_face(facing_type=on(i), node=from%node)]
          end do
        end do
      end do
    end subroutine find_tips

    !> Does a place on the slave lie at a node that has a pair there, of whichever of its sides? (At a corner
    !! rounding tells which of them is faced.)
    pure logical function stands_at_node(on)
      type(facing_type), intent(in) :: on

      associate (node => contact%slave%segment(maxloc(on%share, dim=1), on%segment))
        stands_at_node = maxval(on%share) >= 1.0_wp - beyond .and. &
                         has_face(faces%row, node, -on%normal, opposite)
      end associate
    end function stands_at_node

    !> Shared by the nodes of the slave's side as its shape functions say.
    pure function rows_of_tips() result(row)
      type(mortar_row) :: row(size(tips))
      integer :: i

      do i = 1, size(tips)
        associate (share => tips(i)%share)
          row(i)%node = pack(contact%slave%segment(:, tips(i)%segment), share /= 0.0_wp)
          row(i)%weight = pack(share, share /= 0.0_wp)
        end associate
      end do
    end function rows_of_tips

    !> Pairs behind those that count so far. In their rows of N node B has weight 1, the others have theirs,
    !! less than zero; of these the largest is A.
    subroutine append_pairs(b, row)
      type(node_face), intent(in) :: b(:)      !! and what it faces [rows]
      type(mortar_row), intent(in) :: row(:)
      integer :: a(size(b)), start(size(b) + 1), i, n

      start(1) = model%row_start(model%pairs + 1)
      do i = 1, size(b)
        a(i) = row(i)%node(maxloc(row(i)%weight, dim=1))
        start(i + 1) = start(i) + size(row(i)%node) + 1
      end do
      associate (before => model%pairs, entries => start(1) - 1)
        n = before + size(b)
        model%row_start = [model%row_start(:before), start]
        model%row_node = [model%row_node(:entries), (b(i)%node, row(i)%node, i=1, size(b))]
        model%row_weight = [model%row_weight(:entries), (1.0_wp, -row(i)%weight, i=1, size(b))]
        model%pair_id = [model%pair_id(:before), model%node_id(b%node)]
        model%pair_node = reshape([model%pair_node(:, :before), (a(i), b(i)%node, i=1, size(b))], [2, n])
        model%normal = reshape([model%normal(:, :before), (b(i)%normal, i=1, size(b))], [2, n])
        model%initial_gap = [model%initial_gap(:before), b%gap]
      end associate
      model%pairs = n
    end subroutine append_pairs
  end subroutine add_pairs

end module epcont_contact_geometry_line_pairs
