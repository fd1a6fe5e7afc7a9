!> What pressed pairs press on, once displaced: the gap between the outlines along the normal, how far beside
!> the other body the node stands, and how far the two sides have slid along each other.
module epcont_certificate_pressed
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_effect
  use epcont_certificate_findings, only: is_worse, overlap_place, scene_type, take_if
  use epcont_certificate_meeting, only: keep, meet, motion_at, part_along, point_on, point_type, search_type
  use epcont_geometry_outline_shape, only: near_place
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: look_at_pairs

  !> Sides that slide by less than this part of the longer one carry what they carried where they were drawn;
  !! so do bodies that slide by less than that part of the smaller one. A node may stand as far beside the
  !! other body as that.
  real(wp), parameter :: part_of_side = 0.25_wp, part_of_body = 0.05_wp

contains

  !> All pressed pairs of two bodies.
  subroutine look_at_pairs(model, search, force, scene)
    type(model_type), intent(in) :: model      !! the scene
    type(search_type), intent(in) :: search    !! its outlines
    real(wp), intent(in) :: force(:)           !! contact forces [pairs]
    type(scene_type), intent(inout) :: scene   !! what is found is added
    real(wp) :: least
    integer :: k, side, side_of(model%nodes)

    least = no_effect*maxval(force)
    associate (node => model%body_outline%node, part_of => model%body_outline%part_of)
      side_of = 0
      do side = 1, size(node, 2)
        if (node(3, side) > 0) side_of(node(3, side)) = side
        side_of(node(1, side)) = side
      end do
      do k = 1, model%pairs
        associate (part => part_of(model%pair_node(1, k)), b => model%pair_node(2, k))
          if (force(k) <= least .or. side_of(b) == 0 .or. part == 0 .or. part == part_of(b)) cycle
          side = side_of(b)
          call look_at_pair(k, point_on(search, side, merge(0.0_wp, 0.5_wp, node(1, side) == b)), part)
        end associate
      end do
    end associate

  contains

    !> One pressed pair: its node B, at the part that A is of.
    subroutine look_at_pair(pair, point, part)
      integer, intent(in) :: pair, part
      type(point_type), intent(in) :: point
      type(near_place) :: place
      type(overlap_place) :: found, slid
      real(wp) :: off

      place = search%now%nearest_place(part, point%x)
      found = meet(search, point, place)
      found%pair = pair
      slid = found
      slid%depth = part_along(search%now, place%side, place%s, &
                              point%motion - motion_at(search, place%side, place%s))
      slid%allowed = max(part_of_side*maxval(search%allowance%length([found%side, found%other])), &
                         part_of_body*minval(search%width([part, search%now%outline%part(found%side)])))
      call take_if(is_worse(slid, scene%slid), slid, scene%slid)
      if (place%inside) return
      found%depth = abs(dot_product(point%x - place%x, model%normal(:, pair)))
      off = abs(cross_product(point%x - place%x, model%normal(:, pair)))
      if (off <= found%depth) then
        call keep(search, found, scene%apart, scene%widest, scene%wide)
      else   ! the other body ends before it
        found%depth = off
        found%allowed = found%allowed + slid%allowed
        call take_if(is_worse(found, scene%beside), found, scene%beside)
      end if
    end subroutine look_at_pair
  end subroutine look_at_pairs
end module epcont_certificate_pressed
