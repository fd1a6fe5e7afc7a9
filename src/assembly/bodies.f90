!> The bodies with a linear law, factored, and displacements under nodal forces.
module epcont_assembly_bodies
  use epcont_assembly_stiffness, only: body_stiffness, spring_set
  use epcont_assembly_strain_operator, only: new_strain_operator, strain_operator
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_linalg_assembled, only: sparse_rows
  use epcont_material_linear_law, only: linear_law
  use epcont_model_arrays, only: angle
  use epcont_model_springs, only: spring_forces
  use epcont_model_ties, only: platen_angle
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_threads, only: threads_over, use_one_thread_each
  implicit none
  private
  public :: factored_bodies, force_fields, half_solved_body, new_bodies, prescribe, weak_pivot

  !> The pivot that has lost most of its digits to rounding.
  type :: weak_pivot
    real(wp) :: ratio = 1.0_wp    !! to its diagonal entry
    integer :: body = 0           !! 0: all bodies are rigid
  end type weak_pivot

  !> A body's equations under forces, halfway solved.
  type :: half_solved_body
    logical :: loaded = .false.            !! there are any forces
    real(wp), allocatable :: inner(:, :)   !! [equations, 1]
    real(wp), allocatable :: border(:, :)  !! [border, 1]
  end type half_solved_body

  !> Several fields of forces on some nodes, one of which may stand there twice.
  type :: force_fields
    integer, allocatable :: node(:)          !! [loaded nodes]
    real(wp), allocatable :: force(:, :, :)  !! [force] [directions, fields, loaded nodes]
  end type force_fields

  type :: factored_bodies
    type(strain_operator) :: operator
    type(linear_law) :: law                    !! of the next factors, or the last
    type(spring_set) :: spring                 !! of joined bodies; of the next factor, or the last
    type(body_stiffness), allocatable :: body(:)   !! as they are numbered
    integer :: factorizations = 0              !! done so far, of bodies that have equations
    !> Forces of prescribed displacements on free freedoms [directions, nodes]
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

  !> Bodies with room for their factors, without a law.
  function new_bodies(scene) result(bodies)
    type(planned_model), intent(in) :: scene   !! with the numbers of its equations
    type(factored_bodies) :: bodies

    bodies%operator = new_strain_operator(scene%model)
    allocate (bodies%body(size(scene%numbering%body)))
    allocate (bodies%settlement(directions, scene%model%nodes), source=0.0_wp)
  end function new_bodies

  !> Factor bodies that are joined, as far as law or springs have changed.
  subroutine factor_system(self, scene, threads)
    class(factored_bodies), intent(inout) :: self
    type(planned_model), intent(in) :: scene   !! that they are of
    integer, intent(in) :: threads             !! that share the fronts

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

  !> Forces of the prescribed displacements: minus K_fp u_p on the free freedoms.
  subroutine settle(self, scene)
    class(factored_bodies), intent(inout) :: self
    type(planned_model), intent(in) :: scene   !! that they are of
    real(wp), allocatable :: prescribed(:, :)

    self%settlement = 0.0_wp
    if (all(scene%model%beyond_travel == 0.0_wp) .and. all(scene%model%platen%prescribed == 0.0_wp)) return
    allocate (prescribed(directions, scene%model%nodes), source=0.0_wp)
    call prescribe(scene, 1.0_wp, prescribed)
    self%settlement = -self%operator%nodal_forces( &
                      scene%model, self%law%increment(self%operator%strains(scene%model, prescribed, 0.0_wp)))
    if (size(scene%model%spring) > 0) &
      self%settlement = self%settlement - spring_forces(scene%model, prescribed)
  end subroutine settle

  !> Put a part of the prescribed displacements in its place. Freedoms that are sums follow; nothing else is
  !! touched.
  pure subroutine prescribe(scene, load_factor, displacement)
    type(planned_model), intent(in) :: scene        !! that has them
    real(wp), intent(in) :: load_factor             !! of the prescribed displacements
    real(wp), intent(inout) :: displacement(:, :)   !! [length] [directions, nodes]
    real(wp) :: turned(size(scene%model%platen))    ! [radian]
    integer :: c, k, node

    associate (model => scene%model)
      turned = [(platen_angle(model, k, displacement), k=1, size(turned))]
      where (model%platen%held) turned = load_factor*model%platen%prescribed
      do node = 1, model%nodes
        do c = 1, directions
          if (model%sum_of(c, node) == 0 .and. model%is_held(c, node)) &
            displacement(c, node) = load_factor*model%beyond_travel(c, model%leader(c, node))
        end do
      end do
      if (size(model%sum%first) == 0) return
      do node = 1, model%nodes
        do c = 1, directions
          if (model%sum_of(c, node) > 0) displacement(c, node) = sum_of_terms(model%sum_of(c, node))
        end do
      end do
    end associate

  contains

    pure real(wp) function sum_of_terms(row) result(u)
      integer, intent(in) :: row
      integer :: i

      u = 0.0_wp
      associate (sums => scene%model%sum)
        do i = sums%first(row), sums%last(row)
          associate (of => sums%component(i), at => sums%node(i))
            if (of == angle) u = u + sums%weight(i)*turned(at)
            if (of /= angle) u = u + sums%weight(i)*displacement(of, at)
          end associate
        end do
      end associate
    end function sum_of_terms
  end subroutine prescribe

  !> Estimate of the condition of the stiffness in the 1-norm: the largest of the bodies. What has yielded is
  !! not as stiff as it was when it was assembled first.
  subroutine estimate_condition(self, condition)
    class(factored_bodies), intent(inout) :: self
    real(wp), intent(out) :: condition         !! 1 where all bodies are rigid
    integer :: b

    condition = 1.0_wp
    do b = 1, size(self%body)
      call self%body(b)%estimate_condition()
      condition = max(condition, self%body(b)%condition)
    end do
    if (allocated(self%spring%stiffness)) condition = condition*self%spring%norm/self%body(1)%matrix%norm
  end subroutine estimate_condition

  !> The weakest pivot of all bodies. Of joined ones none is: springs make pivots small, and steps follow
  !! until nothing changes.
  pure type(weak_pivot) function weakest(self)
    class(factored_bodies), intent(in) :: self
    integer :: b

    if (allocated(self%spring%stiffness)) return
    b = minloc(self%body%smallest_ratio, dim=1)
    if (self%body(b)%smallest_ratio < weakest%ratio) weakest = weak_pivot(self%body(b)%smallest_ratio, b)
  end function weakest

  !> Displacements under nodal forces and a part of the prescribed displacements, SUPORT freedoms at zero
  !! [directions, nodes].
  function displacements(self, scene, force, load_factor) result(u)
    class(factored_bodies), intent(in) :: self
    type(planned_model), intent(in) :: scene   !! with the numbers of its equations
    real(wp), intent(in) :: force(:, :)  !! [directions, nodes]
    real(wp), intent(in) :: load_factor  !! of the prescribed displacements
    real(wp), allocatable :: u(:, :)
    type(half_solved_body), allocatable :: half(:)

    call self%add_forces(scene, force, load_factor, half)
    u = self%finish(scene, half, load_factor, .false.)
  end function displacements

  !> Put forces on the bodies: the half of the solve that can be done before all of them are known.
  subroutine add_forces(self, scene, force, load_factor, half)
    class(factored_bodies), intent(in) :: self
    type(planned_model), intent(in) :: scene     !! with the numbers of its equations
    real(wp), intent(in) :: force(:, :)          !! [directions, nodes]
    real(wp), intent(in) :: load_factor          !! of the prescribed displacements, with their forces
    !> What has been put on before; not allocated: nothing [bodies]
    type(half_solved_body), allocatable, intent(inout) :: half(:)
    integer :: b

    if (.not. allocated(half)) allocate (half(size(self%body)))
    do b = 1, size(half)
      call add_to_body(b, half(b))
    end do

  contains

    !> Put forces on one body.
    subroutine add_to_body(b, half)
      integer, intent(in) :: b
      type(half_solved_body), intent(inout) :: half
      real(wp), allocatable :: border(:, :), inner(:, :)
      real(wp) :: own(directions)
      integer :: c, i

      associate (body => scene%numbering%body(b), axes => scene%numbering%axes)
        allocate (inner(body%equations, 1), border(body%border, 1), source=0.0_wp)
        ! Equations are of one freedom each; those of the border are of many.
        !$omp parallel do private(c, own) &
        !$omp num_threads(merge(1, threads_over(size(body%node)), size(body%tied%start) > 1))
        do i = 1, size(body%node)
          associate (node => body%node(i))
            own = force(:, node) + load_factor*self%settlement(:, node)
            if (axes%turn(node) > 0) own = axes%along(node, own)
            do c = 1, directions
              associate (number => scene%numbering%equation(c, node))
                if (number > 0) inner(number, 1) = inner(number, 1) + own(c)
                if (number < 0) call add_tied(body%tied, -number, own(c:c), inner, border)
              end associate
            end do
          end associate
        end do
        !$omp end parallel do
      end associate
      if (any(inner /= 0.0_wp) .or. any(border /= 0.0_wp)) then
        call self%body(b)%solve_lower(inner, border)
        half%loaded = .true.
      end if
      if (allocated(half%inner)) then
        inner = inner + half%inner
        border = border + half%border
      end if
      call move_alloc(inner, half%inner)
      call move_alloc(border, half%border)
    end subroutine add_to_body
  end subroutine add_forces

  !> The other half: displacements under all that has been put on, SUPORT freedoms at zero
  !! [directions, nodes].
  function finish(self, scene, half, load_factor, at_contact) result(u)
    class(factored_bodies), intent(in) :: self
    type(planned_model), intent(in) :: scene       !! with the numbers of its equations
    type(half_solved_body), intent(in) :: half(:)  !! all that has been put on [bodies]
    real(wp), intent(in) :: load_factor  !! of the prescribed displacements
    logical, intent(in) :: at_contact    !! only what gaps depend on is wanted
    real(wp), allocatable :: u(:, :)
    real(wp), allocatable :: border(:, :), inner(:, :)
    integer :: b, c, first, i

    allocate (u(directions, scene%model%nodes), source=0.0_wp)
    call prescribe(scene, load_factor, u)
    do b = 1, size(half)
      associate (body => scene%numbering%body(b), axes => scene%numbering%axes)
        inner = half(b)%inner
        border = half(b)%border
        first = merge(body%first_contact, 1, at_contact)
        if (half(b)%loaded) call self%body(b)%solve_upper(inner, border, first)
        !$omp parallel do num_threads(threads_over(size(body%node))) private(c)
        do i = 1, size(body%node)
          associate (node => body%node(i))
            do c = 1, directions
              associate (number => scene%numbering%equation(c, node))
                if (number > 0) u(c, node) = merge(inner(number, 1), 0.0_wp, number >= first)
                if (number < 0) &
                  u(c, node) = u(c, node) + sum(tied_value(body%tied, -number, inner(:, 1:1), border(:, 1:1)))
              end associate
            end do
            if (axes%turn(node) > 0) u(:, node) = axes%back(node, u(:, node))
          end associate
        end do
        !$omp end parallel do
      end associate
    end do
  end function finish

  !> Put forces on what a tied freedom is a sum of: of the border, or of joined bodies, which have none.
  pure subroutine add_tied(tied, row, force, inner, border)
    type(sparse_rows), intent(in) :: tied       !! of a body
    integer, intent(in) :: row                  !! of the freedom
    real(wp), intent(in) :: force(:)            !! [fields]
    real(wp), intent(inout) :: inner(:, :), border(:, :)   !! [equations, fields], [border, fields]
    integer :: e

    do e = tied%start(row), tied%start(row + 1) - 1
      associate (at => tied%equation(e))
        if (size(border, 1) == 0) inner(at, :) = inner(at, :) + tied%weight(e)*force
        if (size(border, 1) > 0) border(at, :) = border(at, :) + tied%weight(e)*force
      end associate
    end do
  end subroutine add_tied

  !> Displacements of a tied freedom [fields].
  pure function tied_value(tied, row, inner, border) result(u)
    type(sparse_rows), intent(in) :: tied       !! of a body
    integer, intent(in) :: row                  !! of the freedom
    real(wp), intent(in) :: inner(:, :), border(:, :)      !! [equations, fields], [border, fields]
    real(wp) :: u(size(border, 2))
    integer :: e

    u = 0.0_wp
    do e = tied%start(row), tied%start(row + 1) - 1
      if (size(border, 1) == 0) u = u + tied%weight(e)*inner(tied%equation(e), :)
      if (size(border, 1) > 0) u = u + tied%weight(e)*border(tied%equation(e), :)
    end do
  end function tied_value

  !> Displacements of nodes of one body under several fields of forces on some of its nodes, supports at zero.
  !! All fields are solved for at once: so the factor is read only twice.
  subroutine body_displacements(self, scene, b, loads, node, u, at_contact)
    class(factored_bodies), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! with the numbers of its equations
    integer, intent(in) :: b                       !! the body
    type(force_fields), intent(in) :: loads        !! forces on it
    integer, intent(in) :: node(:)                 !! those that are asked for
    real(wp), intent(out) :: u(:, :, :)            !! [length] [directions, fields, nodes asked for]
    logical, intent(in), optional :: at_contact    !! only what gaps depend on is wanted, the rest is zero
    real(wp), allocatable :: border(:, :), inner(:, :)
    real(wp) :: own(directions, size(u, 2))
    integer :: c, first, i

    first = 1
    associate (body => scene%numbering%body(b))
      if (present(at_contact)) first = merge(body%first_contact, 1, at_contact)
      allocate (inner(body%equations, size(u, 2)), border(body%border, size(u, 2)), source=0.0_wp)
    end associate
    do i = 1, size(loads%node)
      own = loads%force(:, :, i)
      call turn(loads%node(i), .true.)
      do c = 1, directions
        associate (number => scene%numbering%equation(c, loads%node(i)))
          if (number > 0) inner(number, :) = inner(number, :) + own(c, :)
          if (number < 0) call add_tied(scene%numbering%body(b)%tied, -number, own(c, :), inner, border)
        end associate
      end do
    end do
    call self%body(b)%solve_lower(inner, border)
    call self%body(b)%solve_upper(inner, border, first)
    inner(:first - 1, :) = 0.0_wp
    do i = 1, size(node)
      own = 0.0_wp
      do c = 1, directions
        associate (number => scene%numbering%equation(c, node(i)))
          if (number > 0) own(c, :) = inner(number, :)
          if (number < 0) own(c, :) = tied_value(scene%numbering%body(b)%tied, -number, inner, border)
        end associate
      end do
      call turn(node(i), .false.)
      u(:, :, i) = own
    end do

  contains

    !> Of all fields at a node to the axes of its freedoms, or back.
    subroutine turn(node, there)
      integer, intent(in) :: node
      logical, intent(in) :: there
      integer :: f

      associate (axes => scene%numbering%axes)
        if (axes%turn(node) == 0) return
        do f = 1, size(own, 2)
          if (there) own(:, f) = axes%along(node, own(:, f))
          if (.not. there) own(:, f) = axes%back(node, own(:, f))
        end do
      end associate
    end subroutine turn
  end subroutine body_displacements
end module epcont_assembly_bodies
