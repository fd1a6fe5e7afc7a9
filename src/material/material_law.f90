!> Von Mises yield with isotropic hardening along the uniaxial curve of the material. The mean stress is
!> elastic, and the stress deviator is parallel to the strain deviator less the plastic strain that is
!> committed:
!>
!>     stress = K theta + (2 E_D/3) (deviatoric strain - plastic strain),   E_D = sigma_i/e    (2-5), (2-6)
!>
!> From the virgin state this is deformation ("total") theory. From a committed state it is one backward
!> Euler increment of flow theory, returned along the radius to the curve.
!>
!> Strains and stresses are xx, yy, zz, xy (engineering shear strain). In plane stress the strain zz is found,
!> whatever is given.
module epcont_material_material_law
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: components
  use epcont_material_curve, only: curve_value, deviatoric_curve
  use epcont_material_elasticity, only: elasticity, equivalent_stress, isotropic_matrix
  implicit none
  private
  public :: material_law, plastic_history, point_state

  !> Steps for the strain across a plane-stress sheet; bisection alone would end after some 60.
  integer, parameter :: most_steps = 100

  !> What a point remembers of the increments that are over.
  type :: plastic_history
    real(wp) :: strain(components) = 0.0_wp   !! plastic strain, a deviator
    real(wp) :: accumulated = 0.0_wp          !! equivalent plastic strain
  end type plastic_history

  !> The material at an integration point.
  type, extends(curve_value) :: point_state
    real(wp) :: stress(components) = 0.0_wp   !! [stress]
    real(wp) :: across = 0.0_wp               !! strain zz
    real(wp) :: deviatoric = 0.0_wp           !! equivalent strain e of deviator less committed plastic strain
    logical :: plastic = .false.              !! it yields, or has yielded in an increment before
  end type point_state

  !> The law of a section.
  type, extends(elasticity) :: material_law
    logical :: sheet = .false.         !! plane stress
    logical :: yields = .false.
    real(wp) :: yield_stress = 0.0_wp  !! of the virgin material [stress]
    type(deviatoric_curve) :: curve
  contains
    procedure :: update
    procedure :: history_after
    procedure :: secant_matrix
    procedure :: tangent_matrix
    procedure :: distance
  end type material_law

contains

  !> The state at a strain.
  pure subroutine update(self, strain, committed, trial)
    class(material_law), intent(in) :: self
    real(wp), intent(in) :: strain(components)
    type(plastic_history), intent(in) :: committed   !! at the end of the last increment of the loads
    type(point_state), intent(out) :: trial
    real(wp) :: beyond(components)   ! the plastic strain

    beyond = strain - committed%strain
    if (self%sheet) beyond(3) = strain_across(self, beyond, committed%accumulated)
    call find_state(self, beyond, committed%accumulated, trial)
    trial%across = beyond(3) + committed%strain(3)
    if (self%sheet) trial%stress(3) = 0.0_wp
    if (committed%accumulated == 0.0_wp) return
    trial%plastic = .true.
    trial%total = equivalent_of(deviator_of([strain(:2), trial%across, strain(4)])) + &
                  self%shift*trial%modulus*trial%deviatoric
  end subroutine update

  !> The state at a strain less the plastic strain, with zz as it is given.
  pure subroutine find_state(self, strain, accumulated, state)
    class(material_law), intent(in) :: self
    real(wp), intent(in) :: strain(components), accumulated
    type(point_state), intent(out) :: state
    real(wp) :: deviator(components), on_curve

    deviator = deviator_of(strain)
    state%deviatoric = equivalent_of(deviator)
    ! The curve is over e of loads that grow from zero, which is that of the elastic strain and the plastic.
    state%curve_value = self%curve%at_strain(state%deviatoric + accumulated)
    if (accumulated > 0.0_wp) then
      on_curve = state%modulus*(state%deviatoric + accumulated)
      state%yielded = on_curve < 3.0_wp*self%shear*state%deviatoric
      state%modulus = 3.0_wp*self%shear
      if (state%yielded) state%modulus = on_curve/state%deviatoric
    end if
    state%plastic = state%yielded
    state%stress = 2.0_wp/3.0_wp*state%modulus*deviator
    state%stress(:3) = state%stress(:3) + 3.0_wp*self%bulk*(sum(strain(:3))/3.0_wp)
  end subroutine find_state

  !> The strain across a sheet in plane stress, less the plastic strain, where the stress across vanishes.
  !! That stress rises with the strain, and has its zero between that of the elastic sheet and that of
  !! constant volume.
  pure real(wp) function strain_across(self, strain, accumulated) result(across)
    class(material_law), intent(in) :: self
    real(wp), intent(in) :: strain(components), accumulated
    type(point_state) :: state
    real(wp) :: deviator(components), elastic, low, high, next, rate
    integer :: step

    elastic = -(self%bulk - 2.0_wp*self%shear/3.0_wp)/(self%bulk + 4.0_wp*self%shear/3.0_wp)
    across = elastic*(strain(1) + strain(2))
    if (.not. self%yields) return
    low = min(across, -(strain(1) + strain(2)))
    high = max(across, -(strain(1) + strain(2)))
    do step = 1, most_steps
      call find_state(self, [strain(:2), across, strain(4)], accumulated, state)
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

  !> What a point remembers once an increment is over.
  pure type(plastic_history) function history_after(self, strain, committed, state) result(history)
    class(material_law), intent(in) :: self
    real(wp), intent(in) :: strain(components)       !! at the end of the increment
    type(plastic_history), intent(in) :: committed   !! before it
    type(point_state), intent(in) :: state           !! that `update` has found
    real(wp) :: elastic

    history = committed
    if (.not. state%yielded) return
    elastic = state%modulus/(3.0_wp*self%shear)   ! part of the deviator that is elastic
    associate (deviator => deviator_of([strain(:2), state%across, strain(4)] - committed%strain))
      history%strain = committed%strain + (1.0_wp - elastic)*deviator*[1.0_wp, 1.0_wp, 1.0_wp, 2.0_wp]
    end associate
    history%accumulated = committed%accumulated + (1.0_wp - elastic)*state%deviatoric
  end function history_after

  !> Deviator of a strain, with the tensor's shear strain.
  pure function deviator_of(strain) result(deviator)
    real(wp), intent(in) :: strain(components)
    real(wp) :: deviator(components)

    deviator(:3) = strain(:3) - sum(strain(:3))/3.0_wp
    deviator(4) = 0.5_wp*strain(4)
  end function deviator_of

  !> Equivalent strain e of a deviator.
  pure real(wp) function equivalent_of(deviator) result(e)
    real(wp), intent(in) :: deviator(components)

    e = sqrt((deviator(1)**2 + deviator(2)**2 + deviator(3)**2 + deviator(4)**2 + deviator(4)**2)* &
             2.0_wp/3.0_wp)
  end function equivalent_of

  !> What the tangent has less than the secant along the deviator: (4/9) (h - E_D)/e**2 [stress].
  pure real(wp) function radial_stiffness(state)
    type(point_state), intent(in) :: state

    radial_stiffness = 0.0_wp
    if (state%yielded) radial_stiffness = 4.0_wp/9.0_wp*(state%slope - state%modulus)/state%deviatoric**2
  end function radial_stiffness

  !> D of stress = D (strain - plastic strain) (2-8) [stress].
  pure function secant_matrix(self, state) result(d)
    class(material_law), intent(in) :: self
    type(point_state), intent(in) :: state   !! that `update` has found
    real(wp) :: d(components, components)

    d = isotropic_matrix(self%bulk, state%modulus/3.0_wp, self%sheet)
  end function secant_matrix

  !> D of d stress = D d strain about a state, consistent with `update` [stress].
  pure function tangent_matrix(self, strain, committed, state) result(d)
    class(material_law), intent(in) :: self
    real(wp), intent(in) :: strain(components)
    type(plastic_history), intent(in) :: committed
    type(point_state), intent(in) :: state       !! that `update` has found there
    real(wp) :: d(components, components)
    real(wp) :: across(components), deviator(components), radial
    integer :: j

    d = isotropic_matrix(self%bulk, state%modulus/3.0_wp, .false.)
    deviator = deviator_of([strain(:2), state%across, strain(4)] - committed%strain)
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

  !> How far a stress is from that of the material: von Mises stress of the difference, over that of the curve
  !! there, or the yield stress below yield. (The mean parts are elastic.)
  pure real(wp) function distance(self, state, stress)
    class(material_law), intent(in) :: self      !! one that yields
    type(point_state), intent(in) :: state       !! that `update` has found
    real(wp), intent(in) :: stress(components)   !! [stress]

    distance = equivalent_stress((stress - state%stress)/max(state%modulus*state%deviatoric, &
        self%yield_stress))
  end function distance
end module epcont_material_material_law
