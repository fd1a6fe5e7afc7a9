!> Interface of an iteration method: a linear law about a state, and the next state from the result of this
!> law. This type itself is METHOD SECANT, the paper's: the whole load in each solve, moduli from the last
!> strains, until nothing changes. With Anderson acceleration it is MODSEC: moduli from a combination of the
!> last strains. Other methods extend it.
module epcont_plasticity_secant
  use epcont_base_kinds, only: wp
  use epcont_linalg_anderson, only: anderson_mixer
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_solved_state, only: solved_state
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: secant_method

  type :: secant_method
    type(anderson_mixer), allocatable :: mixer   !! not allocated: no acceleration
    real(wp) :: blend = 0.0_wp                   !! part of the secant matrix in a tangent
  contains
    procedure :: linearise
    procedure :: stiffen
    procedure :: advance
  end type secant_method

contains

  !> Set the law about a state, at a point that can yield: secant matrix (2-8).
  pure subroutine linearise(self, p, about, linear)
    class(secant_method), intent(inout) :: self
    integer, intent(in) :: p                         !! number of the point
    type(solved_state), intent(in) :: about           !! with strains and points
    type(linear_problem), intent(inout) :: linear    !! its law is set

    call linear%law%set_matrix( &
      p, linear%materials%section(linear%materials%of_point(p))%secant_matrix(about%point(p)))
  end subroutine linearise

  !> Make the next law stiffer, if the stiffness of the last one could not be factored. Most methods cannot.
  pure subroutine stiffen(self, possible)
    class(secant_method), intent(inout) :: self
    logical, intent(out) :: possible                 !! the law is stiffer

    possible = .false.
  end subroutine stiffen

  !> Find the next state to linearise about, after the law about `about` has given `found`.
  subroutine advance(self, model, linear, found, about)
    class(secant_method), intent(inout) :: self
    type(model_type), intent(in) :: model            !! model
    type(linear_problem), intent(in) :: linear       !! solved model
    type(solved_state), intent(in) :: found           !! with its points
    type(solved_state), intent(inout) :: about        !! displacement, strain and points

    if (allocated(self%mixer)) then
      call mix_states(self%mixer, model, linear%operator%volume, found, about)
      about%point = linear%materials%states(about%strain)
    else
      about%displacement = found%displacement
      about%strain = found%strain
      about%point = found%point
    end if
  end subroutine advance

  !> Combine the last states. The norm of a change of strains is that of their elastic energy.
  subroutine mix_states(mixer, model, volume, found, about)
    type(anderson_mixer), intent(inout) :: mixer
    type(model_type), intent(in) :: model            !! model
    real(wp), intent(in) :: volume(:)                !! of each point [length**3]
    type(solved_state), intent(in) :: found          !! displacement and strain
    type(solved_state), intent(inout) :: about       !! the same
    real(wp) :: rest(size(found%strain, 1), size(volume))
    real(wp), allocatable :: value(:)
    integer :: n

    rest = (found%strain - about%strain)*spread( &
           sqrt(volume*model%sections%young(model%mesh%section(model%mesh%point_element))), 1, size(rest, 1))
    rest(4, :) = sqrt(0.5_wp)*rest(4, :)   ! shear, twice in the sum of squares
    n = size(rest)
    value = [found%strain, found%displacement]
    call mixer%mix([rest], value)
    about%strain = reshape(value(:n), shape(about%strain))
    about%displacement = reshape(value(n + 1:), shape(about%displacement))
  end subroutine mix_states
end module epcont_plasticity_secant
