!> The scene as it is solved: what the deck or arrays describe, checked once and read-only from then on.
!>
!> Components come first in all arrays. Nodes, elements and pairs are known by their position; their ids
!> of the deck serve for output alone.
module epcont_model_model
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_element_element_kind, only: element_kind
  use epcont_element_kinematics, only: axisymmetric, directions
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_outline_shape, only: outline_type
  use epcont_model_arrays, only: angle, scene_type
  use epcont_model_finding, only: of_couple, of_element, of_line, of_node, of_pair, of_section
  implicit none
  private
  public :: freedom_sums, line_contact, model_type

  !> Freedoms that are sums of others, which follow nothing: row k has the terms first(k) to last(k).
  type :: freedom_sums
    integer, allocatable :: first(:), last(:)       !! [rows]
    integer, allocatable :: component(:), node(:)   !! component `angle`: of the platen of that number [terms]
    real(wp), allocatable :: weight(:)              !! [terms]
  end type freedom_sums

  !> Contact of boundary lines, and the pairs that came of it. Lines that go on in each other, of one BCONP or
  !! of several, are one contact: all their sides on the one hand are slaves, on the other masters.
  type :: line_contact
    integer, allocatable :: couple(:)     !! by their positions
    integer, allocatable :: bconp(:), slave_id(:), master_id(:)   !! ids of the cards
    type(boundary_line) :: slave, master
    real(wp) :: search = 0.0_wp           !! how far away a side may be [length]
    integer :: first = 1, last = 0        !! its pairs: of the slave's nodes, and from the next one on
    integer :: first_of_master = 1        !! those of the master's nodes, most of them corners
    integer, allocatable :: stands_on(:)  !! the side of the slave at each of the latter [pairs of the master]
    !> Sides of the slave that face nothing at a node: which, which node [2, any]
    integer, allocatable :: left_out(:, :)
    integer :: nodes_left_out = 0             !! nodes of the slave without a pair
    !> Nodes of the master that have a pair since they came near as loads moved them
    integer, allocatable :: came_near(:)
    logical :: is_wider = .false.             !! `search` has grown since nodes came near
  end type line_contact

  !> What is given of the scene, its loads with the pressures and its pairs with those of lines, and all that
  !! follows from it.
  type, extends(scene_type) :: model_type
    integer :: nodes = 0, elements = 0, pairs = 0, bodies = 0
    integer, allocatable :: node_id(:)          !! [nodes]
    integer, allocatable :: element_id(:)       !! [elements]
    type(element_kind), allocatable :: kinds(:) !! the table of elements [any]
    integer, allocatable :: kind(:)             !! of each element: its row there [elements]
    integer, allocatable :: node_count(:)       !! nodes of each element [elements]
    !> The nodes of each element: its corners counter-clockwise, then the middles of its sides, the first
    !! behind the first corner; 0 where it has no more. [most of all, elements]
    integer, allocatable :: connectivity(:, :)
    type(incidence) :: around                   !! the elements around each node
    integer :: points = 0                       !! integration points of all elements
    !> Of each element; those of element e end before that of e + 1 [elements + 1]
    integer, allocatable :: first_point(:)
    integer, allocatable :: point_element(:)    !! [points]
    integer, allocatable :: section(:)          !! section of each element [elements]
    !> What temperatures strain each point by along each axis where nothing resists; not allocated: nothing
    !! [points]
    real(wp), allocatable :: free_strain(:)
    integer, allocatable :: property_id(:)      !! PSHELL or PSOLID [sections]
    integer, allocatable :: material_id(:)      !! MAT1 [sections]
    !> The mass that each node has by its shape functions, and the moments of that about the node, for body
    !! loads [mass, mass*length, mass*length] [3, nodes]
    real(wp), allocatable :: mass(:, :)
    real(wp), allocatable :: body_force(:, :)   !! what `load` has of body loads, if any [force] [2, nodes]
    !> The rigid motion of its body that supports prescribe as a whole, and what they prescribe beyond it
    !! [length] [2, nodes].
    real(wp), allocatable :: travel(:, :), beyond_travel(:, :)
    !> Node whose displacement the DOF shares: itself if it is not tied [2, nodes]
    integer, allocatable :: leader(:, :)
    integer, allocatable :: sum_of(:, :)        !! row of each freedom that is a sum; 0: it is none [2, nodes]
    type(freedom_sums) :: sum
    integer, allocatable :: pair_id(:)          !! [pairs]
    !> Row k of N: along its normal the nodes row_node(row_start(k):row_start(k+1)-1) open the gap by
    !! row_weight. The weights of a row sum to 0. [pairs + 1], [entries], [entries]
    integer, allocatable :: row_start(:), row_node(:)
    real(wp), allocatable :: row_weight(:)
    !> Lower and upper bound of the force of each row; not allocated if all are normal to a surface: zero and
    !! infinity, which is huge(1.0_wp) [force] [2, pairs]
    real(wp), allocatable :: force_bound(:, :)
    !> Sides of the bodies' outlines, by the same numbers, with normals; where lines are
    type(boundary_line) :: boundary
    type(line_contact), allocatable :: line_contact(:)
    integer, allocatable :: body(:)             !! of each node [nodes]
    type(outline_type) :: body_outline          !! of all bodies
  contains
    procedure :: coordinates
    procedure :: corners
    procedure :: edge
    procedure :: edge_between
    procedure :: with_side
    procedure :: edge_coordinates
    procedure :: depth
    procedure :: is_ring
    procedure :: has_rings
    procedure :: is_held
    procedure :: is_tied
    procedure :: is_rigid
    procedure :: platen_of
    procedure :: can_yield
    procedure :: has_flat_curve
    procedure :: bodies_of_pairs
    procedure :: elements_of_bodies
    procedure :: nodes_of_pairs
    procedure :: opening
    procedure :: single_pairs
    procedure :: name_of
  end type model_type

contains

  !> Coordinates of the nodes of an element [length] [2, its nodes].
  pure function coordinates(self, element) result(x)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element   !! which element
    real(wp) :: x(directions, self%node_count(element))

    x = self%x(:, self%connectivity(:self%node_count(element), element))
  end function coordinates

  !> Corners, and sides, of an element.
  pure integer function corners(self, element)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element   !! which element

    corners = self%kinds(self%kind(element))%corners
  end function corners

  !> Nodes of a side of an element: where it begins and ends, counter-clockwise, and its middle, 0 where it
  !! has none.
  pure function edge(self, element, side)
    class(model_type), intent(in) :: self
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
    class(model_type), intent(in) :: self
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
    class(model_type), intent(in) :: self
    integer, intent(in) :: a, b      !! the corners
    integer, allocatable :: element(:)
    integer :: k

    element = self%around%of(a)
    element = pack(element, [(any(self%edge_between(element(k), a, b) > 0), k=1, size(element))])
  end function with_side

  !> Coordinates of the nodes of a side [length] [2, 2 or 3].
  pure function edge_coordinates(self, edge) result(x)
    class(model_type), intent(in) :: self
    integer, intent(in) :: edge(3)   !! nodes of the side, see `edge`
    real(wp) :: x(directions, merge(3, 2, edge(3) > 0))

    x = self%x(:, edge(:size(x, 2)))
  end function edge_coordinates

  !> What belongs to a length in the plane at a radius: the thickness of an element, or the way round its ring
  !! [length].
  pure real(wp) function depth(self, element, radius)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element   !! which element
    real(wp), intent(in) :: radius   !! x [length]

    depth = self%thickness(self%section(element))
    if (self%is_ring(element)) depth = 2.0_wp*acos(-1.0_wp)*radius
  end function depth

  !> Is an element a ring? One whose section could not be found is none.
  pure logical function is_ring(self, element)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element   !! which element

    is_ring = self%section(element) > 0
    if (is_ring) is_ring = self%kinematics(self%section(element)) == axisymmetric
  end function is_ring

  !> Are the elements rings? (All are, or none.)
  pure logical function has_rings(self)
    class(model_type), intent(in) :: self

    has_rings = .false.
    if (self%elements > 0) has_rings = self%is_ring(1)
  end function has_rings

  !> Does RBE2 or MPC say where one of these nodes goes?
  pure logical function is_tied(self, node)
    class(model_type), intent(in) :: self
    integer, intent(in) :: node(:)   !! these nodes [any]

    is_tied = any(self%leader(1, node) /= node) .or. any(self%leader(2, node) /= node) .or. &
              any(self%sum_of(:, node) > 0)
  end function is_tied

  !> Do supports and RBE2 keep the shape between these nodes? In each direction they are all held, or all tied
  !! to one, or they turn as one.
  pure logical function is_rigid(self, node)
    class(model_type), intent(in) :: self
    integer, intent(in) :: node(:)   !! these nodes [any]
    integer :: c, platen(size(node))

    platen = [(self%platen_of(node(c)), c=1, size(node))]
    is_rigid = all(platen == platen(1)) .and. platen(1) > 0
    if (is_rigid) return
    is_rigid = .true.
    do c = 1, directions
      associate (leader => self%leader(c, node))
        is_rigid = is_rigid .and. (all(leader == leader(1)) .or. all(self%held(c, leader)))
      end associate
    end do
  end function is_rigid

  !> The platen that turns and that a node is of; 0: none.
  pure integer function platen_of(self, node) result(platen)
    class(model_type), intent(in) :: self
    integer, intent(in) :: node   !! which node

    platen = findloc(self%platen%leader, node, dim=1)
    associate (row => self%sum_of(1, node))
      if (row == 0) return
      if (self%sum%component(self%sum%last(row)) == angle) platen = self%sum%node(self%sum%last(row))
    end associate
  end function platen_of

  !> Can an element yield?
  elemental function can_yield(self, element)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element   !! which element
    logical :: can_yield

    can_yield = allocated(self%curve(self%section(element))%strain)
  end function can_yield

  !> Does a section's curve end in a flat line? Then there may be loads that nothing carries.
  pure function has_flat_curve(self) result(flat)
    class(model_type), intent(in) :: self
    logical :: flat
    integer :: n, s

    flat = .false.
    do s = 1, size(self%curve)
      if (.not. allocated(self%curve(s)%stress)) cycle
      n = size(self%curve(s)%stress)
      flat = flat .or. self%curve(s)%stress(n) <= self%curve(s)%stress(n - 1)
    end do
  end function has_flat_curve

  !> Does a support hold a node along a component, itself or what it is tied to?
  elemental logical function is_held(self, component, node)
    class(model_type), intent(in) :: self
    integer, intent(in) :: component, node   !! 1: x, 2: y

    is_held = self%held(component, self%leader(component, node))
  end function is_held

  !> The bodies that each pair has nodes of; 0 ends them [any, pairs].
  pure function bodies_of_pairs(self) result(body)
    class(model_type), intent(in) :: self
    integer, allocatable :: body(:, :)
    integer :: found(maxval([self%row_start(2:) - self%row_start(:self%pairs), 0]), self%pairs)
    integer :: i, k, last, most

    found = 0
    most = 0
    do k = 1, self%pairs
      last = 0
      do i = self%row_start(k), self%row_start(k + 1) - 1
        associate (b => self%body(self%row_node(i)))
          if (any(found(:last, k) == b)) cycle
          last = last + 1
          found(last, k) = b
        end associate
      end do
      most = max(most, last)
    end do
    body = found(:most, :)
  end function bodies_of_pairs

  !> Elements of each body.
  pure type(incidence) function elements_of_bodies(self) result(elements)
    class(model_type), intent(in) :: self

    elements = new_incidence(reshape(self%body(self%connectivity(1, :)), [1, self%elements]), self%bodies)
  end function elements_of_bodies

  !> Nodes of each pair's row, zeros behind them [any, pairs].
  pure function nodes_of_pairs(self) result(node)
    class(model_type), intent(in) :: self
    integer :: node(maxval([self%row_start(2:) - self%row_start(:self%pairs), 0]), self%pairs)
    integer :: k

    node = 0
    do k = 1, self%pairs
      associate (own => self%row_node(self%row_start(k):self%row_start(k + 1) - 1))
        node(:size(own), k) = own
      end associate
    end do
  end function nodes_of_pairs

  !> How far displacements open the gap of a pair.
  pure function opening(self, pair, displacement)
    class(model_type), intent(in) :: self
    integer, intent(in) :: pair   !! which pair
    real(wp), intent(in) :: displacement(:, :)  !! of the nodes of its row [2, entries of the row]
    real(wp) :: opening, apart(directions)
    integer :: k

    ! Summed before it is seen along the normal: a travel that the nodes share drops out without rounding.
    apart = 0.0_wp
    do k = 1, size(displacement, 2)
      apart = apart + self%row_weight(self%row_start(pair) + k - 1)*displacement(:, k)
    end do
    opening = dot_product(self%normal(:, pair), apart)
  end function opening

  !> How many pairs are given one by one (CGAP); those of lines come behind them.
  pure integer function single_pairs(self)
    class(model_type), intent(in) :: self

    single_pairs = self%pairs
    if (.not. allocated(self%line_contact)) return
    if (size(self%line_contact) > 0) single_pairs = self%line_contact(1)%first - 1
  end function single_pairs

  !> What messages call a part of the scene: `GRID 17`, `CTRIA3 5`.
  pure function name_of(self, kind, which) result(name)
    class(model_type), intent(in) :: self
    integer, intent(in) :: kind    !! of_node, of_element, of_section, of_pair, of_line or of_couple
    integer, intent(in) :: which   !! of these, by its position
    character(len=:), allocatable :: name

    select case (kind)
    case (of_node)
      name = 'GRID '//text_of(self%node_id(which))
    case (of_element)
      associate (row => self%kinds(self%kind(which)))
        name = trim(merge(row%ring_card, row%plane_card, self%is_ring(which)))// &
               ' '//text_of(self%element_id(which))
      end associate
    case (of_section)
      name = trim(merge('PSOLID', 'PSHELL', self%kinematics(which) == axisymmetric))//' '// &
             text_of(self%property_id(which))
    case (of_pair)
      name = 'CGAP '//text_of(self%pair_id(which))
    case (of_line)
      name = 'BLSEG '//text_of(self%line(which)%id)
    case (of_couple)
      name = 'BCONP '//text_of(self%couple(which)%id)
    case default
      name = ''
    end select
  end function name_of
end module epcont_model_model
