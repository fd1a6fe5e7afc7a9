!> What the factors of symmetric positive definite matrices have in common, however they are stored.
module epcont_linalg_factored
  use epcont_base_kinds, only: wp
  use epcont_linalg_lapack, only: dlacn2
  implicit none
  private
  public :: factored_matrix

  type, abstract :: factored_matrix
    integer :: order = 0
    real(wp) :: norm = 0.0_wp   !! 1-norm of the matrix before it was factored
  contains
    procedure(solve_in_place), deferred :: solve
    procedure :: condition
  end type factored_matrix

  abstract interface
    !> Solve with the factor, in place.
    pure subroutine solve_in_place(self, x)
      import :: factored_matrix, wp
      class(factored_matrix), intent(in) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)  !! right-hand sides, then solutions [order, any]
    end subroutine solve_in_place
  end interface

contains

  !> Estimate of the condition in the 1-norm, from the factor (Hager and Higham's estimator, five solves or so;
  !! `dpbcon` guards its solves against overflow by a search over the whole column in every step: ten times slower).
  pure function condition(self) result(number)
    class(factored_matrix), intent(in) :: self
    real(wp) :: number
    real(wp), allocatable :: v(:), x(:, :)
    real(wp) :: inverse_norm
    integer, allocatable :: signs(:)
    integer :: asked, state(3)

    number = 1.0_wp
    if (self%order == 0) return
    allocate (v(self%order), x(self%order, 1), source=0.0_wp)
    allocate (signs(self%order), source=0)
    asked = 0
    state = 0
    inverse_norm = 0.0_wp
    do
      call dlacn2(self%order, v, x, signs, inverse_norm, asked, state)
      if (asked == 0) exit
      call self%solve(x)  ! the matrix is symmetric: its transpose is asked for in the same way
    end do
    number = self%norm*inverse_norm
  end function condition
end module epcont_linalg_factored
