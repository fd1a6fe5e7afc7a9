!> Data that all elements of one type share. `element_kinds.f90` has the types.
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

  !> Powers of both local coordinates in each monomial of the shape functions: 1, x, y, xy, x**2 and so on.
  integer, parameter :: powers(directions, most_nodes) = &
    reshape([0, 0, 1, 0, 0, 1, 1, 1, 2, 0, 0, 2, 2, 1, 1, 2], [directions, most_nodes])

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
    !> Coefficients of the shape functions: of each node, for each monomial of `powers`
    real(wp) :: coefficient(most_nodes, most_nodes) = 0.0_wp
    integer :: points = 0                               !! number of integration points
    real(wp) :: point(directions, most_points) = 0.0_wp !! their local coordinates
    real(wp) :: weight(most_points) = 0.0_wp            !! their parts of the local area
    real(wp) :: values(most_nodes, most_points) = 0.0_wp               !! shape functions at the points
    !> Their derivatives by the local coordinates
    real(wp) :: slopes(directions, most_nodes, most_points) = 0.0_wp
    real(wp) :: node_slopes(directions, most_nodes, most_nodes) = 0.0_wp   !! the same at the nodes
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
    procedure :: shape => shape_functions
    procedure :: turn
    procedure :: compare_at
    procedure :: sample_at
  end type element_kind

contains

  !> Create a type from its shape functions and integration points, at which strains are sampled and compared.
  pure function new_kind(corner, coefficient, point, weight) result(kind)
    real(wp), intent(in) :: corner(:, :)       !! local coordinates [directions, corners]
    !> Of the shape functions: of all nodes for each monomial; each node has one [nodes**2]
    real(wp), intent(in) :: coefficient(:)
    real(wp), intent(in) :: point(:, :)        !! local coordinates [directions, points]
    real(wp), intent(in) :: weight(:)          !! [points]
    type(element_kind) :: kind
    real(wp) :: at(directions), unit(size(weight), size(weight)), unused(most_nodes)
    integer :: n, p

    n = nint(sqrt(real(size(coefficient))))
    kind%nodes = n
    kind%corners = size(corner, 2)
    kind%degree = n/kind%corners
    kind%coefficient(:n, :n) = reshape(coefficient, [n, n])
    kind%points = size(weight)
    kind%point(:, :kind%points) = point
    kind%weight(:kind%points) = weight
    unit = 0.0_wp
    do p = 1, kind%points
      call kind%shape(point(:, p), kind%values(:, p), kind%slopes(:, :, p))
      unit(p, p) = 1.0_wp
    end do
    do p = 1, n
      at = corner(:, mod(p - 1, kind%corners) + 1)
      if (p > kind%corners) at = 0.5_wp*(at + corner(:, mod(p, kind%corners) + 1))   ! mid-side node
      call kind%shape(at, unused, kind%node_slopes(:, :, p))
    end do
    call kind%compare_at(point, unit, unit)
    kind%sees_points = .true.
    if (kind%degree > 1) call kind%sample_at(point, unit)
  end function new_kind

  !> Find shape functions at a local point, and their derivatives by the local coordinates; 0 beyond the last
  !! node.
  pure subroutine shape_functions(self, place, n, slope)
    class(element_kind), intent(in) :: self
    real(wp), intent(in) :: place(directions)   !! local coordinates
    real(wp), intent(out) :: n(most_nodes), slope(directions, most_nodes)
    integer :: k

    n = 0.0_wp
    slope = 0.0_wp
    do k = 1, self%nodes
      associate (x => place(1), y => place(2), p => powers(1, k), q => powers(2, k), &
                 coefficient => self%coefficient(:, k))
        n = n + coefficient*(x**p*y**q)
        if (p > 0) slope(1, :) = slope(1, :) + coefficient*(p*x**(p - 1)*y**q)
        if (q > 0) slope(2, :) = slope(2, :) + coefficient*(q*x**p*y**(q - 1))
      end associate
    end do
  end subroutine shape_functions

  !> Find the orientation of an element: 1 counter-clockwise, -1 clockwise, 0 if it folds over or is flat. It
  !! is 0 if the determinant of its Jacobian, times the local area, has two signs at its nodes and integration
  !! points, or is not above rounding of the square of its extent and of its coordinates.
  pure integer function turn(self, x)
    class(element_kind), intent(in) :: self
    real(wp), intent(in) :: x(directions, most_nodes)   !! of its nodes [length]
    real(wp) :: area(most_nodes + most_points), extent, least, to(directions, most_nodes)
    integer :: k, n

    n = self%nodes
    do k = 1, n
      to(:, k) = x(:, k) - x(:, 1)
    end do
    do k = 1, n
      area(k) = determinant(self%node_slopes(:, :n, k), to)
    end do
    do k = 1, self%points
      area(n + k) = determinant(self%slopes(:, :n, k), to)
    end do
    extent = maxval(abs(to(:, :n)))
    least = extent*max(rounded_off*extent, cancelled*maxval(abs(x(:, :n))))/sum(self%weight)
    turn = 0
    if (all(area(:n + self%points) > least)) turn = 1
    if (all(area(:n + self%points) < -least)) turn = -1
  end function turn

  !> Determinant of the Jacobian [length**2].
  pure real(wp) function determinant(slope, x)
    real(wp), intent(in) :: slope(:, :)   !! derivatives of the shape functions [directions, nodes]
    real(wp), intent(in) :: x(:, :)       !! [length] [directions, nodes or more]
    real(wp) :: along(directions), across(directions)
    integer :: k

    along = 0.0_wp
    across = 0.0_wp
    do k = 1, size(slope, 2)
      along = along + slope(1, k)*x(:, k)
      across = across + slope(2, k)*x(:, k)
    end do
    determinant = along(1)*across(2) - along(2)*across(1)
  end function determinant

  !> Set the points at which strains are compared.
  pure subroutine compare_at(self, place, p, v)
    class(element_kind), intent(inout) :: self
    real(wp), intent(in) :: place(:, :)        !! local coordinates [directions, places]
    real(wp), intent(in) :: p(:, :), v(:, :)   !! as in the type [points, places]

    self%places = size(place, 2)
    self%sees_points = self%points == 1
    self%n(:, :self%places) = values_at(self, place)
    self%p(:self%points, :self%places) = p
    self%v(:self%points, :self%places) = v
  end subroutine compare_at

  !> Set the points at which strains are sampled.
  pure subroutine sample_at(self, place, sample_of)
    class(element_kind), intent(inout) :: self
    real(wp), intent(in) :: place(:, :)        !! local coordinates [directions, samples]
    real(wp), intent(in) :: sample_of(:, :)    !! as in the type [points, samples]

    self%samples = size(place, 2)
    self%sample_values(:, :self%samples) = values_at(self, place)
    self%sample_of(:self%points, :self%samples) = sample_of
  end subroutine sample_at

  !> Find the shape functions at some points.
  pure function values_at(self, place) result(values)
    class(element_kind), intent(in) :: self
    real(wp), intent(in) :: place(:, :)   !! local coordinates [directions, points]
    real(wp) :: values(most_nodes, size(place, 2)), unused(directions, most_nodes)
    integer :: k

    do k = 1, size(place, 2)
      call self%shape(place(:, k), values(:, k), unused)
    end do
  end function values_at
end module epcont_element_element_kind
