!> What the factors of symmetric positive definite matrices have in common, however they are stored.
module epcont_linalg_factored
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: factored_matrix, probes

  type, abstract :: factored_matrix
    integer :: order = 0
    real(wp) :: norm = 0.0_wp   !! 1-norm of the matrix, or a bound of it
  contains
    procedure :: solve
    procedure :: solve_lower
    procedure(second_half), deferred :: solve_upper
    procedure :: condition
    procedure :: half_solved_probes
  end type factored_matrix

  abstract interface
    !> The second half of a solve, L'^-1 x. Rows before `first` are not wanted, and may be left unfinished.
    pure subroutine second_half(self, x, first)
      import :: factored_matrix, wp
      class(factored_matrix), intent(in) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)  !! [order, any]
      integer, intent(in) :: first
    end subroutine second_half
  end interface

contains

  !> Solve with the factor, in place.
  pure subroutine solve(self, x)
    class(factored_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)  !! right-hand sides, then solutions [order, any]

    call self%solve_lower(x)
    call self%solve_upper(x, 1)
  end subroutine solve

  !> The first half of a solve, L^-1 x: right-hand sides that have it behind them may still be added to each other. Factors that
  !! cannot be used by halves do nothing here, and all in the second.
  pure subroutine solve_lower(self, x)
    class(factored_matrix), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)  !! [order, any]
  end subroutine solve_lower

  !> Estimate of the condition in the 1-norm, from the factor: of the inverse's norm a lower bound, seldom under a third of it. Two
  !! columns at a time (Higham and Tisseur, SIAM J. Matrix Anal. Appl. 21 (2000) 1185) in two solves, since a factor takes longer
  !! to read than to use: `dlacn2`, one column in each of five solves, takes two and a half times as long for the same figure; the
  !! alternating column alone takes three quarters, but its figure depends on the order of the equations (0.6 to 1 of this one).
  !! (Begun with a solution already known it would take one, but where that has ties or zeros the figure would be a matter of
  !! rounding: 0.4 to 1 of this one.)
  pure function condition(self) result(number)
    class(factored_matrix), intent(in) :: self
    real(wp) :: number
    real(wp), allocatable :: x(:, :)
    real(wp) :: inverse_norm

    number = 1.0_wp
    if (self%order == 0) return
    x = self%half_solved_probes()
    call self%solve_upper(x, 1)
    inverse_norm = maxval(sum(abs(x), dim=1))
    x = sign(1.0_wp, x)
    call self%solve(x)
    ! The inverse is symmetric: a row's sum is a column's.
    number = self%norm*max(inverse_norm, maxval(abs(x)))
  end function condition

  !> What the estimate begins with, of 1-norm 1: equal parts, and the alternating column that finds what they cancel (Higham's).
  pure function probes(order) result(x)
    integer, intent(in) :: order
    real(wp), allocatable :: x(:, :)
    integer :: i

    allocate (x(order, 2))
    x(:, 1) = 1.0_wp/max(1, order)
    x(:, 2) = [(merge(1.0_wp, -1.0_wp, mod(i, 2) == 1)*(1.0_wp + real(i - 1, wp)/max(1, order - 1)), i=1, order)]
    x(:, 2) = x(:, 2)/sum(abs(x(:, 2)))
  end function probes

  !> These with the first half of the solve behind them; some factors took them along when they were made.
  pure function half_solved_probes(self) result(x)
    class(factored_matrix), intent(in) :: self
    real(wp), allocatable :: x(:, :)

    x = probes(self%order)
    call self%solve_lower(x)
  end function half_solved_probes
end module epcont_linalg_factored
