!> Deformation (Hencky, "total") theory: deviators of stress and strain are proportional, mean parts elastic.
!>
!>     stress = K theta + (2 E_D/3) deviatoric strain,   E_D = sigma_i/e on the curve        (2-5), (2-6)
!>
!> The state is a function of the strain alone, whatever was committed.
module epcont_material_total_theory
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: components
  use epcont_material_curve, only: deviatoric_curve
  use epcont_material_elasticity, only: isotropic_matrix
  use epcont_material_material_law, only: material_law, point_state
  implicit none
  private
  public :: total_theory

  !> Steps for the strain across a plane-stress sheet; bisection alone would end after some 60.
  integer, parameter :: most_steps = 100

  type, extends(material_law) :: total_theory
    type(deviatoric_curve) :: curve
  contains
    procedure :: update
    procedure :: tangent_matrix
  end type total_theory

contains

  !> The state at a strain.
  pure subroutine update(self, strain, committed, trial)
    class(total_theory), intent(in) :: self
    real(wp), intent(in) :: strain(components)      !! xx, yy, zz, xy
    type(point_state), intent(in) :: committed      !! without effect
    type(point_state), intent(out) :: trial         !! found
    real(wp) :: in_space(components)

    in_space = strain
    if (self%sheet) in_space(3) = strain_across()
    call find_state(in_space, trial)
    if (self%sheet) trial%stress(3) = 0.0_wp

  contains

    !> The state with the strain zz as it is given.
    pure subroutine find_state(strain, state)
      real(wp), intent(in) :: strain(components)
      type(point_state), intent(out) :: state
      real(wp) :: deviator(components)

      deviator = deviator_of(strain)
      state%across = strain(3)
      state%deviatoric = sqrt((deviator(1)**2 + deviator(2)**2 + deviator(3)**2 + deviator(4)**2 + &
                               deviator(4)**2)*2.0_wp/3.0_wp)
      state%curve_value = self%curve%at_strain(state%deviatoric)
      state%stress = 2.0_wp/3.0_wp*state%modulus*deviator
      state%stress(:3) = state%stress(:3) + 3.0_wp*self%bulk*(sum(strain(:3))/3.0_wp)
    end subroutine find_state

    !> The strain across a sheet in plane stress, where the stress across vanishes. That stress rises with the
    !! strain, and has its zero between that of the elastic sheet and that of constant volume.
    pure real(wp) function strain_across() result(across)
      type(point_state) :: state
      real(wp) :: deviator(components), elastic, low, high, next, rate
      integer :: step

      elastic = -(self%bulk - 2.0_wp*self%shear/3.0_wp)/(self%bulk + 4.0_wp*self%shear/3.0_wp)
      across = elastic*(strain(1) + strain(2))
      if (.not. self%yields) return
      low = min(across, -(strain(1) + strain(2)))
      high = max(across, -(strain(1) + strain(2)))
      do step = 1, most_steps
        call find_state([strain(:2), across, strain(4)], state)
        if (.not. state%yielded .and. step == 1) return
        if (state%stress(3) == 0.0_wp) return
        if (state%stress(3) > 0.0_wp) high = across
        if (state%stress(3) < 0.0_wp) low = across
        rate = self%bulk + 4.0_wp/9.0_wp*state%modulus
        if (.not. self%curve%paper_ratio) then
          deviator = deviator_of([strain(:2), across, strain(4)])
          rate = rate + radial_stiffness(state)*deviator(3)**2
        end if
        next = across - state%stress(3)/rate
        if (next <= low .or. next >= high) next = 0.5_wp*(low + high)
        if (abs(next - across) <= epsilon(1.0_wp)*abs(next)) return
        across = next
      end do
    end function strain_across
  end subroutine update

  !> Deviator of a strain, with the tensor's shear strain.
  pure function deviator_of(strain) result(deviator)
    real(wp), intent(in) :: strain(components)
    real(wp) :: deviator(components)

    deviator(:3) = strain(:3) - sum(strain(:3))/3.0_wp
    deviator(4) = 0.5_wp*strain(4)
  end function deviator_of

  !> What the tangent has less than the secant along the deviator: (4/9) (h - E_D)/e**2 [stress].
  pure real(wp) function radial_stiffness(state)
    type(point_state), intent(in) :: state

    radial_stiffness = 0.0_wp
    if (state%yielded) radial_stiffness = 4.0_wp/9.0_wp*(state%slope - state%modulus)/state%deviatoric**2
  end function radial_stiffness

  !> D of d stress = D d strain [stress].
  pure function tangent_matrix(self, strain, state) result(d)
    class(total_theory), intent(in) :: self
    real(wp), intent(in) :: strain(components)   !! xx, yy, zz, xy
    type(point_state), intent(in) :: state       !! that `update` has found there
    real(wp) :: d(components, components)
    real(wp) :: across(components), deviator(components), radial
    integer :: j

    d = isotropic_matrix(self%bulk, state%modulus/3.0_wp, .false.)
    deviator = deviator_of([strain(:2), state%across, strain(4)])
    radial = radial_stiffness(state)
    do j = 1, components
      d(:, j) = d(:, j) + radial*deviator*deviator(j)
    end do
    if (.not. self%sheet) return
    ! The stress zz is zero: its strain is eliminated.
    across = d(:, 3)
    do j = 1, components
      d(:, j) = d(:, j) - across*across(j)/across(3)
    end do
    d(3, :) = 0.0_wp
    d(:, 3) = 0.0_wp
  end function tangent_matrix
end module epcont_material_total_theory
