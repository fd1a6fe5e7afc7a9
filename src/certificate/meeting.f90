!> What a scene is looked through with: the outlines displaced and as drawn, how their sides meet, and what these allow there.
module epcont_certificate_meeting
  use epcont_base_kinds, only: wp
  use epcont_certificate_allowance, only: allowance_type, meeting_type, new_allowance
  use epcont_certificate_findings, only: overlap_place
  use epcont_contact_geometry_mates, only: find_mates, is_mate
  use epcont_geometry_edge, only: edge_tangent
  use epcont_geometry_outline_shape, only: near_place, new_outline_shape, outline_shape
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: search_type, new_search, is_paired, is_joined, meeting_of, middle_of, along_side, place_allowance, widen_allowance, &
            take_told, note_crossing

  !> Bodies deeper in each other, or farther apart where they press, than this part of the largest displacement: that is told,
  !! though it be allowed.
  real(wp), parameter :: told = 0.1_wp
  !> Near a corner the nearest side need not be the one to which a gap is measured: of those so many depths off the largest
  !! allowance counts.
  real(wp), parameter :: about = 1.5_wp

  !> What is worked with.
  type :: search_type
    type(outline_shape) :: now, drawn      !! displaced; as drawn, made where it is asked for
    type(allowance_type) :: allowance
    real(wp) :: moved = 0.0_wp             !! largest displacement [length]
    real(wp) :: told = 0.0_wp              !! depths beyond this and the curves that were drawn are told [length]
    real(wp), allocatable :: displacement(:, :)   !! [length] [2, nodes]
    logical, allocatable :: in_line(:)     !! sides of lines [sides]
    integer, allocatable :: mate(:)        !! part with which pairs join each node [nodes]
    integer, allocatable :: near(:), nearer(:)    !! room for what trees find
    real(wp), allocatable :: crossing(:)   !! room for where a side crosses others
    integer :: last = 1                    !! the side that was nearest to the point before: the next is not far from it
  end type search_type

contains

  !> All but what is made where it is asked for.
  pure function new_search(model, displacement) result(search)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    type(search_type) :: search
    integer :: line

    search%displacement = displacement
    search%now = new_outline_shape(model%body_outline, model%x + displacement)
    search%allowance = new_allowance(model, displacement)
    search%moved = maxval(norm2(displacement, dim=1))
    search%told = search%allowance%least + told*search%moved
    search%mate = find_mates(model)
    allocate (search%in_line(model%body_outline%sides), source=.false.)
    if (allocated(model%line)) then
      do line = 1, size(model%line)
        search%in_line(model%line(line)%side) = .true.
      end do
    end if
    allocate (search%near(16), search%nearer(16), search%crossing(16))
  end function new_search

  !> Does a pair join the two bodies at one of two sides?
  pure logical function is_paired(model, search, side, other)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side, other

    associate (outline => model%body_outline)
      is_paired = is_mate(search%mate, outline%node(:, side), outline%part(other)) .or. &
                  is_mate(search%mate, outline%node(:, other), outline%part(side))
    end associate
  end function is_paired

  !> The same, or at the sides beside them: pairs end with lines, the smooth curve one side later.
  pure logical function is_joined(model, search, side, other)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side, other

    associate (before => model%body_outline%before, after => model%body_outline%after)
      is_joined = is_paired(model, search, side, other) .or. &
                  is_paired(model, search, before(side), before(other)) .or. is_paired(model, search, after(side), after(other))
    end associate
  end function is_joined

  !> How a point of a side meets the place that it is near to: one has slid along the other.
  pure type(meeting_type) function meeting_of(model, search, side, s, place, joined) result(meeting)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side
    real(wp), intent(in) :: s
    type(near_place), intent(in) :: place
    logical, intent(in) :: joined
    real(wp) :: long(2), moved(2)

    meeting%joined = joined
    long = [longest_at(model, search, side, s), longest_at(model, search, place%side, place%s)]
    if (all(long > 0.0_wp)) meeting%longest = maxval(long)
    moved = along_side(model, side, s, search%displacement) - along_side(model, place%side, place%s, search%displacement)
    meeting%slide = max(part_along(model, side, s, moved), part_along(model, place%side, place%s, moved))
  end function meeting_of

  !> How much of a motion goes along a side as drawn, from which gaps are measured, either way. At a node it is the lesser of those
  !! along its two sides: on which of them a point is, rounding decides [length].
  pure real(wp) function part_along(model, side, s, moved) result(slide)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side
    real(wp), intent(in) :: s, moved(2)

    slide = along(side, s)
    if (s <= 0.0_wp) slide = min(slide, along(model%body_outline%before(side), 1.0_wp))
    if (s >= 1.0_wp) slide = min(slide, along(model%body_outline%after(side), 0.0_wp))

  contains

    pure real(wp) function along(side, s)
      integer, intent(in) :: side
      real(wp), intent(in) :: s
      real(wp) :: tangent(2)

      tangent = edge_tangent(model%edge_coordinates(model%body_outline%node(:, side)), s)
      along = abs(dot_product(tangent, moved))/max(norm2(tangent), tiny(1.0_wp))
    end function along
  end function part_along

  !> Length of a side of a line, or of the longer one of two that share a node; 0: of no line [length].
  pure real(wp) function longest_at(model, search, side, s) result(length)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side
    real(wp), intent(in) :: s
    integer :: sides(2)

    sides = side
    if (s <= 0.0_wp) sides(2) = model%body_outline%before(side)
    if (s >= 1.0_wp) sides(2) = model%body_outline%after(side)
    length = maxval(merge(search%allowance%length(sides), 0.0_wp, search%in_line(sides)))
  end function longest_at

  !> What a side allows, and at a node also the one with which it shares that [length].
  pure real(wp) function own_allowance(model, search, side, s, meeting) result(allowed)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side
    real(wp), intent(in) :: s
    type(meeting_type), intent(in) :: meeting

    allowed = search%allowance%of(side, meeting)
    if (s <= 0.0_wp) allowed = max(allowed, search%allowance%of(model%body_outline%before(side), meeting))
    if (s >= 1.0_wp) allowed = max(allowed, search%allowance%of(model%body_outline%after(side), meeting))
  end function own_allowance

  !> What is allowed at a place: where the two sides meet [length].
  pure real(wp) function place_allowance(model, search, side, s, place, meeting) result(allowed)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side
    real(wp), intent(in) :: s
    type(near_place), intent(in) :: place
    type(meeting_type), intent(in) :: meeting

    allowed = search%allowance%least + own_allowance(model, search, side, s, meeting) &
              + own_allowance(model, search, place%side, place%s, meeting)
  end function place_allowance

  !> Allow what sides about a place allow, where more was found than the nearest two do.
  pure subroutine widen_allowance(search, place, distance, meeting)
    type(search_type), intent(in) :: search
    type(overlap_place), intent(inout) :: place
    real(wp), intent(in) :: distance   !! of the two sides there [length]
    type(meeting_type), intent(in) :: meeting

    if (place%depth <= place%allowed) return
    associate (part => search%now%outline%part)
      place%allowed = search%allowance%least &
                      + allowance_about(search, part(place%side), place%x, about*distance, place%side, meeting) &
                      + allowance_about(search, part(place%other), place%x, about*distance, place%other, meeting)
    end associate
  end subroutine widen_allowance

  !> The most that sides of a part within a distance of a point allow, and one of them at least [length].
  pure real(wp) function allowance_about(search, part, x, distance, side, meeting) result(allowed)
    type(search_type), intent(in) :: search
    integer, intent(in) :: part
    real(wp), intent(in) :: x(2), distance
    integer, intent(in) :: side
    type(meeting_type), intent(in) :: meeting
    type(near_place) :: place
    integer, allocatable :: near(:)
    integer :: k, n, other

    allowed = search%allowance%of(side, meeting)
    allocate (near(16))
    call search%now%side_tree(part)%meeting(x - distance, x + distance, near, n)
    do k = 1, n
      other = search%now%outline%first(part) + near(k) - 1
      place = search%now%near_side(other, x)
      if (place%distance <= distance) allowed = max(allowed, search%allowance%of(other, meeting))
    end do
  end function allowance_about

  !> Of a place where more or less is allowed: how much is not told.
  pure subroutine take_told(search, meeting, place)
    type(search_type), intent(in) :: search
    type(meeting_type), intent(in) :: meeting
    type(overlap_place), intent(inout) :: place

    associate (allowance => search%allowance)
      place%moving = 2.0_wp*(allowance%of_motion(place%side, meeting) + allowance%of_motion(place%other, meeting)) > place%allowed
      place%allowed = search%told + allowance%of_drawing(place%side, meeting) + allowance%of_drawing(place%other, meeting)
    end associate
  end subroutine take_told

  !> What a field has at a place of a side.
  pure function along_side(model, side, s, field) result(there)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side
    real(wp), intent(in) :: s             !! from 0 to 1
    real(wp), intent(in) :: field(:, :)   !! coordinates, or displacements [length] [2, nodes]
    real(wp) :: there(2)

    associate (node => model%body_outline%node(:, side), v => field)
      there = (1.0_wp - s)*v(:, node(1)) + s*v(:, node(2))
      if (node(3) > 0) there = there + 4.0_wp*s*(1.0_wp - s)*(v(:, node(3)) - 0.5_wp*(v(:, node(1)) + v(:, node(2))))
    end associate
  end function along_side

  !> Middle of the element that a side is of, or what a field has there.
  pure function middle_of(model, side, field) result(mean)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side
    real(wp), intent(in) :: field(:, :)   !! coordinates, or displacements [length] [2, nodes]
    real(wp) :: mean(2)

    associate (element => model%body_outline%element(side))
      mean = sum(field(:, model%connectivity(:model%corners(element), element)), dim=2)/model%corners(element)
    end associate
  end function middle_of

  !> Add one to the crossings that were found, which ascend.
  pure subroutine note_crossing(search, s, crossings)
    type(search_type), intent(inout) :: search
    real(wp), intent(in) :: s
    integer, intent(inout) :: crossings
    integer :: i

    if (crossings == size(search%crossing)) search%crossing = [search%crossing, search%crossing]
    i = crossings
    do while (i > 0)
      if (search%crossing(i) <= s) exit
      search%crossing(i + 1) = search%crossing(i)
      i = i - 1
    end do
    search%crossing(i + 1) = s
    crossings = crossings + 1
  end subroutine note_crossing
end module epcont_certificate_meeting
