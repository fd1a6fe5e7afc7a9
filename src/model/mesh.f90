!> Mesh of a model: nodes, elements and bodies.
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
    type(element_kind), allocatable :: kinds(:) !! table of element types [any]
    integer, allocatable :: kind(:)             !! row in this table [elements]
    integer, allocatable :: node_count(:)       !! nodes of each element [elements]
    !> The nodes of each element: its corners counter-clockwise, then the mid-side nodes, the first after the
    !! first corner; padded with zeros [most of all, elements]
    integer, allocatable :: connectivity(:, :)
    integer, allocatable :: section(:)          !! section of each element [elements]
    type(incidence) :: around                   !! elements at each node
    integer :: points = 0                       !! integration points of all elements
    !> First point of each element; the last entry is points + 1 [elements + 1]
    integer, allocatable :: first_point(:)
    integer, allocatable :: point_element(:)    !! [points]
    integer, allocatable :: body(:)             !! body of each node [nodes]
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
    integer, intent(in) :: element   !! index of the element
    real(wp) :: x(directions, self%node_count(element))

    x = self%x(:, self%connectivity(:self%node_count(element), element))
  end function coordinates

  !> Number of corners, and edges, of an element.
  pure integer function corners(self, element)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: element   !! index of the element

    corners = self%kinds(self%kind(element))%corners
  end function corners

  !> Nodes of an edge of an element: both ends, counter-clockwise, and its mid-side node, 0 if
  !! absent.
  pure function edge(self, element, side)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: element, side   !! the element, and number of its edge
    integer :: edge(3)

    associate (node => self%connectivity(:, element), n => self%corners(element))
      edge = [node(side), node(mod(side, n) + 1), 0]
      if (self%node_count(element) > n) edge(3) = node(n + side)
    end associate
  end function edge

  !> Nodes of the edge of an element between two corners, in any order, as returned by `edge`; 0 if there is
  !! no such edge.
  pure function edge_between(self, element, a, b) result(node)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: element   !! index of the element
    integer, intent(in) :: a, b      !! the corners
    integer :: node(3), side

    do side = self%corners(element), 1, -1
      node = self%edge(element, side)
      if (all(node(:2) == [a, b]) .or. all(node(:2) == [b, a])) return
    end do
    node = 0
  end function edge_between

  !> Elements that have an edge between two corners.
  pure function with_side(self, a, b) result(element)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: a, b      !! the corners
    integer, allocatable :: element(:)
    integer :: k

    element = self%around%of(a)
    element = pack(element, [(any(self%edge_between(element(k), a, b) > 0), k=1, size(element))])
  end function with_side

  !> Coordinates of the nodes of an edge [length] [2, 2 or 3].
  pure function edge_coordinates(self, edge) result(x)
    class(mesh_type), intent(in) :: self
    integer, intent(in) :: edge(3)   !! nodes of the edge, see `edge`
    real(wp) :: x(directions, merge(3, 2, edge(3) > 0))

    x = self%x(:, edge(:size(x, 2)))
  end function edge_coordinates

  !> Elements of each body.
  pure type(incidence) function elements_of_bodies(self) result(elements)
    class(mesh_type), intent(in) :: self

    elements = new_incidence(reshape(self%body(self%connectivity(1, :)), [1, self%elements]), self%bodies)
  end function elements_of_bodies
end module epcont_model_mesh
