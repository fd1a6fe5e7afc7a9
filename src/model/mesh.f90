!> The mesh of a model: nodes, elements, and the bodies that these make.
module epcont_model_mesh
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: element_kind
  use epcont_element_kinematics, only: directions
  use epcont_geometry_outline_shape, only: outline_type
  implicit none
  private
  public :: mesh_type

  type :: mesh_type
    integer :: nodes = 0, elements = 0, bodies = 0
    real(wp), allocatable :: x(:, :)            !! coordinates [length] [2, nodes]
    integer, allocatable :: node_id(:)          !! [nodes]
    integer, allocatable :: element_id(:)       !! [elements]
    type(element_kind), allocatable :: kinds(:) !! the table of elements [any]
    integer, allocatable :: kind(:)             !! of each element: its row there [elements]
    integer, allocatable :: node_count(:)       !! nodes of each element [elements]
    !> The nodes of each element: its corners counter-clockwise, then the mid-side nodes, the first after the
    !! first corner; 0 if it has no more [most of all, elements]
    integer, allocatable :: connectivity(:, :)
    integer, allocatable :: section(:)          !! section of each element [elements]
    type(incidence) :: around                   !! the elements around each node
    integer :: points = 0                       !! integration points of all elements
    !> Of each element; those of element e end before that of e + 1 [elements + 1]
    integer, allocatable :: first_point(:)
    integer, allocatable :: point_element(:)    !! [points]
    integer, allocatable :: body(:)             !! of each node [nodes]
    type(outline_type) :: body_outline          !! of all bodies
  contains
    procedure :: coordinates
    procedure :: corners
    procedure :: edge
    procedure :: edge_between
    procedure :: with_side
    procedure :: edge_coordinates
    procedure :: elements_of_bodies
  end type mesh_type

contains

  !> Coordinates of the nodes of an element [length] [2, its nodes].
  pure function coordinates(self, element) result(x)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: element   !! which element
    real(wp) :: x(directions, self%node_count(element))

    x = self%x(:, self%connectivity(:self%node_count(element), element))
  end function coordinates

  !> Corners, and sides, of an element.
  pure integer function corners(self, element)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: element   !! which element

    corners = self%kinds(self%kind(element))%corners
  end function corners

  !> Nodes of a side of an element: where it begins and ends, counter-clockwise, and its middle, 0 where it
  !! has none.
  pure function edge(self, element, side)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: element, side   !! which element, which side of it
    integer :: edge(3)

    associate (node => self%connectivity(:, element), n => self%corners(element))
      edge = [node(side), node(mod(side, n) + 1), 0]
      if (self%node_count(element) > n) edge(3) = node(n + side)
    end associate
  end function edge

  !> Nodes of the side of an element that ends at two corners, in either order, as `edge` has them; 0: it has
  !! none.
  pure function edge_between(self, element, a, b) result(node)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: element   !! which element
    integer, intent(in) :: a, b      !! the corners
    integer :: node(3), side

    do side = self%corners(element), 1, -1
      node = self%edge(element, side)
      if (all(node(:2) == [a, b]) .or. all(node(:2) == [b, a])) return
    end do
    node = 0
  end function edge_between

  !> Elements that have a side between two corners.
  pure function with_side(self, a, b) result(element)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: a, b      !! the corners
    integer, allocatable :: element(:)
    integer :: k

    element = self%around%of(a)
    element = pack(element, [(any(self%edge_between(element(k), a, b) > 0), k=1, size(element))])
  end function with_side

  !> Coordinates of the nodes of a side [length] [2, 2 or 3].
  pure function edge_coordinates(self, edge) result(x)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: edge(3)   !! nodes of the side, see `edge`
    real(wp) :: x(directions, merge(3, 2, edge(3) > 0))

    x = self%x(:, edge(:size(x, 2)))
  end function edge_coordinates

  !> Elements of each body.
  pure type(incidence) function elements_of_bodies(self) result(elements)
    class(mesh_type), intent(in) :: self

    elements = new_incidence(reshape(self%body(self%connectivity(1, :)), [1, self%elements]), self%bodies)
  end function elements_of_bodies
end module epcont_model_mesh
