!> Where the pressure of a zone has no limit: at a tip inside it, or at an edge, where one body ends and the
!> other goes on.
!>
!> Both are told by the geometry, not by the pressures, of which each kind of element has others. A tip is a
!> bend of the gap, or of the other body's outline, at one node alone: arcs and fillets bend at each of their
!> nodes. At an edge the contact reaches the last of its pairs and the pressure does not fall towards it.
module epcont_accuracy_limits
  use epcont_accuracy_contact_stress, only: surface_compliance
  use epcont_accuracy_patches, only: patch_table
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: same_place
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: model_type
  use epcont_result_contact_line, only: contact_line, outer_sides
  implicit none
  private
  public :: bend_at, beyond, corner, edge_pairs, gap_bulge, has_tip

  !> A tip's curvature is so many times that of the nodes around it.
  real(wp), parameter :: alone = 4.0_wp
  !> The pressure that a bend adds, E* times its angle, is at least this part of the largest.
  real(wp), parameter :: matters = 0.1_wp
  !> An outline that turns by more than this ends [rad].
  real(wp), parameter :: corner = 35.0_wp*acos(-1.0_wp)/180.0_wp
  !> Bodies that end together in corners of so much in all, or one alone on what is rigid, have no edge: what
  !! the quarter plane on a frictionless floor is a half of [rad].
  real(wp), parameter :: straight = acos(-1.0_wp)*(1.0_wp + 1.0e-3_wp)
  !> Corners of two bodies are at one place within this part of a side.
  real(wp), parameter :: flush = 1.0e-2_wp
  !> Where there is no line of symmetry.
  real(wp), parameter :: nowhere(2, 2) = huge(1.0_wp)
  !> Part of a row's weights that says where a side is.
  real(wp), parameter :: least_weight = 1.0e-3_wp

contains

  !> Is there a tip in a zone, of these pairs?
  pure logical function has_tip(model, table, line, pairs, largest)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pairs(:)
    real(wp), intent(in) :: largest   !! pressure [stress]
    integer :: gaps   !! CGAP pairs, whose gaps tell all of it: they come before those of lines
    integer, allocatable :: ends(:), within(:)
    integer :: across, i, k
    real(wp) :: least
    real(wp) :: mirror(2, 2)   !! places of lines of symmetry at the ends, across x and across y [length]

    has_tip = .true.
    mirror = nowhere
    do k = 1, 2
      associate (pair => pairs(merge(1, size(pairs), k == 1)))
        across = merge(1, 2, abs(model%normal(2, pair)) > abs(model%normal(1, pair)))
        if (line%mirrored(pair)) mirror(across, k) = model%x(across, line%node(pair))
      end associate
    end do
    gaps = model%pairs
    if (size(model%line_contact) > 0) gaps = model%line_contact(1)%first - 1
    ends = reshape(line%neighbour(:, pairs([1, size(pairs)])), [4])
    ends = pack(ends, ends > 0)
    within = [pairs, pack(ends, line%tributary(ends) == 0.0_wp)]   ! a corner on the axis bears nothing by itself
    do k = 1, size(within)
      least = matters*largest*surface_compliance(model, table, within(k))
      if (least <= 0.0_wp) cycle
      if (gap_bends(model, line, within(k), least)) return
      if (within(k) <= gaps) cycle
      do i = model%row_start(within(k)) + 1, model%row_start(within(k) + 1) - 1
        if (abs(model%row_weight(i)) < least_weight) cycle
        associate (node => model%row_node(i))
          if (outline_bends(model, node, mirror, least) .and. .not. is_flush(model, line, pairs, node)) return
        end associate
      end do
    end do
    has_tip = .false.
  end function has_tip

  !> Does the gap bend open at a pair alone?
  pure logical function gap_bends(model, line, pair, least)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair
    real(wp), intent(in) :: least   !! angle [rad]
    real(wp) :: angle, curvature, around, other
    integer :: first, k, second

    call bend_at(model, line, pair, angle, curvature)
    gap_bends = .false.
    if (angle < least) return
    around = -1.0_wp
    do first = 1, 2
      k = line%neighbour(first, pair)
      do second = 1, 2   ! the neighbour, then the one behind it
        if (k == 0) exit
        call bend_at(model, line, k, angle, other)
        around = max(around, abs(other))
        k = beyond(line, k, pair)
      end do
    end do
    gap_bends = around >= 0.0_wp .and. curvature >= alone*around
  end function gap_bends

  !> How far a smooth gap may fall below its values at a pair and beside it, by the most that it bends at one
  !! of them [length].
  pure real(wp) function gap_bulge(model, line, pair)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair
    real(wp) :: angle, curvature
    integer :: k

    gap_bulge = 0.0_wp
    do k = 0, 2
      associate (near => merge(pair, line%neighbour(max(k, 1), pair), k == 0))
        if (near == 0) cycle
        call bend_at(model, line, near, angle, curvature)
        if (curvature <= 0.0_wp .or. angle > corner) cycle   ! beyond, one pair faces a step, or another side
        gap_bulge = max(gap_bulge, angle**2/curvature/8.0_wp)   ! an eighth of angle times spacing
      end associate
    end do
  end function gap_bulge

  !> The pair behind one, seen from its neighbour; 0: none.
  pure integer function beyond(line, pair, from)
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair, from

    beyond = line%neighbour(1, pair)
    if (beyond == from) beyond = line%neighbour(2, pair)
    if (beyond == from) beyond = 0
  end function beyond

  !> By how much the gap bends open at a pair, and that over the length that it stands for; a pair without
  !! neighbours on both sides does not bend.
  pure subroutine bend_at(model, line, pair, angle, curvature)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair
    real(wp), intent(out) :: angle       !! [rad]
    real(wp), intent(out) :: curvature   !! [1/length]
    real(wp) :: long(2), slope(2)
    integer :: k

    angle = 0.0_wp
    curvature = 0.0_wp
    long = 0.0_wp
    do k = 1, 2
      associate (other => line%neighbour(k, pair))
        if (other == 0) cycle
        long(k) = norm2(model%x(:, line%node(other)) - model%x(:, line%node(pair)))
        slope(k) = (model%initial_gap(other) - model%initial_gap(pair))/long(k)
      end associate
    end do
    if (any(long == 0.0_wp)) then
      if (all(long == 0.0_wp) .or. .not. line%mirrored(pair)) return
      k = maxloc(long, dim=1)
      long = long(k)
      slope = slope(k)
    end if
    angle = sum(slope)
    curvature = 2.0_wp*angle/sum(long)
  end subroutine bend_at

  !> Does the outline turn at a node alone?
  pure logical function outline_bends(model, node, mirror, least)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    real(wp), intent(in) :: mirror(2, 2)   !! lines of symmetry
    real(wp), intent(in) :: least          !! angle [rad]
    real(wp) :: angle, around, curvature, other
    integer :: beside(2), here, k, next(2), step

    call turn_at(model, node, mirror, beside, angle, curvature)
    outline_bends = .false.
    if (angle < least) return
    around = 0.0_wp
    do k = 1, 2
      here = beside(k)
      do step = 1, 2   ! the node beside it, then the one behind that
        if (here == 0) exit
        call turn_at(model, here, mirror, next, angle, other)
        around = max(around, abs(other))
        here = next(k)
      end do
    end do
    outline_bends = curvature >= alone*around
  end function outline_bends

  !> Is a node a corner at which a zone's own outline ends in a corner too?
  pure logical function is_flush(model, line, pairs, node)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pairs(:), node
    real(wp) :: side
    integer :: beside(2), k, own

    is_flush = .false.
    if (corner_inside(model, node) <= 0.0_wp) return
    beside = outline_beside(model, node)
    side = norm2(model%x(:, beside(1)) - model%x(:, beside(2)))
    do k = 1, size(pairs), max(1, size(pairs) - 1)
      own = line%node(pairs(k))
      is_flush = is_flush .or. corner_inside(model, own) > 0.0_wp .and. norm2(model%x(:, own) - model%x(:, node)) <= flush*side
    end do
  end function is_flush

  !> By how much an outline turns at a node, outward positive, and that over the length that the node stands
  !! for. On a line of symmetry it goes on as mirrored there.
  pure subroutine turn_at(model, node, mirror, beside, angle, curvature)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    real(wp), intent(in) :: mirror(2, 2)     !! places of lines of symmetry, across x and across y
    integer, intent(out) :: beside(2)        !! nodes before and behind it, the body on their left; 0: none
    real(wp), intent(out) :: angle           !! [rad]
    real(wp), intent(out) :: curvature       !! [1/length]
    real(wp) :: before(2), behind(2)
    integer :: c, k

    beside = outline_beside(model, node)
    angle = 0.0_wp
    curvature = 0.0_wp
    if (any(beside == 0)) return
    before = model%x(:, node) - model%x(:, beside(1))
    behind = model%x(:, beside(2)) - model%x(:, node)
    do c = 1, 2
      do k = 1, 2
        if (beside(k) == 0) cycle
        if (.not. along_symmetry(model, c, mirror(c, :), node, beside(k))) cycle
        beside(k) = 0
        if (k == 1) before = merge(behind, -behind, [1, 2] == c)
        if (k == 2) behind = merge(before, -before, [1, 2] == c)
      end do
    end do
    angle = atan2(cross_product(before, behind), dot_product(before, behind))
    curvature = 2.0_wp*angle/(norm2(before) + norm2(behind))
  end subroutine turn_at

  !> Does a side lie on a line of symmetry that is known, or on one along which its nodes alone are free, or
  !! on the axis of rings?
  pure logical function along_symmetry(model, c, mirror, one, other)
    type(model_type), intent(in) :: model
    integer, intent(in) :: c   !! the direction across
    real(wp), intent(in) :: mirror(2)
    integer, intent(in) :: one, other

    associate (x => model%x(c, [one, other]), tolerance => same_place*norm2(model%x(:, one) - model%x(:, other)))
      along_symmetry = any(abs(mirror - x(1)) <= tolerance .and. abs(mirror - x(2)) <= tolerance)
      if (abs(x(1) - x(2)) > tolerance) return
      along_symmetry = along_symmetry .or. all(model%held(c, [one, other])) .and. .not. any(model%held(3 - c, [one, other])) &
                       .or. c == 1 .and. abs(x(1)) <= tolerance .and. model%has_rings()
    end associate
  end function along_symmetry

  !> Nodes before and behind one on the outline of its body, which lies on their left; 0: none.
  pure function outline_beside(model, node) result(beside)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    integer :: beside(2)
    integer, allocatable :: sides(:, :)
    integer :: i

    beside = 0
    sides = outer_sides(model, node)
    do i = 1, size(sides, 2)
      associate (side => sides(:3, i))
        if (side(3) == node) beside = side(:2)
        if (side(1) == node) beside(2) = merge(side(3), side(2), side(3) > 0)
        if (side(2) == node) beside(1) = merge(side(3), side(1), side(3) > 0)
      end associate
    end do
  end function outline_beside

  !> How many pairs at the end of a zone tell by their pressures whether the last candidate is at an edge: 0:
  !! it is at none, since both bodies end there; 1: the last, where no more than the candidates end; 2: also
  !! the one before it, where a body ends in a corner, which may bear little by itself.
  pure integer function edge_pairs(model, line, pair)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair
    real(wp) :: inside(2)   !! angles of corners, of the pair's own node and on the other side; 0: no corner
    logical :: rigid
    integer :: i

    inside = 0.0_wp
    rigid = .true.
    do i = model%row_start(pair), model%row_start(pair + 1) - 1
      associate (node => model%row_node(i))
        if (abs(model%row_weight(i)) < least_weight) cycle
        if (node /= line%node(pair)) rigid = rigid .and. (model%around%start(node) == model%around%start(node + 1) .or. &
                                                          all(model%held(:, node)))
        associate (found => inside(merge(1, 2, node == line%node(pair))))
          found = max(found, corner_inside(model, node))
        end associate
      end associate
    end do
    edge_pairs = merge(2, 1, any(inside > 0.0_wp))
    if (rigid) then
      if (inside(1) > 0.0_wp .and. inside(1) <= 0.5_wp*straight) edge_pairs = 0
    else if (all(inside > 0.0_wp) .and. sum(inside) <= straight) then
      edge_pairs = 0
    end if
  end function edge_pairs

  !> The angle of the body at a corner; 0: the outline goes on [rad].
  pure real(wp) function corner_inside(model, node) result(inside)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    integer :: beside(2)
    real(wp) :: angle, curvature

    inside = 0.0_wp
    call turn_at(model, node, nowhere, beside, angle, curvature)
    if (angle > corner) inside = acos(-1.0_wp) - angle
  end function corner_inside
end module epcont_accuracy_limits
