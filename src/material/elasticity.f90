!> Isotropic linear elasticity in the plane.
module epcont_material_elasticity
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: elastic_matrix, material_matrix, axial_stress, equivalent_stress

contains

  !> D of stress = D strain, components xx, yy, xy (engineering shear strain) [stress] [3, 3].
  pure function elastic_matrix(young, poisson, plane_strain) result(d)
    real(wp), intent(in) :: young, poisson
    logical, intent(in) :: plane_strain  !! else plane stress
    real(wp) :: d(3, 3)
    real(wp) :: shear, normal, cross

    shear = young/(2.0_wp*(1.0_wp + poisson))
    if (plane_strain) then
      cross = young*poisson/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson))
    else
      cross = young*poisson/(1.0_wp - poisson**2)
    end if
    normal = cross + 2.0_wp*shear
    d = reshape([normal, cross, 0.0_wp, cross, normal, 0.0_wp, 0.0_wp, 0.0_wp, shear], [3, 3])
  end function elastic_matrix

  !> D of an element [stress] [3, 3].
  pure function material_matrix(model, element) result(d)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element
    real(wp) :: d(3, 3)

    associate (s => model%section(element))
      d = elastic_matrix(model%young(s), model%poisson(s), model%plane_strain(s))
    end associate
  end function material_matrix

  !> Stress across the plane: 0 in plane stress.
  pure function axial_stress(poisson, plane_strain, stress) result(across)
    real(wp), intent(in) :: poisson
    logical, intent(in) :: plane_strain
    real(wp), intent(in) :: stress(3)  !! xx, yy, xy
    real(wp) :: across

    across = merge(poisson*(stress(1) + stress(2)), 0.0_wp, plane_strain)
  end function axial_stress

  !> Von Mises stress (2-1).
  pure function equivalent_stress(stress, across) result(equivalent)
    real(wp), intent(in) :: stress(3)  !! xx, yy, xy
    real(wp), intent(in) :: across     !! zz
    real(wp) :: equivalent

    equivalent = sqrt(0.5_wp*((stress(1) - stress(2))**2 + (stress(2) - across)**2 + (across - stress(1))**2) &
                      + 3.0_wp*stress(3)**2)
  end function equivalent_stress
end module epcont_material_elasticity
