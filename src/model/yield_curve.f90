!> Stress-strain curves of materials that yield: made and checked.
module epcont_model_yield_curve
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_base_tolerances, only: no_effect, rounded_off
  use epcont_deck_entry, only: farthest, least_divisor
  use epcont_model_controls, only: uniaxial_curve
  implicit none
  private
  public :: bilinear_curve, curve_fault, straighten

  !> Strain of the yield point and its stress over E may differ by this fraction; stress over E is used.
  real(wp), parameter :: same_strain = 1.0e-2_wp

  !> Error of a stress-strain curve.
  type :: curve_fault
    integer :: point = 0   !! first wrong point; after the last one: a point is missing; 0: no error
    character(len=:), allocatable :: what, remedy   !! message and remedy
  end type curve_fault

contains

  !> Make the curve of a yield stress and a hardening modulus: slope E H/(E + H) over total strain. If
  !! there is no such curve, it has invalid points.
  pure type(uniaxial_curve) function bilinear_curve(young, yield_stress, hardening) result(curve)
    real(wp), intent(in) :: young          !! E [stress]
    real(wp), intent(in) :: yield_stress   !! [stress]
    real(wp), intent(in) :: hardening      !! H [stress]
    real(wp) :: yield_strain

    curve%strain = [0.0_wp, 0.0_wp, 0.0_wp]
    curve%stress = [0.0_wp, yield_stress, hardening]
    if (young < least_divisor .or. abs(yield_stress) > farthest) return
    yield_strain = yield_stress/young
    curve%strain = [0.0_wp, yield_strain, 2.0_wp*yield_strain]
    if (hardening <= -young .or. hardening > farthest) return
    curve%stress(3) = yield_stress + young*(hardening/(young + hardening))*yield_strain
    curve%endless = [curve%strain(3), curve%stress(3)]
  end function bilinear_curve

  !> Correct a curve for rounding: its elastic slope is E, and a fall by rounding becomes level; or return its
  !! first invalid point.
  pure subroutine straighten(curve, young, fault)
    type(uniaxial_curve), intent(inout) :: curve   !! as many strains as stresses
    real(wp), intent(in) :: young                  !! E [stress]
    type(curve_fault), intent(out) :: fault        !! error, if there is one
    character(len=:), allocatable :: what, remedy   ! gfortran 12 leaks expressions in constructors
    integer :: k

    associate (strain => curve%strain, stress => curve%stress)
      if (size(strain) < 3) then
        what = 'has '//plural(size(strain), 'point')
        fault = curve_fault(size(strain) + 1, what, &
                            'give at least 3: 0.0 0.0, the yield point, and one beyond it')
      else if (strain(1) /= 0.0_wp .or. stress(1) /= 0.0_wp) then
        fault = curve_fault(1, 'the first point is not 0.0, 0.0', 'begin the curve at the origin')
      else if (stress(2) <= 0.0_wp .or. abs(strain(2) - stress(2)/young) > &
               same_strain*abs(stress(2)/young)) then
        remedy = 'give strain = stress/E within 1 %'
        if (stress(2) > 0.0_wp) remedy = 'give strain '//short_real(stress(2)/young)//', stress/E, within 1 %'
        fault = curve_fault(2, 'the yield point (the second one) is not on the elastic line of the MAT1', &
                            remedy)
      else
        strain(2) = stress(2)/young
        do k = 3, size(strain)
          if (strain(k) <= strain(k - 1)) then
            remedy = 'give more than '//short_real(strain(k - 1))
            fault = curve_fault(k, 'the strain does not rise', remedy)
          else if (stress(k) < (1.0_wp - rounded_off)*stress(k - 1)) then
            remedy = 'give at least '//short_real(stress(k - 1))
            fault = curve_fault(k, 'the stress falls (softening)', remedy)
          else if (stress(k) - stress(k - 1) > young*(strain(k) - strain(k - 1))*(1.0_wp + no_effect)) then
            fault = curve_fault(k, 'steeper than the elastic line of the MAT1', 'give a slope of at most E')
          end if
          if (fault%point > 0) then
            fault%what = 'point '//text_of(k)//': '//fault%what
            return
          end if
          stress(k) = max(stress(k), stress(k - 1))
        end do
      end if
    end associate
  end subroutine straighten
end module epcont_model_yield_curve
