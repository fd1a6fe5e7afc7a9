!> Nodes of contact lines that have no pair, but penetrate the other line after the displacements of the
!> loads.
!>
!> Gaps are those of the undeformed shape, opened by displacements, as for pairs: small
!> displacements.
module epcont_contact_geometry_nearness
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: same_place
  use epcont_contact_geometry_balance, only: balance_pairs
  use epcont_contact_geometry_faces, only: faces_type
  use epcont_contact_geometry_line_pairs, only: add_pairs, end_pairs
  use epcont_geometry_boundary_line, only: boundary_line, facing_type
  use epcont_contact_geometry_tangential_rows, only: add_tangential_rows
  use epcont_geometry_facing, only: find_facing, looking_point, node_of
  use epcont_geometry_plane, only: cross_product, extent_of
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_nodes_that_came_near, pair_nodes_that_came_near

  !> Displaced bodies.
  type :: moved_bodies
    real(wp) :: extent, travel                    !! size, largest displacement [length]
    real(wp), allocatable :: displacement(:, :)   !! [length] [2, nodes]
    logical, allocatable :: holds(:)              !! nodes in contact with the other line [0:nodes]
  end type moved_bodies

  real(wp), parameter :: &
    !> A master node between the nodes of a slave edge may penetrate by this multiple of the error of
    !! chords of curves and of bent edges.
    allowance = 3.0_wp, &
    !> But not by more than this fraction of the largest displacement: that is missed contact, not the end
    !! of one.
    most = 0.5_wp, &
    !> The two lines, not quite parallel, measure gaps along their own normals: for sliding nodes and closing
    !! gaps, the results differ at most by this factor.
    askew = 1.5_wp, &
    !> New search distance over the distance of a node that came near.
    further = 1.5_wp

contains

  !> Find the nodes that came near: they need pairs. Without displacements (bodies were unconstrained),
  !! all nodes with a projection at any distance need a pair.
  subroutine find_nodes_that_came_near(model, displacement, touching, contacts, found)
    type(model_type), intent(in) :: model                     !! the model
    real(wp), allocatable, intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    logical, allocatable, intent(in) :: touching(:)           !! [pairs]
    type(line_contact), allocatable, intent(out) :: contacts(:)   !! contacts of the model, with these nodes
    logical, intent(out) :: found                             !! are there some?
    type(moved_bodies) :: moved
    integer, allocatable :: node(:)        ! nodes of the elements
    type(line_contact) :: contact
    integer :: c

    found = .false.
    contacts = model%contact%line_contact
    if (size(contacts) == 0) return
    node = model%mesh%around%members()
    moved%extent = sum(extent_of(model%mesh%x(:, node)))
    if (allocated(displacement)) then
      moved%displacement = displacement
      moved%travel = maxval(norm2(displacement(:, node), dim=1))
      allocate (moved%holds(0:model%mesh%nodes), source=.false.)
      moved%holds(pack(model%contact%pair_node(2, :), touching)) = .true.
    end if
    do c = 1, size(contacts)
      contact = contacts(c)
      call look_at_contact()
      contacts(c) = contact
    end do

  contains

    !> Check the nodes of a contact: slave nodes may need a wider search, master nodes may need a
    !! pair.
    subroutine look_at_contact()
      real(wp) :: search
      integer :: i, which

      search = contact%search
      do i = 1, size(contact%left_out, 2)
        call look_from_slave(contact%left_out(1, i), contact%left_out(2, i))
      end do
      if (contact%search > search) then
        contact%is_wider = .true.
        found = .true.
      else if (allocated(displacement)) then   ! slave nodes with a new pair come first
        do i = 1, size(contact%master%element)
          do which = 1, 3
            call look_from_master(i, which)
          end do
        end do
      end if
    end subroutine look_at_contact

    !> Widen the search if a slave node without a pair penetrates the master, or is beside one in contact:
    !! mortar weights of an edge need pairs at all of its nodes.
    subroutine look_from_slave(side, which)
      integer, intent(in) :: side, which
      type(facing_type) :: face(2)
      real(wp) :: gap(2)

      if (.not. allocated(displacement)) then
        contact%search = max(contact%search, moved%extent)
        return
      end if
      associate (node => contact%slave%segment(:, side))
        face = find_facing(contact%master, model%contact%boundary, node_of(contact%slave, side, which), &
                           moved%extent)
        if (.not. face(1)%found) return
        gap = gap_and_slip(displacement, node(which), contact%master, face(1))
        if (gap(1) < -same_place*moved%extent .or. any(moved%holds(node))) &
          contact%search = max(contact%search, further*abs(face(1)%gap))
      end associate
    end subroutine look_from_slave

    !> Add a master node that penetrates a slave edge by more than the gap that is allowed between
    !! slave nodes.
    subroutine look_from_master(side, which)
      integer, intent(in) :: side, which
      type(facing_type) :: face(2)
      type(looking_point) :: from
      real(wp) :: gap(2)
      integer :: k

      from = node_of(contact%master, side, which)
      if (from%node == 0 .or. any(contact%came_near == from%node)) return
      face = find_facing(contact%slave, model%contact%boundary, from, moved%extent)
      do k = 1, 2
        if (.not. face(k)%found .or. from%at_tip .and. abs(face(k)%gap) <= contact%search) cycle
        gap = gap_and_slip(displacement, from%node, contact%slave, face(k))
        if (gap(1) >= -left_open(moved, contact, side, which, face(k), gap(2))) cycle
        contact%came_near = [contact%came_near, from%node]
        contact%search = max(contact%search, further*abs(face(k)%gap))
        found = .true.
        return
      end do
    end subroutine look_from_master
  end subroutine find_nodes_that_came_near

  !> Distance between a straight line, as long as an edge or as `over` if longer, and the curve of the
  !! bent boundary that begins at this edge [length].
  pure real(wp) function bend(displacement, line, side, over)
    real(wp), intent(in) :: displacement(:, :), over
    type(boundary_line), intent(in) :: line
    integer, intent(in) :: side
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
        turn = max(turn, abs(rotation(line, i) - rotation(line, side)))
        if (covered + line%chord_length(i) > over) exit
      end do
      theta = max(theta, turn)   ! as in the certificate
    end do
    bend = max(line%chord_length(side), over)*theta/8.0_wp

  contains

    !> Rotation of an edge by displacements.
    pure real(wp) function rotation(line, side)
      type(boundary_line), intent(in) :: line
      integer, intent(in) :: side

      associate (turned => displacement(:, line%segment(2, side)) - displacement(:, line%segment(1, side)))
        rotation = -dot_product(line%own_normal(side, 0.5_wp), turned)/line%chord_length(side)
      end associate
    end function rotation
  end function bend

  !> Largest distance of edges from the curve of their boundary: height of the undeformed curve, and
  !! bending [length].
  pure real(wp) function openness(displacement, line, sides, over)
    real(wp), intent(in) :: displacement(:, :), over
    type(boundary_line), intent(in) :: line
    integer, intent(in) :: sides(:)   !! 0 if absent
    real(wp) :: rise
    integer :: end, k

    openness = 0.0_wp
    do k = 1, size(sides)
      if (sides(k) == 0) cycle
      associate (normal => line%normal(:, :, sides(k)))
        rise = line%chord_length(sides(k))/4.0_wp* &
               maxval([(norm2(normal(:, end) - line%own_normal(sides(k), real(end - 1, wp))), end=1, 2)])
      end associate
      openness = max(openness, rise + bend(displacement, line, sides(k), over))
    end do
  end function openness

  !> Gap between a node and its projection on a line after displacements, and the relative tangential
  !! displacement [length].
  pure function gap_and_slip(displacement, node, line, face)
    real(wp), intent(in) :: displacement(:, :)
    integer, intent(in) :: node
    type(boundary_line), intent(in) :: line
    type(facing_type), intent(in) :: face
    real(wp) :: apart(2), gap_and_slip(2)
    integer :: k

    apart = displacement(:, node)
    do k = 1, 3
      if (face%share(k) /= 0.0_wp) &
        apart = apart - face%share(k)*displacement(:, line%segment(k, face%segment))
    end do
    gap_and_slip = [face%gap + dot_product(face%normal, apart), abs(cross_product(face%normal, apart))]
  end function gap_and_slip

  !> Allowed penetration of a master node into a slave edge [length].
  pure real(wp) function left_open(moved, contact, side, which, face, slip)
    type(moved_bodies), intent(in) :: moved
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: side, which       !! the master node
    type(facing_type), intent(in) :: face    !! its projection
    real(wp), intent(in) :: slip             !! relative tangential displacement there [length]
    logical :: smooth
    real(wp) :: angle
    integer :: beside

    left_open = same_place*moved%extent
    associate (slave => contact%slave, master => contact%master, s => face%segment)
      smooth = which == 3 .or. .not. master%corner(min(which, 2), side)
      if (smooth .and. all(moved%holds(slave%segment(:, s)) .or. slave%segment(:, s) == 0)) then
        ! The slave node is at this point already; a second pair would be redundant.
        left_open = most*moved%travel
      else if (is_held_off(moved, contact, s)) then
        ! Over a slave edge, gaps are closed on average, however short the master's edges are.
        beside = 0
        if (which < 3) beside = master%neighbour(which, side)
        left_open = left_open + allowance*(openness(moved%displacement, slave, [s], 0.0_wp) + &
            openness(moved%displacement, master, [side, beside], slave%chord_length(s)))
      else
        left_open = left_open + bend(moved%displacement, slave, s, 0.0_wp)
      end if
      if (smooth) then
        angle = norm2(face%normal + master%normal(:, which, side))
        left_open = left_open + askew*angle*(slip + 0.5_wp*angle*abs(face%gap))
      end if
    end associate
    left_open = min(left_open, most*moved%travel)
  end function left_open

  !> Is a node of a slave edge, or of its neighbours, in contact? Then the end of contact is near, between
  !! nodes.
  pure logical function is_held_off(moved, contact, side)
    type(moved_bodies), intent(in) :: moved
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: side

    associate (beside => contact%slave%neighbour(:, side))
      is_held_off = any(moved%holds([contact%slave%segment(:, [side, pack(beside, beside > 0)])]))
    end associate
  end function is_held_off

  !> Give pairs to the nodes that came near.
  subroutine pair_nodes_that_came_near(model, contacts, paired)
    type(model_type), intent(inout) :: model      !! the model
    type(line_contact), intent(in) :: contacts(:) !! its contacts with these nodes
    logical, intent(out) :: paired                !! are there more pairs now?
    type(line_contact) :: contact
    type(faces_type) :: faces
    integer :: before, c

    before = model%contact%pairs
    model%contact%pairs = model%contact%single_pairs()
    do c = 1, size(contacts)
      contact = contacts(c)
      call add_pairs(model, contact, faces)
      model%contact%line_contact(c) = contact
    end do
    call end_pairs(model)
    call balance_pairs(model)
    call add_tangential_rows(model)
    paired = model%contact%pairs > before
  end subroutine pair_nodes_that_came_near
end module epcont_contact_geometry_nearness
