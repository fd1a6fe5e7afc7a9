!> Loads of one load case on a model.
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
    !> Not allocated: the reference temperature everywhere [temperature] [nodes]
    real(wp), allocatable :: temperature(:)
    !> Thermal strain of each point along each axis; not allocated if it is zero [points]
    real(wp), allocatable :: free_strain(:)
    type(body_load), allocatable :: body_load(:)   !! [any]
    real(wp), allocatable :: body_force(:, :)   !! part of `load` from body loads, if any [force] [2, nodes]
    !> Mass of each node by its shape functions, and its first moments about the node, for body loads; not
    !! allocated before they are needed [mass, mass*length, mass*length] [3, nodes]
    real(wp), allocatable :: mass(:, :)
  end type load_set
end module epcont_model_load_set
