!> What is the same in all elements of one kind. `element_kinds.f90` has a row for each, and a file of its own
!> says what is in it.
!>
!> Corners come first, counter-clockwise; then the middles of the sides, the first behind the first corner.
!> Sides are straight, or parabolas through their middle nodes.
module epcont_element_element_kind
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, rounded_off
  use epcont_element_kinematics, only: directions
  implicit none
  private
  public :: element_kind, new_kind

  !> Nodes, integration points and places of comparison of an element, at most.
  integer, parameter, public :: most_nodes = 8, most_points = 9, most_places = 9
  !> In search of a fold: ten along either coordinate leave open where the area comes nearer to none than
  !! about 4**-10, a millionth, of its largest.
  integer, parameter :: most_halvings = 20

  !> Bernstein coefficients of a cubic from its values at 0, 1/3, 2/3 and 1.
  real(wp), parameter :: from_values(4, 0:3) = &
    reshape([6, -5, 2, 0, 0, 18, -9, 0, 0, -9, 18, 0, 0, 2, -5, 6]/6.0_wp, [4, 4])

  !> What `estimated_as` may be.
  integer, parameter, public :: by_linear_triangles = 1, by_quadrilaterals = 2, by_quadratics = 3

  type :: element_kind
    character(len=6) :: plane_card = '', ring_card = ''   !! their names in a deck; blank: there are none
    integer :: nodes = 0
    integer :: corners = 0                  !! and sides
    integer :: degree = 1                   !! of the polynomials along a side
    !> The change of volume is averaged over the element (B-bar), but in plane stress.
    logical :: mean_dilatation = .false.
    logical :: locks = .false.              !! where the material keeps its volume
    integer :: vtk = 0                      !! VTK's number of the cell
    procedure(shape_functions), pointer, nopass :: shape => null()
    integer :: points = 0                               !! of integration
    real(wp) :: point(directions, most_points) = 0.0_wp !! their local places
    real(wp) :: weight(most_points) = 0.0_wp            !! their parts of the local area
    real(wp) :: values(most_nodes, most_points) = 0.0_wp               !! shape functions at the points
    !> And their derivatives by the local coordinates
    real(wp) :: slopes(directions, most_nodes, most_points) = 0.0_wp
    !> What each two nodes have in the area, see `turn`: Bernstein coefficients [4, 4, nodes, nodes]
    real(wp) :: spanned(4, 4, 2:most_nodes - 1, 3:most_nodes) = 0.0_wp
    ! For the estimate of the error (accuracy/):
    integer :: estimated_as = by_linear_triangles       !! which weights it has
    !> Smooth strains are fitted to samples: strain(points) sample_of, where the shape functions are
    !! sample_values. Of degree 1 it is the mean, in the middle.
    integer :: samples = 1
    real(wp) :: sample_values(most_nodes, most_points) = 0.0_wp
    real(wp) :: sample_of(most_points, most_points) = 0.0_wp
    !> Strains are compared at places. There the smooth one is smooth(nodes) n, the element's own
    !! strain(points) p, and the place has the parts v of the points' volumes.
    integer :: places = 0
    !> Its own strain at a place is that of the only point, or of the one with the same number.
    logical :: sees_points = .true.
    real(wp) :: n(most_nodes, most_places) = 0.0_wp
    real(wp) :: p(most_points, most_places) = 0.0_wp
    real(wp) :: v(most_points, most_places) = 0.0_wp
  contains
    procedure :: turn
    procedure :: compare_at
    procedure :: sample_at
  end type element_kind

  abstract interface
    !> Shape functions at a local place, and their derivatives by the local coordinates; 0 beyond the last
    !! node.
    pure subroutine shape_functions(place, n, slope)
      import
      real(wp), intent(in) :: place(directions)
      real(wp), intent(out) :: n(most_nodes), slope(directions, most_nodes)
    end subroutine shape_functions
  end interface

contains

  !> A kind by its nodes, shape functions and integration points; its strains are sampled and compared at
  !! these.
  pure function new_kind(corner, nodes, shape, point, weight) result(kind)
    real(wp), intent(in) :: corner(:, :)       !! local places [directions, corners]
    integer, intent(in) :: nodes               !! how many
    procedure(shape_functions) :: shape        !! of the nodes
    real(wp), intent(in) :: point(:, :)        !! local places [directions, points]
    real(wp), intent(in) :: weight(:)          !! [points]
    type(element_kind) :: kind
    real(wp) :: unit(size(weight), size(weight))
    integer :: p

    kind%corners = size(corner, 2)
    kind%nodes = nodes
    kind%degree = nodes/kind%corners
    kind%shape => shape
    kind%points = size(weight)
    kind%point(:, :kind%points) = point
    kind%weight(:kind%points) = weight
    unit = 0.0_wp
    do p = 1, kind%points
      call shape(point(:, p), kind%values(:, p), kind%slopes(:, :, p))
      unit(p, p) = 1.0_wp
    end do
    call kind%compare_at(point, unit, unit)
    kind%sees_points = .true.
    if (kind%degree > 1) call kind%sample_at(point, unit)
    call find_spanned(kind, corner(:, min([1, 2, 3, 4], kind%corners)))
  end function new_kind

  !> The determinant of the Jacobian is a sum over each two nodes: what the vectors to them span, times a
  !! polynomial, which is at most cubic in either coordinate of a square. A triangle is a square with a side
  !! in its third corner.
  pure subroutine find_spanned(kind, corner)
    type(element_kind), intent(inout) :: kind
    real(wp), intent(in) :: corner(directions, 4)   !! local places of the square's
    real(wp) :: n(most_nodes), part(4, 4), slope(directions, most_nodes)
    integer :: a, b, i, j

    do j = 0, 3
      do i = 0, 3
        call kind%shape(matmul(corner, [(3 - i)*(3 - j), i*(3 - j), i*j, (3 - i)*j]/9.0_wp), n, slope)
        part = sum(kind%weight)*matmul(from_values(:, i:i), transpose(from_values(:, j:j)))
        do b = 3, kind%nodes
          do a = 2, b - 1
            kind%spanned(:, :, a, b) = kind%spanned(:, :, a, b) + &
                                       part*(slope(1, a)*slope(2, b) - slope(2, a)*slope(1, b))
          end do
        end do
      end do
    end do
  end subroutine find_spanned

  !> How an element turns: 1 counter-clockwise, -1 clockwise; 0: it folds over, or is flat, somewhere. That is
  !! where the determinant of its Jacobian, as the area which it would have if that were so everywhere, is
  !! not above what rounding leaves of the square of its extent, and of its coordinates.
  pure integer function turn(self, x)
    class(element_kind), intent(in) :: self
    real(wp), intent(in) :: x(directions, most_nodes)   !! of its nodes [length]
    real(wp) :: area(4, 4), extent, farthest, to(directions, most_nodes)
    integer :: a, b

    area = 0.0_wp
    extent = 0.0_wp
    farthest = maxval(abs(x(:, 1)))
    do b = 2, self%nodes
      to(:, b) = x(:, b) - x(:, 1)
      extent = max(extent, abs(to(1, b)), abs(to(2, b)))
      farthest = max(farthest, abs(x(1, b)), abs(x(2, b)))
      do a = 2, b - 1
        area = area + self%spanned(:, :, a, b)*(to(1, a)*to(2, b) - to(2, a)*to(1, b))
      end do
    end do
    turn = merge(1, -1, sum(area) > 0.0_wp)
    if (.not. is_above(turn*area, extent*max(rounded_off*extent, cancelled*farthest), most_halvings)) turn = 0
  end function turn

  !> Is a polynomial above a bound on the unit square? Its values lie between its Bernstein coefficients, and
  !! those at the corners are values (Johnen, Remacle and Geuzaine 2013). Where they do not tell, those of
  !! both halves do (de Casteljau), along one coordinate after the other; what is open after all halvings
  !! counts as not above.
  pure recursive logical function is_above(net, bound, halvings) result(above)
    real(wp), intent(in) :: net(4, 4), bound   !! its coefficients; in their unit
    integer, intent(in) :: halvings            !! at most
    real(wp), dimension(4, 4) :: lower, upper
    integer :: k

    above = all(net > bound)
    if (above .or. halvings == 0 .or. any(net(::3, ::3) <= bound)) return
    upper = net
    do k = 1, 4
      lower(k, :) = upper(1, :)
      upper(:4 - k, :) = 0.5_wp*(upper(:4 - k, :) + upper(2:5 - k, :))
    end do
    above = is_above(transpose(lower), bound, halvings - 1)
    if (above) above = is_above(transpose(upper), bound, halvings - 1)
  end function is_above

  !> Compare strains at these places.
  pure subroutine compare_at(self, place, p, v)
    class(element_kind), intent(inout) :: self
    real(wp), intent(in) :: place(:, :)        !! local [directions, places]
    real(wp), intent(in) :: p(:, :), v(:, :)   !! as in the type [points, places]
    real(wp) :: slope(directions, most_nodes)   !! not wanted
    integer :: k

    self%places = size(place, 2)
    self%sees_points = self%points == 1
    do k = 1, self%places
      call self%shape(place(:, k), self%n(:, k), slope)
    end do
    self%p(:self%points, :self%places) = p
    self%v(:self%points, :self%places) = v
  end subroutine compare_at

  !> Sample strains at these places.
  pure subroutine sample_at(self, place, sample_of)
    class(element_kind), intent(inout) :: self
    real(wp), intent(in) :: place(:, :)        !! local [directions, samples]
    real(wp), intent(in) :: sample_of(:, :)    !! as in the type [points, samples]
    real(wp) :: slope(directions, most_nodes)   !! not wanted
    integer :: k

    self%samples = size(place, 2)
    do k = 1, self%samples
      call self%shape(place(:, k), self%sample_values(:, k), slope)
    end do
    self%sample_of(:self%points, :self%samples) = sample_of
  end subroutine sample_at
end module epcont_element_element_kind
