!> Which resultants of contact on bodies an error of the mesh can change, and what each pair counts in them.
module epcont_accuracy_body_shares
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_result_body_force, only: body_force, shares_of_pairs
  implicit none
  private
  public :: find_shares

  !> Bodies up to which errors are estimated of what each bears: one costs as much as two load cases.
  integer, parameter :: most_bodies = 12
  !> Shares, and motions, that differ by less than this are equal.
  real(wp), parameter :: equal = 1.0e-9_wp

contains

  !> One column for each resultant that may be off by itself; what two bodies exert on each other is one.
  pure subroutine find_shares(model, motions, bodies, share, column)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(body_force), intent(in) :: bodies(:)
    real(wp), allocatable, intent(out) :: share(:, :)   !! of a unit force at each pair [pairs, any]
    !> The column of each component; 0: loads alone make it; negative: bodies are too many [2, bodies].
    integer, allocatable, intent(out) :: column(:, :)
    real(wp), allocatable :: one(:)
    integer :: c, i, k

    allocate (share(model%pairs, 0))
    allocate (column(2, size(bodies)), source=-1)
    if (size(bodies) > most_bodies) return
    column = 0
    do i = 1, size(bodies)
      do c = merge(2, 1, model%has_rings()), 2
        one = shares_of_pairs(model, bodies(i)%body, c)
        if (is_free(model, motions, bodies(i)%body, c)) cycle
        do k = 1, size(share, 2)
          if (all(abs(share(:, k) - one) <= equal) .or. all(abs(share(:, k) + one) <= equal)) exit
        end do
        if (k > size(share, 2)) share = reshape([share, one], [model%pairs, k])
        column(c, i) = k
      end do
    end do
  end subroutine find_shares

  !> Is a body free to move along a component? Then contact bears its loads that way.
  pure logical function is_free(model, motions, body, c)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    integer, intent(in) :: body, c
    real(wp) :: first(2), u(2)
    integer :: i, k

    is_free = .false.
    do k = 1, motions%count
      if (motions%body(k) /= body .or. is_free) cycle
      first = motions%displacement(model, findloc(model%body, body, dim=1), k)
      is_free = abs(first(3 - c)) <= equal*abs(first(c))
      do i = 1, model%nodes
        if (model%body(i) /= body .or. .not. is_free) cycle
        u = motions%displacement(model, i, k) - first
        is_free = norm2(u) <= equal*norm2(first)
      end do
    end do
  end function is_free
end module epcont_accuracy_body_shares
