!> Model for the solution: its parts, checked once and read-only afterwards.
!>
!> Components come first in all arrays. Nodes, elements and pairs are known by their position; ids
!> of the deck are for output only.
module epcont_model_model
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: is_first
  use epcont_base_text, only: text_of
  use epcont_element_kinematics, only: axisymmetric
  use epcont_model_constraints, only: constraints_type
  use epcont_model_contact_rows, only: contact_rows
  use epcont_model_controls, only: controls_type
  use epcont_model_finding, only: of_couple, of_element, of_line, of_node, of_pair, of_section
  use epcont_model_load_set, only: load_set
  use epcont_model_mesh, only: mesh_type
  use epcont_model_sections, only: sections_type
  implicit none
  private
  public :: model_type

  type :: model_type
    type(mesh_type) :: mesh
    type(sections_type) :: sections
    type(constraints_type) :: constraints
    type(contact_rows) :: contact
    type(load_set) :: loads                     !! loads of the current load case
    type(controls_type) :: controls
  contains
    procedure :: depth
    procedure :: is_ring
    procedure :: has_rings
    procedure :: can_yield
    procedure :: bodies_of_rows
    procedure :: name_of
  end type model_type

contains

  !> Depth of the plane at a radius: thickness of an element, or circumference if it is axisymmetric
  !! [length].
  pure real(wp) function depth(self, element, radius)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element   !! index of the element
    real(wp), intent(in) :: radius   !! x [length]

    depth = self%sections%thickness(self%mesh%section(element))
    if (self%is_ring(element)) depth = 2.0_wp*acos(-1.0_wp)*radius
  end function depth

  !> Is an element axisymmetric? If its section was not found, it is not.
  pure logical function is_ring(self, element)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element   !! index of the element

    is_ring = self%mesh%section(element) > 0
    if (is_ring) is_ring = self%sections%kinematics(self%mesh%section(element)) == axisymmetric
  end function is_ring

  !> Are the elements axisymmetric? (All or no elements are.)
  pure logical function has_rings(self)
    class(model_type), intent(in) :: self

    has_rings = .false.
    if (self%mesh%elements > 0) has_rings = self%is_ring(1)
  end function has_rings

  !> Can an element yield?
  elemental function can_yield(self, element)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element   !! index of the element
    logical :: can_yield

    can_yield = allocated(self%sections%curve(self%mesh%section(element))%strain)
  end function can_yield

  !> Bodies that each row has nodes of, padded with zeros [any, rows].
  pure function bodies_of_rows(self) result(body)
    class(model_type), intent(in) :: self
    integer, allocatable :: body(:, :)
    integer, allocatable :: own(:)
    integer :: k, most

    body = self%contact%nodes_of_rows()
    most = 0
    do k = 1, size(body, 2)
      own = self%mesh%body(pack(body(:, k), body(:, k) > 0))
      own = pack(own, is_first(own))
      body(:, k) = 0
      body(:size(own), k) = own
      most = max(most, size(own))
    end do
    body = body(:most, :)
  end function bodies_of_rows

  !> Name of a part of the model in messages: `GRID 17`, `CTRIA3 5`.
  pure function name_of(self, kind, which) result(name)
    class(model_type), intent(in) :: self
    integer, intent(in) :: kind    !! of_node, of_element, of_section, of_pair, of_line or of_couple
    integer, intent(in) :: which   !! position of the part
    character(len=:), allocatable :: name

    select case (kind)
    case (of_node)
      name = 'GRID '//text_of(self%mesh%node_id(which))
    case (of_element)
      associate (row => self%mesh%kinds(self%mesh%kind(which)))
        name = trim(merge(row%ring_card, row%plane_card, self%is_ring(which)))// &
               ' '//text_of(self%mesh%element_id(which))
      end associate
    case (of_section)
      name = trim(merge('PSOLID', 'PSHELL', self%sections%kinematics(which) == axisymmetric))//' '// &
             text_of(self%sections%property_id(which))
    case (of_pair)
      name = 'CGAP '//text_of(self%contact%pair_id(which))
    case (of_line)
      name = 'BLSEG '//text_of(self%contact%line(which)%id)
    case (of_couple)
      name = 'BCONP '//text_of(self%contact%couple(which)%id)
    case default
      name = ''
    end select
  end function name_of
end module epcont_model_model
