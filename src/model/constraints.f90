!> Supports of a model, and DOFs that depend on others.
module epcont_model_constraints
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle, linear_equation, spring_type, turning_platen
  implicit none
  private
  public :: constraints_type

  type :: constraints_type
    logical, allocatable :: held(:, :)          !! the DOF has a prescribed displacement [2, nodes]
    logical, allocatable :: still(:, :)         !! held, and not displaced in any load case [2, nodes]
    logical, allocatable :: reference(:, :)     !! SUPORT DOFs [2, nodes]
    !> Node whose displacement the DOF has: itself if it is not tied [2, nodes]
    integer, allocatable :: leader(:, :)
    integer, allocatable :: sum_of(:, :)        !! row of each DOF that is a sum, else 0 [2, nodes]
    !> Terms of each row; for the component `angle`, the node is the number of the platen [rows]
    type(linear_equation), allocatable :: sum(:)
    type(turning_platen), allocatable :: platen(:)    !! rotating rigid bodies (RBE2) [any]
    type(linear_equation), allocatable :: equation(:) !! between displacements [any]
    type(spring_type), allocatable :: spring(:)       !! [any]
  contains
    procedure :: is_held
    procedure :: is_tied
    procedure :: is_rigid
    procedure :: platen_of
  end type constraints_type

contains

  !> Is this DOF, or the master DOF that it depends on, fixed by a support?
  elemental logical function is_held(self, component, node)
    class(constraints_type), intent(in) :: self
    integer, intent(in) :: component, node   !! 1: x, 2: y

    is_held = self%held(component, self%leader(component, node))
  end function is_held

  !> Does one of these nodes depend on others, by RBE2 or MPC?
  pure logical function is_tied(self, node)
    class(constraints_type), intent(in) :: self
    integer, intent(in) :: node(:)   !! these nodes [any]

    is_tied = any(self%leader(1, node) /= node) .or. any(self%leader(2, node) /= node) .or. &
              any(self%sum_of(:, node) > 0)
  end function is_tied

  !> Do supports and RBE2 keep the distances between these nodes? In each direction, either all are fixed, or
  !! all depend on one node, or all rotate together.
  pure logical function is_rigid(self, node)
    class(constraints_type), intent(in) :: self
    integer, intent(in) :: node(:)   !! these nodes [any]
    integer :: c, platen(size(node))

    platen = [(self%platen_of(node(c)), c=1, size(node))]
    is_rigid = all(platen == platen(1)) .and. platen(1) > 0
    if (is_rigid) return
    is_rigid = .true.
    do c = 1, directions
      associate (leader => self%leader(c, node))
        is_rigid = is_rigid .and. (all(leader == leader(1)) .or. all(self%held(c, leader)))
      end associate
    end do
  end function is_rigid

  !> Number of the rotating platen that a node belongs to, 0 if absent.
  pure integer function platen_of(self, node) result(platen)
    class(constraints_type), intent(in) :: self
    integer, intent(in) :: node   !! index of the node

    platen = findloc(self%platen%leader, node, dim=1)
    if (self%sum_of(1, node) == 0) return
    associate (row => self%sum(self%sum_of(1, node)))
      if (size(row%node) == 0) return
      if (row%component(size(row%node)) == angle) platen = row%node(size(row%node))
    end associate
  end function platen_of
end module epcont_model_constraints
