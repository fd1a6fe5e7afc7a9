!> Isotropic elasticity in the plane.
module epcont_material_elasticity
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: components
  implicit none
  private
  public :: elasticity, new_elasticity, cross_modulus, isotropic_matrix, equivalent_stress

  !> Elastic constants of a material.
  type :: elasticity
    real(wp) :: young = 1.0_wp   !! E [stress]
    real(wp) :: bulk = 1.0_wp    !! K [stress]
    real(wp) :: shear = 1.0_wp   !! G [stress]
    real(wp) :: shift = 0.0_wp   !! (1 - 2 nu)/(3E): eps_i = e + shift*sigma_i [1/stress]
  contains
    procedure :: elastic_work
  end type elasticity

contains

  !> Compute the constants from E [stress] and Poisson's ratio.
  pure type(elasticity) function new_elasticity(young, poisson)
    real(wp), intent(in) :: young, poisson   !! E [stress], nu

    new_elasticity = elasticity(young, bulk=young/(3.0_wp*(1.0_wp - 2.0_wp*poisson)), &
      shear=young/(2.0_wp*(1.0_wp + poisson)), shift=(1.0_wp - 2.0_wp*poisson)/(3.0_wp*young))
  end function new_elasticity

  !> Factor of a normal strain in the normal stresses of other axes: K - 2/3 G, less in plane stress, where zz
  !! is zero [stress].
  pure real(wp) function cross_modulus(bulk, shear, sheet) result(cross)
    real(wp), intent(in) :: bulk, shear   !! K, G [stress]
    logical, intent(in) :: sheet   !! plane stress

    cross = bulk - 2.0_wp*shear/3.0_wp
    if (sheet) cross = 2.0_wp*shear*cross/(cross + 2.0_wp*shear)
  end function cross_modulus

  !> Find D of stress = D strain, components xx, yy, zz, xy (engineering shear strain) [stress]. With G =
  !! E_D/3 it is the secant matrix (2-8). In plane stress, the stress zz is zero and its strain eliminated.
  pure function isotropic_matrix(bulk, shear, sheet) result(d)
    real(wp), intent(in) :: bulk, shear   !! K, G [stress]
    logical, intent(in) :: sheet   !! plane stress
    real(wp) :: d(components, components)
    real(wp) :: cross
    integer :: i, normals

    cross = cross_modulus(bulk, shear, sheet)
    normals = merge(2, 3, sheet)
    d = 0.0_wp
    d(:normals, :normals) = cross
    do i = 1, normals
      d(i, i) = cross + 2.0_wp*shear
    end do
    d(components, components) = shear
  end function isotropic_matrix

  !> Work of a stress in its elastic strains: twice the strain energy density [stress].
  pure real(wp) function elastic_work(self, stress)
    class(elasticity), intent(in) :: self
    real(wp), intent(in) :: stress(components)  !! xx, yy, zz, xy

    elastic_work = equivalent_stress(stress)**2/(3.0_wp*self%shear) + sum(stress(:3))**2/(9.0_wp*self%bulk)
  end function elastic_work

  !> Von Mises stress (2-1).
  pure real(wp) function equivalent_stress(stress)
    real(wp), intent(in) :: stress(components)  !! xx, yy, zz, xy

    equivalent_stress = sqrt(0.5_wp*((stress(1) - stress(2))**2 + (stress(2) - stress(3))**2 + &
        (stress(3) - stress(1))**2) + 3.0_wp*stress(4)**2)
  end function equivalent_stress
end module epcont_material_elasticity
