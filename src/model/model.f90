!> The scene: what the deck describes, checked once and read-only from then on.
!>
!> Components come first in all arrays. Nodes, elements and pairs are known by their position; their ids
!> of the deck serve for output alone.
module epcont_model_model
  use epcont_base_geometry, only: triangle_area
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: controls_type, uniaxial_curve
  implicit none
  private
  public :: model_type

  type :: model_type
    integer :: nodes = 0, elements = 0, pairs = 0, bodies = 0
    integer, allocatable :: node_id(:)          !! [nodes]
    real(wp), allocatable :: x(:, :)            !! coordinates [length] [2, nodes]
    integer, allocatable :: element_id(:)       !! [elements]
    integer, allocatable :: corner(:, :)        !! nodes of each element, counter-clockwise [3, elements]
    integer, allocatable :: section(:)          !! section of each element [elements]
    real(wp), allocatable :: thickness(:)       !! [length] [sections]
    logical, allocatable :: plane_strain(:)     !! else plane stress [sections]
    real(wp), allocatable :: young(:)           !! [stress] [sections]
    real(wp), allocatable :: poisson(:)         !! [sections]
    type(uniaxial_curve), allocatable :: curve(:)  !! how each section yields, if it does [sections]
    type(controls_type) :: controls             !! of the plastic iteration
    logical, allocatable :: held(:, :)          !! the freedom has a prescribed displacement [2, nodes]
    real(wp), allocatable :: prescribed(:, :)   !! that displacement [length] [2, nodes]
    integer, allocatable :: leader(:, :)        !! node whose displacement the freedom shares: itself if not tied [2, nodes]
    logical, allocatable :: reference(:, :)     !! SUPORT freedoms [2, nodes]
    real(wp), allocatable :: load(:, :)         !! nodal forces [force] [2, nodes]
    integer, allocatable :: pair_id(:)          !! [pairs]
    integer, allocatable :: pair_node(:, :)     !! nodes A and B [2, pairs]
    real(wp), allocatable :: normal(:, :)       !! unit, along which B is pushed [2, pairs]
    real(wp), allocatable :: initial_gap(:)     !! [length] [pairs]
    integer, allocatable :: body(:)             !! of each node [nodes]
  contains
    procedure :: corners
    procedure :: area
    procedure :: can_yield
    procedure :: has_flat_curve
  end type model_type

contains

  !> Coordinates of the corners of an element.
  pure function corners(self, element) result(x)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element
    real(wp) :: x(2, 3)

    x = self%x(:, self%corner(:, element))
  end function corners

  pure function area(self, element)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element
    real(wp) :: area

    area = triangle_area(self%corners(element))
  end function area

  !> Can an element yield?
  pure function can_yield(self, element)
    class(model_type), intent(in) :: self
    integer, intent(in) :: element
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
end module epcont_model_model
