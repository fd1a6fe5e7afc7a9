!> Von Mises yield with isotropic hardening along the uniaxial curve of the material. The mean stress is
!> elastic. The stress deviator is parallel to the strain deviator minus the committed plastic strain:
!>
!>     stress = K theta + (2 E_D/3) (deviatoric strain - plastic strain),   E_D = sigma_i/e    (2-5), (2-6)
!>
!> From the virgin state this is deformation ("total") theory. From a committed state it is one backward Euler
!> increment of flow theory, with radial return to the curve.
!>
!> Strains and stresses are xx, yy, zz, xy (engineering shear strain). In plane stress the strain zz is
!> computed; its input is ignored.
module epcont_material_material_law
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: rounded_off
  use epcont_element_kinematics, only: components
  use epcont_material_curve, only: curve_value, deviatoric_curve
  use epcont_material_elasticity, only: elasticity, equivalent_stress, isotropic_matrix
  implicit none
  private
  public :: material_law, plastic_history, point_state

  !> Largest number of steps for the strain zz in plane stress; bisection alone needs about 60.
  integer, parameter :: most_steps = 100

  !> Plastic history of a point, after complete increments.
  type :: plastic_history
    real(wp) :: strain(components) = 0.0_wp   !! plastic strain, a deviator
    real(wp) :: accumulated = 0.0_wp          !! equivalent plastic strain
  end type plastic_history

  !> State of the material at an integration point.
  type, extends(curve_value) :: point_state
    real(wp) :: stress(components) = 0.0_wp   !! [stress]
    real(wp) :: across = 0.0_wp               !! strain zz
    !> Deviator of the strain minus committed plastic strain and back strain (`back_strain`), with the
    !! tensor's shear strain, and its equivalent strain e
    real(wp) :: deviator(components) = 0.0_wp, deviatoric = 0.0_wp
    logical :: plastic = .false.              !! it yields, or has yielded in an earlier increment
  end type point_state

  !> Material law of a section.
  type, extends(elasticity) :: material_law
    logical :: sheet = .false.         !! plane stress
    logical :: yields = .false.
    logical :: remembers = .false.     !! plastic strain is left after unloading (flow theory)
    real(wp) :: yield_stress = 0.0_wp  !! of the virgin material [stress]
    ! If the yield surface moves, of a bilinear curve:
    real(wp) :: hardening = 0.0_wp     !! stress over plastic strain [stress]
    real(wp) :: kinematic = 0.0_wp     !! its part by motion of the yield surface (Prager) [stress]
    type(deviatoric_curve) :: curve
  contains
    procedure :: update
    procedure :: history_after
    procedure, private :: back_strain
    procedure :: secant_matrix
    procedure :: tangent_matrix
    procedure :: distance
  end type material_law

contains

  !> Find the state at a strain.
  pure subroutine update(self, strain, committed, trial)
    class(material_law), intent(in) :: self
    real(wp), intent(in) :: strain(components)
    type(plastic_history), intent(in) :: committed   !! at the end of the last increment of the loads
    type(point_state), intent(out) :: trial
    real(wp) :: beyond(components)   ! committed plastic strain

    beyond = strain - committed%strain
    if (self%sheet) beyond(3) = strain_across(self, beyond, committed)
    call find_state(self, beyond, committed, trial)
    trial%across = beyond(3) + committed%strain(3)
    if (self%sheet) trial%stress(3) = 0.0_wp
    if (committed%accumulated == 0.0_wp) return
    trial%plastic = .true.
    trial%total = equivalent_of(deviator_of([strain(:2), trial%across, strain(4)])) + &
                  self%shift*equivalent_stress(trial%stress)
  end subroutine update

  !> Find the state at a strain minus the plastic strain, with its zz as given.
  pure subroutine find_state(self, strain, committed, state)
    class(material_law), intent(in) :: self
    real(wp), intent(in) :: strain(components)
    type(plastic_history), intent(in) :: committed
    type(point_state), intent(out) :: state
    real(wp) :: back(components), elastic, on_curve

    back = self%back_strain(committed)
    state%deviator = deviator_of(strain) - back
    state%deviatoric = equivalent_of(state%deviator)
    associate (accumulated => committed%accumulated, e => state%deviatoric)
      ! The curve is over e of loads that grow from zero: elastic plus plastic strain.
      state%curve_value = self%curve%at_strain(e + accumulated)
      if (accumulated > 0.0_wp) then
        elastic = 3.0_wp*self%shear*e
        on_curve = state%modulus*(e + accumulated)
        if (self%kinematic > 0.0_wp) then
          ! Radial return: the yield surface moves by the kinematic part of the hardening, and grows by the
          ! rest.
          on_curve = elastic - max(0.0_wp, elastic - self%yield_stress - (self%hardening - self%kinematic)* &
                                   accumulated)/(1.0_wp + self%hardening/(3.0_wp*self%shear))
        end if
        state%yielded = on_curve < elastic*(1.0_wp - rounded_off)
        state%modulus = 3.0_wp*self%shear
        if (state%yielded) state%modulus = on_curve/e
      end if
    end associate
    state%plastic = state%yielded
    state%stress = 2.0_wp/3.0_wp*state%modulus*state%deviator + 2.0_wp*self%shear*back
    state%stress(:3) = state%stress(:3) + 3.0_wp*self%bulk*(sum(strain(:3))/3.0_wp)
  end subroutine find_state

  !> Find the strain zz in plane stress, minus the plastic strain, at which the stress zz is zero. This stress
  !! increases with the strain, at least by the bulk modulus.
  pure real(wp) function strain_across(self, strain, committed) result(across)
    class(material_law), intent(in) :: self
    real(wp), intent(in) :: strain(components)
    type(plastic_history), intent(in) :: committed
    type(point_state) :: state
    real(wp) :: elastic, low, high, next, rate
    integer :: step

    elastic = -(self%bulk - 2.0_wp*self%shear/3.0_wp)/(self%bulk + 4.0_wp*self%shear/3.0_wp)
    across = elastic*(strain(1) + strain(2))
    if (.not. self%yields) return
    do step = 1, most_steps
      call find_state(self, [strain(:2), across, strain(4)], committed, state)
      if (step == 1) then
        if (.not. state%yielded) return
        ! Twice the range, so that rounding does not exclude the zero.
        next = across - 2.0_wp*state%stress(3)/self%bulk
        low = min(across, next)
        high = max(across, next)
      end if
      if (state%stress(3) == 0.0_wp) return
      if (state%stress(3) > 0.0_wp) high = across
      if (state%stress(3) < 0.0_wp) low = across
      rate = self%bulk + 4.0_wp/9.0_wp*state%modulus
      if (.not. self%curve%paper_ratio) rate = rate + radial_stiffness(state)*state%deviator(3)**2
      next = across - state%stress(3)/rate
      if (next <= low .or. next >= high) next = 0.5_wp*(low + high)
      if (abs(next - across) <= epsilon(1.0_wp)*abs(next)) return
      across = next
    end do
  end function strain_across

  !> Find the history of a point after an increment.
  pure type(plastic_history) function history_after(self, committed, state) result(history)
    class(material_law), intent(in) :: self
    type(plastic_history), intent(in) :: committed   !! before it
    type(point_state), intent(in) :: state           !! from `update`, at its end
    real(wp) :: elastic

    history = committed
    if (.not. (self%remembers .and. state%yielded)) return
    elastic = state%modulus/(3.0_wp*self%shear)   ! elastic part of the deviator
    history%strain = committed%strain + (1.0_wp - elastic)*state%deviator*[1.0_wp, 1.0_wp, 1.0_wp, 2.0_wp]
    history%accumulated = committed%accumulated + (1.0_wp - elastic)*state%deviatoric
  end function history_after

  !> Find the back stress over twice the shear modulus: Prager's, proportional to the plastic strain.
  pure function back_strain(self, committed) result(back)
    class(material_law), intent(in) :: self
    type(plastic_history), intent(in) :: committed
    real(wp) :: back(components)   !! with the tensor's shear strain

    back = self%kinematic/(3.0_wp*self%shear)*committed%strain*[1.0_wp, 1.0_wp, 1.0_wp, 0.5_wp]
  end function back_strain

  !> Find the deviator of a strain, with the tensor's shear strain.
  pure function deviator_of(strain) result(deviator)
    real(wp), intent(in) :: strain(components)
    real(wp) :: deviator(components)

    deviator(:3) = strain(:3) - sum(strain(:3))/3.0_wp
    deviator(4) = 0.5_wp*strain(4)
  end function deviator_of

  !> Find the equivalent strain e of a deviator.
  pure real(wp) function equivalent_of(deviator) result(e)
    real(wp), intent(in) :: deviator(components)

    e = sqrt((deviator(1)**2 + deviator(2)**2 + deviator(3)**2 + deviator(4)**2 + deviator(4)**2)* &
             2.0_wp/3.0_wp)
  end function equivalent_of

  !> Difference of tangent and secant along the deviator: (4/9) (h - E_D)/e**2 [stress].
  pure real(wp) function radial_stiffness(state)
    type(point_state), intent(in) :: state

    radial_stiffness = 0.0_wp
    if (state%yielded) radial_stiffness = 4.0_wp/9.0_wp*(state%slope - state%modulus)/state%deviatoric**2
  end function radial_stiffness

  !> Find D of stress = D (strain - plastic strain) (2-8) [stress].
  pure function secant_matrix(self, state) result(d)
    class(material_law), intent(in) :: self
    type(point_state), intent(in) :: state   !! from `update`
    real(wp) :: d(components, components)

    d = isotropic_matrix(self%bulk, state%modulus/3.0_wp, self%sheet)
  end function secant_matrix

  !> Find D of d stress = D d strain about a state, consistent with `update` [stress].
  pure function tangent_matrix(self, state) result(d)
    class(material_law), intent(in) :: self
    type(point_state), intent(in) :: state       !! from `update`
    real(wp) :: d(components, components)
    real(wp) :: across(components), radial
    integer :: j

    d = isotropic_matrix(self%bulk, state%modulus/3.0_wp, .false.)
    radial = radial_stiffness(state)
    do j = 1, components
      d(:, j) = d(:, j) + radial*state%deviator*state%deviator(j)
    end do
    if (.not. self%sheet) return
    ! Eliminate the strain zz, since the stress zz is zero.
    across = d(:, 3)
    do j = 1, components
      d(:, j) = d(:, j) - across*across(j)/across(3)
    end do
    d(3, :) = 0.0_wp
    d(:, 3) = 0.0_wp
  end function tangent_matrix

  !> Find the stress error: von Mises stress of the difference from the material's stress, over that of the
  !! material's stress, or over the yield stress if this is larger. (The mean parts are elastic.)
  pure real(wp) function distance(self, state, stress)
    class(material_law), intent(in) :: self      !! of a material that can yield
    type(point_state), intent(in) :: state       !! from `update`
    real(wp), intent(in) :: stress(components)   !! [stress]
    real(wp) :: of_material

    of_material = state%modulus*state%deviatoric   ! relative to the back stress
    if (self%kinematic > 0.0_wp) of_material = equivalent_stress(state%stress)
    distance = equivalent_stress((stress - state%stress)/max(of_material, self%yield_stress))
  end function distance
end module epcont_material_material_law
