!> By how much displaced outlines may overlap, or stand apart where they press on each other, though every equation holds:
!> what straight sides, displacements linear between nodes and linear kinematics leave open.
!>
!> A side of length h allows 3 (s + b + k), and as much again as CGAPs there say otherwise than the coordinates:
!>     s = h theta/8          above its chord lies the smooth curve, to which gaps of pairs are measured; theta the turn
!>                            at its ends. Where no pair joins the two bodies, there is one at hollow sides alone: their
!>                            chords lie before the curve, those of others behind it
!>     b = H |d theta|/8      d theta by how much displacements turn the outline along H; that is h, or where both sides are of
!>                            lines in contact the longer one: over such a length their gap is zero in the mean
!>     k = d |w| + d**2 c/2   sliding by d along a side, as drawn, that turns by w, and where s counts has the curvature c: up to
!>                            h/10, however far it slides
!>         + h e**2/2         e the larger of its turn and its stretch: where these are not small no shape is left to speak of
module epcont_certificate_allowance
  use epcont_base_kinds, only: wp
  use epcont_geometry_edge, only: edge_tangent
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: allowance_type, meeting_type, new_allowance

  real(wp), parameter :: factor = 3.0_wp
  !> Where no line says more, sides that turn by more than this meet at a corner.
  real(wp), parameter :: corner_angle = 35.0_wp*acos(-1.0_wp)/180.0_wp
  !> Lengths that differ by this part are equal.
  real(wp), parameter :: equal = 1.0e-6_wp
  !> The least that is allowed: as a part of the scene's extent, and in roundings of its coordinates.
  real(wp), parameter :: least_part = 1.0e-8_wp, roundings = 16.0_wp

  !> Of a side's length: more than this a slide does not explain, however far it goes.
  real(wp), parameter :: most_by_slide = 0.1_wp

  !> How two sides meet.
  type :: meeting_type
    real(wp) :: slide = 0.0_wp      !! of a point of one along the other, 0 or more [length]
    real(wp) :: longest = 0.0_wp    !! length of the longer one, where both are of lines in contact [length]
    logical :: joined = .false.     !! pairs join the two bodies there
  end type meeting_type

  type :: allowance_type
    real(wp) :: least = 0.0_wp             !! between any two sides [length]
    real(wp), allocatable :: sag(:)        !! s [length] [sides]
    logical, allocatable :: hollow(:)      !! the outline is concave at an end of the side, and smooth [sides]
    real(wp), allocatable :: bend(:)       !! turn that displacements add where a side ends, 0 at corners [rad] [sides]
    real(wp), allocatable :: arch(:)       !! the same along a side of six-node elements, from end to end [rad] [sides]
    logical, allocatable :: smooth(:)      !! it does not end at a corner [sides]
    integer, allocatable :: beside(:, :)   !! the sides before and after [2, sides]
    real(wp), allocatable :: turn(:)       !! w, of the displaced side from that drawn [rad] [sides]
    real(wp), allocatable :: curvature(:)  !! c [1/length] [sides]
    real(wp), allocatable :: stretch(:)    !! of the side, whatever its sign [sides]
    real(wp), allocatable :: length(:)     !! h [length] [sides]
    !> Of a circle whose outline is as long as the part's: however it lies, it is the same [length] [parts]
    real(wp), allocatable :: width(:)
    real(wp), allocatable :: gap(:)        !! that CGAPs there give, less that of the coordinates [length] [sides]
  contains
    procedure :: of
    procedure :: of_drawing
    procedure :: of_motion
  end type allowance_type

contains

  !> What a side allows where it meets another.
  pure real(wp) function of(self, side, meeting)
    class(allowance_type), intent(in) :: self
    integer, intent(in) :: side
    type(meeting_type), intent(in) :: meeting

    of = factor*(curve_over(self, side, meeting) + bend_over(self, side, max(self%length(side), meeting%longest))) &
         + self%of_motion(side, meeting) + self%gap(side)
  end function of

  !> What of that no shorter sides would heal: slides and turns.
  pure real(wp) function of_motion(self, side, meeting)
    class(allowance_type), intent(in) :: self
    integer, intent(in) :: side
    type(meeting_type), intent(in) :: meeting

    associate (slide => meeting%slide, turn => abs(self%turn(side)))
      of_motion = factor*(min(slide*turn + merge(0.5_wp*slide**2*self%curvature(side), 0.0_wp, is_curve(self, side, meeting)), &
                              most_by_slide*self%length(side)) &
                          + 0.5_wp*self%length(side)*max(turn, self%stretch(side))**2)
    end associate
  end function of_motion

  !> What of that was there before anything moved, and no more than there was: curves above chords, gaps of CGAPs.
  pure real(wp) function of_drawing(self, side, meeting)
    class(allowance_type), intent(in) :: self
    integer, intent(in) :: side
    type(meeting_type), intent(in) :: meeting

    of_drawing = curve_over(self, side, meeting) + self%gap(side)
  end function of_drawing

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
        if (covered + self%length(i) > length*(1.0_wp + equal)) exit
        turn = turn + self%arch(i)
        theta = max(theta, abs(turn))
      end do
    end do
    bend = length*theta/8.0_wp
  end function bend_over

  !> How far the smooth curve is above a side's chord, where it lies on that side or pairs take it.
  pure real(wp) function curve_over(self, side, meeting)
    type(allowance_type), intent(in) :: self
    integer, intent(in) :: side
    type(meeting_type), intent(in) :: meeting

    curve_over = merge(self%sag(side), 0.0_wp, is_curve(self, side, meeting))
  end function curve_over

  !> Is there more of a side than its chord?
  pure logical function is_curve(self, side, meeting)
    type(allowance_type), intent(in) :: self
    integer, intent(in) :: side
    type(meeting_type), intent(in) :: meeting

    is_curve = meeting%joined .or. self%hollow(side)
  end function is_curve

  !> For all sides of the outlines.
  pure function new_allowance(model, displacement) result(allowance)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    type(allowance_type) :: allowance
    real(wp), allocatable :: drawn(:, :, :), moved(:, :), now(:, :, :), theta(:)
    real(wp) :: before
    integer :: i, s, n

    n = model%body_outline%sides
    allocate (allowance%sag(n), allowance%bend(n), allowance%arch(n), allowance%turn(n), allowance%curvature(n), &
              allowance%stretch(n), allowance%length(n), theta(n), source=0.0_wp)
    allocate (drawn(2, 2, n), now(2, 2, n))
    allocate (allowance%hollow(n), allowance%smooth(n), source=.false.)
    allowance%beside = transpose(reshape([model%body_outline%before, model%body_outline%after], [n, 2]))
    moved = model%x + displacement
    associate (chord => allowance%length)
      do s = 1, n
        call side_ends(model%body_outline%node(:, s), model%x, drawn(:, :, s), chord(s))
        call side_ends(model%body_outline%node(:, s), moved, now(:, :, s), allowance%stretch(s))
        allowance%stretch(s) = abs(allowance%stretch(s)/chord(s) - 1.0_wp)
        allowance%turn(s) = angle(sum(drawn(:, :, s), dim=2), sum(now(:, :, s), dim=2))
        before = angle(drawn(:, 1, s), drawn(:, 2, s))
        allowance%curvature(s) = abs(before)/chord(s)
        allowance%arch(s) = angle(now(:, 1, s), now(:, 2, s)) - before
      end do
      do s = 1, n
        associate (next => model%body_outline%after(s))
          before = angle(drawn(:, 2, s), drawn(:, 1, next))
          if (abs(before) > corner_angle) cycle
          allowance%smooth(s) = .true.
          allowance%bend(s) = angle(now(:, 2, s), now(:, 1, next)) - before
          do i = 1, 2
            associate (side => merge(s, next, i == 1))
              theta(side) = max(theta(side), abs(before))
              allowance%hollow(side) = allowance%hollow(side) .or. before < 0.0_wp
            end associate
          end do
        end associate
      end do
      allowance%sag = chord*theta/8.0_wp
      call take_lines(model, drawn, chord, allowance%sag)
      allowance%curvature = allowance%curvature + 8.0_wp*allowance%sag/chord**2
    end associate
    allowance%width = [(sum(allowance%length(model%body_outline%first(s):model%body_outline%first(s + 1) - 1))/acos(-1.0_wp), &
                        s=1, model%body_outline%parts)]
    call take_gaps(model, allowance%gap)
    allowance%least = least_part*maxval(maxval(model%x, dim=2) - minval(model%x, dim=2)) &
                      + roundings*epsilon(1.0_wp)*(maxval(abs(model%x)) + maxval(abs(displacement)))
  end function new_allowance

  !> Directions of a side where it begins and where it ends, and its length from the one to the other.
  pure subroutine side_ends(node, x, along, length)
    integer, intent(in) :: node(3)
    real(wp), intent(in) :: x(:, :)
    real(wp), intent(out) :: along(2, 2), length

    associate (own => x(:, node(:merge(3, 2, node(3) > 0))))
      along(:, 1) = edge_tangent(own, 0.0_wp)
      along(:, 2) = edge_tangent(own, 1.0_wp)
      length = norm2(own(:, 2) - own(:, 1))
    end associate
  end subroutine side_ends

  !> From one direction to another, counter-clockwise [rad].
  pure real(wp) function angle(from, to)
    real(wp), intent(in) :: from(2), to(2)

    angle = atan2(cross_product(from, to), dot_product(from, to))
  end function angle

  !> Where lines are in contact: over its chord each side has the curve with the normals of contact at its ends.
  pure subroutine take_lines(model, along, chord, sag)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: along(:, :, :), chord(:)
    real(wp), intent(inout) :: sag(:)
    real(wp) :: most
    integer :: k, s

    if (.not. allocated(model%boundary%element)) return
    do s = 1, size(sag)
      most = 0.0_wp
      do k = 1, 2
        most = max(most, abs(angle([along(2, k, s), -along(1, k, s)], model%boundary%normal(:, k, s))))
      end do
      ! The angle between normal and side is half the turn.
      sag(s) = chord(s)*most/4.0_wp
    end do
  end subroutine take_lines

  !> By how much the gaps of CGAPs between two bodies differ from those of the coordinates.
  pure subroutine take_gaps(model, gap)
    type(model_type), intent(in) :: model
    real(wp), allocatable, intent(out) :: gap(:)
    real(wp) :: at_node(model%nodes), drawn
    integer :: c, k, last, s

    last = model%pairs
    do c = 1, size(model%line_contact)
      last = last - (model%line_contact(c)%last - model%line_contact(c)%first + 1)
    end do
    at_node = 0.0_wp
    do k = 1, last
      associate (pair => model%pair_node(:, k))
        if (any(model%body_outline%part_of(pair) == 0)) cycle
        drawn = dot_product(model%normal(:, k), model%x(:, pair(2)) - model%x(:, pair(1)))
        at_node(pair) = max(at_node(pair), abs(model%initial_gap(k) - drawn))
      end associate
    end do
    allocate (gap(model%body_outline%sides))
    do s = 1, model%body_outline%sides
      associate (node => model%body_outline%node(:, s))
        gap(s) = maxval(at_node(node(:merge(3, 2, node(3) > 0))))
      end associate
    end do
  end subroutine take_gaps
end module epcont_certificate_allowance
