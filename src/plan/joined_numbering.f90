!> Equation numbers of all bodies as one system, joined by pairs (`linear/joined_rule.f90`). SUPORT DOFs
!> have equations too, and contact DOFs have the order of the dissection.
!>
!> A spring of this system belongs to a pair, a SUPORT DOF or the model. It is a row of weights. The outer
!> product of the row with itself, times a stiffness, is added to the matrix. Dependent DOFs (MPC, rotating
!> RBE2) are sums of equations: elements and springs at them act on these equations.
module epcont_plan_joined_numbering
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_linalg_assembled, only: sparse_rows
  use epcont_model_arrays, only: angle
  use epcont_model_model, only: model_type
  use epcont_plan_border, only: add_sums
  use epcont_plan_contact_axes, only: followed_nodes
  use epcont_plan_dissection, only: dissect, dissection
  implicit none
  private
  public :: find_terms, number_joined, spring_rows

contains

  !> Number all free DOFs in nested fronts: first the fronts into which no DOFs of pairs and SUPORT are
  !! eliminated. Master DOFs, which are coupled with whole lines of nodes, come last, with the angles of
  !! rotating RBE2.
  subroutine number_joined(model, equation, angles, tied, node, first, first_contact)
    type(model_type), intent(in) :: model
    !> Equation of each DOF; that of its master if it is dependent; 0 if fixed; minus a row of `tied` if it is
    !! a sum [directions, nodes]
    integer, allocatable, intent(out) :: equation(:, :)
    integer, intent(out) :: angles(:)                !! equation of each angle; 0 if fixed [platens]
    type(sparse_rows), intent(out) :: tied           !! DOFs that are sums of equations
    integer, allocatable, intent(out) :: node(:)     !! in the order of elimination [nodes]
    integer, allocatable, intent(out) :: first(:)    !! equation of each front, and one more [fronts + 1]
    integer, intent(out) :: first_contact            !! first equation of the other fronts
    type(dissection) :: found
    integer :: springs(0:model%mesh%nodes)   ! number of nodes with springs, up to a position in the order
    logical, allocatable :: acted(:)    ! pairs or SUPORT act on the node, or in the front
    integer, allocatable :: order(:)    ! of the fronts
    integer :: apart, begun, i, last, p

    found = dissect(model, 2.0_wp*model%mesh%x(1, :) + model%mesh%x(2, :), [(i, i=1, model%mesh%nodes)], &
                    followed_nodes(model), new_incidence(model%contact%nodes_of_rows(), model%mesh%nodes))
    acted = any(model%constraints%reference, dim=1)
    acted(model%contact%row_node) = .true.
    springs(0) = 0
    do i = 1, model%mesh%nodes
      springs(i) = springs(i - 1) + merge(1, 0, acted(found%node(i)))
    end do
    acted = springs(found%first(2:) - 1) > springs(found%below - 1)
    apart = count(.not. acted)
    order = [pack([(p, p=1, size(acted))], .not. acted), pack([(p, p=1, size(acted))], acted)]
    allocate (equation(directions, model%mesh%nodes), source=0)
    angles = 0
    allocate (node(model%mesh%nodes), first(size(order) + 1))
    begun = 0
    last = 0
    first_contact = 0
    do p = 1, size(order)
      if (p == apart + 1) first_contact = last + 1
      first(p) = last + 1
      do i = found%first(order(p)), found%first(order(p) + 1) - 1
        begun = begun + 1
        node(begun) = found%node(i)
        call number_node(node(begun))
      end do
    end do
    first(p) = last + 1
    first = pack(first, [first(2:) > first(:size(first) - 1), .true.])
    ! Component by component: gfortran 12 leaves empty ones of a structure constructor unallocated.
    allocate (tied%start(1), source=1)
    allocate (tied%equation(0), tied%weight(0))
    call add_sums(model, [(i, i=1, model%mesh%nodes)], angles, equation, tied)
    do i = 1, model%mesh%nodes
      equation(:, i) = [equation(1, model%constraints%leader(1, i)), &
                        equation(2, model%constraints%leader(2, i))]
    end do

  contains

    !> Number the free DOFs of a node, and its angle if it is the master of an RBE2.
    subroutine number_node(own)
      integer, intent(in) :: own
      integer :: c, k

      do c = 1, directions
        if (model%constraints%held(c, own) .or. model%constraints%leader(c, own) /= own .or. &
            model%constraints%sum_of(c, own) > 0) cycle
        last = last + 1
        equation(c, own) = last
      end do
      do k = 1, size(angles)
        if (model%constraints%platen(k)%leader /= own .or. model%constraints%platen(k)%held) cycle
        last = last + 1
        angles(k) = last
      end do
    end subroutine number_node
  end subroutine number_joined

  !> Find the equations of which the DOFs of an element are sums: for each term the equation, the DOF of the
  !! element, and the weight.
  pure subroutine find_terms(tied, number, equation, freedom, weight)
    type(sparse_rows), intent(in) :: tied     !! sums
    integer, intent(in) :: number(:)          !! of each DOF: an equation, 0, or minus a sum
    integer, allocatable, intent(out) :: equation(:), freedom(:)   !! [terms]
    real(wp), allocatable, intent(out) :: weight(:)                !! [terms]
    integer :: i

    allocate (equation(0), freedom(0), weight(0))
    do i = 1, size(number)
      if (number(i) > 0) then
        equation = [equation, number(i)]
        weight = [weight, 1.0_wp]
      else if (number(i) < 0) then
        associate (from => tied%start(-number(i)), to => tied%start(1 - number(i)) - 1)
          equation = [equation, tied%equation(from:to)]
          weight = [weight, tied%weight(from:to)]
        end associate
      end if
      freedom = [freedom, spread(i, 1, size(equation) - size(freedom))]
    end do
  end subroutine find_terms

  !> List the springs of all pairs, of all SUPORT DOFs (by nodes, then angles), and of the model.
  type(sparse_rows) function spring_rows(model, equation, angles, tied) result(spring)
    type(model_type), intent(in) :: model
    integer, intent(in) :: equation(:, :)    !! from `number_joined` [directions, nodes]
    integer, intent(in) :: angles(:)         !! from `number_joined` [platens]
    type(sparse_rows), intent(in) :: tied    !! from `number_joined`
    integer :: i, k, last, longest, row

    longest = maxval([1, tied%start(2:) - tied%start(:size(tied%start) - 1)])   ! entries of a DOF
    associate (suports => count(model%constraints%reference) + count(model%constraints%platen%reference))
      allocate (spring%start(model%contact%rows() + suports + size(model%constraints%spring) + 1), source=1)
      k = longest*(directions*size(model%contact%row_node) + suports + 2*size(model%constraints%spring))
      allocate (spring%equation(k), spring%weight(k))
    end associate
    row = 0
    last = 0
    do k = 1, model%contact%rows()
      do i = model%contact%row_start(k), model%contact%row_start(k + 1) - 1
        call put(equation(1, model%contact%row_node(i)), &
                 model%contact%row_weight(i)*model%contact%normal(1, k))
        call put(equation(2, model%contact%row_node(i)), &
                 model%contact%row_weight(i)*model%contact%normal(2, k))
      end do
      call end_row()
    end do
    associate (at_suport => [pack(equation, model%constraints%reference), &
                             pack(angles, model%constraints%platen%reference)])
      do i = 1, size(at_suport)
        call put(at_suport(i), 1.0_wp)
        call end_row()
      end do
    end associate
    do k = 1, size(model%constraints%spring)
      do i = 1, 2
        if (model%constraints%spring(k)%node(i) > 0) &
          call put(equation(model%constraints%spring(k)%component(i), model%constraints%spring(k)%node(i)), &
                   2*i - 3.0_wp)
      end do
      call end_row()
    end do
    spring%equation = spring%equation(:last)
    spring%weight = spring%weight(:last)

  contains

    !> Add an entry to a row, or all entries of a sum; no entry if the DOF is fixed.
    recursive subroutine put(number, weight)
      integer, intent(in) :: number
      real(wp), intent(in) :: weight
      integer :: e

      if (number == 0 .or. weight == 0.0_wp) return
      if (number < 0) then
        do e = tied%start(-number), tied%start(1 - number) - 1
          call put(tied%equation(e), weight*tied%weight(e))
        end do
        return
      end if
      last = last + 1
      spring%equation(last) = number
      spring%weight(last) = weight
    end subroutine put

    !> Begin the next row.
    subroutine end_row()
      row = row + 1
      spring%start(row + 1) = last + 1
    end subroutine end_row
  end function spring_rows
end module epcont_plan_joined_numbering
