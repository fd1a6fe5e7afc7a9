!> What the loop asks of an iteration method: a linear law about a state, and from what that law finds the
!> next state. As it stands it is METHOD SECANT, the paper's: all load each time, moduli from the last
!> strains, until nothing changes; with a mixer MODSEC: moduli from a mixture of the last strains. Others
!> extend it.
module epcont_plasticity_secant
  use epcont_base_kinds, only: wp
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_solved_state, only: solved_state
  use epcont_model_model, only: model_type
  use epcont_plasticity_anderson, only: anderson_mixer
  implicit none
  private
  public :: secant_method

  type :: secant_method
    type(anderson_mixer), allocatable :: mixer   !! not allocated: what was found is taken as it is
    real(wp) :: blend = 0.0_wp                   !! part of the secant matrix in a tangent
  contains
    procedure :: linearise
    procedure :: stiffen
    procedure :: advance
  end type secant_method

contains

  !> The law about a state, at a point that can yield. Secant matrix (2-8).
  pure subroutine linearise(self, p, about, linear)
    class(secant_method), intent(inout) :: self
    integer, intent(in) :: p                         !! the point
    type(solved_state), intent(in) :: about           !! its strain, and its points
    type(linear_problem), intent(inout) :: linear    !! its law is set

    call linear%law%set_matrix( &
      p, linear%materials%section(linear%materials%of_point(p))%secant_matrix(about%point(p)))
  end subroutine linearise

  !> Make the next law a stiffer one, where a stiffness made of the last could not be factored. Most methods
  !! have none.
  pure subroutine stiffen(self, possible)
    class(secant_method), intent(inout) :: self
    logical, intent(out) :: possible                 !! there is one

    possible = .false.
  end subroutine stiffen

  !> The state to linearise about next, when the law about `about` has led to `found`.
  subroutine advance(self, model, linear, load_factor, found, about)
    class(secant_method), intent(inout) :: self
    type(model_type), intent(in) :: model            !! model
    type(linear_problem), intent(in) :: linear       !! solved model
    real(wp), intent(in) :: load_factor              !! of the loads
    type(solved_state), intent(in) :: found           !! with its points
    type(solved_state), intent(inout) :: about        !! displacement, strain and points

    if (allocated(self%mixer)) then
      call self%mixer%mix(model, linear%operator%volume, found, about)
      about%point = linear%materials%states(about%strain)
    else
      about%displacement = found%displacement
      about%strain = found%strain
      about%point = found%point
    end if
  end subroutine advance
end module epcont_plasticity_secant
