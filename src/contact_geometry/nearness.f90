!> Nodes of lines in contact that have no pair, but came so near as loads moved them that they pass through
!> the other line.
!>
!> Gaps are those of the undeformed shape, opened by displacements, as those of pairs are: small
!> displacements.
module epcont_contact_geometry_nearness
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_gap
  use epcont_contact_geometry_faces, only: faces_type, find_faces
  use epcont_contact_geometry_line_pairs, only: add_pairs, forget_pairs
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_facing, only: facing_type, find_facing, node_of
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: line_contact, model_type
  implicit none
  private
  public :: enter_nodes_that_came_near

  !> A node between those of the other line that stand on its own may pass through by so many times what
  !! chords of curves and
  !> of bent sides make.
  real(wp), parameter :: allowance = 3.0_wp
  !> But not by more than this part of the largest displacement: that is no end of contact, but contact
  !! missed.
  real(wp), parameter :: most = 0.5_wp
  !> The two lines, not quite parallel, tell gaps by normals of their own: what these make of nodes that
  !! slide, and of gaps that close, differs by this much at most.
  real(wp), parameter :: askew = 1.5_wp
  !> Search beyond what came near.
  real(wp), parameter :: further = 1.5_wp

  !> What the solve has made of the scene.
  type :: moved_scene
    real(wp) :: size = 0.0_wp                     !! of the scene, as drawn [length]
    real(wp) :: travel = 0.0_wp                   !! the largest displacement [length]
    real(wp), allocatable :: displacement(:, :)   !! [length] [2, nodes]
    logical, allocatable :: holds(:)              !! nodes that stand on the other line; 0 is none [0:nodes]
  end type moved_scene

contains

  !> Give pairs to the nodes that came near; `entered`: there are some, and the scene wants to be solved
  !! again. Without displacements (what moves was held by nothing) all that may be faced, however far, has its
  !! pair.
  subroutine enter_nodes_that_came_near(model, displacement, touching, entered)
    type(model_type), intent(inout) :: model   !! the scene
    real(wp), allocatable, intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    logical, allocatable, intent(in) :: touching(:)           !! [pairs]
    logical, intent(out) :: entered   !! are there nodes that got pairs?
    type(moved_scene) :: moved
    type(faces_type) :: faces
    integer :: before, c, k

    entered = .false.
    if (.not. allocated(model%line_contact)) return
    if (size(model%line_contact) == 0) return
    moved%size = sum(maxval(model%x, dim=2) - minval(model%x, dim=2))
    if (allocated(displacement)) then
      moved%displacement = displacement
      moved%travel = maxval(norm2(displacement, dim=1))
      allocate (moved%holds(0:model%nodes), source=.false.)
      moved%holds(model%pair_node(2, pack([(k, k=1, model%pairs)], touching))) = .true.
    end if
    do c = 1, size(model%line_contact)
      call look_at_contact(model%line_contact(c), model%boundary, moved, entered)
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

  !> What a contact's nodes want: a wider search for those of the slave, or to be entered, as nodes of the
  !! master.
  pure subroutine look_at_contact(contact, obstacles, moved, entered)
    type(line_contact), intent(inout) :: contact
    type(boundary_line), intent(in) :: obstacles    !! the outlines of all bodies
    type(moved_scene), intent(in) :: moved
    logical, intent(inout) :: entered
    real(wp) :: search
    integer :: i, which

    search = contact%search
    if (allocated(moved%displacement)) then
      search = wanted_search(contact, obstacles, moved)
    else if (size(contact%left_out) > 0) then
      search = max(search, moved%size)
    end if
    if (search > contact%search) then
      contact%search = search
      contact%is_wider = .true.
      entered = .true.
    else if (allocated(moved%displacement)) then   ! what the slave's nodes will hold off is not the master's
      do i = 1, size(contact%master%element)
        do which = 1, 3
          call look_from_master(contact, obstacles, moved, i, which, entered)
        end do
      end do
    end if
  end subroutine look_at_contact

  !> How far to search where nodes of the slave, left out so far, pass through the master, or stand beside one
  !! that touches: what the nodes of a side share is known only where all of them have pairs [length].
  pure real(wp) function wanted_search(contact, obstacles, moved) result(search)
    type(line_contact), intent(in) :: contact
    type(boundary_line), intent(in) :: obstacles
    type(moved_scene), intent(in) :: moved
    type(facing_type) :: face,seen(2)
    real(wp) :: gap, slip
    integer :: i

    search = contact%search
    do i = 1, size(contact%left_out, 2)
      associate (side => contact%left_out(1, i), which => contact%left_out(2, i))
        seen = find_facing(contact%master, obstacles, node_of(contact%slave, side, which), moved%size)
 face=seen(1)
        if (.not. face%found) cycle
        call find_gap(contact%slave%segment(which, side), contact%master, face, moved%displacement, gap, slip)
        if (gap < -no_gap*moved%size .or. any(moved%holds(contact%slave%segment(:, side)))) &
          search = max(search, further*abs(face%gap))
      end associate
    end do
  end function wanted_search

  !> Enter a node of the master that passes through a side of the slave by more than is left open between the
  !! slave's nodes.
  pure subroutine look_from_master(contact, obstacles, moved, side, which, entered)
    type(line_contact), intent(inout) :: contact
    type(boundary_line), intent(in) :: obstacles
    type(moved_scene), intent(in) :: moved
    integer, intent(in) :: side, which
    logical, intent(inout) :: entered
    type(facing_type) :: face(2)
    real(wp) :: gap, slip
    integer :: k

    associate (node => contact%master%segment(which, side))
      if (node == 0 .or. any(contact%came_near == node)) return
      face = find_facing(contact%slave, obstacles, node_of(contact%master, side, which), moved%size)
      do k = 1, 2
        if (.not. face(k)%found) cycle
        if (contact%master%tip(min(which, 2), side) .and. which < 3 .and. &
            abs(face(k)%gap) <= contact%search) cycle
        call find_gap(node, contact%slave, face(k), moved%displacement, gap, slip)
        if (gap >= -left_open(contact, moved, side, which, face(k), slip)) cycle
        contact%came_near = [contact%came_near, node]
        contact%search = max(contact%search, further*abs(face(k)%gap))
        entered = .true.
        return
      end do
    end associate
  end subroutine look_from_master

  !> How far a node of the master may pass through a side of the slave [length].
  pure real(wp) function left_open(contact, moved, side, which, face, slip)
    type(line_contact), intent(in) :: contact
    type(moved_scene), intent(in) :: moved
    integer, intent(in) :: side, which       !! the node of the master
    type(facing_type), intent(in) :: face    !! and what it faces
    real(wp), intent(in) :: slip             !! how far it has slid there [length]
    logical :: smooth
    real(wp) :: angle

    left_open = no_gap*moved%size
    associate (slave => contact%slave, master => contact%master, displacement => moved%displacement)
      smooth = which == 3 .or. .not. master%corner(min(which, 2), side)
      if (smooth .and. all(moved%holds(slave%segment(:, face%segment)) .or. &
                           slave%segment(:, face%segment) == 0)) then
        ! It is where the mesh has it; a pair of its own would be one too many.
        left_open = most*moved%travel
      else if (is_held_off(slave, face%segment, moved%holds)) then
        ! Over a side of the slave gaps are closed in the mean, however short the master's are.
        left_open = left_open + allowance*(openness(slave, face%segment, displacement, 0.0_wp) + &
                                           openness_at(master, side, which, displacement, &
                                                       slave%chord_length(face%segment)))
      else
        left_open = left_open + bend(slave, face%segment, displacement, 0.0_wp)
      end if
      if (smooth) then
        angle = norm2(face%normal + master%outward(side, which))
        left_open = left_open + askew*angle*(slip + 0.5_wp*angle*abs(face%gap))
      end if
    end associate
    left_open = min(left_open, most*moved%travel)
  end function left_open

  !> Does a node of a side, or of those beside it, stand on the other line? Then contact ends near by, between
  !! nodes.
  pure logical function is_held_off(line, side, holds)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side
    logical, intent(in) :: holds(0:)   !! [0:nodes]

    associate (near => pack([side, line%neighbour(:, side)], [.true., line%neighbour(:, side) > 0]))
      is_held_off = any(holds([line%segment(:, near)]))
    end associate
  end function is_held_off

  !> Where a node is against what it faces of a line, as displacements have moved both.
  pure subroutine find_gap(node, line, face, displacement, gap, slip)
    integer, intent(in) :: node
    class(boundary_line), intent(in) :: line
    type(facing_type), intent(in) :: face
    real(wp), intent(in) :: displacement(:, :)
    real(wp), intent(out) :: gap     !! [length]
    real(wp), intent(out) :: slip    !! how far it has slid along the line [length]
    real(wp) :: apart(2)
    integer :: k

    apart = displacement(:, node)
    do k = 1, 3
      if (face%share(k) /= 0.0_wp) &
        apart = apart - face%share(k)*displacement(:, line%segment(k, face%segment))
    end do
    gap = face%gap + dot_product(face%normal, apart)
    slip = abs(cross_product(face%normal, apart))
  end subroutine find_gap

  !> How far a side is from the curve that its boundary means: as the undeformed curve rises above it, and as
  !! it bends [length].
  pure real(wp) function openness(line, side, displacement, over)
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side
    real(wp), intent(in) :: displacement(:, :), over

    openness = line%chord_length(side)/4.0_wp*max(norm2(line%normal(:, 1, side) - &
                                                        line%own_normal(side, 0.0_wp)), &
                                                  norm2(line%normal(:, 2, side) - &
                                                        line%own_normal(side, 1.0_wp))) + &
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

  !> How far a straight line, as long as a side or as `over` if that is more, is from the curve into which the
  !! boundary bends from that side on [length].
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
