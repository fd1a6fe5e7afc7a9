!> The factored bodies, and displacements under nodal forces.
module epcont_assembly_bodies
  use epcont_assembly_stiffness, only: assemble_body, body_stiffness
  use epcont_assembly_strain_operator, only: strain_operator
  use epcont_base_kinds, only: wp
  use epcont_material_linear_law, only: linear_law
  use epcont_model_model, only: model_type
  use epcont_plan_numbering, only: numbering_type
  implicit none
  private
  public :: factored_bodies, new_bodies, weak_pivot

  !> The pivot that has lost most of its digits to rounding.
  type :: weak_pivot
    real(wp) :: ratio = 1.0_wp    !! to its diagonal entry
    integer :: body = 0           !! 0: all bodies are rigid
  end type weak_pivot

  type :: factored_bodies
    type(body_stiffness), allocatable :: body(:)
    integer :: factorizations = 0              !! done so far, of bodies that have equations
    real(wp), allocatable :: settlement(:, :)  !! forces of prescribed displacements on free freedoms [2, nodes]
  contains
    procedure :: assemble
    procedure :: factor_body
    procedure :: settle
    procedure, nopass :: prescribe
    procedure :: displacements
    procedure :: condition
    procedure :: weakest
    procedure :: lacks_memory
  end type factored_bodies

contains

  !> Bodies with room for their factors.
  pure function new_bodies(model, single) result(bodies)
    type(model_type), intent(in) :: model
    logical, intent(in) :: single    !! factored in single precision
    type(factored_bodies) :: bodies

    allocate (bodies%body(model%bodies))
    bodies%body%single = single
    allocate (bodies%settlement(2, model%nodes), source=0.0_wp)
  end function new_bodies

  !> Assemble one body; if it was before, as far as elements have changed.
  subroutine assemble(self, model, operator, matrix, changed, numbering, b)
    class(factored_bodies), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(strain_operator), intent(in) :: operator
    real(wp), intent(in) :: matrix(:, :, :)   !! of the material at each point [stress] [4, 4, points]
    logical, intent(in) :: changed(:)         !! since the body was factored last [elements]
    type(numbering_type), intent(in) :: numbering
    integer, intent(in) :: b

    call assemble_body(model, operator, matrix, changed, numbering%equation, numbering%body(b), self%body(b))
  end subroutine assemble

  !> Factor what was assembled. `sound` is false where the factor failed.
  subroutine factor_body(self, numbering, b, sound)
    class(factored_bodies), intent(inout) :: self
    type(numbering_type), intent(in) :: numbering
    integer, intent(in) :: b
    logical, intent(out) :: sound

    call self%body(b)%factor()
    if (numbering%body(b)%equations > 0) self%factorizations = self%factorizations + 1
    sound = self%body(b)%is_sound()
  end subroutine factor_body

  !> Forces of the prescribed displacements: minus K_fp u_p on the free freedoms.
  pure subroutine settle(self, model, operator, law)
    class(factored_bodies), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(strain_operator), intent(in) :: operator
    type(linear_law), intent(in) :: law
    real(wp), allocatable :: prescribed(:, :)

    if (all(model%prescribed == 0.0_wp)) return
    allocate (prescribed(2, model%nodes), source=0.0_wp)
    call prescribe(model, 1.0_wp, prescribed)
    self%settlement = -operator%nodal_forces(model, law%increment(operator%strains(model, prescribed)))
  end subroutine settle

  !> A part of the prescribed displacements, put in its place; nothing else is touched.
  pure subroutine prescribe(model, part, displacement)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: part
    real(wp), intent(inout) :: displacement(:, :)   !! [length] [2, nodes]
    integer :: c, node

    do node = 1, model%nodes
      do c = 1, 2
        associate (leader => model%leader(c, node))
          if (model%held(c, leader)) displacement(c, node) = part*model%prescribed(c, leader)
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

  !> Estimate of the condition of the stiffness in the 1-norm: the largest of the bodies.
  pure real(wp) function condition(self)
    class(factored_bodies), intent(in) :: self
    integer :: b

    condition = 1.0_wp
    do b = 1, size(self%body)
      condition = max(condition, self%body(b)%matrix%condition())
    end do
  end function condition

  !> The weakest pivot of all bodies.
  pure type(weak_pivot) function weakest(self)
    class(factored_bodies), intent(in) :: self
    integer :: b

    do b = 1, size(self%body)
      if (self%body(b)%smallest_ratio < weakest%ratio) weakest = weak_pivot(self%body(b)%smallest_ratio, b)
    end do
  end function weakest

  !> Displacements under nodal forces and a part of the prescribed displacements, SUPORT freedoms at zero [2, nodes].
  pure function displacements(self, model, numbering, force, part) result(u)
    class(factored_bodies), intent(in) :: self
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering
    real(wp), intent(in) :: force(:, :)  !! [2, nodes]
    real(wp), intent(in) :: part         !! of the prescribed displacements
    real(wp), allocatable :: u(:, :)
    real(wp), allocatable :: band(:, :), border(:, :)
    real(wp) :: total
    integer :: b, c, i, node, number

    allocate (u(2, model%nodes))
    do b = 1, model%bodies
      associate (body => numbering%body(b))
        allocate (band(body%equations, 1), border(body%border, 1), source=0.0_wp)
        do i = 1, size(body%node)
          node = body%node(i)
          do c = 1, 2
            number = numbering%equation(c, node)
            total = force(c, node) + part*self%settlement(c, node)
            if (number > 0) band(number, 1) = band(number, 1) + total
            if (number < 0) border(-number, 1) = border(-number, 1) + total
          end do
        end do
        if (any(band /= 0.0_wp) .or. any(border /= 0.0_wp)) call self%body(b)%solve(band, border)
        do i = 1, size(body%node)
          node = body%node(i)
          do c = 1, 2
            number = numbering%equation(c, node)
            if (number > 0) then
              u(c, node) = band(number, 1)
            else if (number < 0) then
              u(c, node) = border(-number, 1)
            else
              u(c, node) = part*model%prescribed(c, model%leader(c, node))
            end if
          end do
        end do
        deallocate (band, border)
      end associate
    end do
  end function displacements
end module epcont_assembly_bodies
