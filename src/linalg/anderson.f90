!> Anderson acceleration of a fixed-point iteration x -> g(x): the combination of the last steps' g with the
!> least g - x (Anderson 1965; Walker and Ni 2011). If g - x grows after a combination, plain steps follow:
!> twice as many as after the previous failure. So if acceleration does harm, the iteration becomes the plain
!> one.
module epcont_linalg_anderson
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: anderson_mixer

  !> Number of steps stored.
  integer, parameter :: memory = 5
  !> A step that differs by at most this part from a combination of the others adds nothing.
  real(wp), parameter :: dependent = 1.0e-10_wp

  type :: anderson_mixer
    integer :: steps = 0                         !! number of stored steps
    real(wp), allocatable, private :: rest(:), value(:)      !! g - x and g of the last step
    !> Changes of g - x and of g in the stored steps, the latest first [any, memory]
    real(wp), allocatable, private :: rest_change(:, :), value_change(:, :)
    logical, private :: mixed = .false.          !! the last step was a combination
    integer, private :: plain = 0                !! number of plain steps before the next combination
    integer, private :: penalty = 0              !! the same number after the last failure
  contains
    procedure :: mix
    procedure, private :: remember
  end type anderson_mixer

contains

  !> Find the next x.
  pure subroutine mix(self, rest, value)
    class(anderson_mixer), intent(inout) :: self
    real(wp), intent(in) :: rest(:)              !! g(x) - x, in components whose norm measures the error
    real(wp), intent(inout) :: value(:)          !! g(x), also of quantities that depend on x; then the next x
    real(wp) :: unit(size(rest), memory), along(size(value), memory)   ! orthonormal changes; those of g
    real(wp) :: length
    integer :: j, k

    if (allocated(self%rest)) call self%remember(rest, value)
    self%rest = rest
    self%value = value
    self%mixed = self%plain == 0 .and. self%steps > 0
    self%plain = max(0, self%plain - 1)
    if (.not. self%mixed) return
    do k = 1, self%steps
      unit(:, k) = self%rest_change(:, k)
      along(:, k) = self%value_change(:, k)
      do j = 1, k - 1
        length = dot_product(unit(:, j), unit(:, k))
        unit(:, k) = unit(:, k) - length*unit(:, j)
        along(:, k) = along(:, k) - length*along(:, j)
      end do
      length = norm2(unit(:, k))
      if (length <= dependent*norm2(self%rest_change(:, k))) length = huge(length)
      unit(:, k) = unit(:, k)/length
      along(:, k) = along(:, k)/length
      value = value - dot_product(unit(:, k), rest)*along(:, k)
    end do
  end subroutine mix

  !> Store the step from the last x to this one; after a failure, forget all.
  pure subroutine remember(self, rest, value)
    class(anderson_mixer), intent(inout) :: self
    real(wp), intent(in) :: rest(:), value(:)

    if (self%mixed .and. norm2(rest) > norm2(self%rest)) then
      self%steps = 0
      self%penalty = max(1, 2*self%penalty)
      self%plain = self%penalty
      return
    end if
    if (.not. allocated(self%rest_change)) &
      allocate (self%rest_change(size(rest), memory), self%value_change(size(value), memory))
    self%steps = min(memory, self%steps + 1)
    self%rest_change(:, 2:self%steps) = self%rest_change(:, :self%steps - 1)
    self%value_change(:, 2:self%steps) = self%value_change(:, :self%steps - 1)
    self%rest_change(:, 1) = rest - self%rest
    self%value_change(:, 1) = value - self%value
  end subroutine remember
end module epcont_linalg_anderson
