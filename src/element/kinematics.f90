!> Behaviour of elements normal to the plane, and numbers of components of vectors and strains.
module epcont_element_kinematics
  implicit none
  private

  !> Plane strain; plane stress; axisymmetric, with x as the radius.
  integer, parameter, public :: plane_strain = 1, plane_stress = 2, axisymmetric = 3
  !> Directions of the plane: x and y (axisymmetric: radius and axis).
  integer, parameter, public :: directions = 2
  !> Components of strains and stresses: xx, yy, zz, xy (shear strain is engineering: twice the tensor's).
  integer, parameter, public :: components = 4
end module epcont_element_kinematics
