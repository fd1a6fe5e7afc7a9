!> Singular pressures: at a tip (sharp corner) inside a zone, or at an edge, where one body ends and the other
!> continues.
!>
!> The geometry decides, not the pressures, which depend on the element type. A tip is a bend of the gap, or
!> of the other body's outline, at one node alone; arcs and fillets bend at each of their nodes. At an edge
!> the contact reaches the last of its pairs, and the pressure does not fall towards it.
module epcont_accuracy_limits
  use epcont_accuracy_surface_line, only: corner, surface_line
  use epcont_accuracy_weights, only: tip_matters, tip_stands_out
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: coincident
  use epcont_geometry_plane, only: angle_between
  use epcont_model_model, only: model_type
  use epcont_result_contact_line, only: contact_line, outer_sides
  use epcont_result_zones, only: contact_zone
  implicit none
  private
  public :: edge_pairs, has_tip

  real(wp), parameter :: pi = acos(-1.0_wp)
  !> If the angles of two bodies that end together, or of one body on a rigid face, sum to at most this angle,
  !! there is no edge: the pressure is bounded, as of a quarter plane on a frictionless floor (half of a
  !! half-plane) [rad].
  real(wp), parameter :: straight = pi*(1.0_wp + 1.0e-3_wp)
  !> Corners of two bodies coincide if their distance is at most this part of an edge.
  real(wp), parameter :: flush = 1.0e-2_wp
  !> Position of a line of symmetry that does not exist.
  real(wp), parameter :: nowhere(2, 2) = huge(1.0_wp)
  !> Smallest weight of a gap row that locates an edge.
  real(wp), parameter :: least_weight = 1.0e-3_wp

  !> Outline at a node.
  type :: turn_type
    integer :: beside(2) = 0            !! nodes before and after it, the body on their left; 0 if there is no
                                        !! such node
    real(wp) :: reach = 0.0_wp          !! distance between these nodes [length]
    real(wp) :: angle = 0.0_wp          !! rotation of the outline, positive outward [rad]
    real(wp) :: curvature = 0.0_wp      !! angle divided by the node's part of the outline [1/length]
  end type turn_type

contains

  !> Is there a tip in a zone?
  pure logical function has_tip(model, line, zone, largest)
    type(model_type), intent(in) :: model    !! model
    type(surface_line), intent(in) :: line   !! of its pairs
    type(contact_zone), intent(in) :: zone   !! of these pairs
    real(wp), intent(in) :: largest          !! largest pressure of the zone [stress]
    integer, allocatable :: within(:)
    integer :: across, ends(2), i, k
    real(wp) :: mirror(2, 2)   !! positions of lines of symmetry at the ends, across x and across y [length]

    has_tip = .true.
    mirror = nowhere
    ends = [zone%first, zone%last]
    do k = 1, 2
      across = merge(1, 2, abs(model%contact%normal(2, ends(k))) > abs(model%contact%normal(1, ends(k))))
      if (line%mirrored(ends(k))) mirror(across, k) = line%x(across, ends(k))
    end do
    ! a corner on the axis carries no force by itself
    within = [zone%pairs, pack(zone%beyond, line%tributary(zone%beyond) == 0.0_wp)]
    do k = 1, size(within)
      associate (pair => within(k), least => tip_matters*largest*line%compliance(within(k)))
        if (least <= 0.0_wp) cycle
        if (gap_bends(pair, least)) return
        if (pair <= model%contact%single_pairs()) cycle   ! their gap shows any bend
        do i = model%contact%row_start(pair) + 1, model%contact%row_start(pair + 1) - 1
          if (abs(model%contact%row_weight(i)) < least_weight) cycle
          if (outline_bends(model%contact%row_node(i), least) .and. &
              .not. is_flush(model%contact%row_node(i))) return
        end do
      end associate
    end do
    has_tip = .false.

  contains

    !> Does the gap bend open at this pair alone?
    pure logical function gap_bends(pair, least)
      integer, intent(in) :: pair
      real(wp), intent(in) :: least   !! angle [rad]
      real(wp) :: around
      integer :: k, near, step

      gap_bends = .false.
      if (line%bend(pair) < least) return
      around = 0.0_wp
      do k = 1, 2
        near = line%neighbour(k, pair)
        do step = 1, 2   ! the neighbour, then the next one
          if (near == 0) exit
          around = max(around, abs(line%curvature(near)))
          near = line%beyond(near, pair)
        end do
      end do
      gap_bends = line%curvature(pair) >= tip_stands_out*around
    end function gap_bends

    !> Does the outline bend at this node alone?
    pure logical function outline_bends(node, least)
      integer, intent(in) :: node
      real(wp), intent(in) :: least   !! angle [rad]
      type(turn_type) :: here, near
      real(wp) :: around
      integer :: k, step

      outline_bends = .false.
      here = turn_at(model, node, mirror)
      if (here%angle < least) return
      around = 0.0_wp
      do k = 1, 2
        near = here
        do step = 1, 2   ! the neighbour, then the next one
          if (near%beside(k) == 0) exit
          near = turn_at(model, near%beside(k), mirror)
          around = max(around, abs(near%curvature))
        end do
      end do
      outline_bends = here%curvature >= tip_stands_out*around
    end function outline_bends

    !> Is a node a corner close to a corner of the zone's own outline?
    pure logical function is_flush(node)
      integer, intent(in) :: node
      type(turn_type) :: here
      integer :: k

      here = turn_at(model, node, nowhere)
      is_flush = here%angle > corner .and. &
                 any([(corner_inside(model, line%node(ends(k))) > 0.0_wp .and. &
                       norm2(line%x(:, ends(k)) - model%mesh%x(:, node)) <= flush*here%reach, k=1, 2)])
    end function is_flush
  end function has_tip

  !> Find the outline of a body at a node; a line of symmetry mirrors it.
  pure function turn_at(model, node, mirror) result(turn)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    real(wp), intent(in) :: mirror(2, 2)     !! positions of lines of symmetry, across x and across y
    type(turn_type) :: turn
    real(wp) :: piece(2, 2)   !! vectors from the node before it, and to the node after it
    integer, allocatable :: sides(:, :)
    integer :: c, i, k

    sides = outer_sides(model, node)
    do i = 1, size(sides, 2)
      associate (side => sides(:3, i))
        if (side(3) == node) turn%beside = side(:2)
        if (side(1) == node) turn%beside(2) = merge(side(3), side(2), side(3) > 0)
        if (side(2) == node) turn%beside(1) = merge(side(3), side(1), side(3) > 0)
      end associate
    end do
    if (any(turn%beside == 0)) return
    turn%reach = norm2(model%mesh%x(:, turn%beside(1)) - model%mesh%x(:, turn%beside(2)))
    piece(:, 1) = model%mesh%x(:, node) - model%mesh%x(:, turn%beside(1))
    piece(:, 2) = model%mesh%x(:, turn%beside(2)) - model%mesh%x(:, node)
    do c = 1, 2
      do k = 1, 2
        if (turn%beside(k) == 0) cycle
        if (.not. along_symmetry(c, turn%beside(k))) cycle
        turn%beside(k) = 0
        piece(:, k) = merge(piece(:, 3 - k), -piece(:, 3 - k), [1, 2] == c)
      end do
    end do
    turn%angle = angle_between(piece(:, 1), piece(:, 2))
    turn%curvature = 2.0_wp*turn%angle/(norm2(piece(:, 1)) + norm2(piece(:, 2)))

  contains

    !> Does an edge lie on a known line of symmetry, on a line along which alone its nodes can move, or on the
    !! axis of symmetry of an axisymmetric model?
    pure logical function along_symmetry(c, other)
      integer, intent(in) :: c   !! direction normal to the line
      integer, intent(in) :: other

      associate (x => model%mesh%x(c, [node, other]), held => model%constraints%held(:, [node, other]), &
                 near => coincident*norm2(model%mesh%x(:, node) - model%mesh%x(:, other)))
        along_symmetry = any(abs(mirror(c, :) - x(1)) <= near .and. abs(mirror(c, :) - x(2)) <= near)
        if (abs(x(1) - x(2)) > near) return
        along_symmetry = along_symmetry .or. all(held(c, :)) .and. .not. any(held(3 - c, :)) &
                         .or. c == 1 .and. abs(x(1)) <= near .and. model%has_rings()
      end associate
    end function along_symmetry
  end function turn_at

  !> Number of pairs at the end of a zone whose pressures show whether the last candidate is at an edge. 0:
  !! not at an edge, since both bodies end there; 1: the last, if only the candidates end; 2: also the pair
  !! before it, if a body ends in a corner, which may carry little force.
  pure integer function edge_pairs(model, line, pair)
    type(model_type), intent(in) :: model     !! model
    class(contact_line), intent(in) :: line   !! of its pairs
    integer, intent(in) :: pair               !! the last candidate
    real(wp) :: inside(2)   !! angles of the corners at the pair's node and on the other body; 0 if there is
                            !! no corner
    logical :: rigid
    integer :: i, side

    inside = 0.0_wp
    rigid = .true.
    do i = model%contact%row_start(pair), model%contact%row_start(pair + 1) - 1
      associate (node => model%contact%row_node(i))
        if (abs(model%contact%row_weight(i)) < least_weight) cycle
        side = merge(1, 2, node == line%node(pair))
        if (side == 2) rigid = rigid .and. (size(model%mesh%around%of(node)) == 0 .or. &
                                            all(model%constraints%held(:, node)))
        inside(side) = max(inside(side), corner_inside(model, node))
      end associate
    end do
    edge_pairs = merge(2, 1, any(inside > 0.0_wp))
    if (rigid) then
      if (inside(1) > 0.0_wp .and. inside(1) <= 0.5_wp*straight) edge_pairs = 0
    else if (all(inside > 0.0_wp) .and. sum(inside) <= straight) then
      edge_pairs = 0
    end if
  end function edge_pairs

  !> Find the angle of the body at a corner; 0 if the outline continues [rad].
  pure real(wp) function corner_inside(model, node) result(inside)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    type(turn_type) :: turn

    turn = turn_at(model, node, nowhere)
    inside = merge(pi - turn%angle, 0.0_wp, turn%angle > corner)
  end function corner_inside
end module epcont_accuracy_limits
