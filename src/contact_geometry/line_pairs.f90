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
    integer, allocatable :: ends(:)                ! of them, those at joints that rows are for
    logical :: covered(size(contact%slave%element)), without(model%nodes)
    integer :: k

    call find_faces(contact, model%boundary, faces)
    call find_mortar_rows(model, contact, faces, rows, covered, ends)
    call find_tips()
    contact%stands_on = tips%segment
    contact%came_near = pack(contact%came_near, [(any(tips%node == contact%came_near(k)), &
        k=1, size(contact%came_near))])
    contact%first = model%pairs + 1
    contact%first_of_master = contact%first + size(faces%row)
    call append_pairs(faces%row, rows(:size(faces%row)))
    call append_pairs(tips, rows_of_tips())
    contact%last = model%pairs
    without = .false.
    associate (side => contact%left_out(1, :), which => contact%left_out(2, :))
      without([(contact%slave%segment(which(k), side(k)), k=1, size(side))]) = .true.
    end associate
    without(faces%row%node) = .false.
    contact%nodes_left_out = count(without)

  contains

    !> Corners of the master that stand on a side of the slave which does not face the master all along, ends
    !! at joints, and nodes that came near.
    subroutine find_tips()
      type(facing_type) :: on(2)
      type(looking_point) :: from
      integer :: i, side, which
      logical :: counts, near

      allocate (tips(0))
      do side = 1, size(contact%master%element)
        do which = 1, 3
          from = node_of(contact%master, side, which)
          near = any(contact%came_near == from%node)
          if (.not. (near .or. from%at_tip)) cycle
          on = find_facing(contact%slave, model%boundary, from, contact%search)
          do i = 1, 2
            if (.not. on(i)%found) cycle
            counts = near .or. .not. covered(on(i)%segment)
            counts = any(ends == from%node) .or. counts .and. .not. is_held(from, on(i))
            if (counts .and. .not. has_face(tips, from%node, on(i)%normal, same_face)) &
              tips = [tips, node_face(facing_type=on(i), node=from%node)]
          end do
        end do
      end do
    end subroutine find_tips

    !> Does a corner lie on a node of the slave that has a pair there, of whichever of its sides? (At a corner
    !! rounding tells which of them is faced.) At a joint that is the pair of the other end.
    pure logical function is_held(corner, on)
      type(looking_point), intent(in) :: corner
      type(facing_type), intent(in) :: on
      integer :: k

      is_held = .false.
      if (maxval(on%share) < 1.0_wp - beyond) return
      associate (node => contact%slave%segment(maxloc(on%share, dim=1), on%segment))
        do k = 1, size(faces%row)
          is_held = faces%row(k)%node == node .and. dot_product(faces%row(k)%normal, -on%normal) > opposite &
                    .and. .not. is_at_joint(faces%row(k), corner)
          if (is_held) return
        end do
      end associate
    end function is_held

    !> Does a node face an end of the master where a corner of it lies that is not that end?
    pure logical function is_at_joint(row, corner)
      type(node_face), intent(in) :: row
      type(looking_point), intent(in) :: corner

      associate (side => row%segment, end => maxloc(row%share, dim=1))
        is_at_joint = row%share(end) == 1.0_wp .and. contact%master%segment(end, side) /= corner%node .and. &
                      norm2(contact%master%x(:, end, side) - corner%x) <= &
                      beyond*contact%master%chord_length(side)
      end associate
    end function is_at_joint

    !> Shared by the nodes of the slave's side as its shape functions say. At a joint what counts for the node
    !! itself is what its row says of the master: the rest is taken off.
    pure function rows_of_tips() result(row)
      type(mortar_row) :: row(size(tips))
      integer :: i, joint

      do i = 1, size(tips)
        associate (share => tips(i)%share)
          row(i)%node = pack(contact%slave%segment(:, tips(i)%segment), share /= 0.0_wp)
          row(i)%weight = pack(share, share /= 0.0_wp)
        end associate
        joint = findloc(ends, tips(i)%node, dim=1)
        if (joint == 0) cycle
        associate (own => rows(size(faces%row) + joint))
          if (all(own%node == tips(i)%node)) cycle
          row(i)%node = [row(i)%node, own%node]
          row(i)%weight = [row(i)%weight, merge(1.0_wp, 0.0_wp, own%node == tips(i)%node) - own%weight]
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
        a(i) = row(i)%node(maxloc(row(i)%weight, dim=1, mask=row(i)%node /= b(i)%node))
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
