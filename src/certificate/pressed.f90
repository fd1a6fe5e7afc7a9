!> What pressed pairs press on, once displaced: the gap between the outlines along the normal, how far beside the other body the
!> node stands, and how far the two sides have slid along each other.
module epcont_certificate_pressed
  use epcont_base_kinds, only: wp
  use epcont_certificate_allowance, only: meeting_type
  use epcont_certificate_findings, only: is_worse, overlap_place, scene_type, take_deeper, take_worse
  use epcont_certificate_meeting, only: along_side, meeting_of, place_allowance, search_type, take_told, widen_allowance
  use epcont_geometry_outline_shape, only: near_place
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: look_at_pairs

  !> A pair presses if its force is more than this part of the largest.
  real(wp), parameter :: pressing = 1.0e-6_wp
  !> Sides that slide by less than this part of the longer one carry what they carried where they were drawn; so do bodies that
  !! slide by less than that part of the smaller one. A node may stand as far beside the other body as that.
  real(wp), parameter :: part_of_side = 0.25_wp, part_of_body = 0.05_wp

contains

  !> All pressed pairs of two bodies.
  pure subroutine look_at_pairs(model, search, force, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    real(wp), intent(in) :: force(:)             !! contact forces [pairs]
    type(scene_type), intent(inout) :: scene
    real(wp) :: least
    integer :: i, k, side_of(model%nodes)

    if (model%pairs == 0) return
    least = pressing*maxval(force)
    side_of = 0
    do i = 1, model%body_outline%sides
      if (model%body_outline%node(3, i) > 0) side_of(model%body_outline%node(3, i)) = i
      side_of(model%body_outline%node(1, i)) = i
    end do
    do k = 1, model%pairs
      associate (ends => model%pair_node(:, k), part => model%body_outline%part_of)
        if (force(k) <= least .or. side_of(ends(2)) == 0 .or. part(ends(1)) == 0 .or. part(ends(1)) == part(ends(2))) cycle
        call look_at_pair(model, search, k, side_of(ends(2)), scene)
      end associate
    end do
  end subroutine look_at_pairs

  !> One pressed pair.
  pure subroutine look_at_pair(model, search, k, side, scene)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: k, side                !! the pair, and a side that its node B is on
    type(scene_type), intent(inout) :: scene
    type(near_place) :: place
    type(meeting_type) :: meeting
    type(overlap_place) :: found, slid
    real(wp) :: allowed, gap, off, s

    associate (b => model%pair_node(2, k), part => model%body_outline%part_of(model%pair_node(1, k)))
      found%x = model%x(:, b) + search%displacement(:, b)
      place = search%now%nearest_place(part, found%x)
      s = merge(0.5_wp, 0.0_wp, model%body_outline%node(3, side) == b)
    end associate
    meeting = meeting_of(model, search, side, s, place, joined=.true.)
    found%side = side
    found%other = place%side
    slid = found
    slid%depth = slide_along(model, search, side, s, place)
    slid%allowed = small_slide(search, found)
    call take_worse(slid, scene%slid)
    if (place%inside) return

    allowed = place_allowance(model, search, side, s, place, meeting)
    gap = abs(dot_product(found%x - place%x, model%normal(:, k)))
    off = abs(cross_product(found%x - place%x, model%normal(:, k)))
    if (off > gap) then   ! the other body ends before it
      found%depth = off
      found%allowed = allowed + slid%allowed
      if (is_worse(found, scene%beside)) scene%beside_pair = k
      call take_worse(found, scene%beside)
      return
    end if
    found%depth = gap
    found%allowed = allowed
    call look_at_gap(search, place%distance, meeting, k, found, scene)
  end subroutine look_at_pair

  !> A gap across which a pair presses.
  pure subroutine look_at_gap(search, distance, meeting, k, found, scene)
    type(search_type), intent(in) :: search
    real(wp), intent(in) :: distance              !! from the other body [length]
    type(meeting_type), intent(in) :: meeting
    integer, intent(in) :: k
    type(overlap_place), intent(inout) :: found
    type(scene_type), intent(inout) :: scene
    type(overlap_place) :: wide

    wide = found
    call take_told(search, meeting, wide)
    if (wide%depth > wide%allowed) call take_worse(wide, scene%wide)
    if (.not. (is_worse(found, scene%apart) .or. found%depth > scene%widest%depth)) return
    call widen_allowance(search, found, distance, meeting)
    if (is_worse(found, scene%apart)) scene%pair = k
    call take_worse(found, scene%apart)
    call take_deeper(found, scene%widest)
  end subroutine look_at_gap

  !> How far a point of a side has slid along the place that it is near to, either way [length].
  pure real(wp) function slide_along(model, search, side, s, place) result(slide)
    type(model_type), intent(in) :: model
    type(search_type), intent(in) :: search
    integer, intent(in) :: side
    real(wp), intent(in) :: s
    type(near_place), intent(in) :: place
    real(wp) :: along(2)

    along = search%now%tangent(place%side, place%s)
    associate (u => search%displacement)
      slide = abs(dot_product(along, along_side(model, side, s, u) - along_side(model, place%side, place%s, u))) &
              /max(norm2(along), tiny(1.0_wp))
    end associate
  end function slide_along

  !> How far sides may slide along each other and be where they were drawn [length].
  pure real(wp) function small_slide(search, place) result(small)
    type(search_type), intent(in) :: search
    type(overlap_place), intent(in) :: place

    associate (part => search%now%outline%part, length => search%allowance%length, width => search%allowance%width)
      small = max(part_of_side*max(length(place%side), length(place%other)), &
                  part_of_body*min(width(part(place%side)), width(part(place%other))))
    end associate
  end function small_slide
end module epcont_certificate_pressed
