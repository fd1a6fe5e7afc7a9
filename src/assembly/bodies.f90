!> The factored bodies, and displacements under nodal forces.
module epcont_assembly_bodies
  use epcont_assembly_stiffness, only: assemble_body, body_stiffness
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_plan_numbering, only: numbering_type
  implicit none
  private
  public :: factored_bodies, factor_bodies

  type :: factored_bodies
    type(body_stiffness), allocatable :: body(:)
    real(wp), allocatable :: settlement(:, :)  !! forces of prescribed displacements on free freedoms [2, nodes]
    real(wp) :: condition = 1.0_wp             !! largest estimate over the bodies
  contains
    procedure :: displacements
  end type factored_bodies

contains

  !> Assemble and factor all bodies. `singular` is the first body whose factor failed, 0 where none did.
  pure subroutine factor_bodies(model, numbering, bodies, singular)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering
    type(factored_bodies), intent(out) :: bodies
    integer, intent(out) :: singular
    integer :: b

    singular = 0
    allocate (bodies%body(model%bodies))
    allocate (bodies%settlement(2, model%nodes), source=0.0_wp)
    do b = 1, model%bodies
      call assemble_body(model, numbering%equation, numbering%body(b), bodies%body(b), bodies%settlement)
      call bodies%body(b)%factor()
      if (bodies%body(b)%smallest_ratio <= epsilon(1.0_wp)) then
        singular = b
        return
      end if
      bodies%condition = max(bodies%condition, bodies%body(b)%band%condition())
    end do
  end subroutine factor_bodies

  !> Displacements under nodal forces and the prescribed displacements, SUPORT freedoms at zero [2, nodes].
  pure function displacements(self, model, numbering, force) result(u)
    class(factored_bodies), intent(in) :: self
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering
    real(wp), intent(in) :: force(:, :)  !! [2, nodes]
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
            total = force(c, node) + self%settlement(c, node)
            if (number > 0) band(number, 1) = band(number, 1) + total
            if (number < 0) border(-number, 1) = border(-number, 1) + total
          end do
        end do
        call self%body(b)%solve(band, border)
        do i = 1, size(body%node)
          node = body%node(i)
          do c = 1, 2
            number = numbering%equation(c, node)
            if (number > 0) then
              u(c, node) = band(number, 1)
            else if (number < 0) then
              u(c, node) = border(-number, 1)
            else
              u(c, node) = model%prescribed(c, model%leader(c, node))
            end if
          end do
        end do
        deallocate (band, border)
      end associate
    end do
  end function displacements
end module epcont_assembly_bodies
