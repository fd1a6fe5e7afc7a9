!> Slave edges, cut into pieces that project onto one master edge each, with their integration points.
!>
!> If not all of an edge projects onto the master, only the projections of its nodes count. At a
!> joint of the master, where ends of two bodies are flush, an edge is split in two: the ends may step, or the
!> line bend there, so each part has a gap row.
module epcont_contact_geometry_mortar_sides
  use epcont_base_kinds, only: wp
  use epcont_contact_geometry_faces, only: faces_type
  use epcont_geometry_boundary_line, only: beyond, facing_type
  use epcont_geometry_facing, only: find_facing, looking_point, rise_of
  use epcont_geometry_plane, only: right_of, unit
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: cut_sides, side_points

  !> Gauss points of each piece of an edge: exact for the product of two quadratics on a straight edge.
  integer, parameter :: gauss_points = 3
  real(wp), parameter :: &
    gauss_place(3) = 0.5_wp + 0.5_wp*[-sqrt(0.6_wp), 0.0_wp, sqrt(0.6_wp)], &
    gauss_weight(3) = [5.0_wp, 8.0_wp, 5.0_wp]/18.0_wp, &
    !> Weights that extrapolate their values to the end of the piece, by a parabola.
    at_end(3) = [1.0_wp - sqrt(0.6_wp), -0.8_wp, 1.0_wp + sqrt(0.6_wp)]/1.2_wp, &
    !> Cosine of the largest angle between normals along an edge on one curve: 35 degrees.
    one_curve = 0.816_wp, &

    !> Jump of the gap, as a fraction of an edge, above which the other line has a step.
    step = 0.01_wp, &
    !> Cosine of the largest angle between edges that can be fully in contact: 20 degrees.
    parallel = 0.94_wp, &
    !> Cosine of normals on both sides of a node, below which it is a corner: more than 9 degrees.
    smooth = 0.988_wp

  !> A slave edge, or its part between joints, with the integration points of its pieces, piece
  !> by piece.
  type :: side_points
    logical :: covered = .true.                !! it is fully opposite the other line
    integer :: row(3) = 0                      !! rows of its nodes, or of its ends at joints, 0 if absent
    real(wp), allocatable :: along(:)          !! position on the edge, from 0 to 1 [points]
    real(wp), allocatable :: share(:, :)       !! shape functions of its nodes [3, points]
    real(wp), allocatable :: weight(:)         !! length, times radius if axisymmetric [points]
    type(facing_type), allocatable :: facing(:)
    real(wp) :: integral(3) = 0.0_wp           !! of the shape functions, or dual functions, of the nodes
    real(wp), allocatable :: dual(:, :)        !! dual functions times weight, if it is covered [3, points]
  end type side_points

contains

  !> Cut the slave edges where the opposite edge changes, and at joints of the
  !! master.
  subroutine cut_sides(model, contact, faces, points, covered, ends)
    type(model_type), intent(in) :: model          !! the model, without these pairs
    type(line_contact), intent(in) :: contact      !! the contact of lines
    type(faces_type), intent(in) :: faces          !! projections of the slave nodes
    type(side_points), allocatable, intent(out) :: points(:)   !! of the edges, and of their parts at joints
    logical, intent(out) :: covered(:)             !! edges that are fully opposite the master [edges]
    integer, allocatable, intent(out) :: ends(:)   !! master nodes at joints that have rows
    integer :: s

    allocate (points(size(covered)))
    do s = 1, size(covered)
      points(s) = cut_side(model, contact, faces, s)
      points(s)%covered = points(s)%covered .and. is_even(model, contact, faces, points(s), s)
    end do
    covered = points%covered
    call cut_at_joints(model, contact, faces, ends, points)
  end subroutine cut_sides

  !> Integration points of an edge, cut where the opposite edge changes. (Nodes of the other line that lie
  !! behind the projection cut nothing.)
  pure type(side_points) function cut_side(model, contact, faces, s) result(points)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    type(faces_type), intent(in) :: faces
    integer, intent(in) :: s
    real(wp), allocatable :: cut(:), starts(:), ends(:)
    integer, allocatable :: faced(:, :)
    logical, allocatable :: first(:)   ! the opposite edge differs from that of the piece before
    integer :: i

    cut = cuts_of_side(contact, faces, s)
    associate (wide => cut(2:) - cut(:size(cut) - 1) > beyond)   ! smaller pieces beyond an end are skipped
      starts = pack(cut(:size(wide)), wide)
      ends = pack(cut(2:), wide)
    end associate
    points = points_of(model, contact, s, starts, ends)
    faced = reshape(points%facing%segment, [gauss_points, size(starts)])
    first = [.true., (any(faced(:, i - 1:i) /= faced(1, i)), i=2, size(starts))]
    if (.not. all(first)) points = points_of(model, contact, s, pack(starts, first), &
                                             pack(ends, [first(2:), .true.]))
  end function cut_side

  !> Integration points of the pieces of an edge. It may be covered if all of them project onto the other
  !! line, nearly parallel.
  pure type(side_points) function points_of(model, contact, s, starts, ends) result(points)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: s
    real(wp), intent(in) :: starts(:), ends(:)   !! of each piece, from 0 to 1
    type(looking_point) :: from
    type(facing_type) :: face(2)
    real(wp) :: tangent(2)
    integer :: i, k, p

    associate (width => ends - starts)
      points%along = [((starts(i) + width(i)*gauss_place(k), k=1, gauss_points), i=1, size(width))]
      points%weight = [((gauss_weight(k)*width(i), k=1, gauss_points), i=1, size(width))]
    end associate
    allocate (points%share(3, size(points%along)), points%facing(size(points%along)))
    from%rise = rise_of(contact%slave, s)
    do p = 1, size(points%along)
      call contact%slave%at(s, points%along(p), points%share(:, p), from%x, tangent)
      points%weight(p) = points%weight(p)*norm2(tangent)
      if (model%has_rings()) &
        points%weight(p) = points%weight(p)*dot_product(points%share(:, p), contact%slave%x(1, :, s))
      from%outward = unit(right_of(tangent))
      from%along = 0.5_wp*tangent
      face = find_facing(contact%master, model%contact%boundary, from, contact%search)
      points%facing(p) = face(1)
      points%covered = points%covered .and. face(1)%found .and. &
                       dot_product(face(1)%normal, from%outward) < -parallel
    end do
  end function points_of

  !> Positions along an edge, from 0 to 1, of the projected ends of the other line's edges, within a distance
  !! of twice that of its own projections, or its length.
  pure function cuts_of_side(contact, faces, s) result(cut)
    type(line_contact), intent(in) :: contact
    type(faces_type), intent(in) :: faces
    integer, intent(in) :: s
    real(wp), allocatable :: cut(:)
    type(facing_type) :: place
    real(wp) :: middle(2), reach, within
    integer, allocatable :: near(:)
    integer :: i, k

    reach = contact%search
    associate (row => faces%row_of(:, s), slave => contact%slave, master => contact%master)
      if (all(row > 0 .or. slave%segment(:, s) == 0)) &
        reach = min(reach, 2.0_wp*max(slave%chord_length(s), maxval(abs(faces%row(row(:2))%gap))))
      middle = 0.5_wp*(slave%x(:, 1, s) + slave%x(:, 2, s))
      within = reach + slave%chord_length(s)
      near = master%in_box(middle - within, middle + within)
      cut = [0.0_wp, 1.0_wp]
      do i = 1, size(near)
        do k = 1, 2
          if (k == 2 .and. i < size(near)) then
            if (near(i + 1) == master%neighbour(2, near(i))) cycle   ! it is also the start of the next edge
          end if
          place = slave%face(s, master%x(:, k, near(i)))
          if (.not. place%found .or. abs(place%gap) > reach*(1.0_wp + beyond)) cycle
          if (place%s >= 0.0_wp .and. place%s <= 1.0_wp) &
            cut = [pack(cut, cut < place%s), place%s, pack(cut, cut >= place%s)]
        end do
      end do
    end associate
  end function cuts_of_side

  !> Do the points of an edge project onto the same face as its nodes, without a step or a corner?
  pure logical function is_even(model, contact, faces, side, s)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    type(faces_type), intent(in) :: faces
    type(side_points), intent(in) :: side
    integer, intent(in) :: s
    real(wp) :: before, most
    integer :: k, p

    associate (row => faces%row_of(:, s), facing => side%facing)
      is_even = all(row > 0 .or. contact%slave%segment(:, s) == 0)
      if (.not. is_even) return
      do k = 1, 3
        if (row(k) > 0) is_even = is_even .and. all(facing%cosine(faces%row(row(k))) > one_curve)
      end do
      most = step*contact%slave%chord_length(s)
      before = faces%row(row(1))%gap
      do p = 1, size(facing), gauss_points   ! for each piece
        is_even = is_even .and. abs(dot_product(at_end, facing(p + 2:p:-1)%gap) - before) <= most
        before = dot_product(at_end, facing(p:p + 2)%gap)
        if (p == 1) cycle
        is_even = is_even .and. facing(p - 1)%cosine(facing(p)) > smooth
        ! At a joint, only straight edges are cut.
        if (contact%slave%segment(3, s) > 0) is_even = is_even .and. goes_on(model, contact, facing(p - 1), &
                                                                             facing(p))
      end do
      is_even = is_even .and. abs(faces%row(row(2))%gap - before) <= most
    end associate
  end function is_even

  !> Are two points on one edge of the other line, or on edges that are connected? If not, there is a joint
  !! between them, unless its ends must move together.
  pure logical function goes_on(model, contact, one, other)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    type(facing_type), intent(in) :: one, other
    integer :: c, node(2)

    goes_on = one%segment == other%segment
    if (goes_on .or. min(one%segment, other%segment) == 0) return   ! 0: it faces no edge
    goes_on = any(contact%master%neighbour(:, one%segment) == other%segment)
    if (goes_on) return
    node = [end_at(contact, one), end_at(contact, other)]
    goes_on = .true.
    do c = 1, 2
      associate (one => model%constraints%leader(c, node(1)), other => model%constraints%leader(c, node(2)))
        goes_on = goes_on .and. (one == other .or. all(model%constraints%held(c, [one, other])) .and. &
                                 model%loads%prescribed(c, one) == model%loads%prescribed(c, other))
      end associate
    end do
  end function goes_on

  !> End of the other line's edge that is nearer to a point.
  pure integer function end_at(contact, place) result(node)
    type(line_contact), intent(in) :: contact
    type(facing_type), intent(in) :: place

    node = contact%master%segment(maxloc(place%share(:2), dim=1), place%segment)
  end function end_at

  !> Cut edges at joints, and give each part the rows of its ends.
  subroutine cut_at_joints(model, contact, faces, ends, points)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    type(faces_type), intent(in) :: faces
    integer, allocatable, intent(out) :: ends(:)
    type(side_points), allocatable, intent(inout) :: points(:)
    integer :: s, first, i, p
    type(side_points), allocatable :: whole(:)

    call move_alloc(points, whole)
    allocate (points(size(whole) + sum([(joints_within(whole(s)), s=1, size(whole))])), ends(0))
    i = 0
    do s = 1, size(whole)
      first = 1
      do p = gauss_points, size(whole(s)%along) - 1, gauss_points
        if (.not. has_joint(whole(s), p)) cycle
        i = i + 1
        points(i) = stretch(whole(s), first, p)
        first = p + 1
      end do
      i = i + 1
      points(i) = stretch(whole(s), first, size(whole(s)%along))
    end do

  contains

    pure integer function joints_within(side)
      type(side_points), intent(in) :: side
      integer :: p

      joints_within = count([(has_joint(side, p), p=gauss_points, size(side%along) - 1, gauss_points)])
    end function joints_within

    !> Is there a joint after a point, the last of a piece?
    pure logical function has_joint(side, p)
      type(side_points), intent(in) :: side
      integer, intent(in) :: p

      has_joint = side%covered
      if (has_joint) has_joint = .not. goes_on(model, contact, side%facing(p), side%facing(p + 1))
    end function has_joint

    !> Part of edge s from its point `first` to its point `last`.
    type(side_points) function stretch(side, first, last) result(part)
      type(side_points), intent(in) :: side
      integer, intent(in) :: first, last
      real(wp) :: begins, ends_at, place(last - first + 1)

      part = side
      part%row = faces%row_of(:, s)
      if (.not. side%covered) return
      if (first > 1 .or. last < size(side%along)) then
        part%along = side%along(first:last)
        part%weight = side%weight(first:last)
        part%facing = side%facing(first:last)
        begins = dot_product(at_end, part%along(3:1:-1))
        ends_at = dot_product(at_end, part%along(size(part%along) - 2:))
        place = (part%along - begins)/(ends_at - begins)
        part%share = reshape([1.0_wp - place, place, 0.0_wp*place], [3, size(place)], order=[2, 1])
      end if
      call give_row(part%row(1), part%facing(1), first > 1)
      call give_row(part%row(2), part%facing(size(part%facing)), last < size(side%along))
    end function stretch

    !> Set the row of the end of a part: that of its node, if on the same side of the joint; else a new one.
    subroutine give_row(row, facing, cut)
      integer, intent(inout) :: row
      type(facing_type), intent(in) :: facing   !! projection of the nearest point
      logical, intent(in) :: cut                !! there is a joint

      if (.not. cut) then
        if (goes_on(model, contact, faces%row(row)%facing_type, facing)) return
      end if
      ends = [ends, end_at(contact, facing)]
      row = size(faces%row) + size(ends)
    end subroutine give_row
  end subroutine cut_at_joints
end module epcont_contact_geometry_mortar_sides
