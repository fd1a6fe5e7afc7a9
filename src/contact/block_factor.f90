!> The factor of a basis whose set of contacts changes by blocks.
!>
!> Pairs that are likely to stay stand first. When the set changes, the factor is kept up to the first pair
!> that has gone, and only the rows below it are factored anew:
!>
!>     +------+
!>     | kept |         pairs of large force
!>     +------+------+
!>     |     new     |  pairs at the edges of the contact, and those that came
!>     +------+------+
module epcont_contact_block_factor
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_contact_basis, only: contact_basis, hold_motions, rank_tolerance, weight_of_motions
  use epcont_contact_scaling, only: scaled_problem
  use epcont_linalg_dense, only: extend_cholesky
  implicit none
  private
  public :: begin_blocks, change_set

  !> Part of a set from which on its factor is kept. With 1/2, where pairs that come as the candidates are
  !! doubled stand behind edges that go, block pivoting takes half as long again; without keeping anything it
  !! does so too.
  real(wp), parameter :: worth_keeping = 0.75_wp
  !> Firmness is told apart to this part of the largest.
  real(wp), parameter :: firmness_steps = 1.0e6_wp

contains

  !> A basis of no pairs, with room for all.
  pure subroutine begin_blocks(basis, problem)
    type(contact_basis), intent(out) :: basis   !! of no pairs
    type(scaled_problem), intent(in) :: problem   !! in its own units

    allocate (basis%pairs(0), basis%factor(size(problem%gap), size(problem%gap)))
    basis%gamma = weight_of_motions(problem)
  end subroutine begin_blocks

  !> Go over to another set. Without unique forces the basis is not sound, and nothing is kept of its factor.
  pure subroutine change_set(basis, problem, closed, firmness)
    type(contact_basis), intent(inout) :: basis   !! from `begin_blocks`, or of the set before
    type(scaled_problem), intent(in) :: problem   !! in its own units
    logical, intent(in) :: closed(:)      !! the set [n]
    real(wp), intent(in) :: firmness(:)   !! how likely pairs are to stay, largest first [n]
    integer, allocatable :: added(:)
    logical, allocatable :: missing(:)
    integer :: info, k, kept, n

    n = count(closed)
    kept = findloc([closed(basis%pairs), .false.], .false., dim=1) - 1
    ! Where much is new, all are put into order, so that the next sets keep most of it.
    if (kept < worth_keeping*n) kept = 0
    missing = closed
    missing(basis%pairs(:kept)) = .false.
    added = pack([(k, k=1, size(closed))], missing)
    added = added(sorted_order(nint(-firmness_steps*firmness(added))))
    basis%pairs = [basis%pairs(:kept), added]
    call fill_rows(basis, problem, kept)
    call extend_cholesky(size(basis%factor, 1), basis%factor, kept, n, info)
    if (info == 0) then
      if (any([(basis%factor(k, k)**2, k=1, n)] <= rank_tolerance(problem))) info = 1
    end if
    if (info == 0) then
      call hold_motions(basis, problem)
    else
      basis%sound = .false.
      deallocate (basis%pairs)
      allocate (basis%pairs(0))
    end if
  end subroutine change_set

  !> The rows of F_g = F + gamma A A' after the first `kept`.
  pure subroutine fill_rows(basis, problem, kept)
    type(contact_basis), intent(inout) :: basis
    type(scaled_problem), intent(in) :: problem
    integer, intent(in) :: kept
    real(wp), allocatable :: motion(:, :)
    integer :: first, i, j, k, n

    n = size(basis%pairs)
    motion = problem%motion(basis%pairs, :)
    do j = 1, n
      first = max(j, kept + 1)
      do i = first, n
        basis%factor(i, j) = problem%flexibility(basis%pairs(i), basis%pairs(j))
      end do
      do k = 1, size(motion, 2)
        basis%factor(first:n, j) = basis%factor(first:n, j) + basis%gamma*motion(j, k)*motion(first:n, k)
      end do
    end do
  end subroutine fill_rows
end module epcont_contact_block_factor
