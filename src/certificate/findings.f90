!> Results of the search for penetration of bodies, and their comparison.
module epcont_certificate_findings
  use epcont_base_kinds, only: wp
  use epcont_certificate_allowance, only: meeting_type
  use epcont_element_kinematics, only: directions
  implicit none
  private
  public :: overlap_place, beyond_place, overlaps_type, is_worse, rated

  !> Of places that differ by less than this part the first counts: rounding decides nothing.
  real(wp), parameter :: more = 1.0_wp + 1.0e-9_wp

  !> Point of a body inside another body, or inside its own.
  type :: overlap_place
    real(wp) :: ratio = 0.0_wp     !! depth / allowed depth
    real(wp) :: depth = 0.0_wp     !! [length]
    real(wp) :: allowed = 0.0_wp   !! [length]
    real(wp) :: distance = 0.0_wp  !! from the point to the other outline: usually the depth [length]
    real(wp) :: x(directions) = 0.0_wp      !! the point inside, displaced [length]
    real(wp) :: drawn(directions) = 0.0_wp  !! the same point, undeformed [length]
    integer :: side = 0            !! edge of the point; 0 if there is no such point
    integer :: other = 0           !! nearest edge of the other body
    type(meeting_type) :: meeting  !! how these two edges meet
    logical :: moving = .false.    !! tangential displacements and rotations are most of the allowance
    integer :: pair = 0            !! its pair in contact
    integer :: node = 0            !! node at the point; 0 if there is no node
  end type overlap_place

  !> Node displaced beyond a line at which its body ends: the axis of axisymmetric bodies, or a line of
  !! symmetry.
  type :: beyond_place
    real(wp) :: depth = 0.0_wp     !! [length]
    real(wp) :: line = 0.0_wp      !! coordinate of the line [length]
    integer :: component = 1       !! 1: the line has constant x, 2: constant y
    integer :: node = 0            !! 0 if there is no such node
  end type beyond_place

  type :: overlaps_type
    logical :: looked_through = .false.
    type(overlap_place) :: inside          !! deepest in another body, by depth / allowed depth
    type(overlap_place) :: itself          !! deepest in its own body
    type(overlap_place) :: apart           !! widest gap at a contact force, by depth / allowed depth
    type(overlap_place) :: beside          !! depth: distance of a node in contact from the end of the other
                                           !! body
    type(overlap_place) :: slid            !! depth: relative tangential displacement in contact
    type(overlap_place) :: passed          !! deepest in another body along the path of displacement
    type(overlap_place) :: deep            !! deepest in another body, by the limit for a warning
    type(overlap_place) :: wide            !! widest gap at a contact force, by the limit for a warning
    type(beyond_place) :: axis, mirror     !! farthest beyond the axis, and beyond a line of symmetry
    real(wp) :: moved = 0.0_wp             !! largest displacement [length]
    real(wp) :: change = 0.0_wp            !! largest rotation [rad] or stretch of an edge
    integer :: changed_side = 0            !! its edge
  contains
    procedure :: sound
  end type overlaps_type

contains

  !> Is the model free of penetration, and of contact forces across a gap?
  pure logical function sound(self)
    class(overlaps_type), intent(in) :: self

    sound = max(self%inside%ratio, self%apart%ratio, self%beside%ratio, self%passed%ratio) <= 1.0_wp &
            .and. self%axis%node == 0
  end function sound

  !> Is a point worse, by depth / allowed depth?
  pure logical function is_worse(found, than)
    type(overlap_place), intent(in) :: found, than   !! the latter with its ratio

    is_worse = found%depth > more*found%allowed*than%ratio
  end function is_worse

  !> Complete a point by its ratio.
  elemental type(overlap_place) function rated(found)
    type(overlap_place), intent(in) :: found     !! its ratio is ignored

    rated = found
    rated%ratio = found%depth/found%allowed
  end function rated
end module epcont_certificate_findings
