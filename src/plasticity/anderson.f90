!> Anderson's acceleration of a fixed-point iteration x -> g(x): from the last steps the mixture of g whose g - x is
!> least, in the norm of the elastic energy of strains.
module epcont_plasticity_anderson
  use epcont_assembly_fields, only: element_volumes
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_plasticity_state, only: scene_state
  implicit none
  private
  public :: anderson_mixer

  !> Steps remembered.
  integer, parameter :: memory = 5
  !> Steps are forgotten when g - x has grown by this factor: they mislead.
  real(wp), parameter :: growth_limit = 2.0_wp
  !> A step that is the others' mixture but for this part of it tells nothing new.
  real(wp), parameter :: dependent = 1.0e-10_wp

  !> A step: the change of g - x, and that of g.
  type :: step_type
    real(wp), allocatable :: rest(:, :)           !! of g - x, strains [3, elements]
    real(wp), allocatable :: strain(:, :)         !! of g [3, elements]
    real(wp), allocatable :: displacement(:, :)   !! of g [2, nodes]
  end type step_type

  type :: anderson_mixer
    integer :: steps = 0                          !! remembered
    logical :: begun = .false.
    type(step_type) :: step(memory)               !! the latest first
    type(step_type) :: last                       !! the last g - x and g themselves
    real(wp), allocatable :: weight(:)            !! of each element in the norm [elements]
  contains
    procedure :: forget
    procedure :: mix
  end type anderson_mixer

contains

  pure subroutine forget(self)
    class(anderson_mixer), intent(inout) :: self

    self%steps = 0
    self%begun = .false.
  end subroutine forget

  !> The next x, when the last one was `about` and g(about) is `found`.
  pure subroutine mix(self, model, found, about)
    class(anderson_mixer), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(scene_state), intent(in) :: found
    type(scene_state), intent(inout) :: about
    type(step_type) :: now
    real(wp) :: share(memory)
    integer :: k

    if (.not. allocated(self%weight)) self%weight = element_volumes(model)*model%young(model%section)
    now%rest = found%strain - about%strain
    now%strain = found%strain
    now%displacement = found%displacement
    if (self%begun) call remember(self, now)
    self%begun = .true.
    self%last = now
    share = best_shares(self)
    about%displacement = found%displacement
    about%strain = found%strain
    do k = 1, self%steps
      about%displacement = about%displacement - share(k)*self%step(k)%displacement
      about%strain = about%strain - share(k)*self%step(k)%strain
    end do
  end subroutine mix

  !> Add the step from the last x to this one.
  pure subroutine remember(self, now)
    class(anderson_mixer), intent(inout) :: self
    type(step_type), intent(in) :: now
    integer :: k

    if (product_of(self, now%rest, now%rest) > growth_limit**2*product_of(self, self%last%rest, self%last%rest)) then
      self%steps = 0
      return
    end if
    self%steps = min(memory, self%steps + 1)
    do k = self%steps, 2, -1
      self%step(k) = self%step(k - 1)
    end do
    self%step(1)%rest = now%rest - self%last%rest
    self%step(1)%strain = now%strain - self%last%strain
    self%step(1)%displacement = now%displacement - self%last%displacement
  end subroutine remember

  !> Shares of the steps that make the last g - x least: least squares by Gram and Schmidt.
  pure function best_shares(self) result(share)
    type(anderson_mixer), intent(in) :: self
    real(wp) :: share(memory)
    type(step_type) :: unit(memory)
    real(wp) :: factor(memory, memory), length
    integer :: j, k

    share = 0.0_wp
    factor = 0.0_wp
    do k = 1, self%steps
      unit(k)%rest = self%step(k)%rest
      length = sqrt(product_of(self, unit(k)%rest, unit(k)%rest))
      do j = 1, k - 1
        factor(j, k) = product_of(self, unit(j)%rest, unit(k)%rest)
        unit(k)%rest = unit(k)%rest - factor(j, k)*unit(j)%rest
      end do
      factor(k, k) = sqrt(product_of(self, unit(k)%rest, unit(k)%rest))
      if (factor(k, k) <= dependent*length) then
        factor(k, k) = 0.0_wp
        unit(k)%rest = 0.0_wp
      else
        unit(k)%rest = unit(k)%rest/factor(k, k)
        share(k) = product_of(self, unit(k)%rest, self%last%rest)
      end if
    end do
    do k = self%steps, 1, -1
      if (factor(k, k) == 0.0_wp) then
        share(k) = 0.0_wp
      else
        share(k) = (share(k) - dot_product(factor(k, k + 1:self%steps), share(k + 1:self%steps)))/factor(k, k)
      end if
    end do
  end function best_shares

  pure real(wp) function product_of(self, a, b)
    type(anderson_mixer), intent(in) :: self
    real(wp), intent(in) :: a(:, :), b(:, :)   !! strains [3, elements]
    integer :: e

    product_of = 0.0_wp
    do e = 1, size(a, 2)
      product_of = product_of + self%weight(e)*(a(1, e)*b(1, e) + a(2, e)*b(2, e) + 0.5_wp*a(3, e)*b(3, e))
    end do
  end function product_of
end module epcont_plasticity_anderson
