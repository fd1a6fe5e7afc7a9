!> What a material is asked: from a strain, and the state that it committed itself to before, the trial state
!> there, with the stress; and how the stress changes about it. A law is one file that extends this type, and
!> a line in `scene_materials.f90`.
!>
!> Strains and stresses are xx, yy, zz, xy (engineering shear strain). In a sheet (plane stress) the strain zz
!> is found, whatever is given.
module epcont_material_material_law
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: components
  use epcont_material_curve, only: curve_value
  use epcont_material_elasticity, only: elasticity, equivalent_stress, isotropic_matrix
  implicit none
  private
  public :: material_law, point_state

  !> The material at an integration point.
  type, extends(curve_value) :: point_state
    real(wp) :: stress(components) = 0.0_wp   !! [stress]
    real(wp) :: across = 0.0_wp               !! strain zz
    real(wp) :: deviatoric = 0.0_wp           !! equivalent deviatoric strain e, at which the curve is taken
  end type point_state

  !> The law of a section, with its elastic part.
  type, abstract, extends(elasticity) :: material_law
    logical :: sheet = .false.         !! plane stress
    logical :: yields = .false.
    real(wp) :: yield_stress = 0.0_wp  !! [stress]
  contains
    procedure(update_state), deferred :: update
    procedure :: secant_matrix
    procedure(matrix_at), deferred :: tangent_matrix
    procedure :: distance
  end type material_law

  abstract interface
    !> The state at a strain.
    pure subroutine update_state(self, strain, committed, trial)
      import :: components, material_law, point_state, wp
      class(material_law), intent(in) :: self
      real(wp), intent(in) :: strain(components)
      type(point_state), intent(in) :: committed   !! at the end of the last increment of the loads
      type(point_state), intent(out) :: trial
    end subroutine update_state

    !> D of d stress = D d strain about a state that has yielded, consistent with `update` [stress].
    pure function matrix_at(self, strain, state) result(d)
      import :: components, material_law, point_state, wp
      class(material_law), intent(in) :: self
      real(wp), intent(in) :: strain(components)
      type(point_state), intent(in) :: state       !! that `update` has found there
      real(wp) :: d(components, components)
    end function matrix_at
  end interface

contains

  !> D of stress = D strain (2-8) [stress].
  pure function secant_matrix(self, state) result(d)
    class(material_law), intent(in) :: self
    type(point_state), intent(in) :: state   !! that `update` has found
    real(wp) :: d(components, components)

    d = isotropic_matrix(self%bulk, state%modulus/3.0_wp, self%sheet)
  end function secant_matrix

  !> How far a stress is from that of the material: von Mises stress of the difference, over that of the curve
  !! there, or the yield stress below yield. (The mean parts are elastic in every law.)
  pure real(wp) function distance(self, state, stress)
    class(material_law), intent(in) :: self      !! one that yields
    type(point_state), intent(in) :: state       !! that `update` has found
    real(wp), intent(in) :: stress(components)   !! [stress]

    distance = equivalent_stress((stress - state%stress)/max(state%modulus*state%deviatoric, &
        self%yield_stress))
  end function distance
end module epcont_material_material_law
