!> How sides of displaced outlines meet, and what they allow there.
module epcont_certificate_meeting
  use epcont_base_kinds, only: wp
  use epcont_certificate_allowance, only: allowance_type, meeting_type
  use epcont_model_mates, only: is_mate
  use epcont_model_model, only: model_type
  use epcont_model_outline_shape, only: near_place, outline_shape
  implicit none
  private
  public :: search_type, allowance_about, is_joined, is_paired, meeting_of, own_allowance

  !> What is worked with.
  type :: search_type
    type(outline_shape) :: now, drawn      !! displaced; as drawn, made where it is asked for
    type(allowance_type) :: allowance
    real(wp) :: told = 0.0_wp              !! depths beyond this and the curves that were drawn are told [length]
    real(wp), allocatable :: displacement(:, :)   !! [length] [2, nodes]
    logical, allocatable :: in_line(:)     !! sides of lines [sides]
    integer, allocatable :: mate(:)        !! part with which pairs join each node [nodes]
    integer, allocatable :: near(:), nearer(:)    !! room for what trees find
    real(wp), allocatable :: crossing(:)   !! room for where a side crosses others
    integer :: last = 1                    !! the side that was nearest to the point before: the next is not far from it
  end type search_type

contains

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

  !> How a point of a side meets the place that it is near to: it has slid along it.
  pure type(meeting_type) function meeting_of(model, search, side, s, place, joined) result(meeting)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side
    real(wp), intent(in) :: s
    type(near_place), intent(in) :: place
    logical, intent(in) :: joined
    real(wp) :: along(2), long(2)

    meeting%joined = joined
    long = [longest_at(model, search, side, s), longest_at(model, search, place%side, place%s)]
    if (all(long > 0.0_wp)) meeting%longest = maxval(long)
    along = search%now%tangent(place%side, place%s)
    meeting%slide = dot_product(along, motion(side, s) - motion(place%side, place%s))/max(norm2(along), tiny(1.0_wp))

  contains

    !> Displacement of a place of a side.
    pure function motion(side, s) result(u)
      integer, intent(in) :: side
      real(wp), intent(in) :: s
      real(wp) :: u(2)

      associate (node => model%body_outline%node(:, side), v => search%displacement)
        u = (1.0_wp - s)*v(:, node(1)) + s*v(:, node(2))
        if (node(3) > 0) u = u + 4.0_wp*s*(1.0_wp - s)*(v(:, node(3)) - 0.5_wp*(v(:, node(1)) + v(:, node(2))))
      end associate
    end function motion
  end function meeting_of

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
end module epcont_certificate_meeting
