!> Loads on a model at one point of the load path: at most times those at the end of a load case.
module epcont_model_load_set
  use epcont_base_kinds, only: wp
  use epcont_model_arrays, only: body_load
  implicit none
  private
  public :: load_set

  type :: load_set
    real(wp), allocatable :: load(:, :)         !! nodal forces of all loads [force] [2, nodes]
    real(wp), allocatable :: prescribed(:, :)   !! displacement of fixed DOFs [length] [2, nodes]
    !> Rigid-body displacement that supports prescribe, and the rest of the prescribed displacements
    !! [length] [2, nodes].
    real(wp), allocatable :: travel(:, :), beyond_travel(:, :)
    real(wp), allocatable :: rotation(:)        !! of supported RBE2 master nodes [radian] [platens]
    !> Temperature of the nodes of each element above the reference temperature of its section; not allocated:
    !! zero [temperature] [element's nodes, elements]
    real(wp), allocatable :: rise(:, :)
    !> Thermal strain of each point along each axis; not allocated if it is zero [points]
    real(wp), allocatable :: free_strain(:)
    type(body_load), allocatable :: body_load(:)   !! [any]
    real(wp), allocatable :: body_force(:, :)   !! part of `load` from body loads, if any [force] [2, nodes]
    !> Mass of each node by its shape functions, and its first moments about the node, for body loads; not
    !! allocated before they are needed [mass, mass*length, mass*length] [3, nodes]
    real(wp), allocatable :: mass(:, :)
  contains
    procedure :: set_between
  end type load_set

contains

  !> Set the loads between those at the start and at the end of a path, without `free_strain`.
  pure subroutine set_between(self, start, last, part)
    class(load_set), intent(inout) :: self
    type(load_set), intent(in) :: start   !! `load` not allocated: no loads
    type(load_set), intent(in) :: last
    real(wp), intent(in) :: part          !! part of the path, from 0 to 1

    call mix(start%load, last%load, part, self%load)
    call mix(start%prescribed, last%prescribed, part, self%prescribed)
    call mix(start%travel, last%travel, part, self%travel)
    call mix(start%beyond_travel, last%beyond_travel, part, self%beyond_travel)
    self%rotation = part*last%rotation
    self%body_load%factor = part*last%body_load%factor
    if (allocated(start%load)) then
      self%rotation = self%rotation + (1.0_wp - part)*start%rotation
      self%body_load%factor = self%body_load%factor + (1.0_wp - part)*start%body_load%factor
    end if
    call mix(start%rise, last%rise, part, self%rise)
    call mix(start%body_force, last%body_force, part, self%body_force)
  end subroutine set_between

  !> Find an array between two others; one that is not allocated is zero.
  pure subroutine mix(start, last, part, now)
    real(wp), allocatable, intent(in) :: start(:, :), last(:, :)
    real(wp), intent(in) :: part
    real(wp), allocatable, intent(inout) :: now(:, :)

    if (allocated(now)) deallocate (now)
    if (allocated(last)) now = part*last
    if (allocated(start) .and. allocated(last)) now = now + (1.0_wp - part)*start
    if (allocated(start) .and. .not. allocated(last)) now = (1.0_wp - part)*start
  end subroutine mix
end module epcont_model_load_set
