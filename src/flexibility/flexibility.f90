!> What a unit force at one pair does to the gaps of all pairs, and what the rigid motions do to them.
module epcont_flexibility_flexibility
  use epcont_assembly_stiffness, only: body_stiffness
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_numbering, only: numbering_type
  implicit none
  private
  public :: add_body_flexibility, gap_opening, motion_columns, motion_resultants, pair_forces

contains

  !> Add one body's part of F = N K^-1 N' [length/force] [pairs, pairs].
  pure subroutine add_body_flexibility(model, numbering, b, stiffness, flexibility)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering
    integer, intent(in) :: b                       !! the body
    type(body_stiffness), intent(in) :: stiffness  !! factored
    real(wp), intent(inout) :: flexibility(:, :)
    real(wp), allocatable :: compliance(:, :), weight(:, :)
    integer, allocatable :: place(:, :)
    integer :: i, j, k, l

    if (numbering%body(b)%contact_equations + numbering%body(b)%border == 0) return
    call pair_weights(model, numbering, b, place, weight)
    compliance = stiffness%trailing_compliance(numbering%body(b)%contact_equations)
    do l = 1, model%pairs
      do j = 1, 4
        if (place(j, l) == 0) cycle
        do k = 1, model%pairs
          do i = 1, 4
            if (place(i, k) == 0) cycle
            flexibility(k, l) = flexibility(k, l) + weight(i, k)*weight(j, l)*compliance(place(i, k), place(j, l))
          end do
        end do
      end do
    end do
  end subroutine add_body_flexibility

  !> Rows of N in one body: the freedoms of nodes A and B by their place in the compliance, 0 where held or of
  !! another body, and their weights in the gap.
  pure subroutine pair_weights(model, numbering, b, place, weight)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering
    integer, intent(in) :: b
    integer, allocatable, intent(out) :: place(:, :)    !! [4, pairs]
    real(wp), allocatable, intent(out) :: weight(:, :)  !! [4, pairs]
    integer :: c, first, k, number, side

    allocate (place(4, model%pairs), source=0)
    allocate (weight(4, model%pairs))
    associate (body => numbering%body(b))
      first = body%equations - body%contact_equations
      do k = 1, model%pairs
        do side = 1, 2
          do c = 1, 2
            weight(2*side - 2 + c, k) = merge(-1.0_wp, 1.0_wp, side == 1)*model%normal(c, k)
            if (model%body(model%pair_node(side, k)) /= b) cycle
            number = numbering%equation(c, model%pair_node(side, k))
            if (number > 0) place(2*side - 2 + c, k) = number - first
            if (number < 0) place(2*side - 2 + c, k) = body%contact_equations - number
          end do
        end do
      end do
    end associate
  end subroutine pair_weights

  !> Opening of the gaps by displacements: N u [length] [pairs].
  pure function gap_opening(model, displacement) result(opening)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)  !! [2, nodes]
    real(wp), allocatable :: opening(:)
    integer :: k

    allocate (opening(model%pairs))
    do k = 1, model%pairs
      opening(k) = dot_product(model%normal(:, k), displacement(:, model%pair_node(2, k)) - &
                               displacement(:, model%pair_node(1, k)))
    end do
  end function gap_opening

  !> Forces of the pairs on the nodes: N' R [force] [2, nodes].
  pure function pair_forces(model, force) result(nodal)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: force(:)  !! [pairs]
    real(wp), allocatable :: nodal(:, :)
    integer :: k

    allocate (nodal(2, model%nodes), source=0.0_wp)
    do k = 1, model%pairs
      associate (a => model%pair_node(1, k), b => model%pair_node(2, k))
        nodal(:, b) = nodal(:, b) + force(k)*model%normal(:, k)
        nodal(:, a) = nodal(:, a) - force(k)*model%normal(:, k)
      end associate
    end do
  end function pair_forces

  !> A = -N Phi, the closing of the gaps by unit rigid motions [pairs, motions].
  pure function motion_columns(model, motions) result(columns)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    real(wp), allocatable :: columns(:, :)
    integer :: k, m

    allocate (columns(model%pairs, motions%count))
    do m = 1, motions%count
      do k = 1, model%pairs
        columns(k, m) = -dot_product(model%normal(:, k), motions%displacement(model, model%pair_node(2, k), m) - &
                                     motions%displacement(model, model%pair_node(1, k), m))
      end do
    end do
  end function motion_columns

  !> P = Phi' f, the loads along the free motions [motions].
  pure function motion_resultants(model, motions) result(resultant)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    real(wp), allocatable :: resultant(:)
    integer :: i, m

    allocate (resultant(motions%count), source=0.0_wp)
    do m = 1, motions%count
      do i = 1, model%nodes
        if (model%body(i) /= motions%body(m) .or. all(model%load(:, i) == 0.0_wp)) cycle
        resultant(m) = resultant(m) + dot_product(motions%displacement(model, i, m), model%load(:, i))
      end do
    end do
  end function motion_resultants
end module epcont_flexibility_flexibility
