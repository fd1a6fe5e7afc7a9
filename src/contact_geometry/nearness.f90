!> Nodes of lines in contact that have no pair, but came so near as loads moved them that they pass through the other line.
!>
!> Gaps are those of the undeformed shape, opened by displacements, as those of pairs are: small displacements.
module epcont_contact_geometry_nearness
  use epcont_base_kinds, only: wp
  use epcont_contact_geometry_line_pairs, only: add_pairs, faces_type, find_faces, forget_pairs
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_boxed_line, only: boxed_line
  use epcont_geometry_facing, only: facing_type, find_facing, find_nearest, node_of
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: line_contact, model_type
  implicit none
  private
  public :: enter_nodes_that_came_near

  !> A gap below this part of the scene is none.
  real(wp), parameter :: least = 1.0e-8_wp
  !> A node between those of the other line that stand on its own may pass through by so many times what chords of curves and
  !> of bent sides make.
  real(wp), parameter :: allowance = 3.0_wp
  !> But not by more than this part of the largest displacement: that is no end of contact, but contact missed.
  real(wp), parameter :: most = 0.5_wp
  !> The two lines, not quite parallel, tell gaps by normals of their own: what these make of nodes that slide, and of gaps that
  !! close, differs by this much at most.
  real(wp), parameter :: askew = 1.5_wp
  !> Search beyond what came near.
  real(wp), parameter :: further = 1.5_wp

contains

  !> Give pairs to the nodes that came near; `entered`: there are some, and the scene wants to be solved again. Without
  !! displacements (what moves was held by nothing) all that may be faced, however far, has its pair.
  subroutine enter_nodes_that_came_near(model, displacement, touching, entered)
    type(model_type), intent(inout) :: model
    real(wp), allocatable, intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    logical, allocatable, intent(in) :: touching(:)           !! [pairs]
    logical, intent(out) :: entered
    real(wp) :: size_of_scene
    integer :: before, c, k
    type(faces_type) :: faces
    logical, allocatable :: holds(:)   !! nodes that stand on the other line [nodes]
    logical :: wider

    entered = .false.
    if (.not. allocated(model%line_contact)) return
    if (size(model%line_contact) == 0) return
    size_of_scene = sum(maxval(model%x, dim=2) - minval(model%x, dim=2))
    allocate (holds(model%nodes), source=.false.)
    if (allocated(displacement)) holds(model%pair_node(2, pack([(k, k=1, model%pairs)], touching))) = .true.
    do c = 1, size(model%line_contact)
      associate (contact => model%line_contact(c))
        if (allocated(displacement)) then
          call widen(contact, model%boundary, displacement, holds, size_of_scene, wider)
          ! What the slave's nodes will hold off is not the master's.
          if (.not. wider) call look_from_master(contact, model%boundary, displacement, holds, size_of_scene, entered)
          entered = entered .or. wider
        else if (size(contact%left_out) > 0 .and. contact%search < size_of_scene) then
          contact%search = size_of_scene
          contact%is_wider = .true.
          entered = .true.
        end if
      end associate
    end do
    if (.not. entered) return
    before = model%pairs
    call forget_pairs(model)
    do c = 1, size(model%line_contact)
      call find_faces(model%line_contact(c), model%boundary, faces)
      call add_pairs(faces, model, model%line_contact(c))
    end do
    entered = model%pairs > before
  end subroutine enter_nodes_that_came_near

  !> Search farther where nodes of the slave, left out so far, pass through the master, or stand beside one that touches: what the
  !! nodes of a side share is known only where all of them have pairs.
  subroutine widen(contact, obstacles, displacement, holds, size_of_scene, wider)
    type(line_contact), intent(inout) :: contact
    type(boxed_line), intent(in) :: obstacles
    real(wp), intent(in) :: displacement(:, :), size_of_scene
    logical, intent(in) :: holds(:)
    logical, intent(out) :: wider
    type(facing_type) :: face
    real(wp) :: search
    integer :: i

    search = contact%search
    do i = 1, size(contact%left_out, 2)
      associate (side => contact%left_out(1, i), which => contact%left_out(2, i))
        face = find_nearest(contact%master, obstacles, node_of(contact%slave, side, which), size_of_scene)
        if (.not. face%place%found) cycle
        if (gap_of(contact%slave%segment(which, side), contact%master, face, displacement) >= -least*size_of_scene .and. &
            .not. any(holds(pack(contact%slave%segment(:, side), contact%slave%segment(:, side) > 0)))) cycle
        search = max(search, further*abs(face%place%gap))
      end associate
    end do
    wider = search > contact%search
    if (.not. wider) return
    contact%search = search
    contact%is_wider = .true.
  end subroutine widen

  !> Nodes of the master that pass through sides of the slave by more than what these leave open between their nodes.
  subroutine look_from_master(contact, obstacles, displacement, holds, size_of_scene, entered)
    type(line_contact), intent(inout) :: contact
    type(boxed_line), intent(in) :: obstacles
    real(wp), intent(in) :: displacement(:, :), size_of_scene
    logical, intent(in) :: holds(:)
    logical, intent(inout) :: entered
    type(facing_type) :: face(2)
    logical :: smooth
    real(wp) :: allowed, angle
    integer :: i, k, which
    real(wp) :: travel   !! the largest displacement [length]

    travel = maxval(norm2(displacement, dim=1))
    associate (slave => contact%slave, master => contact%master)
      do i = 1, size(master%element)
        do which = 1, 3
          associate (node => master%segment(which, i))
            if (node == 0) cycle
            if (any(contact%came_near == node)) cycle
            smooth = .not. master%corner(min(which, 2), i) .or. which == 3
            call find_facing(slave, obstacles, node_of(master, i, which), size_of_scene, face(1), face(2))
            do k = 1, 2
              if (.not. face(k)%place%found) cycle
              allowed = least*size_of_scene
              if (master%tip(min(which, 2), i) .and. which < 3 .and. abs(face(k)%place%gap) <= contact%search) then
                cycle   ! it has a pair
              else if (smooth .and. all_hold(slave%segment(:, face(k)%segment), holds)) then
                ! It is where the mesh has it; a pair of its own would be one too many.
                allowed = most*travel
              else if (is_held_off(slave, face(k)%segment, holds)) then
                ! Over a side of the slave gaps are closed in the mean, however short the master's are.
                allowed = allowed + allowance*(openness(slave, face(k)%segment, displacement, 0.0_wp) + &
                                               openness_at(master, i, which, displacement, slave%chord_length(face(k)%segment)))
              else
                allowed = allowed + bend(slave, face(k)%segment, displacement, 0.0_wp)
              end if
              if (smooth) then
                angle = norm2(face(k)%place%normal + master%outward(i, which))
                allowed = allowed + askew*angle*(slip_of(node, slave, face(k), displacement) + 0.5_wp*angle*abs(face(k)%place%gap))
              end if
              allowed = min(allowed, most*travel)
              if (gap_of(node, slave, face(k), displacement) >= -allowed) cycle
              contact%came_near = [contact%came_near, node]
              contact%search = max(contact%search, further*abs(face(k)%place%gap))
              entered = .true.
              exit
            end do
          end associate
        end do
      end do
    end associate
  end subroutine look_from_master

  !> Do all nodes of a side stand on the other line?
  pure logical function all_hold(nodes, holds)
    integer, intent(in) :: nodes(3)
    logical, intent(in) :: holds(:)   !! [nodes]

    all_hold = all(holds(pack(nodes, nodes > 0)))
  end function all_hold

  !> Does a node of a side, or of those beside it, stand on the other line? Then contact ends near by, between nodes.
  pure logical function is_held_off(line, side, holds)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side
    logical, intent(in) :: holds(:)   !! [nodes]
    integer :: i, k, near(3)

    is_held_off = .false.
    near = [side, line%neighbour(:, side)]
    do i = 1, 3
      if (near(i) == 0) cycle
      do k = 1, 3
        associate (node => line%segment(k, near(i)))
          if (node == 0) cycle
          is_held_off = is_held_off .or. holds(node)
        end associate
      end do
    end do
  end function is_held_off

  !> Gap of a node against what it faces of a line, as displacements have opened it [length].
  pure real(wp) function gap_of(node, line, face, displacement)
    integer, intent(in) :: node
    class(boundary_line), intent(in) :: line
    type(facing_type), intent(in) :: face
    real(wp), intent(in) :: displacement(:, :)

    gap_of = face%place%gap + dot_product(face%place%normal, apart_of(node, line, face, displacement))
  end function gap_of

  !> How far the node has slid along it [length].
  pure real(wp) function slip_of(node, line, face, displacement)
    integer, intent(in) :: node
    class(boundary_line), intent(in) :: line
    type(facing_type), intent(in) :: face
    real(wp), intent(in) :: displacement(:, :)

    slip_of = abs(cross_product(face%place%normal, apart_of(node, line, face, displacement)))
  end function slip_of

  !> Displacement of the node against that of what it faces [length].
  pure function apart_of(node, line, face, displacement) result(apart)
    integer, intent(in) :: node
    class(boundary_line), intent(in) :: line
    type(facing_type), intent(in) :: face
    real(wp), intent(in) :: displacement(:, :)
    real(wp) :: apart(2)
    integer :: k

    apart = displacement(:, node)
    do k = 1, 3
      if (face%place%share(k) /= 0.0_wp) &
        apart = apart - face%place%share(k)*displacement(:, line%segment(k, face%segment))
    end do
  end function apart_of

  !> How far a side is from the curve that its boundary means: as the undeformed curve rises above it, and as it bends [length].
  pure real(wp) function openness(line, side, displacement, over)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side
    real(wp), intent(in) :: displacement(:, :), over

    openness = line%chord_length(side)/4.0_wp*max(norm2(line%normal(:, 1, side) - line%own_normal(side, 0.0_wp)), &
                                                  norm2(line%normal(:, 2, side) - line%own_normal(side, 1.0_wp))) + &
               bend(line, side, displacement, over)
  end function openness

  !> The larger one of the sides that meet in a node.
  pure real(wp) function openness_at(line, side, which, displacement, over)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side, which
    real(wp), intent(in) :: displacement(:, :), over

    openness_at = openness(line, side, displacement, over)
    if (which == 3) return
    associate (beside => line%neighbour(which, side))
      if (beside > 0) openness_at = max(openness_at, openness(line, beside, displacement, over))
    end associate
  end function openness_at

  !> How far a straight line, as long as a side or as `over` if that is more, is from the curve into which the boundary bends
  !! from that side on [length].
  pure real(wp) function bend(line, side, displacement, over)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side
    real(wp), intent(in) :: displacement(:, :), over
    real(wp) :: covered, theta, turn
    integer :: end, i

    theta = 0.0_wp
    do end = 1, 2
      i = side
      turn = 0.0_wp
      covered = 0.0_wp
      do
        covered = covered + line%chord_length(i)
        if (line%neighbour(end, i) == 0 .or. line%corner(end, i)) exit
        i = line%neighbour(end, i)
        turn = max(turn, abs(rotation(line, i, displacement) - rotation(line, side, displacement)))
        if (covered + line%chord_length(i) > over) exit
      end do
      theta = theta + turn
    end do
    bend = max(line%chord_length(side), over)*theta/8.0_wp
  end function bend

  !> By how much displacements turn a side.
  pure real(wp) function rotation(line, side, displacement)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side
    real(wp), intent(in) :: displacement(:, :)

    associate (moved => displacement(:, line%segment(2, side)) - displacement(:, line%segment(1, side)))
      rotation = -dot_product(line%own_normal(side, 0.5_wp), moved)/line%chord_length(side)
    end associate
  end function rotation
end module epcont_contact_geometry_nearness
