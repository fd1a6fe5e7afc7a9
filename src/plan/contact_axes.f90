!> DOFs that gaps depend on, and their directions.
!>
!> Most contact nodes have one normal, and gaps depend only on their displacement along it. The DOFs of such a
!> node are rotated: the first is along the normal, the second perpendicular to it. Then only the first is
!> needed of the inverse of the stiffness, which halves its order. If the normal is along x or y, nothing is
!> rotated. Nodes with several normals (corners, masters of curved contact), and nodes with supports or ties,
!> keep both DOFs.
!>
!> Only factored bodies use these axes: elsewhere displacements and forces are along x and y.
module epcont_plan_contact_axes
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: contact_axes, followed_nodes, new_contact_axes

  type :: contact_axes
    integer, allocatable :: pair(:)         !! first pair of each node; 0 if it has no pair [nodes]
    logical, allocatable :: wanted(:, :)    !! gaps depend on the DOF [directions, nodes]
    !> Index of the normal of each node; 0 if its DOFs are along x and y [nodes]
    integer, allocatable :: turn(:)
    !> Direction of the first DOF of each rotated node [directions, rotated nodes]
    real(wp), allocatable :: normal(:, :)
  contains
    procedure :: ask_nothing
    procedure :: along
    procedure :: back
    procedure :: turn_stiffness
  end type contact_axes

  !> Sine of the angle between unit vectors that differ only by rounding. Such components across the axis are
  !! left out.
  real(wp), parameter :: rounding = 8*epsilon(1.0_wp)

contains

  !> Find the axes of all nodes. Frictionless gaps depend on displacements along their normals; further
  !! directions of the nodes of a pair are to be added in `want`.
  function new_contact_axes(model, fixed) result(axes)
    type(model_type), intent(in) :: model
    !> The DOF has no equation: a support, or SUPORT [directions, nodes]
    logical, intent(in) :: fixed(:, :)
    type(contact_axes) :: axes
    !> First direction in which each node is needed, and whether another direction is needed too
    real(wp), allocatable :: first(:, :)
    logical, allocatable :: is_whole(:)
    logical, allocatable :: leads(:)        ! the node is a master, or has a spring
    integer :: i, k, node, turned

    allocate (axes%pair(model%mesh%nodes), axes%turn(model%mesh%nodes), source=0)
    allocate (axes%wanted(directions, model%mesh%nodes), is_whole(model%mesh%nodes), source=.false.)
    allocate (first(directions, model%mesh%nodes))
    do k = 1, model%contact%rows()
      do i = model%contact%row_start(k), model%contact%row_start(k + 1) - 1
        call want(model%contact%row_node(i), model%contact%normal(:, k))
      end do
    end do
    leads = followed_nodes(model)
    do k = 1, size(model%constraints%spring)
      leads(pack(model%constraints%spring(k)%node, model%constraints%spring(k)%node > 0)) = .true.
    end do
    turned = 0
    do node = 1, model%mesh%nodes
      if (axes%pair(node) == 0) cycle
      axes%wanted(:, node) = is_whole(node) .or. abs(first(:, node)) > rounding
      if (.not. all(axes%wanted(:, node)) .or. is_whole(node) .or. leads(node) .or. &
          any(model%constraints%leader(:, node) /= node .or. model%constraints%sum_of(:, node) > 0 .or. &
              fixed(:, node))) cycle
      turned = turned + 1
      axes%turn(node) = turned
      axes%wanted(:, node) = [.true., .false.]
      first(:, turned) = first(:, node)
    end do
    axes%normal = first(:, :turned)

  contains

    !> Record that the gap of pair k depends on the displacement of a node along a unit vector.
    subroutine want(node, direction)
      integer, intent(in) :: node
      real(wp), intent(in) :: direction(directions)

      if (axes%pair(node) == 0) then
        axes%pair(node) = k
        first(:, node) = direction
      else
        is_whole(node) = is_whole(node) .or. &
          abs(first(1, node)*direction(2) - first(2, node)*direction(1)) > rounding
      end if
    end subroutine want
  end function new_contact_axes

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
    leads(pack(model%constraints%sum%node, model%constraints%sum%component /= angle)) = .true.
  end function followed_nodes

  !> Let no gap depend on any DOF, with all DOFs along x and y.
  pure subroutine ask_nothing(self)
    class(contact_axes), intent(inout) :: self

    self%turn = 0
    self%wanted = .false.
    self%normal = self%normal(:, :0)
  end subroutine ask_nothing

  !> Components of a vector along the DOFs of a node. Rounding across the normal is set to zero, so that
  !! contact forces act only on the needed DOFs.
  pure function along(self, node, vector) result(own)
    class(contact_axes), intent(in) :: self
    integer, intent(in) :: node
    real(wp), intent(in) :: vector(directions)      !! in x and y
    real(wp) :: own(directions)

    own = vector
    if (self%turn(node) == 0) return
    associate (n => self%normal(:, self%turn(node)))
      own = [n(1)*vector(1) + n(2)*vector(2), n(1)*vector(2) - n(2)*vector(1)]
    end associate
    if (abs(own(2)) <= rounding*abs(own(1))) own(2) = 0.0_wp
  end function along

  !> A vector in x and y, from its components along the DOFs of a node.
  pure function back(self, node, own) result(vector)
    class(contact_axes), intent(in) :: self
    integer, intent(in) :: node
    real(wp), intent(in) :: own(directions)         !! from `along`
    real(wp) :: vector(directions)

    vector = own
    if (self%turn(node) == 0) return
    associate (n => self%normal(:, self%turn(node)))
      vector = [n(1)*own(1) - n(2)*own(2), n(2)*own(1) + n(1)*own(2)]
    end associate
  end function back

  !> Rotate the stiffness of an element to the DOFs of its nodes.
  pure subroutine turn_stiffness(self, node, n, k)
    class(contact_axes), intent(in) :: self
    integer, intent(in) :: node(:)                  !! nodes of the element, at least n/2
    integer, intent(in) :: n                        !! its DOFs
    real(wp), intent(inout) :: k(n, n)              !! along x and y; on exit along the DOFs
    real(wp) :: before(n)
    integer :: i, j

    if (size(self%normal, 2) == 0) return
    do i = 1, n/directions
      if (self%turn(node(i)) == 0) cycle
      j = directions*(i - 1) + 1
      associate (c => self%normal(1, self%turn(node(i))), s => self%normal(2, self%turn(node(i))))
        before = k(:, j)
        k(:, j) = c*before + s*k(:, j + 1)
        k(:, j + 1) = c*k(:, j + 1) - s*before
        before = k(j, :)
        k(j, :) = c*before + s*k(j + 1, :)
        k(j + 1, :) = c*k(j + 1, :) - s*before
      end associate
    end do
  end subroutine turn_stiffness
end module epcont_plan_contact_axes
