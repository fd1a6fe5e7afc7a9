!> What bodies ask of their stiffness matrices, however these are stored: filled element by element, factored, and seen by
!> the pairs. How one begins, by its band or by its pattern, is the affair of each kind.
!>
!> The elements of fronts are added in the order of the first front that they have equations of (`front_layout`): what stands
!> before is complete then, and is factored while it is at hand. So `add` does most of the work, and `factor` the rest.
module epcont_linalg_assembled
  use epcont_base_kinds, only: wp
  use epcont_linalg_factored, only: factored_matrix
  implicit none
  private
  public :: assembled_matrix, add_seen_through

  type, abstract, extends(factored_matrix) :: assembled_matrix
    real(wp) :: rounding = epsilon(1.0_wp)   !! relative, of its entries and of what is done with them
    logical :: lacks_memory = .false.   !! there was not enough to begin, to analyse or to factor it
  contains
    procedure(clear_entries), deferred :: clear
    procedure(add_element), deferred :: add
    procedure(factor_in_place), deferred :: factor
    procedure(add_compliance), deferred :: add_gram
  end type assembled_matrix

  abstract interface
    !> Make ready to be filled anew where only the columns of these equations have changed: stale columns begin with zeros, the
    !! others remain as they are, even factored.
    pure subroutine clear_entries(self, stale)
      import :: assembled_matrix
      class(assembled_matrix), intent(inout) :: self
      logical, intent(inout) :: stale(:)     !! on return with those that have to be filled anew on their account [order]
    end subroutine clear_entries

    !> Add the matrix of the next element; rows and columns of number 0 and less are left out, and columns that are not stale.
    pure subroutine add_element(self, n, number, k)
      import :: assembled_matrix, wp
      class(assembled_matrix), intent(inout) :: self
      integer, intent(in) :: n
      integer, intent(in) :: number(n)       !! equations
      real(wp), intent(in) :: k(n, n)        !! symmetric
    end subroutine add_element

    !> End with the Cholesky factor of the matrix. Many singular matrices pass for definite, so the ratio of the smallest
    !! pivot to its diagonal entry is returned as well.
    pure subroutine factor_in_place(self, smallest_ratio, at)
      import :: assembled_matrix, wp
      class(assembled_matrix), intent(inout) :: self
      real(wp), intent(out) :: smallest_ratio  !! 0 where the matrix is not definite, or memory did not suffice
      integer, intent(out) :: at               !! its equation, where that is known
    end subroutine factor_in_place

    !> Add N K^-1 N' from the factor, N given by rows: entries start(k) to start(k+1)-1 of row k are equations and weights.
    pure subroutine add_compliance(self, start, equation, weight, gram)
      import :: assembled_matrix, wp
      class(assembled_matrix), intent(in) :: self
      integer, intent(in) :: start(:)             !! [rows + 1]
      integer, intent(in) :: equation(:)          !! those that are not positive count for nothing [entries]
      real(wp), intent(in) :: weight(:)           !! [entries]
      real(wp), intent(inout) :: gram(:, :)       !! [rows, rows]
    end subroutine add_compliance
  end interface

contains

  !> Add N C N', C being a block of the inverse; N as above, its equations being rows of that block.
  pure subroutine add_seen_through(inverse, start, equation, weight, gram)
    real(wp), intent(in) :: inverse(:, :)
    integer, intent(in) :: start(:), equation(:)
    real(wp), intent(in) :: weight(:)
    real(wp), intent(inout) :: gram(:, :)
    real(wp), allocatable :: response(:)
    real(wp) :: opening
    integer :: i, j, k, l

    allocate (response(size(inverse, 1)))
    do l = 1, size(start) - 1
      response = 0.0_wp
      do j = start(l), start(l + 1) - 1
        if (equation(j) > 0) response = response + weight(j)*inverse(:, equation(j))
      end do
      do k = l, size(start) - 1
        opening = 0.0_wp
        do i = start(k), start(k + 1) - 1
          if (equation(i) > 0) opening = opening + weight(i)*response(equation(i))
        end do
        gram(k, l) = gram(k, l) + opening
        if (k > l) gram(l, k) = gram(l, k) + opening
      end do
    end do
  end subroutine add_seen_through
end module epcont_linalg_assembled
