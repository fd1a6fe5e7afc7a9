!> Anderson acceleration of a fixed-point iteration x -> g(x): the combination of the last steps' g with the
!> least g - x, in the norm of the elastic strain energy. If g - x grows after a combination, plain steps
!> follow: twice as many as after the previous failure. So if acceleration does harm, the iteration becomes
!> the plain one.
module epcont_plasticity_anderson
  use epcont_base_kinds, only: wp
  use epcont_linear_solved_state, only: solved_state
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: anderson_mixer

  !> Number of steps stored.
  integer, parameter :: memory = 5
  !> A step that differs by at most this part from a combination of the others adds nothing.
  real(wp), parameter :: dependent = 1.0e-10_wp

  !> Result of a step, or its change.
  type :: step_type
    real(wp), allocatable :: rest(:, :)           !! residual strains of g - x [components, points]
    real(wp), allocatable :: strain(:, :)         !! of g [components, points]
    real(wp), allocatable :: displacement(:, :)   !! of g [directions, nodes]
  end type step_type

  type :: anderson_mixer
    private
    real(wp), allocatable :: weight(:)   !! of each point in the norm [points]
    type(step_type) :: last
    integer :: steps = 0                 !! number of stored steps
    type(step_type) :: change(memory)    !! their changes, the latest first
    logical :: mixed = .false.           !! the last step was a combination
    integer :: plain = 0                 !! number of plain steps before the next combination
    integer :: penalty = 0               !! the same number after the last failure
  contains
    procedure :: mix
  end type anderson_mixer

contains

  !> Find the next x from the last one, `about`, and its result g(about), `found`.
  subroutine mix(self, model, volume, found, about)
    class(anderson_mixer), intent(inout) :: self
    type(model_type), intent(in) :: model        !! model
    real(wp), intent(in) :: volume(:)            !! of each point [length**3]
    type(solved_state), intent(in) :: found       !! displacement and strain
    type(solved_state), intent(inout) :: about    !! the same
    type(step_type) :: now
    real(wp) :: share(memory)
    integer :: k

    now = step_type(found%strain - about%strain, found%strain, found%displacement)
    if (allocated(self%weight)) then
      call remember()
    else
      self%weight = volume*model%sections%young(model%mesh%section(model%mesh%point_element))
    end if
    self%last = now
    share = 0.0_wp
    if (self%plain == 0) share = best_shares()
    self%mixed = any(share /= 0.0_wp)
    self%plain = max(0, self%plain - 1)
    about%displacement = found%displacement
    about%strain = found%strain
    do k = 1, self%steps
      about%displacement = about%displacement - share(k)*self%change(k)%displacement
      about%strain = about%strain - share(k)*self%change(k)%strain
    end do

  contains

    !> Store the step from the last x to this one.
    subroutine remember()
      if (self%mixed .and. product_of(now%rest, now%rest) > product_of(self%last%rest, self%last%rest)) then
        self%steps = 0
        self%penalty = max(1, 2*self%penalty)
        self%plain = self%penalty
        return
      end if
      self%steps = min(memory, self%steps + 1)
      do k = self%steps, 2, -1
        self%change(k) = self%change(k - 1)
      end do
      self%change(1) = step_type(now%rest - self%last%rest, now%strain - self%last%strain, &
                                 now%displacement - self%last%displacement)
    end subroutine remember

    !> Find the factors of the steps with the least g - x: least squares by Gram-Schmidt orthogonalization.
    pure function best_shares() result(share)
      real(wp) :: share(memory)
      type(step_type) :: unit(memory)
      real(wp) :: factor(memory, memory), length
      integer :: j, k

      share = 0.0_wp
      factor = 0.0_wp
      do k = 1, self%steps
        unit(k)%rest = self%change(k)%rest
        associate (own => unit(k)%rest)
          length = sqrt(product_of(own, own))
          do j = 1, k - 1
            factor(j, k) = product_of(unit(j)%rest, own)
            own = own - factor(j, k)*unit(j)%rest
          end do
          factor(k, k) = sqrt(product_of(own, own))
          if (factor(k, k) <= dependent*length) then
            factor(k, k) = 0.0_wp
            own = 0.0_wp
          else
            own = own/factor(k, k)
            share(k) = product_of(own, now%rest)
          end if
        end associate
      end do
      do k = self%steps, 1, -1
        if (factor(k, k) == 0.0_wp) cycle
        share(k) = (share(k) - dot_product(factor(k, k + 1:self%steps), share(k + 1:self%steps)))/factor(k, k)
      end do
    end function best_shares

    !> Product of two strain fields [components, points].
    pure real(wp) function product_of(a, b)
      real(wp), intent(in) :: a(:, :), b(:, :)
      integer :: p

      product_of = 0.0_wp
      do p = 1, size(a, 2)
        product_of = product_of + self%weight(p)*(dot_product(a(:3, p), b(:3, p)) + 0.5_wp*a(4, p)*b(4, p))
      end do
    end function product_of
  end subroutine mix
end module epcont_plasticity_anderson
