!> The answer to a scene: displacements, contact and stresses.
module epcont_result_answer
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_solution
  implicit none
  private
  public :: answer_type

  type :: answer_type
    real(wp), allocatable :: displacement(:, :)      !! [length] [2, nodes]
    real(wp), allocatable :: reaction(:, :)          !! of the supports [force] [2, nodes]
    real(wp), allocatable :: stress(:, :)            !! xx, yy, zz, xy [stress] [4, elements]
    real(wp), allocatable :: equivalent_stress(:)    !! von Mises [stress] [elements]
    real(wp), allocatable :: equivalent_strain(:)    !! [elements]
    type(contact_solution) :: contact
    real(wp), allocatable :: pressure(:)             !! at the pairs; negative: no boundary there [stress] [pairs]
    real(wp) :: condition = 1.0_wp                   !! of the stiffness, estimated in the 1-norm
  end type answer_type
end module epcont_result_answer
