!> Rigid parts of the bodies, as far as their free motions are concerned.
!>
!> Elements that share two nodes turn as one; where parts share a single node they are hinged. A node without
!> elements is a part that cannot turn.
module epcont_plan_rigid_parts
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_element_kinematics, only: axisymmetric
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: rigid_parts, find_rigid_parts

  type :: rigid_parts
    integer :: count = 0
    integer, allocatable :: of_node(:)      !! a part of each node [nodes]
    integer, allocatable :: body(:)         !! of each part [count]
    logical, allocatable :: turns(:)        !! the part can turn [count]
    logical, allocatable :: ring(:)         !! the part can move along y alone [count]
    integer, allocatable :: hinge(:, :)     !! node, part, other part of each hinge [3, hinges]
    real(wp), allocatable :: centre(:, :)   !! of each body [length] [2, bodies]
    real(wp), allocatable :: extent(:)      !! of each body, largest half width [length] [bodies]
  contains
    procedure :: row
    procedure :: turn
  end type rigid_parts

contains

  !> The rigid parts of all bodies, with their hinges.
  pure function find_rigid_parts(model) result(parts)
    type(model_type), intent(in) :: model   !! the scene
    type(rigid_parts) :: parts
    integer, allocatable :: of_element(:)
    integer :: e, i, solid

    call join_elements(model, of_element, solid)
    parts%count = solid
    allocate (parts%of_node(model%nodes))
    do i = 1, model%nodes
      if (model%around%start(i) < model%around%start(i + 1)) then
        parts%of_node(i) = of_element(model%around%group(model%around%start(i)))
      else
        parts%count = parts%count + 1
        parts%of_node(i) = parts%count
      end if
    end do
    parts%turns = [(i <= solid, i=1, parts%count)]
    allocate (parts%body(parts%count))
    allocate (parts%ring(parts%count), source=.false.)
    parts%body(parts%of_node) = model%body
    do e = 1, model%elements
      parts%body(of_element(e)) = model%body(model%connectivity(1, e))
      parts%ring(of_element(e)) = model%kinematics(model%section(e)) == axisymmetric
    end do
    call find_hinges(model, of_element, parts)
    call measure(model, parts)
  end function find_rigid_parts

  !> Where parts share a single node.
  pure subroutine find_hinges(model, of_element, parts)
    type(model_type), intent(in) :: model
    integer, intent(in) :: of_element(:)    !! the part of each element
    type(rigid_parts), intent(inout) :: parts
    integer :: hinges, i, k

    allocate (parts%hinge(3, size(model%around%group)))
    hinges = 0
    do i = 1, model%nodes
      associate (around => model%around%group, first => model%around%start(i))
        do k = first, model%around%start(i + 1) - 1
          if (of_element(around(k)) == parts%of_node(i)) cycle
          if (any(of_element(around(first:k - 1)) == of_element(around(k)))) cycle
          hinges = hinges + 1
          parts%hinge(:, hinges) = [i, parts%of_node(i), of_element(around(k))]
        end do
      end associate
    end do
    parts%hinge = parts%hinge(:, :hinges)
  end subroutine find_hinges

  !> Number the sets of elements that share two nodes.
  pure subroutine join_elements(model, of_element, count)
    type(model_type), intent(in) :: model
    integer, allocatable, intent(out) :: of_element(:)
    integer, intent(out) :: count
    type(partition) :: sets
    !> The last element with which each was found to share a node [elements]
    integer, allocatable :: met_by(:)
    integer :: e, j, k, neighbour

    sets = new_partition(model%elements)
    allocate (met_by(model%elements), source=0)
    do e = 1, model%elements
      do k = 1, model%order(e)
        associate (node => model%connectivity(k, e))
          do j = model%around%start(node), model%around%start(node + 1) - 1
            neighbour = model%around%group(j)
            if (neighbour >= e) exit
            if (met_by(neighbour) == e) call sets%join(e, neighbour)
            met_by(neighbour) = e
          end do
        end associate
      end do
    end do
    call sets%numbers(of_element, count)
  end subroutine join_elements

  !> Centre and extent of each body.
  pure subroutine measure(model, parts)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(inout) :: parts
    real(wp), allocatable :: low(:, :), high(:, :)
    integer :: i

    allocate (low(2, model%bodies), source=huge(1.0_wp))
    allocate (high(2, model%bodies), source=-huge(1.0_wp))
    do i = 1, model%nodes
      low(:, model%body(i)) = min(low(:, model%body(i)), model%x(:, i))
      high(:, model%body(i)) = max(high(:, model%body(i)), model%x(:, i))
    end do
    parts%centre = 0.5_wp*low + 0.5_wp*high
    parts%extent = maxval(0.5_wp*high - 0.5_wp*low, dim=1)
    where (parts%extent <= 0.0_wp) parts%extent = 1.0_wp
  end subroutine measure

  !> Displacement of component c at a place of a body by unit motions of the part it belongs to: along x,
  !! along y, and a turn that moves the body's extent by one.
  pure function row(self, model, node, c)
    class(rigid_parts), intent(in) :: self
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: node, c   !! the place, and component
    real(wp) :: row(3)

    associate (turned => self%turn(model, node))
      row = [merge(1.0_wp, 0.0_wp, c == 1), merge(0.0_wp, 1.0_wp, c == 1), turned(c)]
    end associate
  end function row

  !> Displacement of a place of a body by the turn that moves the body's extent by one.
  pure function turn(self, model, node)
    class(rigid_parts), intent(in) :: self
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: node   !! the place
    real(wp) :: turn(2)

    associate (b => model%body(node))
      turn = [-(model%x(2, node) - self%centre(2, b)), model%x(1, node) - self%centre(1, b)]/self%extent(b)
    end associate
  end function turn
end module epcont_plan_rigid_parts
