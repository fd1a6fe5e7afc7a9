!> Result of a linear step: displacements, stresses in equilibrium, contact.
module epcont_linear_solved_state
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_solution
  use epcont_material_material_law, only: point_state
  implicit none
  private
  public :: force_change, relative_change, solved_state

  type :: solved_state
    real(wp), allocatable :: displacement(:, :)   !! [length] [directions, nodes]
    !> Displacements without the rigid-body displacements [length] [directions, nodes]
    real(wp), allocatable :: deformation(:, :)
    real(wp), allocatable :: strain(:, :)         !! xx, yy, zz, xy (engineering) [components, points]
    !> xx, yy, zz, xy, in equilibrium [stress] [components, points]
    real(wp), allocatable :: point_stress(:, :)
    !> Material states at this strain, if one yields [points]; not allocated: not computed yet
    type(point_state), allocatable :: point(:)
    type(contact_solution) :: contact
  end type solved_state

contains

  !> Largest change of a displacement, over the largest.
  pure real(wp) function relative_change(before, after, of) result(change)
    real(wp), intent(in) :: before(:, :), after(:, :), of(:, :)

    change = maxval(abs(after - before))/max(maxval(abs(of)), tiny(1.0_wp))
  end function relative_change

  !> Largest change of a contact force, over the largest; 0 without contact.
  pure real(wp) function force_change(before, after, of) result(change)
    type(contact_solution), intent(in) :: before, after, of

    change = 0.0_wp
    if (any(of%force > 0.0_wp)) change = maxval(abs(after%force - before%force))/maxval(of%force)
  end function force_change
end module epcont_linear_solved_state
