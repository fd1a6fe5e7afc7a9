!> Stress of a strain by the paper's equations: the uniaxial curve over total strain, the secant body's
!> Poisson's ratio mu, and bisection for the equivalent strain. The solver shifts the curve instead.
module epcont_certificate_yielding
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: components, plane_stress
  use epcont_model_controls, only: uniaxial_curve
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: replayed_history, return_to_curve, stress_on_curve, von_mises_stress

  !> Number of bisections that reduce an interval to rounding.
  integer, parameter :: halvings = 60

  !> Plastic history of a point, integrated from displacements.
  type :: replayed_history
    real(wp) :: plastic(components) = 0.0_wp   !! plastic strain xx, yy, zz, xy (engineering)
    real(wp) :: hardened = 0.0_wp              !! equivalent plastic strain
    real(wp) :: stress(components) = 0.0_wp    !! [stress]
    real(wp) :: free = 0.0_wp                  !! thermal strain along each axis
  contains
    procedure :: energy_of_back_stress
  end type replayed_history

  !> Moduli of a material.
  type :: moduli_type
    real(wp) :: bulk = 1.0_wp, shear = 1.0_wp   !! K, G [stress]
    real(wp) :: moves = 0.0_wp                  !! kinematic hardening [stress]
  contains
    procedure :: growth
    procedure :: lost
  end type moduli_type

contains

  !> Stress xx, yy, zz, xy of a strain xx, yy, zz, xy (engineering) [stress].
  pure function stress_on_curve(model, section, strain) result(stress)
    type(model_type), intent(in) :: model   !! its sections, their curves and PARAM MUP
    integer, intent(in) :: section          !! a section of the model
    real(wp), intent(in) :: strain(components)       !! xx, yy, zz, xy (engineering)
    real(wp) :: stress(components), across, lambda, mu, secant, shear, total

    associate (young => model%sections%young(section), nu => model%sections%poisson(section))
      secant = young
      mu = nu
      if (allocated(model%sections%curve(section)%strain)) then
        total = strain_on_curve()
        if (total > model%sections%curve(section)%strain(2)) then
          secant = stress_at(model%sections%curve(section), total)/total
          mu = poisson_ratio(total)
        end if
      end if
      across = strain_across(mu)
      ! E_D/3 of (2-5) is the shear modulus, E/(1 - 2 nu) of (2-6) three times the bulk modulus.
      shear = young/(3.0_wp*young/secant - (1.0_wp - 2.0_wp*nu))
      lambda = young/(3.0_wp*(1.0_wp - 2.0_wp*nu)) - 2.0_wp/3.0_wp*shear
      stress = lambda*(strain(1) + strain(2) + across) + 2.0_wp*shear*[strain(1), strain(2), across, 0.0_wp]
      if (model%sections%kinematics(section) == plane_stress) stress(3) = 0.0_wp
      stress(4) = shear*strain(4)
    end associate

  contains

    !> Find the strain on the curve with the equivalent strain eps_i of this strain, with the mu of that
    !! point; below yield, the yield strain.
    pure real(wp) function strain_on_curve() result(low)
      real(wp) :: high, middle
      integer :: k

      low = model%sections%curve(section)%strain(2)
      if (.not. is_beyond(low)) return
      high = low
      do while (is_beyond(high))
        high = 2.0_wp*high
      end do
      do k = 1, halvings
        middle = 0.5_wp*(low + high)
        if (is_beyond(middle)) then
          low = middle
        else
          high = middle
        end if
      end do
    end function strain_on_curve

    !> Is the strain's eps_i (2-2), with the mu of a point of the curve, beyond this point?
    pure logical function is_beyond(total)
      real(wp), intent(in) :: total
      real(wp) :: across, mu

      mu = poisson_ratio(total)
      across = strain_across(mu)
      is_beyond = sqrt(0.5_wp*((strain(1) - strain(2))**2 + (strain(2) - across)**2 &
                               + (across - strain(1))**2) + 0.75_wp*strain(4)**2)/(1.0_wp + mu) > total
    end function is_beyond

    !> Poisson's ratio mu: exact for a secant body, or by (2-4).
    pure real(wp) function poisson_ratio(total)
      real(wp), intent(in) :: total

      associate (curve => model%sections%curve(section), &
                 compressible => 0.5_wp - model%sections%poisson(section))
        if (model%controls%paper_ratio) then
          poisson_ratio = 0.5_wp - compressible*curve%stress(2)/stress_at(curve, total)
        else
          poisson_ratio = 0.5_wp - compressible*stress_at(curve, total)/total/model%sections%young(section)
        end if
      end associate
    end function poisson_ratio

    !> Find the strain normal to the plane; in plane stress it is that of a secant body without normal stress.
    pure real(wp) function strain_across(mu)
      real(wp), intent(in) :: mu

      strain_across = strain(3)
      if (model%sections%kinematics(section) == plane_stress) strain_across = &
        -mu/(1.0_wp - mu)*(strain(1) + strain(2))
    end function strain_across
  end function stress_on_curve

  !> Integrate an increment of flow theory: bisection for the part of the trial stress, relative to the back
  !! stress, that is left at its end.
  pure subroutine return_to_curve(model, section, strain, history, stress)
    type(model_type), intent(in) :: model                  !! its sections and their curves
    integer, intent(in) :: section                         !! a yielding section of the model
    real(wp), intent(in) :: strain(components)             !! xx, yy, zz, xy (engineering), at its end
    type(replayed_history), intent(inout) :: history       !! before it; then after it
    real(wp), intent(out) :: stress(components)
    type(moduli_type) :: moduli
    real(wp) :: beyond(components), grown, high, low, part, trial(components)
    real(wp) :: mises   ! von Mises stress of `trial`; only in plane stress it depends on `part`
    integer :: k

    associate (curve => model%sections%curve(section), young => model%sections%young(section), &
               poisson => model%sections%poisson(section), &
               sheet => model%sections%kinematics(section) == plane_stress)
      moduli%bulk = young/(3.0_wp*(1.0_wp - 2.0_wp*poisson))
      moduli%shear = young/(2.0_wp*(1.0_wp + poisson))
      moduli%moves = curve%kinematic*hardening_of(curve, young)
      low = 0.0_wp
      high = 1.0_wp
      part = high
      do k = 1, halvings
        if (sheet .or. k == 1) then
          call find_trial(moduli, sheet, strain, history%plastic, part, beyond, trial)
          mises = von_mises_stress(trial)
        end if
        grown = history%hardened + moduli%growth(part, mises)
        if (part*mises > &
            stress_when_hardened(curve, young, grown) - moduli%moves*grown) then
          high = part
        else
          low = part
        end if
        if (low == high) exit   ! all elastic
        part = 0.5_wp*(low + high)
      end do
      if (sheet) then
        call find_trial(moduli, sheet, strain, history%plastic, part, beyond, trial)
        mises = von_mises_stress(trial)
      end if
      stress = 2.0_wp*moduli%shear*deviator_of(beyond) - moduli%lost(part)*trial
      stress(:3) = stress(:3) + moduli%bulk*sum(beyond(:3))
      if (sheet) stress(3) = 0.0_wp
    end associate
    history%hardened = history%hardened + moduli%growth(part, mises)
    history%plastic = history%plastic + moduli%lost(part)*trial/(2.0_wp*moduli%shear)* &
                      [1.0_wp, 1.0_wp, 1.0_wp, 2.0_wp]
  end subroutine return_to_curve

  !> Energy that the back stress stores, for each unit of volume [stress].
  pure real(wp) function energy_of_back_stress(self, model, section) result(energy)
    class(replayed_history), intent(in) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: section   !! a yielding section

    associate (curve => model%sections%curve(section))
      energy = curve%kinematic*hardening_of(curve, model%sections%young(section))/3.0_wp* &
               dot_product(self%plastic*[1.0_wp, 1.0_wp, 1.0_wp, 0.5_wp], self%plastic)
    end associate
  end function energy_of_back_stress

  !> Equivalent plastic strain of an increment.
  pure real(wp) function growth(self, part, mises)
    class(moduli_type), intent(in) :: self
    real(wp), intent(in) :: part, mises   !! von Mises stress of the trial stress

    growth = (1.0_wp - part)*mises/(3.0_wp*self%shear + self%moves)
  end function growth

  !> Stress that the plastic strain of an increment takes, over the trial stress.
  pure real(wp) function lost(self, part)
    class(moduli_type), intent(in) :: self
    real(wp), intent(in) :: part

    lost = (1.0_wp - part)/(1.0_wp + self%moves/(3.0_wp*self%shear))
  end function lost

  !> Find the strain beyond the plastic strain, and the trial stress relative to the back stress. In plane
  !! stress the normal strain is that without normal stress at the end of the increment.
  pure subroutine find_trial(moduli, sheet, strain, plastic, part, beyond, trial)
    type(moduli_type), intent(in) :: moduli
    logical, intent(in) :: sheet   !! plane stress
    real(wp), intent(in) :: strain(components), plastic(components), part
    real(wp), intent(out) :: beyond(components), trial(components)
    real(wp) :: back(components), lambda, soft

    back = 2.0_wp/3.0_wp*moduli%moves*plastic*[1.0_wp, 1.0_wp, 1.0_wp, 0.5_wp]
    beyond = strain - plastic
    soft = (1.0_wp - moduli%lost(part))*moduli%shear
    lambda = moduli%bulk - 2.0_wp/3.0_wp*soft
    if (sheet) beyond(3) = -(lambda*(beyond(1) + beyond(2)) + moduli%lost(part)*back(3))/ &
                           (lambda + 2.0_wp*soft)
    trial = 2.0_wp*moduli%shear*deviator_of(beyond) - back
  end subroutine find_trial

  !> Find the deviator of a strain, with the tensor's shear strain.
  pure function deviator_of(strain) result(deviator)
    real(wp), intent(in) :: strain(components)
    real(wp) :: deviator(components)

    deviator = [strain(:3) - sum(strain(:3))/3.0_wp, 0.5_wp*strain(4)]
  end function deviator_of

  !> Hardening of a bilinear curve: stress over plastic strain [stress].
  pure real(wp) function hardening_of(curve, young) result(hardening)
    type(uniaxial_curve), intent(in) :: curve
    real(wp), intent(in) :: young

    hardening = 0.0_wp
    if (curve%kinematic > 0.0_wp) hardening = (curve%stress(3) - curve%stress(2))/ &
      (curve%strain(3) - curve%strain(2) - (curve%stress(3) - curve%stress(2))/young)
  end function hardening_of

  !> Find the yield stress at an equivalent plastic strain [stress].
  pure real(wp) function stress_when_hardened(curve, young, hardened) result(stress)
    type(uniaxial_curve), intent(in) :: curve
    real(wp), intent(in) :: young, hardened

    stress = interpolated(curve%strain(2:) - curve%stress(2:)/young, curve%stress(2:), hardened)
  end function stress_when_hardened

  !> Find the equivalent stress (2-1), scaled by the largest component, since squares may overflow or
  !! underflow.
  pure real(wp) function von_mises_stress(stress)
    real(wp), intent(in) :: stress(components)   !! xx, yy, zz, xy
    real(wp) :: part(components), largest

    largest = maxval(abs(stress))
    von_mises_stress = 0.0_wp
    if (largest == 0.0_wp) return
    part = stress/largest
    von_mises_stress = largest*sqrt(0.5_wp*((part(1) - part(2))**2 + (part(2) - part(3))**2 &
        + (part(3) - part(1))**2) + 3.0_wp*part(4)**2)
  end function von_mises_stress

  !> Find the stress at a total strain.
  pure real(wp) function stress_at(curve, total)
    type(uniaxial_curve), intent(in) :: curve
    real(wp), intent(in) :: total

    stress_at = interpolated(curve%strain, curve%stress, total)
  end function stress_at

  !> Interpolate the stress; the last slope continues. It is computed from the lower point, without
  !! cancellation.
  pure real(wp) function interpolated(strain, stress, at)
    real(wp), intent(in) :: strain(:), stress(:), at
    integer :: k

    k = count(strain(2:size(strain) - 1) < at) + 2
    interpolated = stress(k - 1) + (stress(k) - stress(k - 1))/(strain(k) - strain(k - 1))* &
                   (at - strain(k - 1))
  end function interpolated
end module epcont_certificate_yielding
