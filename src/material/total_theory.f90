!> Deformation (Hencky, "total") theory: deviators of stress and strain are proportional, mean parts elastic.
!>
!>     stress = K theta + (2 E_D/3) deviatoric strain,   E_D = sigma_i/e on the curve        (2-5), (2-6)
!>
!> Vectors of four components are xx, yy, zz, xy, with the tensor's shear strain.
module epcont_material_total_theory
  use epcont_base_kinds, only: wp
  use epcont_material_curve, only: curve_value, material_type
  use epcont_material_elasticity, only: equivalent_stress, isotropic_matrix
  implicit none
  private
  public :: response_type, respond, distance_from_curve, secant_matrix, tangent_matrix

  !> Steps for the strain across a plane-stress sheet; bisection alone would end after some 60.
  integer, parameter :: most_steps = 100

  !> What the material is at a strain.
  type :: response_type
    real(wp) :: stress(4) = 0.0_wp       !! [stress]
    real(wp) :: deviator(4) = 0.0_wp     !! of the strain
    real(wp) :: e = 0.0_wp               !! deviatoric equivalent strain
    type(curve_value) :: curve
  end type response_type

contains

  !> Stress and moduli at a strain; in a sheet the strain zz is found, whatever is given.
  pure function respond(material, strain) result(response)
    type(material_type), intent(in) :: material
    real(wp), intent(in) :: strain(4)      !! xx, yy, zz, xy (engineering)
    type(response_type) :: response

    if (material%sheet) then
      response = respond_in_space(material, [strain(:2), strain_across(material, strain), strain(4)])
      response%stress(3) = 0.0_wp
    else
      response = respond_in_space(material, strain)
    end if
  end function respond

  !> How far a stress is from that of the material: von Mises stress of the difference, over that of the curve there, or the yield
  !! stress below yield. (The mean parts are elastic in every law.)
  pure real(wp) function distance_from_curve(material, response, stress)
    type(material_type), intent(in) :: material   !! one that yields
    type(response_type), intent(in) :: response
    real(wp), intent(in) :: stress(4)

    distance_from_curve = equivalent_stress((stress - response%stress)/max(response%curve%modulus*response%e, material%stress(1)))
  end function distance_from_curve

  !> The same with the strain zz as it is given.
  pure function respond_in_space(material, strain) result(response)
    type(material_type), intent(in) :: material
    real(wp), intent(in) :: strain(4)
    type(response_type) :: response
    real(wp) :: mean

    mean = sum(strain(:3))/3.0_wp
    response%deviator = [strain(:3) - mean, 0.5_wp*strain(4)]
    response%e = sqrt((sum(response%deviator**2) + response%deviator(4)**2)*2.0_wp/3.0_wp)
    response%curve = material%at_strain(response%e)
    response%stress = 2.0_wp/3.0_wp*response%curve%modulus*response%deviator
    response%stress(:3) = response%stress(:3) + 3.0_wp*material%bulk*mean
  end function respond_in_space

  !> The strain across a sheet in plane stress, where the stress across vanishes. That stress rises with the strain,
  !! and has its zero between that of the elastic sheet and that of constant volume.
  pure function strain_across(material, strain) result(across)
    type(material_type), intent(in) :: material
    real(wp), intent(in) :: strain(4)
    real(wp) :: across
    type(response_type) :: response
    real(wp) :: elastic, low, high, next, rate
    integer :: step

    elastic = -(material%bulk - 2.0_wp*material%shear/3.0_wp)/(material%bulk + 4.0_wp*material%shear/3.0_wp)
    across = elastic*(strain(1) + strain(2))
    if (.not. material%yields) return
    low = min(across, -(strain(1) + strain(2)))
    high = max(across, -(strain(1) + strain(2)))
    do step = 1, most_steps
      response = respond_in_space(material, [strain(:2), across, strain(4)])
      if (.not. response%curve%yielded .and. step == 1) return
      if (response%stress(3) == 0.0_wp) return
      if (response%stress(3) > 0.0_wp) high = across
      if (response%stress(3) < 0.0_wp) low = across
      rate = material%bulk + 4.0_wp/9.0_wp*response%curve%modulus
      if (.not. material%paper_ratio) rate = rate + radial_stiffness(response)*response%deviator(3)**2
      next = across - response%stress(3)/rate
      if (next <= low .or. next >= high) next = 0.5_wp*(low + high)
      if (abs(next - across) <= epsilon(1.0_wp)*abs(next)) return
      across = next
    end do
  end function strain_across

  !> What the tangent has less than the secant along the deviator: (4/9) (h - E_D)/e**2 [stress].
  pure real(wp) function radial_stiffness(response)
    type(response_type), intent(in) :: response

    radial_stiffness = 0.0_wp
    if (response%curve%yielded) &
      radial_stiffness = 4.0_wp/9.0_wp*(response%curve%slope - response%curve%modulus)/response%e**2
  end function radial_stiffness

  !> D of stress = D strain (2-8) [stress] [4, 4].
  pure function secant_matrix(material, response) result(d)
    type(material_type), intent(in) :: material
    type(response_type), intent(in) :: response
    real(wp) :: d(4, 4)

    d = isotropic_matrix(material%bulk, response%curve%modulus/3.0_wp, material%sheet)
  end function secant_matrix

  !> D of d stress = D d strain, the consistent tangent [stress] [4, 4].
  pure function tangent_matrix(material, response) result(d)
    type(material_type), intent(in) :: material
    type(response_type), intent(in) :: response
    real(wp) :: d(4, 4)
    real(wp) :: across(4), radial
    integer :: j

    d = isotropic_matrix(material%bulk, response%curve%modulus/3.0_wp, .false.)
    radial = radial_stiffness(response)
    do j = 1, 4
      d(:, j) = d(:, j) + radial*response%deviator*response%deviator(j)
    end do
    if (.not. material%sheet) return
    ! The stress zz is zero: its strain is eliminated.
    across = d(:, 3)
    do j = 1, 4
      d(:, j) = d(:, j) - across*across(j)/across(3)
    end do
    d(3, :) = 0.0_wp
    d(:, 3) = 0.0_wp
  end function tangent_matrix
end module epcont_material_total_theory
