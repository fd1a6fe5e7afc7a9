!> Factored bodies with a linear law, and displacements under nodal forces.
module epcont_assembly_bodies
  use epcont_assembly_stiffness, only: body_stiffness, spring_set
  use epcont_assembly_strain_operator, only: new_strain_operator, strain_operator
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_material_linear_law, only: linear_law
  use epcont_model_arrays, only: angle
  use epcont_model_springs, only: spring_forces
  use epcont_model_ties, only: platen_angle
  use epcont_plan_numbering, only: numbering_type
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_threads, only: threads_over, use_one_thread_each
  implicit none
  private
  public :: factored_bodies, force_fields, half_solved_body, new_bodies, prescribe, weak_pivot

  !> Pivot that lost most digits by rounding.
  type :: weak_pivot
    real(wp) :: ratio = 1.0_wp    !! to its diagonal entry
    integer :: body = 0           !! 0 if all bodies are rigid
  end type weak_pivot

  !> Forces on a body after forward substitution.
  type :: half_solved_body
    logical :: loaded = .false.            !! there are any forces
    real(wp), allocatable :: inner(:, :)   !! [equations, 1]
  end type half_solved_body

  !> Several fields of forces on some nodes; a node may occur twice.
  type :: force_fields
    integer, allocatable :: node(:)          !! [loaded nodes]
    real(wp), allocatable :: force(:, :, :)  !! [force] [directions, fields, loaded nodes]
  end type force_fields

  type :: factored_bodies
    type(strain_operator) :: operator
    type(linear_law) :: law                    !! of the next or the last factors
    type(spring_set) :: spring                 !! of the next or the last factor
    type(body_stiffness), allocatable :: body(:)   !! bodies of the numbering
    integer :: factorizations = 0              !! number so far, of bodies with equations
    !> Forces of prescribed displacements on free DOFs [directions, nodes]
    real(wp), allocatable :: settlement(:, :)
  contains
    procedure :: factor_system
    procedure :: settle
    procedure :: displacements
    procedure :: add_forces
    procedure :: finish
    procedure :: body_displacements
    procedure :: estimate_condition
    procedure :: weakest
  end type factored_bodies

contains

  !> Make bodies without factors and material law.
  function new_bodies(scene) result(bodies)
    type(planned_model), intent(in) :: scene   !! with equation numbers
    type(factored_bodies) :: bodies

    bodies%operator = new_strain_operator(scene%model)
    allocate (bodies%body(size(scene%numbering%body)))
    if (.not. scene%numbering%joined) bodies%spring%stiffness = scene%model%constraints%spring%stiffness
    allocate (bodies%settlement(directions, scene%model%mesh%nodes), source=0.0_wp)
  end function new_bodies

  !> Factor joined bodies, as far as law or springs have changed.
  subroutine factor_system(self, scene, threads)
    class(factored_bodies), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    integer, intent(in) :: threads             !! which share the fronts

    !$omp parallel num_threads(threads) if (threads > 1)
    call use_one_thread_each()
    !$omp single
    call self%body(1)%assemble(scene, self%operator, self%law, self%spring, 1)
    call self%body(1)%factor()
    !$omp end single
    !$omp end parallel
    self%factorizations = self%factorizations + 1
    self%law%changed = .false.
    self%spring%changed = .false.
  end subroutine factor_system

  !> Compute the forces of the prescribed displacements on the free DOFs: -K_fp u_p.
  subroutine settle(self, scene)
    class(factored_bodies), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    real(wp), allocatable :: prescribed(:, :)

    self%settlement = 0.0_wp
    if (all(scene%model%loads%beyond_travel == 0.0_wp) .and. &
        all(scene%model%loads%rotation == 0.0_wp)) return
    allocate (prescribed(directions, scene%model%mesh%nodes), source=0.0_wp)
    call prescribe(scene, .true., prescribed)
    self%settlement = -self%operator%nodal_forces( &
      scene%model, self%law%increment(self%operator%strains(scene%model, prescribed, heated=.false.)))
    if (size(scene%model%constraints%spring) > 0) &
      self%settlement = self%settlement - spring_forces(scene%model, prescribed)
  end subroutine settle

  !> Set the prescribed displacements, or zero, and the DOFs that are sums. Other DOFs stay as they are.
  pure subroutine prescribe(scene, moved, displacement)
    type(planned_model), intent(in) :: scene
    logical, intent(in) :: moved                    !! by the prescribed displacements
    real(wp), intent(inout) :: displacement(:, :)   !! [length] [directions, nodes]
    real(wp) :: turned(size(scene%model%constraints%platen))    ! [radian]
    integer :: c, k, node

    associate (model => scene%model)
      turned = [(platen_angle(model, k, displacement), k=1, size(turned))]
      where (model%constraints%platen%held) turned = merge(model%loads%rotation, 0.0_wp, moved)
      do node = 1, model%mesh%nodes
        do c = 1, directions
          if (model%constraints%sum_of(c, node) == 0 .and. model%constraints%is_held(c, node)) &
            displacement(c, node) = merge(model%loads%beyond_travel(c, model%constraints%leader(c, node)), &
                                          0.0_wp, moved)
        end do
      end do
      if (size(model%constraints%sum) == 0) return
      do node = 1, model%mesh%nodes
        do c = 1, directions
          if (model%constraints%sum_of(c, node) > 0) displacement(c, node) = &
            sum_of_terms(model%constraints%sum_of(c, node))
        end do
      end do
    end associate

  contains

    pure real(wp) function sum_of_terms(row) result(u)
      integer, intent(in) :: row
      integer :: i

      u = 0.0_wp
      associate (sum => scene%model%constraints%sum(row))
        do i = 1, size(sum%node)
          associate (of => sum%component(i), at => sum%node(i))
            if (of == angle) u = u + sum%coefficient(i)*turned(at)
            if (of /= angle) u = u + sum%coefficient(i)*displacement(of, at)
          end associate
        end do
      end associate
    end function sum_of_terms
  end subroutine prescribe

  !> Estimate the condition of the stiffness in the 1-norm: the largest of all bodies.
  subroutine estimate_condition(self, condition)
    class(factored_bodies), intent(inout) :: self
    real(wp), intent(out) :: condition         !! 1 if all bodies are rigid
    integer :: b

    condition = 1.0_wp
    do b = 1, size(self%body)
      call self%body(b)%estimate_condition()
      condition = max(condition, self%body(b)%condition)
    end do
    if (self%spring%norm > 0.0_wp) condition = condition*self%spring%norm/self%body(1)%matrix%norm
  end subroutine estimate_condition

  !> Find the weakest pivot of all bodies. Joined bodies are skipped: their springs make pivots small, and
  !! iterative refinement follows.
  pure type(weak_pivot) function weakest(self)
    class(factored_bodies), intent(in) :: self
    integer :: b

    if (self%spring%norm > 0.0_wp) return
    b = minloc(self%body%smallest_ratio, dim=1)
    if (self%body(b)%smallest_ratio < weakest%ratio) weakest = weak_pivot(self%body(b)%smallest_ratio, b)
  end function weakest

  !> Displacements under nodal forces alone, supports and SUPORT DOFs at zero [directions, nodes].
  function displacements(self, scene, force) result(u)
    class(factored_bodies), intent(in) :: self
    type(planned_model), intent(in) :: scene   !! with equation numbers
    real(wp), intent(in) :: force(:, :)        !! [directions, nodes]
    real(wp), allocatable :: u(:, :)
    type(half_solved_body), allocatable :: half(:)

    call self%add_forces(scene, force, .false., half)
    u = self%finish(scene, half, moved=.false., at_contact=.false.)
  end function displacements

  !> Add forces to the bodies, with forward substitution.
  subroutine add_forces(self, scene, force, moved, half)
    class(factored_bodies), intent(in) :: self
    type(planned_model), intent(in) :: scene     !! with equation numbers
    real(wp), intent(in) :: force(:, :)          !! [directions, nodes]
    logical, intent(in) :: moved                 !! with the forces of the prescribed displacements
    !> Forces added before; not allocated if no forces were added [bodies]
    type(half_solved_body), allocatable, intent(inout) :: half(:)
    real(wp), allocatable :: inner(:, :), whole(:, :)
    integer :: b, i

    whole = force
    if (moved) whole = force + self%settlement
    if (.not. allocated(half)) allocate (half(size(self%body)))
    do b = 1, size(half)
      associate (body => scene%numbering%body(b))
        allocate (inner(body%equations, 1), source=0.0_wp)
        !$omp parallel do num_threads(merge(1, threads_over(size(body%node)), body%is_tied))
        do i = 1, size(body%node)
          associate (at => body%node(i))
            call put_forces(scene%numbering, b, at, whole(:, at:at), inner)
          end associate
        end do
        !$omp end parallel do
      end associate
      if (any(inner /= 0.0_wp)) then
        call self%body(b)%matrix%solve_lower(inner)
        half(b)%loaded = .true.
      end if
      if (allocated(half(b)%inner)) inner = inner + half(b)%inner
      call move_alloc(inner, half(b)%inner)
    end do
  end subroutine add_forces

  !> Compute displacements under all forces that have been added, SUPORT DOFs at zero [directions, nodes].
  function finish(self, scene, half, moved, at_contact) result(u)
    class(factored_bodies), intent(in) :: self
    type(planned_model), intent(in) :: scene       !! with equation numbers
    type(half_solved_body), intent(in) :: half(:)  !! forces that have been added [bodies]
    logical, intent(in) :: moved         !! by the prescribed displacements
    logical, intent(in) :: at_contact    !! only displacements that gaps depend on are needed
    real(wp), allocatable :: u(:, :)
    real(wp), allocatable :: inner(:, :)
    integer :: b, first, i

    allocate (u(directions, scene%model%mesh%nodes), source=0.0_wp)
    call prescribe(scene, moved, u)
    do b = 1, size(half)
      associate (body => scene%numbering%body(b))
        inner = half(b)%inner
        first = merge(body%first_contact, 1, at_contact)
        if (half(b)%loaded) call self%body(b)%matrix%solve_upper(inner, first)
        !$omp parallel do num_threads(threads_over(size(body%node)))
        do i = 1, size(body%node)
          associate (node => body%node(i))
            call add_displacements(scene%numbering, b, node, first, inner, u(:, node:node))
          end associate
        end do
        !$omp end parallel do
      end associate
    end do
  end function finish

  !> Compute displacements of nodes of one body under several fields of forces on some of its nodes, supports
  !! at zero. All fields are solved for at once, so the factor is read only twice.
  subroutine body_displacements(self, scene, b, loads, node, u, at_contact)
    class(factored_bodies), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! with equation numbers
    integer, intent(in) :: b                       !! the body
    type(force_fields), intent(in) :: loads        !! forces on it
    integer, intent(in) :: node(:)                 !! nodes whose displacements are needed
    real(wp), intent(out) :: u(:, :, :)            !! [length] [directions, fields, nodes]
    logical, intent(in), optional :: at_contact    !! only displacements that gaps depend on are needed
    real(wp), allocatable :: inner(:, :)
    integer :: first, i

    first = 1
    associate (body => scene%numbering%body(b))
      if (present(at_contact)) first = merge(body%first_contact, 1, at_contact)
      allocate (inner(body%equations, size(u, 2)), source=0.0_wp)
    end associate
    do i = 1, size(loads%node)
      call put_forces(scene%numbering, b, loads%node(i), loads%force(:, :, i), inner)
    end do
    call self%body(b)%matrix%solve_lower(inner)
    call self%body(b)%matrix%solve_upper(inner, first)
    inner(:first - 1, :) = 0.0_wp
    u = 0.0_wp
    do i = 1, size(node)
      call add_displacements(scene%numbering, b, node(i), first, inner, u(:, :, i))
    end do
  end subroutine body_displacements

  !> Add fields of forces at a node to the right-hand sides of its body.
  pure subroutine put_forces(numbering, b, node, force, inner)
    type(numbering_type), intent(in) :: numbering
    integer, intent(in) :: b, node
    real(wp), intent(in) :: force(:, :)        !! [directions, fields]
    real(wp), intent(inout) :: inner(:, :)     !! [equations, fields]
    integer :: c, e

    associate (tied => numbering%body(b)%tied, number => numbering%equation(:, node))
      do c = 1, directions
        if (number(c) > 0) inner(number(c), :) = inner(number(c), :) + force(c, :)
        if (number(c) >= 0) cycle
        do e = tied%start(-number(c)), tied%start(1 - number(c)) - 1
          associate (at => tied%equation(e))
            inner(at, :) = inner(at, :) + tied%weight(e)*force(c, :)
          end associate
        end do
      end do
    end associate
  end subroutine put_forces

  !> Put the displacements of a node in their place, those of sums in addition to prescribed parts.
  pure subroutine add_displacements(numbering, b, node, first, inner, u)
    type(numbering_type), intent(in) :: numbering
    integer, intent(in) :: b, node
    integer, intent(in) :: first             !! equations before this one are not needed
    real(wp), intent(in) :: inner(:, :)      !! [equations, fields]
    real(wp), intent(inout) :: u(:, :)       !! [directions, fields]
    integer :: c, e

    associate (tied => numbering%body(b)%tied, number => numbering%equation(:, node))
      do c = 1, directions
        if (number(c) > 0) u(c, :) = merge(inner(number(c), :), 0.0_wp, number(c) >= first)
        if (number(c) >= 0) cycle
        do e = tied%start(-number(c)), tied%start(1 - number(c)) - 1
          u(c, :) = u(c, :) + tied%weight(e)*inner(tied%equation(e), :)
        end do
      end do
    end associate
  end subroutine add_displacements
end module epcont_assembly_bodies
