!> Friction limits that follow the normal forces: each next limit is mu R of the forces under the limits
!> before. While pairs neither close, open, stick nor slip, the forces are a linear function of the limits,
!> and differences of earlier steps lead to the limits that do not change (Anderson 1965; Walker and Ni 2011).
module epcont_linear_friction_limits
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, negligible
  use epcont_contact_problem, only: contact_problem
  implicit none
  private
  public :: friction_limits

  !> Number of steps in which the set changes, after which only half of a change is taken: else limits may
  !! jump to and fro.
  integer, parameter :: whole_changes = 5
  !> Number of differences that are kept.
  integer, parameter :: most_kept = 20

  type :: friction_limits
    private
    integer :: sets = 0               !! number of changes of the limits after which the set has changed
    integer :: known = 0              !! number of differences
    real(wp), allocatable :: last(:), rest(:)   !! limits and their residuals before [tangential]
    !> Differences of limits, and of residuals, which are orthonormal [tangential, kept]
    real(wp), allocatable :: limit_step(:, :), rest_step(:, :)
  contains
    procedure :: forget
    procedure :: update
    procedure, private :: learn
  end type friction_limits

contains

  !> Forget the differences, because the set has changed.
  pure subroutine forget(self)
    class(friction_limits), intent(inout) :: self

    self%sets = self%sets + 1
    self%known = 0
    if (allocated(self%last)) deallocate (self%last)
  end subroutine forget

  !> Replace the limits by those of the forces found with them.
  pure subroutine update(self, problem, force, closed, limit, change)
    class(friction_limits), intent(inout) :: self
    type(contact_problem), intent(in) :: problem
    real(wp), intent(in) :: force(:)       !! [force] [rows]
    logical, intent(in) :: closed(:)       !! rows whose forces are between their bounds [rows]
    real(wp), intent(inout) :: limit(:)    !! [force] [tangential]
    real(wp), intent(out) :: change        !! largest residual of a limit, over the largest force
    real(wp), dimension(size(limit)) :: next, rest
    real(wp) :: largest
    integer :: k

    largest = max(maxval(force), tiny(largest))
    next = problem%friction*max(force(problem%pair_of), 0.0_wp)
    change = maxval(abs(next - limit))/largest
    associate (slips => .not. closed(size(closed) - size(limit) + 1:))
      rest = merge(next - limit, 0.0_wp, slips)   ! limits of rows that stick have no effect
      if (allocated(self%last)) then
        if (maxval(abs(rest - self%rest)) > negligible*largest) &
          call self%learn(merge(limit - self%last, 0.0_wp, slips), rest - self%rest)
      end if
    end associate
    self%last = limit
    self%rest = rest
    if (self%known == 0 .and. self%sets > whole_changes) next = 0.5_wp*(limit + next)
    do k = 1, self%known
      next = next - dot_product(self%rest_step(:, k), rest)*(self%limit_step(:, k) + self%rest_step(:, k))
    end do
    limit = max(next, 0.0_wp)
  end subroutine update

  !> Add a difference of limits and of their residuals, unless it follows from the others.
  pure subroutine learn(self, limit_step, rest_step)
    class(friction_limits), intent(inout) :: self
    real(wp), intent(in) :: limit_step(:), rest_step(:)
    real(wp) :: fall(size(rest_step)), step(size(rest_step)), part
    integer :: k

    if (self%known == most_kept) return
    if (.not. allocated(self%limit_step)) &
      allocate (self%limit_step(size(fall), most_kept), self%rest_step(size(fall), most_kept))
    step = limit_step
    fall = rest_step
    do k = 1, self%known
      part = dot_product(self%rest_step(:, k), fall)
      step = step - part*self%limit_step(:, k)
      fall = fall - part*self%rest_step(:, k)
    end do
    if (norm2(fall) <= cancelled*norm2(limit_step)) return
    self%known = self%known + 1
    self%limit_step(:, self%known) = step/norm2(fall)
    self%rest_step(:, self%known) = fall/norm2(fall)
  end subroutine learn
end module epcont_linear_friction_limits
