!> Forces on all mass: nodal forces of gravity and rotation. Both are linear in the coordinates, so that they
!> depend on the mass of each node and its first moments only, which are integrated once.
module epcont_model_body_forces
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: element_kind, most_nodes
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: body_load
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: body_forces, put_body_forces, weigh_nodes

  !> Gauss points along a line, and their weights. A triangle is a square with one edge collapsed to its third
  !! corner. They integrate rho x N exactly, also for axisymmetric elements and curved edges: shape function,
  !! coordinate and radius have degree 2 each, the determinant of the Jacobian 3. The points of the stiffness
  !! are too few.
  integer, parameter :: along = 5
  real(wp), parameter :: &
    inner = sqrt(5.0_wp - 2.0_wp*sqrt(10.0_wp/7.0_wp))/3.0_wp, &
    outer = sqrt(5.0_wp + 2.0_wp*sqrt(10.0_wp/7.0_wp))/3.0_wp, &
    heavy = (322.0_wp + 13.0_wp*sqrt(70.0_wp))/900.0_wp, &
    light = (322.0_wp - 13.0_wp*sqrt(70.0_wp))/900.0_wp, &
    place(along) = [-outer, -inner, 0.0_wp, inner, outer], &
    weight(along) = [light, heavy, 128/225.0_wp, heavy, light]

  real(wp), parameter :: full_turn = 2.0_wp*acos(-1.0_wp)

  !> Integration points of an element type.
  type :: mass_rule
    real(wp) :: weight(along**2) = 0.0_wp               !! fractions of the local area
    real(wp) :: values(most_nodes, along**2) = 0.0_wp   !! shape functions
    real(wp) :: slopes(directions, most_nodes, along**2) = 0.0_wp   !! local derivatives
  end type mass_rule

contains

  !> Find the mass of each node and its moments: integrals of rho N and rho N (x - x of the node).
  pure subroutine weigh_nodes(model)
    type(model_type), intent(inout) :: model   !! the model
    type(mass_rule) :: rule(size(model%mesh%kinds))
    integer :: e, k

    do k = 1, size(model%mesh%kinds)
      rule(k) = new_mass_rule(model%mesh%kinds(k))
    end do
    if (allocated(model%loads%mass)) deallocate (model%loads%mass)
    allocate (model%loads%mass(1 + directions, model%mesh%nodes), source=0.0_wp)
    do e = 1, model%mesh%elements
      call weigh_element(model, e, rule(model%mesh%kind(e)))
    end do
  end subroutine weigh_nodes

  !> Make the integration points of an element type.
  pure function new_mass_rule(kind) result(rule)
    type(element_kind), intent(in) :: kind
    type(mass_rule) :: rule
    real(wp) :: at(directions)
    integer :: i, j, p

    do p = 1, along**2
      i = mod(p - 1, along) + 1
      j = (p - 1)/along + 1
      at = [place(i), place(j)]
      rule%weight(p) = weight(i)*weight(j)
      if (kind%corners == 3) then
        rule%weight(p) = rule%weight(p)*0.125_wp*(1.0_wp - at(2))
        at = 0.5_wp*[0.5_wp*(1.0_wp + at(1))*(1.0_wp - at(2)), 1.0_wp + at(2)]
      end if
      call kind%shape(at, rule%values(:, p), rule%slopes(:, :, p))
    end do
  end function new_mass_rule

  !> Add the mass of an element to its nodes.
  pure subroutine weigh_element(model, element, rule)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: element
    type(mass_rule), intent(in) :: rule
    real(wp) :: from_first(directions, most_nodes)   ! relative to the first corner, to keep digits
    real(wp) :: at(directions), jacobian(directions, directions), mass, node_mass
    integer :: c, k, n, p

    n = model%mesh%node_count(element)
    associate (node => model%mesh%connectivity(:n, element))
      from_first(:, :n) = model%mesh%x(:, node) - spread(model%mesh%x(:, node(1)), 2, n)
      do p = 1, along**2
        do c = 1, directions
          at(c) = dot_product(from_first(c, :n), rule%values(:n, p))
          jacobian(1, c) = dot_product(from_first(c, :n), rule%slopes(1, :n, p))
          jacobian(2, c) = dot_product(from_first(c, :n), rule%slopes(2, :n, p))
        end do
        mass = model%sections%density(model%mesh%section(element))*model%depth(element, &
          model%mesh%x(1, node(1)) + at(1))* &
               rule%weight(p)*(jacobian(1, 1)*jacobian(2, 2) - jacobian(1, 2)*jacobian(2, 1))
        do k = 1, n
          node_mass = mass*rule%values(k, p)
          model%loads%mass(:, node(k)) = model%loads%mass(:, node(k)) + &
            node_mass*[1.0_wp, at - from_first(:, k)]
        end do
      end do
    end associate
  end subroutine weigh_element

  !> Nodal forces of a body load on a model with known nodal masses [force] [2, nodes].
  pure function body_forces(model, load) result(force)
    type(model_type), intent(in) :: model   !! the model
    type(body_load), intent(in) :: load     !! the body load
    real(wp) :: force(directions, model%mesh%nodes)
    real(wp) :: arm(directions)   ! mass times its distance from the rotation axis
    logical :: rings
    integer :: i

    rings = model%has_rings()
    do i = 1, model%mesh%nodes
      arm = model%loads%mass(1, i)*(model%mesh%x(:, i) - load%centre) + model%loads%mass(2:, i)
      if (rings) arm(2) = 0.0_wp
      force(:, i) = load%factor*(model%loads%mass(1, i)*load%acceleration + (full_turn*load%spin)**2*arm + &
                                 full_turn*load%spin_up*[-arm(2), arm(1)])
    end do
  end function body_forces

  !> Add the nodal forces of all body loads to the loads of the model.
  pure subroutine put_body_forces(model)
    type(model_type), intent(inout) :: model   !! the model
    integer :: k

    if (allocated(model%loads%body_force)) deallocate (model%loads%body_force)
    if (all(model%loads%body_load%factor == 0.0_wp)) return
    if (.not. allocated(model%loads%mass)) call weigh_nodes(model)
    allocate (model%loads%body_force(directions, model%mesh%nodes), source=0.0_wp)
    do k = 1, size(model%loads%body_load)
      model%loads%body_force = model%loads%body_force + body_forces(model, model%loads%body_load(k))
    end do
    model%loads%load = model%loads%load + model%loads%body_force
  end subroutine put_body_forces
end module epcont_model_body_forces
