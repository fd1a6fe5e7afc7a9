!> What elements do across the plane.
module epcont_element_kinematics
  implicit none
  private

  !> Nothing; give way; or they are rings, x their radius.
  integer, parameter, public :: plane_strain = 1, plane_stress = 2, axisymmetric = 3
end module epcont_element_kinematics
