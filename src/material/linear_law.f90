!> Stress as a linear function of strain at each integration point, from which stiffness matrices are made.
module epcont_material_linear_law
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: components
  use epcont_material_elasticity, only: isotropic_matrix
  use epcont_material_model_materials, only: model_materials
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: linear_law, elastic_law

  !> stress = matrix strain + initial_stress; components xx, yy, zz, xy (engineering shear strain).
  type :: linear_law
    real(wp), allocatable :: matrix(:, :, :)        !! [stress] [components, components, any]
    !> Matrix of each point: its own if the material can yield, otherwise that of its section [points]
    integer, allocatable :: matrix_of(:)
    real(wp), allocatable :: initial_stress(:, :)   !! [stress] [components, points]
    logical, allocatable :: changed(:)              !! matrix differs from that of the last factor [points]
  contains
    procedure :: stress
    procedure :: increment
    procedure :: set_matrix
  end type linear_law

contains

  !> Make the elastic law.
  pure function elastic_law(materials) result(law)
    type(model_materials), intent(in) :: materials   !! of the model
    type(linear_law) :: law
    integer :: last, p, s

    last = size(materials%section)
    law%matrix_of = materials%of_point
    allocate (law%initial_stress(components, size(law%matrix_of)), source=0.0_wp)
    allocate (law%changed(size(law%matrix_of)), source=.true.)
    allocate (law%matrix(components, components, last + count(materials%can_yield)))
    do s = 1, last
      associate (material => materials%section(s))
        law%matrix(:, :, s) = isotropic_matrix(material%bulk, material%shear, material%sheet)
      end associate
    end do
    do p = 1, size(law%matrix_of)
      if (.not. materials%can_yield(p)) cycle
      last = last + 1
      law%matrix(:, :, last) = law%matrix(:, :, law%matrix_of(p))
      law%matrix_of(p) = last
    end do
  end function elastic_law

  !> Set the matrix of a point that yields.
  pure subroutine set_matrix(self, point, matrix)
    class(linear_law), intent(inout) :: self
    integer, intent(in) :: point                             !! number of the point
    real(wp), intent(in) :: matrix(components, components)   !! [stress]

    associate (now => self%matrix(:, :, self%matrix_of(point)))
      if (any(now /= matrix)) self%changed(point) = .true.
      now = matrix
    end associate
  end subroutine set_matrix

  !> Find the stress of each point [components, points].
  function stress(self, strain)
    class(linear_law), intent(in) :: self
    real(wp), intent(in) :: strain(:, :)   !! [components, points]
    real(wp), allocatable :: stress(:, :)

    stress = self%increment(strain) + self%initial_stress
  end function stress

  !> Find the change of the stress of each point by a strain [components, points].
  function increment(self, strain)
    class(linear_law), intent(in) :: self
    real(wp), intent(in) :: strain(:, :)   !! [components, points]
    real(wp), allocatable :: increment(:, :)
    integer :: p

    allocate (increment(components, size(strain, 2)))
    !$omp parallel do num_threads(threads_over(size(strain, 2)))
    do p = 1, size(strain, 2)
      associate (matrix => self%matrix(:, :, self%matrix_of(p)))
        increment(:, p) = matrix(:, 1)*strain(1, p) + matrix(:, 2)*strain(2, p) + &
                          matrix(:, 3)*strain(3, p) + matrix(:, 4)*strain(4, p)
      end associate
    end do
    !$omp end parallel do
  end function increment
end module epcont_material_linear_law
