!> Contact of a model: a gap row for each pair, and the lines of nodes that most pairs are made from.
module epcont_model_contact_rows
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_model_arrays, only: line_couple, named_line
  implicit none
  private
  public :: contact_rows, line_contact

  !> Contact of boundary lines, and its pairs. Lines that continue each other, in one BCONP or
  !! in several, are one contact: all edges of one side are slaves, all of the other masters.
  type :: line_contact
    integer, allocatable :: couple(:)     !! positions of its couples of lines
    integer, allocatable :: bconp(:), slave_id(:), master_id(:)   !! ids of the cards
    type(boundary_line) :: slave, master
    real(wp) :: search = 0.0_wp           !! largest distance to an opposite edge [length]
    integer :: first = 1, last = 0        !! its pairs: those of slave nodes first
    integer :: first_of_master = 1        !! first pair of the master's nodes, most of which are corners
    integer, allocatable :: stands_on(:)  !! slave edge at each of these master nodes [pairs of the master]
    !> Slave edges without an opposite edge at one of their nodes: edge, and its end [2, any]
    integer, allocatable :: left_out(:, :)
    integer :: nodes_left_out = 0             !! slave nodes without a pair
    !> Master nodes that got a pair because the loads moved them near the slave
    integer, allocatable :: came_near(:)
    logical :: is_wider = .false.             !! `search` has grown because nodes came near
    real(wp) :: friction = 0.0_wp             !! coefficient of friction
  end type line_contact

  type :: contact_rows
    integer :: pairs = 0
    logical :: contact_is_off = .false.         !! bodies may penetrate each other; this gives a warning
    logical :: gap_by_geometry = .false.        !! the distance along the normal is part of the gap
    integer, allocatable :: pair_id(:)          !! [pairs]
    integer, allocatable :: pair_node(:, :)     !! nodes A and B that name the pair [2, pairs]
    !> Unit normal of each pair, along which B is pushed; then the tangents of pairs with friction [2, rows]
    real(wp), allocatable :: normal(:, :)
    real(wp), allocatable :: initial_gap(:)     !! [length] [pairs]
    real(wp), allocatable :: friction(:)        !! coefficient of friction, 0 without [pairs]
    !> Pair of each tangential row. These rows follow those of the pairs [tangential rows]
    integer, allocatable :: sliding(:)
    !> Tangential displacement of B relative to A at the start of the load step; slip is the change since
    !! then [length] [tangential rows]
    real(wp), allocatable :: slipped(:)
    !> Row k of N: nodes row_node(row_start(k):row_start(k+1)-1) open the gap by row_weight times their
    !! displacement along the normal. The weights of a row sum to 0. [rows + 1], [entries], [entries]
    integer, allocatable :: row_start(:), row_node(:)
    real(wp), allocatable :: row_weight(:)
    type(named_line), allocatable :: line(:)    !! lines of nodes [any]
    type(line_couple), allocatable :: couple(:) !! lines that may come into contact [any]
    !> Edges of the outlines of bodies, numbered as there, with normals; only if there are lines
    type(boundary_line) :: boundary
    type(line_contact), allocatable :: line_contact(:)
  contains
    procedure :: rows
    procedure :: has_friction
    procedure :: nodes_of_rows
    procedure :: opening
    procedure :: slides
    procedure :: single_pairs
  end type contact_rows

contains

  !> Number of rows: pairs, then the tangential rows.
  pure integer function rows(self)
    class(contact_rows), intent(in) :: self

    rows = size(self%row_start) - 1
  end function rows

  !> Has a pair friction?
  pure logical function has_friction(self)
    class(contact_rows), intent(in) :: self

    has_friction = .false.
    if (allocated(self%sliding)) has_friction = size(self%sliding) > 0
  end function has_friction

  !> Nodes of each row, padded with zeros [any, rows].
  pure function nodes_of_rows(self) result(node)
    class(contact_rows), intent(in) :: self
    integer :: node(maxval([self%row_start(2:) - self%row_start(:self%rows()), 0]), self%rows())
    integer :: k

    node = 0
    do k = 1, size(node, 2)
      associate (own => self%row_node(self%row_start(k):self%row_start(k + 1) - 1))
        node(:size(own), k) = own
      end associate
    end do
  end function nodes_of_rows

  !> Compute the opening of a row by displacements: along the normal of a pair, or its tangent.
  pure function opening(self, row, displacement)
    class(contact_rows), intent(in) :: self
    integer, intent(in) :: row
    real(wp), intent(in) :: displacement(:, :)  !! of the nodes of its row [2, entries of the row]
    real(wp) :: opening, apart(directions)
    integer :: k

    ! Summed before the projection on the normal: a common translation cancels without rounding.
    apart = 0.0_wp
    do k = 1, size(displacement, 2)
      apart = apart + self%row_weight(self%row_start(row) + k - 1)*displacement(:, k)
    end do
    opening = dot_product(self%normal(:, row), apart)
  end function opening

  !> Tangential displacement of B relative to A [length] [tangential rows].
  pure function slides(self, displacement)
    class(contact_rows), intent(in) :: self
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp) :: slides(size(self%sliding))
    integer :: j

    do j = 1, size(slides)
      associate (k => self%pairs + j)
        slides(j) = self%opening(k, displacement(:, &
          self%row_node(self%row_start(k):self%row_start(k + 1) - 1)))
      end associate
    end do
  end function slides

  !> Number of pairs from CGAP; the pairs of lines come after them.
  pure integer function single_pairs(self)
    class(contact_rows), intent(in) :: self

    single_pairs = self%pairs
    if (.not. allocated(self%line_contact)) return
    if (size(self%line_contact) > 0) single_pairs = self%line_contact(1)%first - 1
  end function single_pairs
end module epcont_model_contact_rows
