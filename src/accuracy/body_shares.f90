!> Which resultants of contact on bodies an error of the mesh can change, and what each pair counts in them.
module epcont_accuracy_body_shares
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_result_body_force, only: body_force, shares_of_pairs
  implicit none
  private
  public :: find_shares

  !> Bodies up to which errors are estimated of what each bears: one costs as much as two load cases.
  integer, parameter, public :: most_bodies = 12

contains

  !> One column for the sum of all forces, then one for each resultant that may be off by itself; what two
  !! bodies exert on each other is one. Of bodies that no pair touches, though some might, nothing is known.
  pure subroutine find_shares(model, motions, touching, bodies, share, column)
    type(model_type), intent(in) :: model        !! the scene
    type(free_motions), intent(in) :: motions    !! of its bodies
    logical, intent(in) :: touching(:)           !! [pairs]
    type(body_force), intent(in) :: bodies(:)    !! those that have elements
    real(wp), allocatable, intent(out) :: share(:, :)   !! of a unit force at each pair [pairs, any]
    !> The column of each component; 0: loads alone make it; negative: not known [2, bodies].
    integer, allocatable, intent(out) :: column(:, :)
    real(wp), allocatable :: one(:)
    integer :: c, i, k

    allocate (share(model%pairs, 1), source=1.0_wp)
    allocate (column(2, size(bodies)), source=merge(-1, 0, size(bodies) > most_bodies))
    if (size(bodies) > most_bodies) return
    do i = 1, size(bodies)
      do c = merge(2, 1, model%has_rings()), 2
        if (is_free(model, motions, bodies(i)%body, c)) cycle
        one = shares_of_pairs(model, bodies(i)%body, c)
        associate (counts => abs(one) > least_difference)
          if (any(counts) .and. all(bodies(i)%resultant == 0.0_wp) .and. .not. any(counts .and. touching)) then
            column(c, i) = -1
            cycle
          end if
        end associate
        do k = 2, size(share, 2)
          if (any([all(abs(share(:, k) - one) <= least_difference), all(abs(share(:, k) + one) <= least_difference)])) exit
        end do
        if (k > size(share, 2)) share = reshape([share, one], [model%pairs, k])
        column(c, i) = k
      end do
    end do
  end subroutine find_shares

  !> Is a body free to move along a component? Then contact bears its loads that way. Motions are measured at
  !! SUPORT freedoms: that one may be a sum of some that turn the body.
  pure logical function is_free(model, motions, body, c)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    integer, intent(in) :: body, c
    real(wp), allocatable :: basis(:, :), rest(:, :)   !! displacements of its nodes [2, nodes]
    real(wp), allocatable :: moved(:, :, :)            !! orthonormal ones of its motions [2, nodes, any]
    integer, allocatable :: nodes(:)
    integer :: i, m

    nodes = pack([(i, i=1, model%nodes)], model%body == body)
    allocate (moved(2, size(nodes), 0))
    do m = 1, motions%count
      if (motions%body(m) /= body) cycle
      basis = reshape([(motions%displacement(model, nodes(i), m), i=1, size(nodes))], [2, size(nodes)])
      rest = across(basis)
      if (norm2(rest) > least_difference*norm2(basis)) &
        moved = reshape([moved, rest/norm2(rest)], [2, size(nodes), size(moved, 3) + 1])
    end do
    basis = spread(merge(1.0_wp, 0.0_wp, [1, 2] == c), 2, size(nodes))
    is_free = norm2(across(basis)) <= least_difference*norm2(basis)

  contains

    !> What none of the motions makes of a displacement; twice, for rounding.
    pure function across(displacement) result(rest)
      real(wp), intent(in) :: displacement(:, :)
      real(wp) :: rest(2, size(nodes))
      integer :: k

      rest = displacement
      do k = 1, 2*size(moved, 3)
        associate (along => moved(:, :, 1 + mod(k - 1, size(moved, 3))))
          rest = rest - sum(along*rest)*along
        end associate
      end do
    end function across
  end function is_free
end module epcont_accuracy_body_shares
