!> What is the same in all elements of one kind. `element_kinds.f90` has a row for each, and a file of its own
!> says what is in it.
!>
!> Corners come first, counter-clockwise; then the middles of the sides, the first behind the first corner.
!> Sides are straight, or parabolas through their middle nodes.
module epcont_element_element_kind
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  implicit none
  private
  public :: element_kind, new_kind

  !> Nodes, integration points and places of comparison of an element, at most.
  integer, parameter, public :: most_nodes = 8, most_points = 9, most_places = 9

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
    procedure :: compare_at
    procedure :: sample_at
  end type element_kind

  abstract interface
    !> Shape functions at a local place, and their derivatives by the local coordinates; 0 beyond the last
    !! node.
    pure subroutine shape_functions(place, n, slope)
      import :: directions, most_nodes, wp
      real(wp), intent(in) :: place(directions)
      real(wp), intent(out) :: n(most_nodes), slope(directions, most_nodes)
    end subroutine shape_functions
  end interface

contains

  !> A kind by its nodes, shape functions and integration points; its strains are sampled and compared at
  !! these.
  pure function new_kind(corners, nodes, shape, point, weight) result(kind)
    integer, intent(in) :: corners, nodes      !! how many
    procedure(shape_functions) :: shape        !! of the nodes
    real(wp), intent(in) :: point(:, :)        !! local places [directions, points]
    real(wp), intent(in) :: weight(:)          !! [points]
    type(element_kind) :: kind
    real(wp) :: unit(size(weight), size(weight))
    integer :: p

    kind%corners = corners
    kind%nodes = nodes
    kind%degree = nodes/corners
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
  end function new_kind

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
