!> Stress of a strain by the paper's equations: the uniaxial curve over total strain, the secant body's
!> Poisson's ratio mu, and bisection for the equivalent strain. The solver shifts the curve instead.
module epcont_certificate_yielding
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: components, plane_stress
  use epcont_model_controls, only: uniaxial_curve
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: stress_after, stress_on_curve, von_mises_stress

  !> Number of bisections that reduce an interval to rounding.
  integer, parameter :: halvings = 60

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

  !> Find the stress after several load steps of flow theory with isotropic hardening [stress].
  pure function stress_after(model, section, strain) result(stress)
    type(model_type), intent(in) :: model     !! its sections and their curves
    integer, intent(in) :: section            !! a yielding section of the model
    real(wp), intent(in) :: strain(:, :)      !! xx, yy, zz, xy (engineering) [components, load steps]
    real(wp) :: stress(components), plastic(components), hardened
    integer :: step

    plastic = 0.0_wp
    hardened = 0.0_wp
    do step = 1, size(strain, 2)
      call return_to_curve(model, section, strain(:, step), plastic, hardened, stress)
    end do
  end function stress_after

  !> Integrate one load step: bisection for the elastic part of the strain deviator at its end.
  pure subroutine return_to_curve(model, section, strain, plastic, hardened, stress)
    type(model_type), intent(in) :: model
    integer, intent(in) :: section
    real(wp), intent(in) :: strain(components)
    real(wp), intent(inout) :: plastic(components), hardened   !! plastic strain, and its equivalent, before
                                                               !! the step
    real(wp), intent(out) :: stress(components)
    real(wp) :: bulk, deviator(components), equivalent, high, low, mean, part, shear
    integer :: k

    bulk = model%sections%young(section)/(3.0_wp*(1.0_wp - 2.0_wp*model%sections%poisson(section)))
    shear = model%sections%young(section)/(2.0_wp*(1.0_wp + model%sections%poisson(section)))
    low = 0.0_wp
    high = 1.0_wp
    part = high
    do k = 1, halvings
      call divide(part, mean, deviator, equivalent)
      if (3.0_wp*shear*part*equivalent > stress_when_hardened(model%sections%curve(section), &
                                                              model%sections%young(section), &
                                                               hardened + (1.0_wp - part)*equivalent)) then
        high = part
      else
        low = part
      end if
      if (low == high) exit   ! all elastic
      part = 0.5_wp*(low + high)
    end do
    call divide(part, mean, deviator, equivalent)
    stress = 2.0_wp*shear*part*deviator
    stress(:3) = stress(:3) + 3.0_wp*bulk*mean
    if (model%sections%kinematics(section) == plane_stress) stress(3) = 0.0_wp
    plastic = plastic + (1.0_wp - part)*deviator*[1.0_wp, 1.0_wp, 1.0_wp, 2.0_wp]
    hardened = hardened + (1.0_wp - part)*equivalent

  contains

    !> Split the elastic strain into mean and deviator; in plane stress the normal strain is that of a body
    !! with a part of the shear modulus.
    pure subroutine divide(part, mean, deviator, equivalent)
      real(wp), intent(in) :: part
      real(wp), intent(out) :: mean, deviator(components), equivalent
      real(wp) :: beyond(components), lambda

      beyond = strain - plastic
      lambda = bulk - 2.0_wp/3.0_wp*part*shear
      if (model%sections%kinematics(section) == plane_stress) &
        beyond(3) = -lambda/(lambda + 2.0_wp*part*shear)*(beyond(1) + beyond(2))
      mean = sum(beyond(:3))/3.0_wp
      deviator = [beyond(:3) - mean, 0.5_wp*beyond(4)]
      equivalent = sqrt(2.0_wp/3.0_wp*(sum(deviator(:3)**2) + 2.0_wp*deviator(4)**2))
    end subroutine divide
  end subroutine return_to_curve

  !> Find the yield stress at an equivalent plastic strain; the last slope of the curve continues [stress].
  pure real(wp) function stress_when_hardened(curve, young, hardened) result(stress)
    type(uniaxial_curve), intent(in) :: curve
    real(wp), intent(in) :: young, hardened
    integer :: k

    associate (plastic => curve%strain - curve%stress/young)
      k = count(plastic(3:size(plastic) - 1) < hardened) + 3
      stress = curve%stress(k - 1) + (curve%stress(k) - curve%stress(k - 1))/(plastic(k) - plastic(k - 1))* &
               (hardened - plastic(k - 1))
    end associate
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

  !> Find the stress at a total strain; the last slope continues. It is computed from the lower point, without
  !! cancellation.
  pure real(wp) function stress_at(curve, total)
    type(uniaxial_curve), intent(in) :: curve
    real(wp), intent(in) :: total
    integer :: k

    k = count(curve%strain(2:size(curve%strain) - 1) < total) + 2
    associate (strain => curve%strain(k - 1:k), stress => curve%stress(k - 1:k))
      stress_at = stress(1) + (stress(2) - stress(1))/(strain(2) - strain(1))*(total - strain(1))
    end associate
  end function stress_at
end module epcont_certificate_yielding
