!> Attempts after a solve without a result, or with one that can be improved: the only list of them.
!> `solution` makes the attempts; `messages/attempt_text.f90` describes them.
module epcont_attempts
  implicit none
  private
  public :: attempt_list, attempt_type

  !> Attempts, in order of priority: the first one with a reason is made.
  integer, parameter, public :: &
    more_steps = 1, &     !! more load steps
    other_rule = 2, &     !! the other contact rule
    refinement = 3, &     !! iterative refinement of the answer, in some steps
    more_pairs = 4        !! pairs of nodes that came near
  integer, parameter, public :: attempts = 4
  !> Maximum number of each; in total if they change the model's plan, else for each plan.
  integer, parameter :: most(attempts) = [1, 2, 1, 7]
  logical, parameter :: plans_again(attempts) = [.false., .true., .false., .true.]

  !> Reasons; 0: no reason.
  integer, parameter, public :: &
    because_not_converged = 1, &   !! no convergence, and no limit load found
    because_no_contact = 2, &      !! no active set found
    because_not_unique = 3, &      !! the contact solver does not show which contact forces are not unique
    because_singular = 4, &        !! or why the stiffness is singular
    because_refused = 5, &         !! the certificate rejects the result
    because_unbalanced = 6, &      !! forces, gaps or energy have a residual, or a pivot lost digits
    because_near = 7               !! nodes without a pair penetrate

  type :: attempt_type
    integer :: what = 0     !! one of the attempts
    integer :: why = 0      !! one of the reasons, from the solve before
    integer :: many = 0     !! load steps or steps of refinement taken, or pairs added
  end type attempt_type

  !> Attempts after the first solve.
  type :: attempt_list
    type(attempt_type), allocatable :: made(:)
  contains
    procedure :: begin
    procedure :: count_of
    procedure :: has_left
    procedure :: add
  end type attempt_list

contains

  !> Begin with the first solve, without attempts.
  pure subroutine begin(self)
    class(attempt_list), intent(inout) :: self

    if (allocated(self%made)) deallocate (self%made)
    allocate (self%made(0))
  end subroutine begin

  !> Number of times that an attempt was made.
  pure integer function count_of(self, what)
    class(attempt_list), intent(in) :: self
    integer, intent(in) :: what
    integer :: first, k

    first = 1
    if (.not. plans_again(what)) then   ! of this plan
      do k = 1, size(self%made)
        if (plans_again(self%made(k)%what)) first = k
      end do
    end if
    count_of = count(self%made(first:)%what == what)
  end function count_of

  !> Is the maximum not reached?
  pure logical function has_left(self, what)
    class(attempt_list), intent(in) :: self
    integer, intent(in) :: what

    has_left = self%count_of(what) < most(what)
  end function has_left

  !> Add an attempt.
  pure subroutine add(self, what, why, many)
    class(attempt_list), intent(inout) :: self
    integer, intent(in) :: what, why, many

    self%made = [self%made, attempt_type(what, why, many)]
  end subroutine add
end module epcont_attempts
