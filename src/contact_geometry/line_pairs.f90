!> Pairs of a contact of lines, by geometry alone: each node of the slave edges with its projection on the
!> master, and each corner of the master that projects onto a slave edge between its nodes. Gap and
!> normal are those at the node; the weights of the master nodes come from
!> epcont_contact_geometry_mortar.
module epcont_contact_geometry_line_pairs
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: is_first
  use epcont_contact_geometry_faces, only: faces_type, find_faces, has_face, node_face
  use epcont_contact_geometry_mortar, only: find_mortar_rows, mortar_row
  use epcont_geometry_boundary_line, only: beyond, facing_type
  use epcont_geometry_facing, only: find_facing, looking_point, node_of, same_face
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: add_pairs, end_pairs

  !> Cosine of the largest angle between a node's normals on the two lines if it has a pair: 35 degrees, for
  !! coarse curves.
  real(wp), parameter :: opposite = 0.816_wp

contains

  !> Append the pairs of a contact, with their rows of N. The projected node is B, the nodes of the
  !! opposite edge are A.
  subroutine add_pairs(model, contact, faces)
    type(model_type), intent(inout) :: model       !! the model
    type(line_contact), intent(inout) :: contact   !! the contact of lines
    type(faces_type), intent(out) :: faces         !! projections of the slave nodes
    type(mortar_row), allocatable :: rows(:)
    type(node_face), allocatable :: tips(:)        ! master nodes, and their projections on the slave
    integer, allocatable :: ends(:)                ! those of them at joints that have rows
    logical :: covered(size(contact%slave%element))
    integer :: k

    call find_faces(contact, model%contact%boundary, faces)
    call find_mortar_rows(model, contact, faces, rows, covered, ends)
    call find_tips()
    contact%stands_on = tips%segment
    contact%came_near = pack(contact%came_near, [(any(tips%node == contact%came_near(k)), &
        k=1, size(contact%came_near))])
    contact%first = model%contact%pairs + 1
    contact%first_of_master = contact%first + size(faces%row)
    call append_pairs(faces%row, rows(:size(faces%row)), model)
    call append_pairs(tips, rows_of_tips(), model)
    contact%last = model%contact%pairs
    associate (side => contact%left_out(1, :), which => contact%left_out(2, :))
      contact%nodes_left_out = count(is_first([faces%row%node, (contact%slave%segment(which(k), side(k)), &
                                               k=1, size(side))])) - count(is_first(faces%row%node))
    end associate

  contains

    !> Find corners of the master on slave edges that are not covered by the master, ends
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
          on = find_facing(contact%slave, model%contact%boundary, from, contact%search)
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

    !> Is a corner at a slave node that has a pair there, on any of its edges? (At a corner, rounding
    !! chooses the edge.) At a joint, this is the pair of the other end.
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

    !> Does a node project onto an end of the master at which another node is a corner?
    pure logical function is_at_joint(row, corner)
      type(node_face), intent(in) :: row
      type(looking_point), intent(in) :: corner

      associate (side => row%segment, end => maxloc(row%share, dim=1))
        is_at_joint = row%share(end) == 1.0_wp .and. contact%master%segment(end, side) /= corner%node .and. &
                      norm2(contact%master%x(:, end, side) - corner%x) <= &
                      beyond*contact%master%chord_length(side)
      end associate
    end function is_at_joint

    !> Weights are the shape function values of the slave edge. At a joint, the weight of the node itself is
    !! corrected for its row from the master side.
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
  end subroutine add_pairs

  !> Append pairs after the present ones. In their rows of N, node B has weight 1, and the other weights
  !! are negative; node A has the largest of these.
  subroutine append_pairs(b, row, model)
    type(node_face), intent(in) :: b(:)      !! node and projection [rows]
    type(mortar_row), intent(in) :: row(:)
    type(model_type), intent(inout) :: model
    integer :: entries, i, k, pairs

    pairs = model%contact%pairs + size(b)
    entries = model%contact%row_start(model%contact%pairs + 1) - 1 + &
      sum([(size(row(i)%node) + 1, i=1, size(b))])
    if (pairs > size(model%contact%pair_id) .or. entries > size(model%contact%row_node)) &
      call set_room(model, 2*pairs, 2*entries)   ! doubled, so that many contacts do not copy all pairs each
    do i = 1, size(b)
      k = model%contact%pairs + i
      associate (first => model%contact%row_start(k), node => row(i)%node)
        associate (last => first + size(node))
          model%contact%row_node(first:last) = [b(i)%node, node]
          model%contact%row_weight(first:last) = [1.0_wp, -row(i)%weight]
          model%contact%row_start(k + 1) = last + 1
        end associate
        model%contact%pair_node(:, k) = [node(maxloc(row(i)%weight, dim=1, mask=node /= b(i)%node)), &
                                         b(i)%node]
      end associate
      model%contact%pair_id(k) = model%mesh%node_id(b(i)%node)
      model%contact%normal(:, k) = b(i)%normal
      model%contact%initial_gap(k) = b(i)%gap
    end do
    model%contact%pairs = pairs
  end subroutine append_pairs

  !> Cut unused space after the last pair.
  subroutine end_pairs(model)
    type(model_type), intent(inout) :: model   !! the model

    call set_room(model, model%contact%pairs, model%contact%row_start(model%contact%pairs + 1) - 1)
  end subroutine end_pairs

  !> Reserve space for pairs and for entries of their rows of N.
  subroutine set_room(model, pairs, entries)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: pairs, entries
    integer :: k

    associate (n => model%contact%pairs, last => model%contact%row_start(model%contact%pairs + 1) - 1)
      model%contact%row_node = [model%contact%row_node(:last), (0, k=last + 1, entries)]
      model%contact%row_weight = [model%contact%row_weight(:last), (0.0_wp, k=last + 1, entries)]
      model%contact%row_start = [model%contact%row_start(:n + 1), (0, k=n + 1, pairs)]
      model%contact%pair_id = [model%contact%pair_id(:n), (0, k=n + 1, pairs)]
      model%contact%pair_node = reshape([model%contact%pair_node(:, :n), (0, 0, k=n + 1, pairs)], [2, pairs])
      model%contact%normal = reshape([model%contact%normal(:, :n), (0.0_wp, 0.0_wp, k=n + 1, pairs)], &
                                     [2, pairs])
      model%contact%initial_gap = [model%contact%initial_gap(:n), (0.0_wp, k=n + 1, pairs)]
    end associate
  end subroutine set_room

end module epcont_contact_geometry_line_pairs
