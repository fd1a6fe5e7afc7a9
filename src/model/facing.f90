!> What a point near a boundary line faces of it.
module epcont_model_facing
  use epcont_base_kinds, only: wp
  use epcont_model_boundary_line, only: boundary_line, facing_place
  use epcont_model_side_boxes, only: side_boxes
  implicit none
  private
  public :: facing_type, find_nearest

  !> Gaps that differ by less than this part of the search are equal: at a corner the better normal decides.
  real(wp), parameter :: equal = 1.0e-9_wp
  !> A gap below so many roundings of the coordinates is none.
  real(wp), parameter :: roundings = 16.0_wp*epsilon(1.0_wp)
  !> Most points have the line before their eyes: it is looked for within search/widening**rounds first.
  real(wp), parameter :: widening = 8.0_wp
  integer, parameter :: rounds = 3

  type :: facing_type
    type(facing_place) :: place
    integer :: segment = 0        !! the side
    logical :: same_way = .false. !! there is none, but one near by that looks the same way
  end type facing_type

contains

  !> The side of a line that a point faces nearest by, not farther than `search`; `outward` is the normal of the boundary
  !! to which the point belongs. Sides that end at node `except` do not count.
  pure function find_nearest(line, boxes, x, outward, search, except) result(best)
    type(boundary_line), intent(in) :: line
    type(side_boxes), intent(in) :: boxes   !! of the line
    real(wp), intent(in) :: x(2), outward(2), search
    integer, intent(in) :: except
    type(facing_type) :: best
    real(wp) :: within
    integer :: round

    do round = rounds, 0, -1
      within = search/widening**round
      best = nearest_of(line, boxes%near(x, within), x, outward, search, except)
      ! Sides that were left out are farther than `within`.
      if (best%place%found .and. abs(best%place%gap) < within - 2.0_wp*equal*search) exit
    end do
    if (abs(best%place%gap) <= roundings*maxval(abs(x))) best%place%gap = 0.0_wp
    best%same_way = best%same_way .and. .not. best%place%found
  end function find_nearest

  !> The same among a few sides of the line.
  pure function nearest_of(line, sides, x, outward, search, except) result(best)
    type(boundary_line), intent(in) :: line
    integer, intent(in) :: sides(:)
    real(wp), intent(in) :: x(2), outward(2), search
    integer, intent(in) :: except
    type(facing_type) :: best
    type(facing_place) :: place
    real(wp) :: better
    integer :: i, k

    do k = 1, size(sides)
      i = sides(k)
      if (any(line%segment(:, i) == except) .and. except > 0) cycle
      place = line%face(i, x)
      if (.not. place%found .or. abs(place%gap) > search) cycle
      if (dot_product(place%normal, outward) >= 0.0_wp) then
        best%same_way = .true.
        cycle
      end if
      if (best%place%found) then
        better = abs(best%place%gap) - abs(place%gap)
        if (better < -equal*search) cycle
        if (better <= equal*search) then
          better = dot_product(best%place%normal, outward) - dot_product(place%normal, outward)
          if (abs(better) <= equal) call take_mean(place, best%place)
          if (better <= equal) cycle
        end if
      end if
      best%place = place
      best%segment = i
    end do
  end function nearest_of

  !> Of two sides that are faced equally well at their corner none is the better one: between their normals.
  pure subroutine take_mean(other, place)
    type(facing_place), intent(in) :: other
    type(facing_place), intent(inout) :: place
    real(wp) :: both(2)

    if (maxval(other%share) < 1.0_wp .or. maxval(place%share) < 1.0_wp) return
    both = place%normal + other%normal
    place%normal = both/norm2(both)
    place%gap = (place%gap + other%gap)/norm2(both)
  end subroutine take_mean
end module epcont_model_facing
