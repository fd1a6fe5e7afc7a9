!> What elements do across the plane, and how many components vectors and strains have in it.
module epcont_element_kinematics
  implicit none
  private

  !> Nothing; give way; or they are rings, x their radius.
  integer, parameter, public :: plane_strain = 1, plane_stress = 2, axisymmetric = 3
  !> Directions of the plane, x and y (of rings: radius and axis).
  integer, parameter, public :: directions = 2
  !> Of strains and stresses: xx, yy, zz, xy (of strains engineering: twice the tensor's).
  integer, parameter, public :: components = 4
end module epcont_element_kinematics
