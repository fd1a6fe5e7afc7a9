!> Thickness and material of the elements.
module epcont_model_sections
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: uniaxial_curve
  implicit none
  private
  public :: sections_type

  !> Thickness and material of each section [sections].
  type :: sections_type
    real(wp), allocatable :: young(:)           !! [stress]
    real(wp), allocatable :: poisson(:)
    integer, allocatable :: kinematics(:)       !! plane_strain, plane_stress or axisymmetric
    real(wp), allocatable :: thickness(:)       !! [length]
    real(wp), allocatable :: density(:)         !! [mass/length**3]
    type(uniaxial_curve), allocatable :: curve(:)  !! stress-strain curve, if it can yield
    real(wp), allocatable :: expansion(:)       !! strain for each degree [1/temperature]
    real(wp), allocatable :: reference_temperature(:)   !! temperature without thermal strain [temperature]
    integer, allocatable :: property_id(:)      !! PSHELL or PSOLID; not of model data from arrays
    integer, allocatable :: material_id(:)      !! MAT1; not of model data from arrays
  contains
    procedure :: has_flat_curve
  end type sections_type

contains

  !> Is a section perfectly plastic at the end of its curve? Then loads may have no equilibrium.
  pure function has_flat_curve(self) result(flat)
    class(sections_type), intent(in) :: self
    logical :: flat
    integer :: n, s

    flat = .false.
    do s = 1, size(self%curve)
      if (.not. allocated(self%curve(s)%stress)) cycle
      n = size(self%curve(s)%stress)
      flat = flat .or. self%curve(s)%stress(n) <= self%curve(s)%stress(n - 1)
    end do
  end function has_flat_curve
end module epcont_model_sections
