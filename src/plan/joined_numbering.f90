!> Numbers of the equations of all bodies as one system, where pairs join them (`linear/joined_contact.f90`).
!> SUPORT freedoms have equations too, and what gaps depend on stands where the dissection has it.
!>
!> A spring of this system is one of a pair or of a SUPORT freedom: a row of weights, whose product with
!> itself, times a stiffness, is added to the matrix.
module epcont_plan_joined_numbering
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_linalg_assembled, only: sparse_rows
  use epcont_model_model, only: model_type
  use epcont_plan_dissection, only: dissect, dissection
  implicit none
  private
  public :: number_joined, spring_rows

contains

  !> Number all free freedoms in nested fronts. Those that others follow, which are coupled with whole lines
  !! of nodes, come last.
  subroutine number_joined(model, equation, node, first)
    type(model_type), intent(in) :: model   !! the scene
    !> Of each freedom; of a tied one that of its leader; 0: held [directions, nodes]
    integer, allocatable, intent(out) :: equation(:, :)
    integer, allocatable, intent(out) :: node(:)     !! in the order of elimination [nodes]
    integer, allocatable, intent(out) :: first(:)    !! equation of each front, and one behind [fronts + 1]
    type(dissection) :: found
    integer :: i, last, p

    found = dissect(model, 2.0_wp*model%x(1, :) + model%x(2, :), [(i, i=1, model%nodes)], &
                    followed_nodes(model), new_incidence(model%nodes_of_pairs(), model%nodes))
    node = found%node
    allocate (equation(directions, model%nodes), source=0)
    allocate (first(size(found%first)), source=1)
    last = 0
    do p = 1, size(found%first) - 1
      do i = found%first(p), found%first(p + 1) - 1
        call number_node(node(i))
      end do
      first(p + 1) = last + 1
    end do
    first = pack(first, [first(2:) > first(:size(first) - 1), .true.])
    do i = 1, model%nodes
      equation(:, i) = [equation(1, model%leader(1, i)), equation(2, model%leader(2, i))]
    end do

  contains

    !> The free freedoms of a node are next.
    subroutine number_node(own)
      integer, intent(in) :: own
      integer :: c

      do c = 1, directions
        if (model%held(c, own) .or. model%leader(c, own) /= own) cycle
        last = last + 1
        equation(c, own) = last
      end do
    end subroutine number_node
  end subroutine number_joined

  !> Do others follow each node? [nodes]
  pure function followed_nodes(model) result(leads)
    type(model_type), intent(in) :: model
    logical :: leads(model%nodes)
    integer :: c, i

    leads = .false.
    do i = 1, model%nodes
      do c = 1, directions
        if (model%leader(c, i) /= i) leads(model%leader(c, i)) = .true.
      end do
    end do
  end function followed_nodes

  !> Springs of all pairs, then of all SUPORT freedoms, node by node.
  type(sparse_rows) function spring_rows(model, equation) result(spring)
    type(model_type), intent(in) :: model    !! the scene
    integer, intent(in) :: equation(:, :)    !! of each freedom, or 0 [directions, nodes]
    integer :: i, k, last

    allocate (spring%start(model%pairs + count(model%reference) + 1), source=1)
    allocate (spring%equation(directions*size(model%row_node) + count(model%reference)))
    allocate (spring%weight(size(spring%equation)))
    last = 0
    do k = 1, model%pairs
      do i = model%row_start(k), model%row_start(k + 1) - 1
        call put(equation(1, model%row_node(i)), model%row_weight(i)*model%normal(1, k))
        call put(equation(2, model%row_node(i)), model%row_weight(i)*model%normal(2, k))
      end do
      spring%start(k + 1) = last + 1
    end do
    associate (at_suport => pack(equation, model%reference))
      do i = 1, size(at_suport)
        call put(at_suport(i), 1.0_wp)
        spring%start(model%pairs + i + 1) = last + 1
      end do
    end associate
    spring%equation = spring%equation(:last)
    spring%weight = spring%weight(:last)

  contains

    !> One more entry of a row, unless the freedom is held.
    subroutine put(number, weight)
      integer, intent(in) :: number
      real(wp), intent(in) :: weight

      if (number == 0 .or. weight == 0.0_wp) return
      last = last + 1
      spring%equation(last) = number
      spring%weight(last) = weight
    end subroutine put
  end function spring_rows
end module epcont_plan_joined_numbering
