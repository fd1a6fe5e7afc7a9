!> Stress as a linear function of strain at each integration point: what a stiffness matrix can be made of.
module epcont_material_linear_law
  use epcont_base_kinds, only: wp
  use epcont_material_curve, only: material_type
  use epcont_material_elasticity, only: isotropic_matrix
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: linear_law, elastic_law

  !> stress = matrix strain + initial_stress; components xx, yy, zz, xy (engineering shear strain).
  type :: linear_law
    real(wp), allocatable :: matrix(:, :, :)        !! [stress] [4, 4, any]
    integer, allocatable :: matrix_of(:)            !! each point: its own where the material yields, else its section's [points]
    real(wp), allocatable :: initial_stress(:, :)   !! [stress] [4, points]
  contains
    procedure :: stress
    procedure :: increment
  end type linear_law

contains

  !> The law of bodies that do not yield.
  pure function elastic_law(model, material) result(law)
    type(model_type), intent(in) :: model
    type(material_type), intent(in) :: material(:)   !! of each section
    type(linear_law) :: law
    integer :: last, p, s

    allocate (law%initial_stress(4, model%points), source=0.0_wp)
    law%matrix_of = model%section(model%point_element)
    allocate (law%matrix(4, 4, size(material) + count(material(law%matrix_of)%yields)))
    do s = 1, size(material)
      law%matrix(:, :, s) = isotropic_matrix(material(s)%bulk, material(s)%shear, material(s)%sheet)
    end do
    last = size(material)
    do p = 1, model%points
      s = law%matrix_of(p)
      if (.not. material(s)%yields) cycle
      last = last + 1
      law%matrix(:, :, last) = law%matrix(:, :, s)
      law%matrix_of(p) = last
    end do
  end function elastic_law

  !> Stress of each point [4, points].
  pure function stress(self, strain)
    class(linear_law), intent(in) :: self
    real(wp), intent(in) :: strain(:, :)   !! [4, points]
    real(wp), allocatable :: stress(:, :)
    integer :: p

    stress = self%increment(strain)
    do p = 1, size(strain, 2)
      stress(:, p) = stress(:, p) + self%initial_stress(:, p)
    end do
  end function stress

  !> What a strain adds to the stress of each point [4, points].
  pure function increment(self, strain)
    class(linear_law), intent(in) :: self
    real(wp), intent(in) :: strain(:, :)   !! [4, points]
    real(wp), allocatable :: increment(:, :)
    integer :: p

    allocate (increment(4, size(strain, 2)))
    do p = 1, size(strain, 2)
      associate (d => self%matrix(:, :, self%matrix_of(p)))
        increment(:, p) = d(:, 1)*strain(1, p) + d(:, 2)*strain(2, p) + d(:, 3)*strain(3, p) + d(:, 4)*strain(4, p)
      end associate
    end do
  end function increment
end module epcont_material_linear_law
