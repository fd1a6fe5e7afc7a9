!> Anderson's acceleration of a fixed-point iteration x -> g(x): from the last steps the mixture of g whose g
!> - x is least, in the norm of the elastic energy of strains. A mixture after which g - x has grown has
!> misled: twice as many steps as after the last such one are then taken as they are, so that where mixing
!> does harm it is the plain iteration.
module epcont_plasticity_anderson
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_linear_scene_state, only: scene_state
  implicit none
  private
  public :: anderson_mixer

  !> Steps remembered.
  integer, parameter :: memory = 5
  !> A step that is the others' mixture but for this part of it tells nothing new.
  real(wp), parameter :: dependent = 1.0e-10_wp

  type :: anderson_mixer
    integer :: steps = 0                               !! remembered
    logical :: begun = .false.
    logical :: mixed = .false.                         !! the last step was a mixture
    integer :: plain = 0                               !! steps to be taken as they are before the next mixture
    integer :: penalty = 0                             !! the same after the last mixture that misled
    real(wp), allocatable :: weight(:)                 !! of each point in the norm [points]
    ! The last strains of g - x, and g.
    real(wp), allocatable :: rest(:, :), strain(:, :), displacement(:, :)
    ! How they changed in the last steps, the latest first [., ., memory].
    real(wp), allocatable :: rest_step(:, :, :), strain_step(:, :, :), displacement_step(:, :, :)
  contains
    procedure :: forget
    procedure :: mix
  end type anderson_mixer

contains

  pure subroutine forget(self)
    class(anderson_mixer), intent(inout) :: self

    self%steps = 0
    self%begun = .false.
    self%mixed = .false.
    self%plain = 0
    self%penalty = 0
  end subroutine forget

  !> The next x, when the last one was `about` and g(about) is `found`.
  pure subroutine mix(self, model, volume, found, about)
    class(anderson_mixer), intent(inout) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: volume(:)   !! of each point
    type(scene_state), intent(in) :: found
    type(scene_state), intent(inout) :: about
    real(wp) :: share(memory)
    integer :: k

    if (.not. allocated(self%weight)) then
      self%weight = volume*model%young(model%section(model%point_element))
      allocate (self%rest_step(4, model%points, memory), self%strain_step(4, model%points, memory))
      allocate (self%displacement_step(2, model%nodes, memory))
    end if
    if (self%begun) call remember(self, found%strain - about%strain, found)
    self%begun = .true.
    self%rest = found%strain - about%strain
    self%strain = found%strain
    self%displacement = found%displacement
    share = 0.0_wp
    if (self%plain == 0) share = best_shares(self)
    self%mixed = any(share /= 0.0_wp)
    self%plain = max(0, self%plain - 1)
    about%displacement = found%displacement
    about%strain = found%strain
    do k = 1, self%steps
      about%displacement = about%displacement - share(k)*self%displacement_step(:, :, k)
      about%strain = about%strain - share(k)*self%strain_step(:, :, k)
    end do
  end subroutine mix

  !> Add the step from the last x, with its g, to this one.
  pure subroutine remember(self, rest, found)
    class(anderson_mixer), intent(inout) :: self
    real(wp), intent(in) :: rest(:, :)
    type(scene_state), intent(in) :: found
    integer :: k

    if (self%mixed .and. product_of(self, rest, rest) > product_of(self, self%rest, self%rest)) then
      self%steps = 0
      self%penalty = max(1, 2*self%penalty)
      self%plain = self%penalty
      return
    end if
    self%steps = min(memory, self%steps + 1)
    do k = self%steps, 2, -1
      self%rest_step(:, :, k) = self%rest_step(:, :, k - 1)
      self%strain_step(:, :, k) = self%strain_step(:, :, k - 1)
      self%displacement_step(:, :, k) = self%displacement_step(:, :, k - 1)
    end do
    self%rest_step(:, :, 1) = rest - self%rest
    self%strain_step(:, :, 1) = found%strain - self%strain
    self%displacement_step(:, :, 1) = found%displacement - self%displacement
  end subroutine remember

  !> Shares of the steps that make the last g - x least: least squares by Gram and Schmidt.
  pure function best_shares(self) result(share)
    type(anderson_mixer), intent(in) :: self
    real(wp) :: share(memory)
    real(wp), allocatable :: unit(:, :, :)
    real(wp) :: factor(memory, memory), length
    integer :: j, k

    share = 0.0_wp
    factor = 0.0_wp
    unit = self%rest_step(:, :, :self%steps)
    do k = 1, self%steps
      length = sqrt(product_of(self, unit(:, :, k), unit(:, :, k)))
      do j = 1, k - 1
        factor(j, k) = product_of(self, unit(:, :, j), unit(:, :, k))
        unit(:, :, k) = unit(:, :, k) - factor(j, k)*unit(:, :, j)
      end do
      factor(k, k) = sqrt(product_of(self, unit(:, :, k), unit(:, :, k)))
      if (factor(k, k) <= dependent*length) then
        factor(k, k) = 0.0_wp
        unit(:, :, k) = 0.0_wp
      else
        unit(:, :, k) = unit(:, :, k)/factor(k, k)
        share(k) = product_of(self, unit(:, :, k), self%rest)
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

  !> Product of two strain fields [4, points].
  pure real(wp) function product_of(self, a, b)
    type(anderson_mixer), intent(in) :: self
    real(wp), intent(in) :: a(:, :), b(:, :)
    integer :: p

    product_of = 0.0_wp
    do p = 1, size(a, 2)
      product_of = product_of + self%weight(p)*(dot_product(a(:3, p), b(:3, p)) + 0.5_wp*a(4, p)*b(4, p))
    end do
  end function product_of
end module epcont_plasticity_anderson
