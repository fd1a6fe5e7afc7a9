!> What looking through a scene finds: places where bodies lie in each other, and which of two is the worse.
module epcont_certificate_findings
  use epcont_base_kinds, only: wp
  use epcont_certificate_allowance, only: meeting_type
  use epcont_element_kinematics, only: directions
  implicit none
  private
  public :: overlap_place, beyond_place, overlaps_type, is_deeper, is_worse, rated

  !> Of places that differ by less than this part the first counts: rounding decides nothing.
  real(wp), parameter :: more = 1.0_wp + 1.0e-9_wp

  !> Where a body lies in another, or in itself.
  type :: overlap_place
    real(wp) :: ratio = 0.0_wp     !! depth, of what is allowed
    real(wp) :: depth = 0.0_wp     !! [length]
    real(wp) :: allowed = 0.0_wp   !! [length]
    real(wp) :: distance = 0.0_wp  !! of the point from the other outline: mostly the depth [length]
    real(wp) :: x(directions) = 0.0_wp      !! of the point that lies inside, displaced [length]
    real(wp) :: drawn(directions) = 0.0_wp  !! where that point was drawn [length]
    integer :: side = 0            !! of the outlines, on which the point is; 0: there is no such place
    integer :: other = 0           !! the side of the other body that it is nearest to
    type(meeting_type) :: meeting  !! of these two
    logical :: moving = .false.    !! it is for slides and turns that most of the depth is allowed
    integer :: pair = 0            !! that presses there
    integer :: node = 0            !! that the point is; 0: none
  end type overlap_place

  !> A node that is displaced beyond a line to which its body ends: the axis of rings, or a line of symmetry.
  type :: beyond_place
    real(wp) :: depth = 0.0_wp     !! [length]
    real(wp) :: line = 0.0_wp      !! where the line is [length]
    integer :: component = 1       !! 1: the line has one x, 2: it has one y
    integer :: node = 0            !! 0: there is none
  end type beyond_place

  type :: overlaps_type
    logical :: looked_through = .false.
    type(overlap_place) :: inside          !! deepest in another body, by what is allowed
    type(overlap_place) :: deepest         !! deepest in another body
    type(overlap_place) :: itself          !! deepest in its own body
    type(overlap_place) :: apart           !! the depth is that of a gap across which a pair presses
    type(overlap_place) :: widest          !! the widest of such gaps
    type(overlap_place) :: beside          !! the depth is how far off the end of the other body a node stands
    type(overlap_place) :: slid            !! the depth is how far sides slid along each other, pressed
    type(overlap_place) :: passed          !! deepest in another body on the way through it
    type(overlap_place) :: deep            !! deepest in another body, by what is told
    type(overlap_place) :: wide            !! the same of a gap across which a pair presses
    type(beyond_place) :: axis, mirror     !! farthest beyond the axis of rings, beyond a line of symmetry
    real(wp) :: moved = 0.0_wp             !! largest displacement [length]
    real(wp) :: change = 0.0_wp            !! largest turn [rad] or stretch of a side
    integer :: changed_side = 0            !! which one
  contains
    procedure :: sound
  end type overlaps_type

contains

  !> Does no body lie in another or pass through one, and no force press where nothing is?
  pure logical function sound(self)
    class(overlaps_type), intent(in) :: self

    sound = max(self%inside%ratio, self%apart%ratio, self%beside%ratio, self%passed%ratio) <= 1.0_wp &
            .and. self%axis%node == 0
  end function sound

  !> Is a place worse, by what is allowed there?
  pure logical function is_worse(found, than)
    type(overlap_place), intent(in) :: found, than   !! the latter with its ratio

    is_worse = found%depth > more*found%allowed*than%ratio
  end function is_worse

  !> Is a place deeper?
  pure logical function is_deeper(found, than)
    type(overlap_place), intent(in) :: found, than   !! the two places

    is_deeper = found%depth > more*than%depth
  end function is_deeper

  !> A place with its ratio, to be kept.
  elemental type(overlap_place) function rated(found)
    type(overlap_place), intent(in) :: found     !! its ratio is not looked at

    rated = found
    rated%ratio = found%depth/found%allowed
  end function rated
end module epcont_certificate_findings
