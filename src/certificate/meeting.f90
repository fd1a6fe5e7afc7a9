!> What a scene is looked through with: the outlines displaced and as drawn, how their sides meet, and what
!> these allow there.
module epcont_certificate_meeting
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: same_place
  use epcont_certificate_allowance, only: allowance_type, meeting_type, new_allowance
  use epcont_certificate_findings, only: is_deeper, is_worse, overlap_place, rated
  use epcont_contact_geometry_mates, only: find_mates, is_mate
  use epcont_element_kinematics, only: directions
  use epcont_geometry_box_tree, only: box_query
  use epcont_geometry_outline_shape, only: near_place, new_outline_shape, outline_shape
  use epcont_geometry_plane, only: extent_of, span_along
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: point_type, search_type, new_search, point_on, sides_meeting, motion_at, &
            part_along, meet, keep, insert

  real(wp), parameter :: &
    !> Bodies deeper in each other, or farther apart where they press, than this part of the largest
    !! displacement: that is told, though it be allowed.
    told = 0.1_wp, &
    !> Near a corner the nearest side need not be the one to which a gap is measured: of those so many depths
    !! off the largest allowance counts.
    about = 1.5_wp, &
    !> The least that is allowed, beside `same_place`, in roundings of the coordinates.
    roundings = 16.0_wp

  !> A point of a body.
  type :: point_type
    integer :: side = 0                !! of the outlines
    real(wp) :: s = 0.5_wp             !! along it, from 0 to 1
    logical :: in_element = .false.    !! it is the middle of that side's element
    real(wp) :: drawn(directions) = 0.0_wp      !! where it was drawn [length]
    real(wp) :: motion(directions) = 0.0_wp     !! its displacement [length]
    real(wp) :: x(directions) = 0.0_wp          !! where it is then [length]
  end type point_type

  !> What is worked with.
  type :: search_type
    type(outline_shape) :: drawn, now      !! the outlines as drawn, and displaced
    !> Displacements of begin, end, middle of each side [length] [directions, 3, sides]
    real(wp), allocatable :: motion(:, :, :)
    type(allowance_type) :: allowance
    type(point_type), allocatable :: middle(:)    !! a point within each part [parts]
    !> Of a circle whose outline is as long as the part's: however it lies, it is the same [length] [parts]
    real(wp), allocatable :: width(:)
    real(wp), allocatable :: line_length(:)       !! of sides of lines as drawn, 0 of others [length] [sides]
    integer, allocatable :: mate(:)        !! part with which pairs join each node [nodes]
    real(wp) :: least = 0.0_wp             !! what is allowed between any two sides [length]
    real(wp) :: moved = 0.0_wp             !! largest displacement [length]
  end type search_type

contains

  !> For a scene that has outlines.
  pure function new_search(model, displacement) result(search)
    type(model_type), intent(in) :: model        !! model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [directions, nodes]
    type(search_type) :: search
    integer :: k, side

    associate (outline => model%body_outline, x => model%x, own => model%around%members())
      search%drawn = new_outline_shape(outline, x)
      search%now = new_outline_shape(outline, x + displacement)
      ! A middle that is not there has that of the first node, for which nobody asks.
      search%motion = reshape(displacement(:, [max(outline%node, 1)]), [directions, 3, outline%sides])
      do k = 1, outline%parts
        associate (first => outline%first(k), last => outline%first(k + 1) - 1)
          call search%now%side_tree(k)%set_spans(reshape( &
              [(span_along(search%motion(:, :, side), outline%node(3, side) > 0), side=first, last)], &
              [directions, 2, last - first + 1]))
        end associate
      end do
      search%allowance = new_allowance(model, search%drawn, search%now)
      search%mate = find_mates(model)
      search%moved = maxval(norm2(displacement(:, own), dim=1))
      search%least = same_place*maxval(extent_of(x(:, own))) &
                     + roundings*epsilon(1.0_wp)*(maxval(abs(x(:, own))) + maxval(abs(displacement(:, own))))
      allocate (search%line_length(outline%sides), source=0.0_wp)
      do k = 1, size(model%line)
        search%line_length(model%line(k)%side) = search%allowance%length(model%line(k)%side)
      end do
      search%width = [(sum(search%allowance%length(outline%first(k):outline%first(k + 1) - 1)) &
                       /acos(-1.0_wp), k=1, outline%parts)]
      search%middle = [(middle_of(outline%first(k)), k=1, outline%parts)]
    end associate

  contains

    !> The middle of the element that a side is of.
    pure type(point_type) function middle_of(side) result(point)
      integer, intent(in) :: side
      integer, allocatable :: corner(:)

      point = point_type(side=side, in_element=.true.)
      associate (element => model%body_outline%element(side))
        corner = model%connectivity(:model%corners(element), element)
      end associate
      point%drawn = sum(model%x(:, corner), dim=2)/size(corner)
      point%motion = sum(displacement(:, corner), dim=2)/size(corner)
      point%x = point%drawn + point%motion
    end function middle_of
  end function new_search

  !> A point of the outlines.
  pure type(point_type) function point_on(search, side, s) result(point)
    type(search_type), intent(in) :: search   !! the outlines
    integer, intent(in) :: side               !! of the outlines
    real(wp), intent(in) :: s                 !! along the side, from 0 to 1

    point = point_type(side, s, .false., search%drawn%at(side, s), motion_at(search, side, s), &
                       search%now%at(side, s))
  end function point_on

  !> The sides of a part whose boxes are looked for.
  pure function sides_meeting(shape, part, query) result(side)
    type(outline_shape), intent(in) :: shape   !! the outlines, drawn or displaced
    integer, intent(in) :: part                !! of the outlines
    class(box_query), intent(in) :: query      !! which boxes
    integer, allocatable :: side(:)

    side = shape%side_tree(part)%meeting(query)
    side = side + (shape%outline%first(part) - 1)
  end function sides_meeting

  !> Displacement of a place of a side [length].
  pure function motion_at(search, side, s) result(motion)
    type(search_type), intent(in) :: search   !! the outlines
    integer, intent(in) :: side               !! of the outlines
    real(wp), intent(in) :: s                 !! from 0 to 1
    real(wp) :: motion(directions)

    associate (own => search%motion(:, :, side))
      motion = (1.0_wp - s)*own(:, 1) + s*own(:, 2)
      if (search%now%outline%node(3, side) > 0) &
        motion = motion + 4.0_wp*s*(1.0_wp - s)*(own(:, 3) - 0.5_wp*(own(:, 1) + own(:, 2)))
    end associate
  end function motion_at

  !> How much of a motion goes along a side, either way [length].
  pure real(wp) function part_along(shape, side, s, motion) result(part)
    type(outline_shape), intent(in) :: shape   !! the outlines, drawn or displaced
    integer, intent(in) :: side                !! of the outlines
    real(wp), intent(in) :: s                  !! where on it, from 0 to 1
    real(wp), intent(in) :: motion(directions)          !! [length]
    real(wp) :: along(directions)

    along = shape%tangent(side, s)
    part = abs(dot_product(along, motion))/max(norm2(along), tiny(1.0_wp))
  end function part_along

  !> A point at the place of another outline, or of its own, that it is near to, and what is allowed there: by
  !! the two sides, and at a node by the one with which the side shares that, too.
  pure type(overlap_place) function meet(search, point, place) result(found)
    type(search_type), intent(in) :: search   !! the outlines
    type(point_type), intent(in) :: point     !! displaced
    type(near_place), intent(in) :: place     !! the nearest one of the other outline
    integer, allocatable :: own(:), other(:)   ! sides
    real(wp) :: longest(2), moved(directions)

    found = overlap_place(depth=place%distance, distance=place%distance, x=point%x, drawn=point%drawn, &
                          side=point%side, other=place%side)
    moved = motion_at(search, point%side, point%s) - motion_at(search, place%side, place%s)
    own = sides_at(point%side, point%s)
    other = sides_at(place%side, place%s)
    longest = [maxval(search%line_length(own)), maxval(search%line_length(other))]
    found%meeting = meeting_type(max(slide_along(own, point%s), slide_along(other, place%s)), &
        merge(maxval(longest), 0.0_wp, all(longest > 0.0_wp)), &
        is_joined(point%side, place%side))
    found%allowed = search%least + most_allowed(own) + most_allowed(other)

  contains

    !> A side, and at a node the one with which it shares that.
    pure function sides_at(side, s) result(sides)
      integer, intent(in) :: side
      real(wp), intent(in) :: s
      integer, allocatable :: sides(:)

      sides = [side]
      if (s <= 0.0_wp) sides = [side, search%now%outline%before(side)]
      if (s >= 1.0_wp) sides = [side, search%now%outline%after(side)]
    end function sides_at

    !> Along a side as drawn, from which gaps are measured, either way. At a node it is the lesser of those
    !! along its two sides: on which of them a point is, rounding decides.
    pure real(wp) function slide_along(sides, s) result(slide)
      integer, intent(in) :: sides(:)
      real(wp), intent(in) :: s         !! on the first

      slide = part_along(search%drawn, sides(1), s, moved)
      if (size(sides) > 1) slide = min(slide, part_along(search%drawn, sides(2), 1.0_wp - s, moved))
    end function slide_along

    !> What the one of these sides that allows more does.
    pure real(wp) function most_allowed(sides) result(allowed)
      integer, intent(in) :: sides(:)
      integer :: k

      allowed = maxval([(search%allowance%of(sides(k), found%meeting), k=1, size(sides))])
    end function most_allowed

    !> Does a pair join the two bodies at one of two sides, or of the sides beside them? Pairs end with lines,
    !! the smooth curve one side later. A body is joined with itself.
    pure logical function is_joined(side, other)
      integer, intent(in) :: side, other

      associate (outline => search%now%outline)
        is_joined = outline%part(side) == outline%part(other) .or. is_paired(search, side, other) .or. &
                    is_paired(search, outline%before(side), outline%before(other)) .or. &
                    is_paired(search, outline%after(side), outline%after(other))
      end associate
    end function is_joined
  end function meet

  !> Does a pair join the two bodies at one of two sides?
  pure logical function is_paired(search, side, other)
    type(search_type), intent(in) :: search
    integer, intent(in) :: side, other

    associate (outline => search%now%outline)
      is_paired = is_mate(search%mate, outline%node(:, side), outline%part(other)) .or. &
                  is_mate(search%mate, outline%node(:, other), outline%part(side))
    end associate
  end function is_paired

  !> Keep a place if it is the worst by what is allowed, the deepest, or the worst by what is not told.
  !! Allowed is what sides about it allow, where more was found than the nearest two do. Where bodies may have
  !! overlapped as drawn, that is taken off, if no pair is to close it.
  pure subroutine keep(search, found, worst, deepest, not_told)
    type(search_type), intent(in) :: search                          !! the outlines
    type(overlap_place), intent(in) :: found                         !! from `meet`; its depth may be another
    type(overlap_place), intent(inout) :: worst, deepest, not_told   !! those kept so far
    type(overlap_place) :: place, telling

    place = found
    telling = found
    associate (allowance => search%allowance, a => found%side, b => found%other, meeting => found%meeting)
      telling%moving = allowance%of_motion(a, meeting) + allowance%of_motion(b, meeting) &
                       > 0.5_wp*found%allowed
      telling%allowed = search%least + told*search%moved &
                        + allowance%of_drawing(a, meeting) + allowance%of_drawing(b, meeting)
      if (.not. (is_worse(found, worst) .or. is_deeper(found, deepest) .or. &
                 is_worse(telling, not_told))) return
      if (found%depth > found%allowed) place%allowed = search%least + allowance_about(a) + allowance_about(b)
      if (found%distance > min(place%allowed, telling%allowed)) then
        place%depth = found%depth - overlap_as_drawn()
        telling%depth = place%depth
      end if
    end associate
    if (is_worse(place, worst)) worst = rated(place)
    if (is_deeper(place, deepest)) deepest = rated(place)
    if (is_worse(telling, not_told)) not_told = rated(telling)

  contains

    !> The most that a side at the place allows, or others of its part that are about as near to that as the
    !! two there to each other [length].
    pure real(wp) function allowance_about(side) result(allowed)
      integer, intent(in) :: side
      type(near_place) :: near
      integer, allocatable :: others(:)
      integer :: k
      real(wp) :: within

      allowed = search%allowance%of(side, found%meeting)
      within = about*found%distance
      others = sides_meeting(search%now, search%now%outline%part(side), &
                             box_query(found%x - within, found%x + within))
      do k = 1, size(others)
        near = search%now%near_side(others(k), found%x)
        if (near%distance <= within) allowed = max(allowed, search%allowance%of(others(k), found%meeting))
      end do
    end function allowance_about

    !> What the bodies overlapped there as drawn, if no pair is to close that; else nothing [length].
    pure real(wp) function overlap_as_drawn() result(overlap)
      type(near_place) :: before

      overlap = 0.0_wp
      if (is_paired(search, found%side, found%other)) return
      before = search%drawn%nearest_place(search%drawn%outline%part(found%other), found%drawn)
      if (before%inside) overlap = before%distance
    end function overlap_as_drawn
  end subroutine keep

  !> Put a number into an ascending list.
  pure subroutine insert(number, list)
    real(wp), intent(in) :: number                    !! what is put in
    real(wp), allocatable, intent(inout) :: list(:)   !! made longer by one

    list = [pack(list, list <= number), number, pack(list, list > number)]
  end subroutine insert
end module epcont_certificate_meeting
