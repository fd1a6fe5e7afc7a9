!> Allowed overlap of displaced outlines, or gap between them at a contact force, if every equation holds. Its
!> sources are straight edges, displacements linear between nodes, and linear kinematics.
!>
!> The allowance of an edge of length h is 3 (s + b + k), plus the difference of CGAP gaps and coordinates:
!>     s = h theta/8        distance of the smooth curve from its chord; theta is the turn at the ends. Gaps
!>                          of pairs are measured to this curve. Without pairs only concave edges have this
!>                          term: their chords lie outside the body
!>     b = H |d theta|/8    d theta is the rotation of the outline by displacements along H. H is h, or the
!>                          longer edge if both are on contact lines: the mean gap along it is zero
!>     k = d w + d**2 c/2   relative tangential displacement d along the undeformed edge, which rotates by w
!>                          and, if s counts, has the curvature c: at most h/10
!>         + h e**2/2       e is the larger of rotation and stretch, at most 1
module epcont_certificate_allowance
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: coincident
  use epcont_geometry_outline_shape, only: outline_shape
  use epcont_geometry_plane, only: angle => angle_between, right_of
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: allowance_type, meeting_type, new_allowance

  real(wp), parameter :: &
    factor = 3.0_wp, &
    !> Edges that turn by more than this form a corner, unless contact lines continue there.
    corner_angle = 35.0_wp*acos(-1.0_wp)/180.0_wp, &
    !> Largest part of an edge's length that a relative tangential displacement explains.
    most_by_slide = 0.1_wp

  !> How two edges meet.
  type :: meeting_type
    real(wp) :: slide = 0.0_wp      !! relative tangential displacement, at least 0 [length]
    real(wp) :: longest = 0.0_wp    !! length of the longer edge, if both are on contact lines [length]
    logical :: joined = .false.     !! pairs join the two bodies there
  end type meeting_type

  !> Terms of the allowance of all edges of the outlines.
  type :: allowance_type
    real(wp), allocatable :: length(:)     !! h, undeformed [length]
    real(wp), allocatable :: sag(:)        !! s [length]
    real(wp), allocatable :: gap(:)        !! gap from CGAPs minus gap from coordinates [length]
    logical, allocatable :: hollow(:)      !! the outline is smooth and concave at an end of the edge
    logical, allocatable :: smooth(:)      !! its end is not a corner
    real(wp), allocatable :: bend(:)       !! rotation that displacements add at its end, 0 at corners [rad]
    real(wp), allocatable :: arch(:)       !! the same along a curved edge, from end to end [rad]
    real(wp), allocatable :: turn(:)       !! w, rotation of the edge by displacements, at least 0 [rad]
    real(wp), allocatable :: change(:)     !! e, the larger of its rotation and the size of its stretch
    real(wp), allocatable :: curvature(:)  !! c [1/length]
    integer, allocatable :: beside(:, :)   !! edges before and after [2, sides]
  contains
    procedure :: of
    procedure :: of_drawing
    procedure :: of_motion
  end type allowance_type

contains

  !> Find the allowance of an edge that meets another [length].
  pure real(wp) function of(self, side, meeting)
    class(allowance_type), intent(in) :: self
    integer, intent(in) :: side                 !! number of the edge
    type(meeting_type), intent(in) :: meeting   !! how the two edges meet

    of = factor*(curve(self, side, meeting)*self%sag(side) &
                 + bend_over(self, side, max(self%length(side), meeting%longest))) &
         + self%of_motion(side, meeting) + self%gap(side)
  end function of

  !> Find the part of the allowance that finer meshes do not reduce: tangential displacements and rotations
  !! [length].
  pure real(wp) function of_motion(self, side, meeting)
    class(allowance_type), intent(in) :: self
    integer, intent(in) :: side                 !! number of the edge
    type(meeting_type), intent(in) :: meeting   !! how the two edges meet
    real(wp) :: explained   ! by the tangential displacement

    explained = meeting%slide*self%turn(side) &
                + curve(self, side, meeting)*(0.5_wp*meeting%slide**2*self%curvature(side))
    of_motion = factor*(min(explained, most_by_slide*self%length(side)) &
                        + 0.5_wp*self%length(side)*min(1.0_wp, self%change(side))**2)
  end function of_motion

  !> Find the allowance for the undeformed state: curves above chords, gaps of CGAPs [length].
  pure real(wp) function of_drawing(self, side, meeting)
    class(allowance_type), intent(in) :: self
    integer, intent(in) :: side                 !! number of the edge
    type(meeting_type), intent(in) :: meeting   !! how the two edges meet

    of_drawing = curve(self, side, meeting)*self%sag(side) + self%gap(side)
  end function of_drawing

  !> Does the smooth curve above an edge's chord count (1 or 0)? It does if the outline is concave there, or
  !! if pairs use it.
  pure real(wp) function curve(self, side, meeting)
    type(allowance_type), intent(in) :: self
    integer, intent(in) :: side
    type(meeting_type), intent(in) :: meeting

    curve = merge(1.0_wp, 0.0_wp, meeting%joined .or. self%hollow(side))
  end function curve

  !> Find the bend of the outline over this length, from an edge on, in either direction [length].
  pure real(wp) function bend_over(self, side, length) result(bend)
    type(allowance_type), intent(in) :: self
    integer, intent(in) :: side
    real(wp), intent(in) :: length
    real(wp) :: covered, theta, turn
    integer :: i, node, way

    theta = 0.0_wp
    do way = 1, 2
      i = side
      turn = 0.0_wp
      covered = 0.0_wp
      do
        node = merge(self%beside(1, i), i, way == 1)   ! the edge that ends at this node
        if (.not. self%smooth(node)) exit
        turn = turn + self%bend(node)
        theta = max(theta, abs(turn))
        covered = covered + self%length(i)
        i = self%beside(way, i)
        if (covered + self%length(i) > length*(1.0_wp + coincident)) exit
        turn = turn + self%arch(i)
        theta = max(theta, abs(turn))
      end do
    end do
    bend = length*theta/8.0_wp
  end function bend_over

  !> Find the allowances of all edges.
  pure function new_allowance(model, drawn, now) result(allowance)
    type(model_type), intent(in) :: model           !! model
    type(outline_shape), intent(in) :: drawn, now   !! undeformed and displaced outlines
    type(allowance_type) :: allowance
    real(wp), dimension(drawn%outline%sides) :: length, sag, bend, arch, turn, change, curvature
    real(wp) :: joint(drawn%outline%sides)   ! undeformed turn at the end of an edge, 0 at corners [rad]
    logical :: smooth(drawn%outline%sides)
    real(wp) :: own_arch
    integer :: s

    do s = 1, size(length)
      length(s) = norm2(drawn%chord(s))
      turn(s) = abs(angle(drawn%chord(s), now%chord(s)))
      change(s) = max(turn(s), abs(norm2(now%chord(s))/length(s) - 1.0_wp))
      own_arch = angle(drawn%tangent(s, 0.0_wp), drawn%tangent(s, 1.0_wp))
      curvature(s) = abs(own_arch)/length(s)
      arch(s) = angle(now%tangent(s, 0.0_wp), now%tangent(s, 1.0_wp)) - own_arch
      joint(s) = angle(drawn%tangent(s, 1.0_wp), drawn%tangent(drawn%outline%after(s), 0.0_wp))
      bend(s) = angle(now%tangent(s, 1.0_wp), now%tangent(drawn%outline%after(s), 0.0_wp)) - joint(s)
    end do
    smooth = abs(joint) <= corner_angle
    joint = merge(joint, 0.0_wp, smooth)
    bend = merge(bend, 0.0_wp, smooth)
    sag = length*max(abs(joint), abs(joint(drawn%outline%before)))/8.0_wp
    if (allocated(model%contact%boundary%element)) sag = length*turns_of_lines()/8.0_wp
    curvature = curvature + 8.0_wp*sag/length**2
    allowance = allowance_type(length, sag, gaps_of_cards(), &
                               min(joint, joint(drawn%outline%before)) < 0.0_wp, smooth, bend, arch, turn, &
                               change, curvature)
    allowance%beside = transpose(reshape([drawn%outline%before, drawn%outline%after], [size(length), 2]))

  contains

    !> Find the turn at edges of contact lines: the contact normals at the ends of an edge define its curve.
    !! The angle between this normal and the normal of the edge is half the turn [rad] [sides].
    pure function turns_of_lines() result(turn)
      real(wp) :: turn(size(length))
      integer :: k, s

      turn = 0.0_wp
      do s = 1, size(turn)
        do k = 1, 2
          turn(s) = max(turn(s), 2.0_wp*abs(angle(right_of(drawn%tangent(s, real(k - 1, wp))), &
              model%contact%boundary%normal(:, k, s))))
        end do
      end do
    end function turns_of_lines

    !> Find the differences between CGAP gaps and gaps from coordinates, between two bodies [length] [sides].
    pure function gaps_of_cards() result(gap)
      real(wp) :: gap(size(length)), at_node(model%mesh%nodes), gap_drawn
      integer :: k, node(3), s

      at_node = 0.0_wp
      do k = 1, model%contact%single_pairs()
        associate (pair => model%contact%pair_node(:, k))
          if (any(model%mesh%body_outline%part_of(pair) == 0)) cycle
          gap_drawn = dot_product(model%contact%normal(:, k), &
                                  model%mesh%x(:, pair(2)) - model%mesh%x(:, pair(1)))
          at_node(pair) = max(at_node(pair), abs(model%contact%initial_gap(k) - gap_drawn))
        end associate
      end do
      do s = 1, size(gap)
        node = model%mesh%body_outline%node(:, s)
        gap(s) = maxval(at_node(pack(node, node > 0)))
      end do
    end function gaps_of_cards
  end function new_allowance
end module epcont_certificate_allowance
