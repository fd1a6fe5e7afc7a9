!> Data that all elements of one type share. `element_kinds.f90` has a row for each type, and each type has a
!> file.
!>
!> Corners come first, counter-clockwise; then the mid-side nodes, starting after the first corner. Edges are
!> straight, or parabolas through their mid-side nodes.
module epcont_element_element_kind
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, rounded_off
  use epcont_element_kinematics, only: directions
  implicit none
  private
  public :: element_kind, new_kind

  !> Largest numbers of nodes, integration points and comparison points of an element.
  integer, parameter, public :: most_nodes = 8, most_points = 9, most_places = 9
  !> Search for folds: after ten bisections of each coordinate, the sign of the area is open only if it is
  !! below about 4**-10, a millionth, of its largest value.
  integer, parameter :: most_halvings = 20

  !> Bernstein coefficients of a cubic from its values at 0, 1/3, 2/3 and 1.
  real(wp), parameter :: from_values(4, 0:3) = &
    reshape([6, -5, 2, 0, 0, 18, -9, 0, 0, -9, 18, 0, 0, 2, -5, 6]/6.0_wp, [4, 4])

  !> Values of `estimated_as`.
  integer, parameter, public :: by_linear_triangles = 1, by_quadrilaterals = 2, by_quadratics = 3

  type :: element_kind
    character(len=6) :: plane_card = '', ring_card = ''   !! names of their cards; blank if it has no card
    integer :: nodes = 0
    integer :: corners = 0                  !! number of corners, and of edges
    integer :: degree = 1                   !! of the polynomials along an edge
    !> The change of volume is averaged over the element (B-bar), except in plane stress.
    logical :: mean_dilatation = .false.
    logical :: locks = .false.              !! it locks in nearly incompressible materials
    integer :: vtk = 0                      !! VTK cell type
    procedure(shape_functions), pointer, nopass :: shape => null()
    integer :: points = 0                               !! number of integration points
    real(wp) :: point(directions, most_points) = 0.0_wp !! their local coordinates
    real(wp) :: weight(most_points) = 0.0_wp            !! their parts of the local area
    real(wp) :: values(most_nodes, most_points) = 0.0_wp               !! shape functions at the points
    !> Their derivatives by the local coordinates
    real(wp) :: slopes(directions, most_nodes, most_points) = 0.0_wp
    !> Contribution of each two nodes to the area, see `turn`: Bernstein coefficients [4, 4, nodes, nodes]
    real(wp) :: spanned(4, 4, 2:most_nodes - 1, 3:most_nodes) = 0.0_wp
    ! For the error estimate (accuracy/):
    integer :: estimated_as = by_linear_triangles       !! column of its weights
    !> Recovered strains are fitted to samples: strain(points) sample_of, at the points where the shape
    !! functions are sample_values. For degree 1 the sample is the mean, at the centre.
    integer :: samples = 1
    real(wp) :: sample_values(most_nodes, most_points) = 0.0_wp
    real(wp) :: sample_of(most_points, most_points) = 0.0_wp
    !> Strains are compared at points. There the recovered strain is smooth(nodes) n, the element's own strain
    !! is strain(points) p, and the volume is a sum of the points' volumes times v.
    integer :: places = 0
    !> Own strain at a comparison point: that of the only integration point, or of the one with the same
    !! number.
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
    !> Shape functions at a local point, and their derivatives by the local coordinates; 0 beyond the last
    !! node.
    pure subroutine shape_functions(place, n, slope)
      import
      real(wp), intent(in) :: place(directions)
      real(wp), intent(out) :: n(most_nodes), slope(directions, most_nodes)
    end subroutine shape_functions
  end interface

contains

  !> Create a type from its nodes, shape functions and integration points, at which strains are sampled and
  !! compared.
  pure function new_kind(corner, nodes, shape, point, weight) result(kind)
    real(wp), intent(in) :: corner(:, :)       !! local coordinates [directions, corners]
    integer, intent(in) :: nodes               !! number of nodes
    procedure(shape_functions) :: shape        !! of the nodes
    real(wp), intent(in) :: point(:, :)        !! local coordinates [directions, points]
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

  !> Expand the determinant of the Jacobian as a sum over each two nodes: the cross product of their vectors,
  !! times a polynomial of degree at most three in each coordinate of a square. A triangle is a square with a
  !! degenerate edge at its third corner.
  pure subroutine find_spanned(kind, corner)
    type(element_kind), intent(inout) :: kind
    real(wp), intent(in) :: corner(directions, 4)   !! local coordinates of the square's corners
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

  !> Find the orientation of an element: 1 counter-clockwise, -1 clockwise, 0 if it folds over or is flat
  !! somewhere. It is 0 if the determinant of its Jacobian, times the local area, is not above rounding of the
  !! square of its extent and of its coordinates.
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

  !> Is a polynomial above a bound on the unit square? Its values are between its Bernstein coefficients, and
  !! those at the corners are values (Johnen, Remacle and Geuzaine 2013). If these do not decide, both halves
  !! are checked (de Casteljau), along one coordinate after the other. If all bisections do not decide, the
  !! answer is no.
  pure recursive logical function is_above(net, bound, halvings) result(above)
    real(wp), intent(in) :: net(4, 4), bound   !! coefficients, and bound in their unit
    integer, intent(in) :: halvings            !! largest number of bisections
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

  !> Set the points at which strains are compared.
  pure subroutine compare_at(self, place, p, v)
    class(element_kind), intent(inout) :: self
    real(wp), intent(in) :: place(:, :)        !! local coordinates [directions, places]
    real(wp), intent(in) :: p(:, :), v(:, :)   !! as in the type [points, places]
    real(wp) :: slope(directions, most_nodes)   !! unused
    integer :: k

    self%places = size(place, 2)
    self%sees_points = self%points == 1
    do k = 1, self%places
      call self%shape(place(:, k), self%n(:, k), slope)
    end do
    self%p(:self%points, :self%places) = p
    self%v(:self%points, :self%places) = v
  end subroutine compare_at

  !> Set the points at which strains are sampled.
  pure subroutine sample_at(self, place, sample_of)
    class(element_kind), intent(inout) :: self
    real(wp), intent(in) :: place(:, :)        !! local coordinates [directions, samples]
    real(wp), intent(in) :: sample_of(:, :)    !! as in the type [points, samples]
    real(wp) :: slope(directions, most_nodes)   !! unused
    integer :: k

    self%samples = size(place, 2)
    do k = 1, self%samples
      call self%shape(place(:, k), self%sample_values(:, k), slope)
    end do
    self%sample_of(:self%points, :self%samples) = sample_of
  end subroutine sample_at
end module epcont_element_element_kind
