!> Data for the search for penetration: displaced and undeformed outlines, the way their edges meet, and the
!> allowed depth there.
module epcont_certificate_meeting
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: same_place
  use epcont_certificate_allowance, only: allowance_type, meeting_type, new_allowance
  use epcont_certificate_findings, only: is_worse, overlap_place, rated
  use epcont_contact_geometry_mates, only: find_mates, is_mate
  use epcont_element_kinematics, only: directions
  use epcont_geometry_outline_shape, only: near_place, new_outline_shape, outline_shape
  use epcont_geometry_plane, only: extent_of
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: point_type, search_type, new_search, point_on, part_along, meet, keep

  real(wp), parameter :: &
    !> Deeper penetration than this part of the largest displacement, or a wider gap at a contact force, gives
    !! a warning, even if it is allowed.
    told = 0.1_wp, &
    !> Near a corner, the gap may be measured to another edge than the nearest. The largest allowance of edges
    !! within this many depths is used.
    about = 1.5_wp, &
    !> If an edge rotates [rad] or stretches by more than this, the path of its body is not straight and is
    !! not checked.
    shapeless = 1.0_wp, &
    !> Smallest allowance, beside `same_place`, in roundings of the coordinates.
    roundings = 16.0_wp

  !> A point of a body.
  type :: point_type
    integer :: side = 0                !! edge of the outlines
    real(wp) :: s = 0.5_wp             !! along it, from 0 to 1
    logical :: in_element = .false.    !! it is the centre of this edge's element
    real(wp) :: drawn(directions) = 0.0_wp      !! undeformed position [length]
    real(wp) :: motion(directions) = 0.0_wp     !! its displacement [length]
    real(wp) :: x(directions) = 0.0_wp          !! displaced position [length]
  end type point_type

  !> Data of the search.
  type :: search_type
    type(outline_shape) :: drawn, now      !! undeformed and displaced outlines
    type(outline_shape) :: motion          !! displacements of the outlines
    type(allowance_type) :: allowance
    type(point_type), allocatable :: middle(:)    !! a point inside each part [parts]
    !> Diameter of a circle with the length of the part's outline; it does not depend on the orientation
    !! [length] [parts]
    real(wp), allocatable :: width(:)
    real(wp), allocatable :: line_length(:)       !! undeformed edges of contact lines, 0 for others [length]
                                                  !! [sides]
    logical, allocatable :: straight(:)    !! the path of displacement is checked [parts]
    integer, allocatable :: mate(:)        !! part with which pairs join each node [nodes]
    real(wp) :: least = 0.0_wp             !! allowance between any two edges [length]
    real(wp) :: moved = 0.0_wp             !! largest displacement [length]
  end type search_type

contains

  !> Prepare the search in a model with outlines.
  pure function new_search(model, displacement) result(search)
    type(model_type), intent(in) :: model        !! model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [directions, nodes]
    type(search_type) :: search
    integer :: k

    associate (outline => model%mesh%body_outline, x => model%mesh%x, own => model%mesh%around%members())
      search%drawn = new_outline_shape(outline, x)
      search%now = new_outline_shape(outline, x + displacement)
      search%motion = new_outline_shape(outline, displacement)
      search%allowance = new_allowance(model, search%drawn, search%now)
      search%mate = find_mates(model)
      search%moved = maxval(norm2(displacement(:, own), dim=1))
      search%least = same_place*maxval(extent_of(x(:, own))) &
                     + roundings*epsilon(1.0_wp)*(maxval(abs(x(:, own))) + maxval(abs(displacement(:, own))))
      allocate (search%line_length(outline%sides), source=0.0_wp)
      do k = 1, size(model%contact%line)
        search%line_length(model%contact%line(k)%side) = search%allowance%length(model%contact%line(k)%side)
      end do
      search%width = [(sum(search%allowance%length(outline%first(k):outline%first(k + 1) - 1)) &
                       /acos(-1.0_wp), k=1, outline%parts)]
      search%straight = [(all(search%allowance%change(outline%first(k):outline%first(k + 1) - 1) <= &
                              shapeless), k=1, outline%parts)]
      search%middle = [(middle_of(outline%first(k)), k=1, outline%parts)]
    end associate

  contains

    !> Find the centre of the element of an edge.
    pure type(point_type) function middle_of(side) result(point)
      integer, intent(in) :: side
      integer, allocatable :: corner(:)

      point = point_type(side=side, in_element=.true.)
      associate (element => model%mesh%body_outline%element(side))
        corner = model%mesh%connectivity(:model%mesh%corners(element), element)
      end associate
      point%drawn = sum(model%mesh%x(:, corner), dim=2)/size(corner)
      point%motion = sum(displacement(:, corner), dim=2)/size(corner)
      point%x = point%drawn + point%motion
    end function middle_of
  end function new_search

  !> Find a point of the outlines.
  pure type(point_type) function point_on(search, side, s) result(point)
    type(search_type), intent(in) :: search   !! the outlines
    integer, intent(in) :: side               !! number of the edge
    real(wp), intent(in) :: s                 !! along the edge, from 0 to 1

    point = point_type(side, s, .false., search%drawn%at(side, s), search%motion%at(side, s), &
                       search%now%at(side, s))
  end function point_on

  !> Find the component of a displacement along an edge, without sign [length].
  pure real(wp) function part_along(shape, side, s, motion) result(part)
    type(outline_shape), intent(in) :: shape   !! undeformed or displaced outlines
    integer, intent(in) :: side                !! number of the edge
    real(wp), intent(in) :: s                  !! along the edge, from 0 to 1
    real(wp), intent(in) :: motion(directions)          !! [length]
    real(wp) :: along(directions)

    along = shape%tangent(side, s)
    part = abs(dot_product(along, motion))/max(norm2(along), tiny(1.0_wp))
  end function part_along

  !> Describe how a point meets a nearby point of an outline, with the allowance of both edges; at a node, of
  !! both edges that share it.
  pure type(overlap_place) function meet(search, point, place) result(found)
    type(search_type), intent(in) :: search   !! the outlines
    type(point_type), intent(in) :: point     !! displaced
    type(near_place), intent(in) :: place     !! nearest point of the outline
    integer, allocatable :: own(:), other(:)   ! edges
    real(wp) :: longest(2), moved(directions)

    found = overlap_place(depth=place%distance, distance=place%distance, x=point%x, drawn=point%drawn, &
                          side=point%side, other=place%side)
    moved = search%motion%at(point%side, point%s) - search%motion%at(place%side, place%s)
    own = sides_at(point%side, point%s)
    other = sides_at(place%side, place%s)
    longest = [maxval(search%line_length(own)), maxval(search%line_length(other))]
    found%meeting = meeting_type(max(slide_along(own, point%s), slide_along(other, place%s)), &
        merge(maxval(longest), 0.0_wp, all(longest > 0.0_wp)), &
        is_joined(point%side, place%side))
    found%allowed = search%least + most_allowed(own) + most_allowed(other)

  contains

    !> Find an edge, and at a node the other edge that shares it.
    pure function sides_at(side, s) result(sides)
      integer, intent(in) :: side
      real(wp), intent(in) :: s
      integer, allocatable :: sides(:)

      sides = [side]
      if (s <= 0.0_wp) sides = [side, search%now%outline%before(side)]
      if (s >= 1.0_wp) sides = [side, search%now%outline%after(side)]
    end function sides_at

    !> Find the relative displacement along an undeformed edge, from which gaps are measured, without sign. At
    !! a node it is the lesser of those along its two edges, since rounding chooses between them.
    pure real(wp) function slide_along(sides, s) result(slide)
      integer, intent(in) :: sides(:)
      real(wp), intent(in) :: s         !! on the first edge

      slide = part_along(search%drawn, sides(1), s, moved)
      if (size(sides) > 1) slide = min(slide, part_along(search%drawn, sides(2), 1.0_wp - s, moved))
    end function slide_along

    !> Find the largest allowance of these edges.
    pure real(wp) function most_allowed(sides) result(allowed)
      integer, intent(in) :: sides(:)
      integer :: k

      allowed = maxval([(search%allowance%of(sides(k), found%meeting), k=1, size(sides))])
    end function most_allowed

    !> Does a pair join the two bodies at one of two edges, or at their neighbours? The smooth curve continues
    !! one edge beyond the last pair. A body is joined to itself.
    pure logical function is_joined(side, other)
      integer, intent(in) :: side, other

      associate (outline => search%now%outline)
        is_joined = outline%part(side) == outline%part(other) .or. is_paired(search, side, other) .or. &
                    is_paired(search, outline%before(side), outline%before(other)) .or. &
                    is_paired(search, outline%after(side), outline%after(other))
      end associate
    end function is_joined
  end function meet

  !> Does a pair join the two bodies at one of two edges?
  pure logical function is_paired(search, side, other)
    type(search_type), intent(in) :: search
    integer, intent(in) :: side, other

    associate (outline => search%now%outline)
      is_paired = is_mate(search%mate, outline%node(:, side), outline%part(other)) .or. &
                  is_mate(search%mate, outline%node(:, other), outline%part(side))
    end associate
  end function is_paired

  !> Keep a point if it is the worst by its allowance, or by the limit for a warning. If it exceeds the
  !! allowance of its two edges, the allowance of edges around it is used. An initial overlap that no pair
  !! closes is subtracted.
  pure subroutine keep(search, found, worst, not_told)
    type(search_type), intent(in) :: search                          !! the outlines
    type(overlap_place), intent(in) :: found                         !! from `meet`; its depth may have
                                                                     !! changed
    type(overlap_place), intent(inout) :: worst, not_told   !! those kept so far
    type(overlap_place) :: place, telling

    place = found
    telling = found
    associate (allowance => search%allowance, a => found%side, b => found%other, meeting => found%meeting)
      telling%moving = allowance%of_motion(a, meeting) + allowance%of_motion(b, meeting) &
                       > 0.5_wp*found%allowed
      telling%allowed = search%least + told*search%moved &
                        + allowance%of_drawing(a, meeting) + allowance%of_drawing(b, meeting)
      if (.not. (is_worse(found, worst) .or. is_worse(telling, not_told))) return
      if (found%depth > found%allowed) place%allowed = search%least + allowance_about(a) + allowance_about(b)
      if (found%distance > min(place%allowed, telling%allowed)) then
        place%depth = found%depth - overlap_as_drawn()
        telling%depth = place%depth
      end if
    end associate
    if (is_worse(place, worst)) worst = rated(place)
    if (is_worse(telling, not_told)) not_told = rated(telling)

  contains

    !> Find the largest allowance of the edge at the point and of edges of its part that are about as near to
    !! this point as the other outline [length].
    pure real(wp) function allowance_about(side) result(allowed)
      integer, intent(in) :: side
      type(near_place) :: near
      integer, allocatable :: others(:)
      integer :: k
      real(wp) :: within

      allowed = search%allowance%of(side, found%meeting)
      within = about*found%distance
      others = search%now%sides_meeting(search%now%outline%part(side), &
                                        found%x - within, found%x + within)
      do k = 1, size(others)
        near = search%now%near_side(others(k), found%x)
        if (near%distance <= within) allowed = max(allowed, search%allowance%of(others(k), found%meeting))
      end do
    end function allowance_about

    !> Find the initial overlap at the point, if no pair closes it; else 0 [length].
    pure real(wp) function overlap_as_drawn() result(overlap)
      type(near_place) :: before

      overlap = 0.0_wp
      if (is_paired(search, found%side, found%other)) return
      before = search%drawn%nearest_place(search%drawn%outline%part(found%other), found%drawn)
      if (before%inside) overlap = before%distance
    end function overlap_as_drawn
  end subroutine keep
end module epcont_certificate_meeting
