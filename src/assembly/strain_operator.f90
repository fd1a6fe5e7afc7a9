!> Operator B of all integration points, made once: strain = B u. It gives strains of displacements, nodal
!> forces of stresses, and element stiffness.
module epcont_assembly_strain_operator
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: most_nodes, most_points
  use epcont_element_integration_point, only: evaluate_points, integration_point
  use epcont_element_kinematics, only: components, directions
  use epcont_material_linear_law, only: linear_law
  use epcont_model_model, only: model_type
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: strain_operator, new_strain_operator

  type :: strain_operator
    !> Rows xx, yy, zz, xy; two columns for each node, point by point [1/length] [components, columns]
    real(wp), allocatable :: b(:, :)
    integer, allocatable :: column(:)        !! number of columns before those of each point [points]
    real(wp), allocatable :: volume(:)       !! volume of each point [length**3] [points]
  contains
    procedure :: strains
    procedure :: weigh_strains
    procedure :: nodal_forces
    procedure :: element_stiffness
  end type strain_operator

contains

  !> Make the operator of a model.
  function new_strain_operator(model) result(operator)
    type(model_type), intent(in) :: model
    type(strain_operator) :: operator
    integer :: columns, e, p

    allocate (operator%column(model%mesh%points), operator%volume(model%mesh%points))
    columns = 0
    do p = 1, model%mesh%points
      operator%column(p) = columns
      columns = columns + directions*model%mesh%node_count(model%mesh%point_element(p))
    end do
    allocate (operator%b(components, columns))
    !$omp parallel do num_threads(threads_over(model%mesh%elements))
    do e = 1, model%mesh%elements
      call put_element(operator, model, e)
    end do
    !$omp end parallel do
  end function new_strain_operator

  !> Add the columns of one element.
  pure subroutine put_element(operator, model, e)
    type(strain_operator), intent(inout) :: operator
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    type(integration_point) :: point(most_points)
    real(wp) :: x(directions, most_nodes)
    integer :: columns, first, k, points

    first = model%mesh%first_point(e)
    points = model%mesh%first_point(e + 1) - first
    do k = 1, model%mesh%node_count(e)
      x(:, k) = model%mesh%x(:, model%mesh%connectivity(k, e))
    end do
    columns = directions*model%mesh%node_count(e)
    call evaluate_points(model%mesh%kinds(model%mesh%kind(e)), x(:, :model%mesh%node_count(e)), &
                         model%sections%kinematics(model%mesh%section(e)), &
                           model%sections%thickness(model%mesh%section(e)), &
                         point(:points))
    operator%volume(first:first + points - 1) = point(:points)%volume
    do k = 1, points
      associate (column => operator%column(first + k - 1))
        operator%b(:, column + 1:column + columns) = point(k)%b(:, :columns)
      end associate
    end do
  end subroutine put_element

  !> Strains xx, yy, zz, xy (engineering) that cause stresses: those of displacements minus thermal strains
  !! [components, points].
  function strains(self, model, displacement, heated) result(strain)
    class(strain_operator), intent(in) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [directions, nodes]
    logical, intent(in) :: heated                !! with thermal strains
    real(wp), allocatable :: strain(:, :)
    logical :: expands
    integer :: p

    expands = allocated(model%loads%free_strain) .and. heated
    allocate (strain(components, model%mesh%points))
    if (.not. expands .and. all(displacement == 0.0_wp)) then   ! first state of joined bodies
      strain = 0.0_wp
      return
    end if
    !$omp parallel do num_threads(threads_over(model%mesh%points))
    do p = 1, model%mesh%points
      strain(:, p) = strain_at(p)
      if (expands) strain(:3, p) = strain(:3, p) - model%loads%free_strain(p)
    end do
    !$omp end parallel do

  contains

    pure function strain_at(p) result(strain)
      integer, intent(in) :: p
      real(wp) :: strain(components)
      integer :: c, i

      strain = 0.0_wp
      c = self%column(p)
      do i = 1, model%mesh%node_count(model%mesh%point_element(p))
        associate (u => displacement(:, model%mesh%connectivity(i, model%mesh%point_element(p))))
          strain = strain + self%b(:, c + 1)*u(1) + self%b(:, c + 2)*u(2)
        end associate
        c = c + directions
      end do
    end function strain_at
  end function strains

  !> Compute a weighted sum of the strains at the points of an element, for several displacement fields.
  pure subroutine weigh_strains(self, first, nodes, weight, place, u, strain)
    class(strain_operator), intent(in) :: self
    integer, intent(in) :: first                !! first of the points
    integer, intent(in) :: nodes                !! of the element
    real(wp), intent(in) :: weight(:)           !! of each point
    integer, intent(in) :: place(:)             !! positions of the nodes in `u`
    !> Displacements [length] [directions, fields, any]
    real(wp), contiguous, intent(in) :: u(:, :, :)
    real(wp), contiguous, intent(out) :: strain(:, :)   !! [components, fields]
    real(wp) :: b(components, directions)
    integer :: c, f, i, p

    strain = 0.0_wp
    do i = 1, nodes
      b = 0.0_wp
      do p = 1, size(weight)
        c = self%column(first + p - 1) + directions*(i - 1)
        b = b + weight(p)*self%b(:, c + 1:c + directions)
      end do
      do f = 1, size(u, 2)
        strain(:, f) = strain(:, f) + b(:, 1)*u(1, f, place(i)) + b(:, 2)*u(2, f, place(i))
      end do
    end do
  end subroutine weigh_strains

  !> Nodal forces in equilibrium with stresses [force] [directions, nodes].
  pure function nodal_forces(self, model, stress) result(force)
    class(strain_operator), intent(in) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: stress(:, :)         !! xx, yy, zz, xy [stress] [components, points]
    real(wp), allocatable :: force(:, :)
    real(wp) :: s(components)
    integer :: c, i, p

    allocate (force(directions, model%mesh%nodes), source=0.0_wp)
    if (all(stress == 0.0_wp)) return
    do p = 1, model%mesh%points
      s = self%volume(p)*stress(:, p)
      c = self%column(p)
      do i = 1, model%mesh%node_count(model%mesh%point_element(p))
        associate (f => force(:, model%mesh%connectivity(i, model%mesh%point_element(p))))
          f(1) = f(1) + dot_product(s, self%b(:, c + 1))
          f(2) = f(2) + dot_product(s, self%b(:, c + 2))
        end associate
        c = c + directions
      end do
    end do
  end function nodal_forces

  !> Stiffness of an element: B'D B times the volume of each point [force/length].
  pure subroutine element_stiffness(self, model, element, law, n, k)
    class(strain_operator), intent(in) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: element               !! its number
    type(linear_law), intent(in) :: law          !! material law at its points
    integer, intent(in) :: n                     !! DOFs of the element
    real(wp), intent(out) :: k(n, n)             !! its stiffness
    integer :: i, j, p

    k = 0.0_wp
    do p = model%mesh%first_point(element), model%mesh%first_point(element + 1) - 1
      call add_point(n, self%b(1, self%column(p) + 1), self%volume(p), law%matrix(1, 1, law%matrix_of(p)), k)
    end do
    do j = 1, n
      do i = j + 1, n
        k(i, j) = k(j, i)
      end do
    end do
  end subroutine element_stiffness

  !> Add the contribution of a point, above the diagonal.
  pure subroutine add_point(n, b, volume, d, k)
    integer, intent(in) :: n
    real(wp), intent(in) :: b(components, n), volume, d(components, components)
    real(wp), intent(inout) :: k(n, n)
    real(wp) :: stress(components)
    integer :: i, j

    do j = 1, n
      stress = volume*(d(:, 1)*b(1, j) + d(:, 2)*b(2, j) + d(:, 3)*b(3, j) + d(:, 4)*b(4, j))
      do i = 1, j
        k(i, j) = k(i, j) + (b(1, i)*stress(1) + b(2, i)*stress(2) + b(3, i)*stress(3) + b(4, i)*stress(4))
      end do
    end do
  end subroutine add_point
end module epcont_assembly_strain_operator
