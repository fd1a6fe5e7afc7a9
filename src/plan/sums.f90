!> DOFs that are sums of equations (MPC, rotating RBE2): elements, pairs and springs at them act on these
!> equations.
!>
!> A spring belongs to the model, or to a pair or SUPORT DOF of joined bodies. It is a row of weights. The
!> outer product of the row with itself, times a stiffness, is added to the matrix.
module epcont_plan_sums
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_linalg_assembled, only: sparse_rows
  use epcont_model_arrays, only: angle
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_sums, find_terms, find_wanted, followed_nodes, put_pair, spring_rows

  !> Cosine between a normal and an axis that is only rounding: gaps do not depend on this DOF.
  real(wp), parameter :: rounding = 8*epsilon(1.0_wp)

contains

  !> Is each node the master of an RBE2, or does an MPC depend on it? [nodes]
  pure function followed_nodes(model) result(leads)
    type(model_type), intent(in) :: model
    logical :: leads(model%mesh%nodes)
    integer :: c, i

    leads = .false.
    do i = 1, model%mesh%nodes
      do c = 1, directions
        if (model%constraints%leader(c, i) /= i) leads(model%constraints%leader(c, i)) = .true.
      end do
    end do
    leads(model%constraints%platen%leader) = .true.
    do i = 1, size(model%constraints%sum)
      associate (sum => model%constraints%sum(i))
        leads(pack(sum%node, sum%component /= angle)) = .true.
      end associate
    end do
  end function followed_nodes

  !> Find the DOFs that gaps depend on: those of contact nodes along their normals, and those on which these
  !! depend.
  pure subroutine find_wanted(model, pair, wanted)
    type(model_type), intent(in) :: model
    integer, intent(inout) :: pair(:)        !! first pair of each node; 0 if it has no pair [nodes]
    !> Of x, y, and the angle of the platens that each node leads [angle, nodes]
    logical, intent(inout) :: wanted(:, :)
    integer :: c, i, k

    do k = 1, model%contact%rows()
      do i = model%contact%row_start(k), model%contact%row_start(k + 1) - 1
        associate (node => model%contact%row_node(i))
          if (pair(node) == 0) pair(node) = k
          wanted(:directions, node) = wanted(:directions, node) .or. &
                                           abs(model%contact%normal(:, k)) > rounding
        end associate
      end do
    end do
    associate (ties => model%constraints)
      do i = 1, model%mesh%nodes
        do c = 1, directions
          if (pair(i) == 0 .or. .not. wanted(c, i)) cycle
          wanted(c, ties%leader(c, i)) = .true.
          if (ties%sum_of(c, i) == 0) cycle
          associate (sum => ties%sum(ties%sum_of(c, i)))
            do k = 1, size(sum%node)
              if (sum%component(k) == angle) wanted(angle, ties%platen(sum%node(k))%leader) = .true.
              if (sum%component(k) /= angle) wanted(sum%component(k), sum%node(k)) = .true.
            end do
          end associate
        end do
      end do
    end associate
  end subroutine find_wanted

  !> Find the DOFs of some nodes that are sums of equations. A sum in which nothing is free gets no row.
  pure subroutine find_sums(model, nodes, angles, equation, tied)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)
    integer, intent(in) :: angles(:)             !! equation of each angle; 0 if it is not free [platens]
    !> Equations of free DOFs; 0 if they are not free. Sums get the negative of their row [directions, nodes
    !! of the model]
    integer, intent(inout) :: equation(:, :)
    type(sparse_rows), intent(out) :: tied
    type(sparse_rows) :: no_sums                 ! terms are not sums themselves
    integer, allocatable :: number(:)
    integer :: c, e, i, row

    allocate (tied%start(count(model%constraints%sum_of(:, nodes) > 0) + 1), source=1)
    allocate (tied%equation(0), tied%weight(0))
    row = 0
    do i = 1, size(nodes)
      do c = 1, directions
        associate (k => model%constraints%sum_of(c, nodes(i)), sum => model%constraints%sum)
          if (model%constraints%leader(c, nodes(i)) /= nodes(i) .or. k == 0) cycle
          number = 0*sum(k)%node
          do e = 1, size(number)
            associate (of => sum(k)%component(e), node => sum(k)%node(e))
              if (of == angle) number(e) = angles(node)
              if (of /= angle) number(e) = equation(of, node)
            end associate
          end do
          call put_row(no_sums, number, sum(k)%coefficient, row + 1, tied)
        end associate
        equation(c, nodes(i)) = 0
        if (tied%start(row + 2) == tied%start(row + 1)) cycle
        row = row + 1
        equation(c, nodes(i)) = -row
      end do
    end do
    tied%start = tied%start(:row + 1)
    tied%equation = tied%equation(:tied%start(row + 1) - 1)
    tied%weight = tied%weight(:tied%start(row + 1) - 1)
  end subroutine find_sums

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

  !> List the springs of the model, those of other bodies without entries. If bodies are joined, list those of
  !! all pairs and of all SUPORT DOFs (by nodes, then angles) before.
  pure type(sparse_rows) function spring_rows(model, joined, own, equation, angles, tied) result(spring)
    type(model_type), intent(in) :: model
    logical, intent(in) :: joined            !! all bodies form one system
    integer, intent(in) :: own(:)            !! nodes of the body
    integer, intent(in) :: equation(:, :)    !! [directions, nodes of the model]
    integer, intent(in) :: angles(:)         !! equation of each angle; 0 if it is not free [platens]
    type(sparse_rows), intent(in) :: tied    !! sums
    integer, allocatable :: number(:)
    integer :: i, k, row

    allocate (number(0))
    if (joined) number = [pack(equation, model%constraints%reference), &
                          pack(angles, model%constraints%platen%reference)]
    k = size(number) + size(model%constraints%spring) + merge(model%contact%rows(), 0, joined)
    allocate (spring%start(k + 1), source=1)
    allocate (spring%equation(0), spring%weight(0))
    row = 0
    if (joined) then
      do k = 1, model%contact%rows()
        row = row + 1
        call put_pair(model, k, 0, equation, tied, row, spring)
      end do
    end if
    do k = 1, size(number)
      row = row + 1
      call put_row(tied, number(k:k), [1.0_wp], row, spring)
    end do
    do k = 1, size(model%constraints%spring)
      associate (ends => model%constraints%spring(k))
        number = [(0, i=1, 2)]
        do i = 1, 2
          if (ends%node(i) > 0) number(i) = equation(ends%component(i), ends%node(i))
        end do
        if (model%mesh%body(maxval(ends%node)) /= model%mesh%body(own(1)) .and. .not. joined) number = 0
      end associate
      row = row + 1
      call put_row(tied, number, [-1.0_wp, 1.0_wp], row, spring)
    end do
    spring%equation = spring%equation(:spring%start(row + 1) - 1)
    spring%weight = spring%weight(:spring%start(row + 1) - 1)
  end function spring_rows

  !> Put the row of N of a pair: the weights of the displacements of its nodes in the change of its gap.
  pure subroutine put_pair(model, pair, body, equation, tied, row, rows)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    integer, intent(in) :: body              !! only nodes of this body; 0: of all bodies
    integer, intent(in) :: equation(:, :)    !! [directions, nodes of the model]
    type(sparse_rows), intent(in) :: tied    !! sums
    integer, intent(in) :: row               !! position of the row
    type(sparse_rows), intent(inout) :: rows
    integer, allocatable :: entry(:)
    real(wp) :: normal(directions)
    integer :: i

    entry = [(i, i=model%contact%row_start(pair), model%contact%row_start(pair + 1) - 1)]
    if (body > 0) entry = pack(entry, model%mesh%body(model%contact%row_node(entry)) == body)
    normal = merge(model%contact%normal(:, pair), 0.0_wp, abs(model%contact%normal(:, pair)) > rounding)
    associate (weight => model%contact%row_weight(entry))
      call put_row(tied, reshape(equation(:, model%contact%row_node(entry)), [directions*size(entry)]), &
                   [(weight(i)*normal, i=1, size(entry))], row, rows)
    end associate
  end subroutine put_pair

  !> Put a sum of weighted DOFs in a row, without fixed DOFs. The rows before it are complete.
  pure subroutine put_row(tied, number, weight, row, rows)
    type(sparse_rows), intent(in) :: tied      !! sums
    integer, intent(in) :: number(:)           !! of each DOF: an equation, 0, or minus a sum
    real(wp), intent(in) :: weight(:)
    integer, intent(in) :: row                 !! position of the row
    type(sparse_rows), intent(inout) :: rows   !! may have unused space
    integer, allocatable :: equation(:), freedom(:)
    real(wp), allocatable :: part(:)
    integer :: last

    call find_terms(tied, number, equation, freedom, part)
    part = part*weight(freedom)
    associate (counts => part /= 0.0_wp, from => rows%start(row))
      last = from + count(counts) - 1
      if (last > size(rows%equation)) then
        ! Doubled, so that few rows copy all of them.
        rows%equation = [rows%equation, rows%equation, equation]
        rows%weight = [rows%weight, rows%weight, part]
      end if
      rows%equation(from:last) = pack(equation, counts)
      rows%weight(from:last) = pack(part, counts)
      rows%start(row + 1) = last + 1
    end associate
  end subroutine put_row
end module epcont_plan_sums
