!> Rigid parts of the bodies, for their rigid-body modes.
!>
!> Elements that share two nodes rotate together. Parts that share a single node are hinged there. A node
!> without elements is a part that cannot rotate. The angle of a rotating platen is a part that can only
!> rotate.
module epcont_plan_rigid_parts
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_element_kinematics, only: axisymmetric, directions
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: rigid_parts, find_rigid_parts

  !> Unknowns of a part: displacements along x and y, rotation.
  integer, parameter, public :: part_motions = directions + 1

  type :: rigid_parts
    integer :: count = 0
    integer, allocatable :: of_node(:)      !! part of each node [nodes]
    integer, allocatable :: body(:)         !! body of each part [count]
    integer, allocatable :: own(:)          !! number of each part among the parts of its body [count]
    !> Axisymmetric parts do not move along x or rotate; nodes without elements do not rotate [part_motions,
    !! count]
    logical, allocatable :: cannot(:, :)
    integer, allocatable :: hinge(:, :)     !! node, part, other part of each hinge [3, hinges]
    integer, allocatable :: of_platen(:)    !! part of each rotating platen [platens]
    real(wp), allocatable :: centre(:, :)   !! of each body [length] [directions, bodies]
    real(wp), allocatable :: extent(:)      !! of each body, largest half width [length] [bodies]
  contains
    procedure :: column
    procedure :: rows
    procedure :: turn
  end type rigid_parts

contains

  !> Find the rigid parts of all bodies, and their hinges.
  function find_rigid_parts(model) result(parts)
    type(model_type), intent(in) :: model
    type(rigid_parts) :: parts
    integer, allocatable :: of_element(:)   ! the part of each element
    integer :: e, i, points, solid

    call join_elements()
    parts%count = solid
    allocate (parts%of_node(model%mesh%nodes))
    do i = 1, model%mesh%nodes
      if (model%mesh%around%start(i) < model%mesh%around%start(i + 1)) then
        parts%of_node(i) = of_element(model%mesh%around%group(model%mesh%around%start(i)))
      else
        parts%count = parts%count + 1
        parts%of_node(i) = parts%count
      end if
    end do
    points = parts%count
    parts%count = points + size(model%constraints%platen)
    parts%of_platen = [(i, i=points + 1, parts%count)]
    allocate (parts%body(parts%count))
    allocate (parts%cannot(part_motions, parts%count), source=.false.)
    parts%cannot(part_motions, solid + 1:points) = .true.
    parts%cannot(:directions, points + 1:) = .true.
    parts%body(parts%of_node) = model%mesh%body
    parts%body(parts%of_platen) = model%mesh%body(model%constraints%platen%leader)
    do e = 1, model%mesh%elements
      parts%body(of_element(e)) = model%mesh%body(model%mesh%connectivity(1, e))
      if (model%sections%kinematics(model%mesh%section(e)) == axisymmetric) &
        parts%cannot(::directions, of_element(e)) = .true.
    end do
    call number_parts()
    call find_hinges()
    call measure()

  contains

    !> Number the parts of each body.
    subroutine number_parts()
      integer :: last(model%mesh%bodies), k

      last = 0
      allocate (parts%own(parts%count))
      do k = 1, parts%count
        last(parts%body(k)) = last(parts%body(k)) + 1
        parts%own(k) = last(parts%body(k))
      end do
    end subroutine number_parts

    !> Number sets of elements that share two nodes.
    subroutine join_elements()
      type(partition) :: sets
      integer, allocatable :: met_by(:)   ! the last element with which each was found to share a node
      integer :: j, k, neighbour, node

      sets = new_partition(model%mesh%elements)
      allocate (met_by(model%mesh%elements), source=0)
      do e = 1, model%mesh%elements
        do k = 1, model%mesh%node_count(e)
          node = model%mesh%connectivity(k, e)
          do j = model%mesh%around%start(node), model%mesh%around%start(node + 1) - 1
            neighbour = model%mesh%around%group(j)
            if (neighbour >= e) exit
            if (met_by(neighbour) == e) call sets%join(e, neighbour)
            met_by(neighbour) = e
          end do
        end do
      end do
      call sets%numbers(of_element, solid)
    end subroutine join_elements

    !> Find nodes that several parts share.
    subroutine find_hinges()
      integer :: here, hinges, k
      integer, allocatable :: met(:)   ! parts of the elements at a node

      allocate (parts%hinge(3, size(model%mesh%around%group)))
      hinges = 0
      do i = 1, model%mesh%nodes
        here = parts%of_node(i)
        met = of_element(model%mesh%around%of(i))
        do k = 1, size(met)
          if (met(k) == here .or. any(met(:k - 1) == met(k))) cycle
          hinges = hinges + 1
          parts%hinge(:, hinges) = [i, here, met(k)]
        end do
      end do
      parts%hinge = parts%hinge(:, :hinges)
    end subroutine find_hinges

    !> Measure centre and extent of the elements of each body. A body without elements does not rotate: it
    !! gets the centre 0 and the extent 1.
    subroutine measure()
      real(wp), dimension(directions, model%mesh%bodies) :: low, high
      integer, allocatable :: node(:)

      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      node = model%mesh%around%members()
      do i = 1, size(node)
        associate (b => model%mesh%body(node(i)))
          low(:, b) = min(low(:, b), model%mesh%x(:, node(i)))
          high(:, b) = max(high(:, b), model%mesh%x(:, node(i)))
        end associate
      end do
      parts%centre = 0.5_wp*low + 0.5_wp*high
      parts%extent = maxval(0.5_wp*high - 0.5_wp*low, dim=1)
      where (parts%extent <= 0.0_wp) parts%extent = 1.0_wp
    end subroutine measure
  end function find_rigid_parts

  !> The column before those of a part, in rows with three columns for each part of its body.
  pure integer function column(self, part)
    class(rigid_parts), intent(in) :: self
    integer, intent(in) :: part

    column = part_motions*(self%own(part) - 1)
  end function column

  !> Displacements of a node due to unit displacements and rotation of its part [directions, part_motions].
  pure function rows(self, model, node)
    class(rigid_parts), intent(in) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    real(wp) :: rows(directions, part_motions)

    rows = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, self%turn(model, node)], shape(rows))
  end function rows

  !> Displacement of a node due to the rotation that moves the extent of its body by one; zero if its part
  !! cannot rotate.
  pure function turn(self, model, node)
    class(rigid_parts), intent(in) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    real(wp) :: turn(directions)

    turn = 0.0_wp
    if (self%cannot(part_motions, self%of_node(node))) return
    associate (b => model%mesh%body(node))
      turn = [-(model%mesh%x(2, node) - self%centre(2, b)), &
              model%mesh%x(1, node) - self%centre(1, b)]/self%extent(b)
    end associate
  end function turn
end module epcont_plan_rigid_parts
