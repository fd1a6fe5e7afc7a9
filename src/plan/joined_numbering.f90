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

  !> Number all free freedoms in nested fronts: first those into which nothing is eliminated that pairs and
  !! SUPORT freedoms act on. Freedoms that others follow, which are coupled with whole lines of nodes, come
  !! last.
  subroutine number_joined(model, equation, node, first, first_contact)
    type(model_type), intent(in) :: model   !! the scene
    !> Of each freedom; of a tied one that of its leader; 0: held [directions, nodes]
    integer, allocatable, intent(out) :: equation(:, :)
    integer, allocatable, intent(out) :: node(:)     !! in the order of elimination [nodes]
    integer, allocatable, intent(out) :: first(:)    !! equation of each front, and one behind [fronts + 1]
    integer, intent(out) :: first_contact            !! first equation of the others
    type(dissection) :: found
    integer :: springs(0:model%nodes)   ! nodes that they act on so far in the order
    logical, allocatable :: acted(:)    ! springs act on what is eliminated into the front
    integer, allocatable :: order(:)    ! of the fronts
    integer :: apart, begun, i, last, p

    found = dissect(model, 2.0_wp*model%x(1, :) + model%x(2, :), [(i, i=1, model%nodes)], &
                    followed_nodes(model), new_incidence(model%nodes_of_pairs(), model%nodes))
    acted = acted_on(model)
    springs(0) = 0
    do i = 1, model%nodes
      springs(i) = springs(i - 1) + merge(1, 0, acted(found%node(i)))
    end do
    acted = springs(found%first(2:) - 1) > springs(found%below - 1)
    apart = count(.not. acted)
    order = [pack([(p, p=1, size(acted))], .not. acted), pack([(p, p=1, size(acted))], acted)]
    allocate (equation(directions, model%nodes), source=0)
    allocate (node(model%nodes), first(size(order) + 1))
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

  !> Do pairs or SUPORT freedoms act on each node? [nodes]
  pure function acted_on(model) result(acts)
    type(model_type), intent(in) :: model
    logical :: acts(model%nodes)

    acts = any(model%reference, dim=1)
    acts(model%row_node) = .true.
  end function acted_on

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
