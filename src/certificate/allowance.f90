!> By how much displaced outlines may overlap, or stand apart where they press on each other, though every
!> equation holds: what straight sides, displacements linear between nodes and linear kinematics leave open.
!>
!> A side of length h allows 3 (s + b + k), and as much again as CGAPs there say otherwise than coordinates:
!>     s = h theta/8        above its chord lies the smooth curve, to which gaps of pairs are measured; theta
!>                          the turn at its ends. Where no pair joins the two bodies, there is one at hollow
!>                          sides alone: their chords lie before the curve, those of others behind it
!>     b = H |d theta|/8    d theta by how much displacements turn the outline along H; that is h, or where
!>                          both sides are of lines in contact the longer one: over such a length their gap
!>                          is zero in the mean
!>     k = d w + d**2 c/2   sliding by d along a side, as drawn, that turns by w, and where s counts has the
!>                          curvature c: up to h/10, however far it slides
!>         + h e**2/2       e the larger of its turn and its stretch, at most 1: beyond it no shape is
!>                          left to speak of
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
    !> Where no line says more, sides that turn by more than this meet at a corner.
    corner_angle = 35.0_wp*acos(-1.0_wp)/180.0_wp, &
    !> Of a side's length: more than this a slide does not explain, however far it goes.
    most_by_slide = 0.1_wp

  !> How two sides meet.
  type :: meeting_type
    real(wp) :: slide = 0.0_wp      !! of a point of one along the other, 0 or more [length]
    real(wp) :: longest = 0.0_wp    !! length of the longer one, where both are of lines in contact [length]
    logical :: joined = .false.     !! pairs join the two bodies there
  end type meeting_type

  !> Of all sides of the outlines.
  type :: allowance_type
    real(wp), allocatable :: length(:)     !! h, as drawn [length]
    real(wp), allocatable :: sag(:)        !! s [length]
    real(wp), allocatable :: gap(:)        !! that CGAPs there give, less that of the coordinates [length]
    logical, allocatable :: hollow(:)      !! the outline is concave at an end of the side, and smooth
    logical, allocatable :: smooth(:)      !! it does not end at a corner
    real(wp), allocatable :: bend(:)       !! turn that displacements add where it ends, 0 at corners [rad]
    real(wp), allocatable :: arch(:)       !! the same along a curved side, from end to end [rad]
    real(wp), allocatable :: turn(:)       !! w, of the displaced side from that drawn, 0 or more [rad]
    real(wp), allocatable :: change(:)     !! e, its turn or the size of its stretch, the larger
    real(wp), allocatable :: curvature(:)  !! c [1/length]
    integer, allocatable :: beside(:, :)   !! the sides before and after [2, sides]
  contains
    procedure :: of
    procedure :: of_drawing
    procedure :: of_motion
  end type allowance_type

contains

  !> What a side allows where it meets another [length].
  pure real(wp) function of(self, side, meeting)
    class(allowance_type), intent(in) :: self
    integer, intent(in) :: side                 !! of the outlines
    type(meeting_type), intent(in) :: meeting   !! how it meets that

    of = factor*(curve(self, side, meeting)*self%sag(side) &
                 + bend_over(self, side, max(self%length(side), meeting%longest))) &
         + self%of_motion(side, meeting) + self%gap(side)
  end function of

  !> What of that no shorter sides would heal: slides and turns [length].
  pure real(wp) function of_motion(self, side, meeting)
    class(allowance_type), intent(in) :: self
    integer, intent(in) :: side                 !! of the outlines
    type(meeting_type), intent(in) :: meeting   !! how it meets another
    real(wp) :: explained   ! by the slide

    explained = meeting%slide*self%turn(side) &
                + curve(self, side, meeting)*(0.5_wp*meeting%slide**2*self%curvature(side))
    of_motion = factor*(min(explained, most_by_slide*self%length(side)) &
                        + 0.5_wp*self%length(side)*min(1.0_wp, self%change(side))**2)
  end function of_motion

  !> What of that was there before anything moved, and no more than there was: curves above chords, gaps of
  !! CGAPs [length].
  pure real(wp) function of_drawing(self, side, meeting)
    class(allowance_type), intent(in) :: self
    integer, intent(in) :: side                 !! of the outlines
    type(meeting_type), intent(in) :: meeting   !! how it meets another

    of_drawing = curve(self, side, meeting)*self%sag(side) + self%gap(side)
  end function of_drawing

  !> Does the smooth curve above a side's chord count (1 or 0)? It does where it lies on that side, or pairs
  !! take it.
  pure real(wp) function curve(self, side, meeting)
    type(allowance_type), intent(in) :: self
    integer, intent(in) :: side
    type(meeting_type), intent(in) :: meeting

    curve = merge(1.0_wp, 0.0_wp, meeting%joined .or. self%hollow(side))
  end function curve

  !> How far the outline bends over so long a part of it, from a side on, either way [length].
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
        node = merge(self%beside(1, i), i, way == 1)   ! the side that ends there
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

  !> For all sides of the outlines.
  pure function new_allowance(model, drawn, now) result(allowance)
    type(model_type), intent(in) :: model           !! model
    type(outline_shape), intent(in) :: drawn, now   !! the outlines as drawn, and displaced
    type(allowance_type) :: allowance
    real(wp), dimension(drawn%outline%sides) :: length, sag, bend, arch, turn, change, curvature
    real(wp) :: joint(drawn%outline%sides)   ! turn as drawn where a side ends, 0 at corners [rad]
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
    if (allocated(model%boundary%element)) sag = length*turns_of_lines()/8.0_wp
    curvature = curvature + 8.0_wp*sag/length**2
    allowance = allowance_type(length, sag, gaps_of_cards(), &
                               min(joint, joint(drawn%outline%before)) < 0.0_wp, smooth, bend, arch, turn, &
                               change, curvature)
    allowance%beside = transpose(reshape([drawn%outline%before, drawn%outline%after], [size(length), 2]))

  contains

    !> Where lines are in contact: over its chord each side has the curve with the normals of contact at its
    !! ends. The angle between normal and side is half the turn [rad] [sides].
    pure function turns_of_lines() result(turn)
      real(wp) :: turn(size(length))
      integer :: k, s

      turn = 0.0_wp
      do s = 1, size(turn)
        do k = 1, 2
          turn(s) = max(turn(s), 2.0_wp*abs(angle(right_of(drawn%tangent(s, real(k - 1, wp))), &
              model%boundary%normal(:, k, s))))
        end do
      end do
    end function turns_of_lines

    !> By how much the gaps of CGAPs between two bodies differ from those of the coordinates [length] [sides].
    pure function gaps_of_cards() result(gap)
      real(wp) :: gap(size(length)), at_node(model%nodes), gap_drawn
      integer :: k, node(3), s

      at_node = 0.0_wp
      do k = 1, model%single_pairs()
        associate (pair => model%pair_node(:, k))
          if (any(model%body_outline%part_of(pair) == 0)) cycle
          gap_drawn = dot_product(model%normal(:, k), model%x(:, pair(2)) - model%x(:, pair(1)))
          at_node(pair) = max(at_node(pair), abs(model%initial_gap(k) - gap_drawn))
        end associate
      end do
      do s = 1, size(gap)
        node = model%body_outline%node(:, s)
        gap(s) = maxval(at_node(pack(node, node > 0)))
      end do
    end function gaps_of_cards
  end function new_allowance
end module epcont_certificate_allowance
