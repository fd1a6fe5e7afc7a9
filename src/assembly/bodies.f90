!> The factored bodies, and displacements under nodal forces.
module epcont_assembly_bodies
  use epcont_assembly_stiffness, only: assemble_body, body_stiffness, norm_of
  use epcont_assembly_strain_operator, only: strain_operator
  use epcont_base_kinds, only: wp
  use epcont_material_linear_law, only: linear_law
  use epcont_model_model, only: model_type
  use epcont_plan_numbering, only: numbering_type
  implicit none
  private
  public :: factored_bodies, half_solution, new_bodies, weak_pivot

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

  type :: half_solution
    type(half_solved_body), allocatable :: body(:)
  end type half_solution

  type :: factored_bodies
    type(body_stiffness), allocatable :: body(:)
    integer :: factorizations = 0              !! done so far, of bodies that have equations
    !> Forces of prescribed displacements on free freedoms [2, nodes]
    real(wp), allocatable :: settlement(:, :)
  contains
    procedure :: factor_body
    procedure :: settle
    procedure, nopass :: prescribe
    procedure :: displacements
    procedure :: add_forces
    procedure :: finish
    procedure :: estimate_condition
    procedure :: weakest
    procedure :: lacks_memory
  end type factored_bodies

contains

  !> Bodies with room for their factors.
  pure function new_bodies(model, single) result(bodies)
    type(model_type), intent(in) :: model   !! the scene
    logical, intent(in) :: single    !! factored in single precision
    type(factored_bodies) :: bodies

    allocate (bodies%body(model%bodies))
    bodies%body%single = single
    allocate (bodies%settlement(2, model%nodes), source=0.0_wp)
  end function new_bodies

  !> Assemble and factor one body; if it was before, as far as elements have changed. Nothing of other bodies
  !! is touched.
  subroutine factor_body(self, model, operator, law, changed, numbering, b)
    class(factored_bodies), intent(inout) :: self
    type(model_type), intent(in) :: model   !! the scene
    type(strain_operator), intent(in) :: operator   !! strains of nodal displacements
    type(linear_law), intent(in) :: law   !! D of each point
    logical, intent(in) :: changed(:)         !! since the body was factored last [elements]
    type(numbering_type), intent(in) :: numbering   !! of its equations
    integer, intent(in) :: b   !! the body

    call assemble_body(model, operator, law, changed, numbering, b, self%body(b))
    call self%body(b)%factor()
  end subroutine factor_body

  !> Forces of the prescribed displacements: minus K_fp u_p on the free freedoms.
  pure subroutine settle(self, model, operator, law)
    class(factored_bodies), intent(inout) :: self
    type(model_type), intent(in) :: model   !! the scene
    type(strain_operator), intent(in) :: operator   !! strains of nodal displacements
    type(linear_law), intent(in) :: law   !! stresses of strains
    real(wp), allocatable :: prescribed(:, :)

    if (all(model%beyond_travel == 0.0_wp)) return
    allocate (prescribed(2, model%nodes), source=0.0_wp)
    call prescribe(model, 1.0_wp, prescribed)
    self%settlement = -operator%nodal_forces(model, law%increment(operator%strains(model, prescribed)))
  end subroutine settle

  !> A part of the prescribed displacements, put in its place; nothing else is touched.
  pure subroutine prescribe(model, part, displacement)
    type(model_type), intent(in) :: model   !! the scene
    real(wp), intent(in) :: part   !! of the prescribed displacements
    real(wp), intent(inout) :: displacement(:, :)   !! [length] [2, nodes]
    integer :: c, node

    do node = 1, model%nodes
      do c = 1, 2
        associate (leader => model%leader(c, node))
          if (model%held(c, leader)) displacement(c, node) = part*model%beyond_travel(c, leader)
        end associate
      end do
    end do
  end subroutine prescribe

  !> Whether there was not enough memory for the factor of a body.
  pure logical function lacks_memory(self)
    class(factored_bodies), intent(in) :: self
    integer :: b

    lacks_memory = .false.
    do b = 1, size(self%body)
      if (allocated(self%body(b)%matrix)) lacks_memory = lacks_memory .or. self%body(b)%matrix%lacks_memory
    end do
  end function lacks_memory

  !> Estimate of the condition of the stiffness in the 1-norm: the largest of the bodies. What has yielded is
  !! not as stiff as it was when it was assembled first.
  pure subroutine estimate_condition(self, model, operator, law, numbering, condition)
    class(factored_bodies), intent(inout) :: self
    type(model_type), intent(in) :: model   !! the scene
    type(strain_operator), intent(in) :: operator   !! strains of nodal displacements
    type(linear_law), intent(in) :: law   !! that the bodies were factored with
    type(numbering_type), intent(in) :: numbering   !! of its equations
    real(wp), intent(out) :: condition   !! 1 where all bodies are rigid
    integer :: b

    condition = 1.0_wp
    do b = 1, size(self%body)
      associate (stiffness => self%body(b))
        if (numbering%body(b)%can_yield) then
          stiffness%matrix%norm = norm_of(model, operator, law, numbering, b, stiffness)
        end if
        condition = max(condition, stiffness%matrix%condition())
      end associate
    end do
  end subroutine estimate_condition

  !> The weakest pivot of all bodies.
  pure type(weak_pivot) function weakest(self)
    class(factored_bodies), intent(in) :: self
    integer :: b

    do b = 1, size(self%body)
      if (self%body(b)%smallest_ratio < weakest%ratio) weakest = weak_pivot(self%body(b)%smallest_ratio, b)
    end do
  end function weakest

  !> Displacements under nodal forces and a part of the prescribed displacements, SUPORT freedoms at zero [2,
  !! nodes].
  pure function displacements(self, model, numbering, force, part) result(u)
    class(factored_bodies), intent(in) :: self
    type(model_type), intent(in) :: model   !! the scene
    type(numbering_type), intent(in) :: numbering   !! of its equations
    real(wp), intent(in) :: force(:, :)  !! [2, nodes]
    real(wp), intent(in) :: part         !! of the prescribed displacements
    real(wp), allocatable :: u(:, :)
    type(half_solution) :: half

    call self%add_forces(numbering, force, part, half)
    u = self%finish(model, numbering, half, part, .false.)
  end function displacements

  !> Put forces on the bodies: the half of the solve that can be done before all of them are known.
  pure subroutine add_forces(self, numbering, force, part, half)
    class(factored_bodies), intent(in) :: self
    type(numbering_type), intent(in) :: numbering   !! of its equations
    real(wp), intent(in) :: force(:, :)          !! [2, nodes]
    real(wp), intent(in) :: part                 !! of the prescribed displacements, with their forces
    type(half_solution), intent(inout) :: half   !! what has been put on before
    real(wp) :: total(2, size(force, 2))
    integer :: b

    if (.not. allocated(half%body)) allocate (half%body(size(numbering%body)))
    total = force + part*self%settlement
    do b = 1, size(half%body)
      call add_to_body(self%body(b), numbering, b, total, half%body(b))
    end do
  end subroutine add_forces

  !> Put forces on one body.
  pure subroutine add_to_body(stiffness, numbering, b, force, half)
    type(body_stiffness), intent(in) :: stiffness
    type(numbering_type), intent(in) :: numbering
    integer, intent(in) :: b
    real(wp), intent(in) :: force(:, :)             !! [2, nodes]
    type(half_solved_body), intent(inout) :: half
    real(wp), allocatable :: border(:, :), inner(:, :)
    integer :: c, i

    associate (body => numbering%body(b))
      allocate (inner(body%equations, 1), border(body%border, 1), source=0.0_wp)
      do i = 1, size(body%node)
        do c = 1, 2
          associate (number => numbering%equation(c, body%node(i)), own => force(c, body%node(i)))
            if (number > 0) inner(number, 1) = inner(number, 1) + own
            if (number < 0) border(-number, 1) = border(-number, 1) + own
          end associate
        end do
      end do
    end associate
    if (any(inner /= 0.0_wp) .or. any(border /= 0.0_wp)) then
      call stiffness%solve_lower(inner, border)
      half%loaded = .true.
    end if
    if (allocated(half%inner)) then
      inner = inner + half%inner
      border = border + half%border
    end if
    call move_alloc(inner, half%inner)
    call move_alloc(border, half%border)
  end subroutine add_to_body

  !> The other half: displacements under all that has been put on, SUPORT freedoms at zero [2, nodes].
  pure function finish(self, model, numbering, half, part, at_contact) result(u)
    class(factored_bodies), intent(in) :: self
    type(model_type), intent(in) :: model   !! the scene
    type(numbering_type), intent(in) :: numbering   !! of its equations
    type(half_solution), intent(in) :: half   !! all that has been put on
    real(wp), intent(in) :: part         !! of the prescribed displacements
    logical, intent(in) :: at_contact    !! only nodes of pairs are wanted
    real(wp), allocatable :: u(:, :)
    real(wp), allocatable :: border(:, :), inner(:, :)
    integer :: b, c, i

    allocate (u(2, model%nodes))
    do b = 1, model%bodies
      associate (body => numbering%body(b))
        inner = half%body(b)%inner
        border = half%body(b)%border
        if (half%body(b)%loaded) then
          call self%body(b)%solve_upper(inner, border, merge(body%first_contact, 1, at_contact))
        end if
        do i = 1, size(body%node)
          do c = 1, 2
            associate (node => body%node(i), number => numbering%equation(c, body%node(i)))
              if (number > 0) then
                u(c, node) = inner(number, 1)
              else if (number < 0) then
                u(c, node) = border(-number, 1)
              else
                u(c, node) = part*model%beyond_travel(c, model%leader(c, node))
              end if
            end associate
          end do
        end do
      end associate
    end do
  end function finish
end module epcont_assembly_bodies
