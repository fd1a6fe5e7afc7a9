!> Curves of materials that yield: made, and checked.
module epcont_model_yield_curve
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_model_controls, only: uniaxial_curve
  implicit none
  private
  public :: bilinear_curve, check_curve

  !> The strain of the yield point and its stress over E may differ by this part; the stress over E is used.
  real(wp), parameter :: same_strain = 1.0e-2_wp

contains

  !> The curve of a yield stress and a slope over plastic strain: E H/(E + H) over total strain.
  pure type(uniaxial_curve) function bilinear_curve(young, yield_stress, hardening) result(curve)
    real(wp), intent(in) :: young          !! E [stress]
    real(wp), intent(in) :: yield_stress   !! [stress]
    real(wp), intent(in) :: hardening      !! H [stress]
    real(wp) :: slope, yield_strain

    slope = young*(hardening/(young + hardening))
    yield_strain = yield_stress/young
    curve%strain = [0.0_wp, yield_strain, 2.0_wp*yield_strain]
    curve%stress = [0.0_wp, yield_stress, yield_stress + slope*yield_strain]
  end function bilinear_curve

  !> The first point of a curve that cannot be, and why; 0 where all can. A number beyond the last point: one
  !! is missing.
  pure subroutine check_curve(strain, stress, young, wrong, what, remedy)
    real(wp), intent(in) :: strain(:)      !! total [points]
    real(wp), intent(in) :: stress(:)      !! [stress] [points]
    real(wp), intent(in) :: young          !! E [stress]
    integer, intent(out) :: wrong          !! which point
    character(len=:), allocatable, intent(out) :: what, remedy   !! is wrong with it; would be right

    if (size(strain) < 3) then
      wrong = size(strain) + 1
      what = 'has '//plural(size(strain), 'point')
      remedy = 'at least 3: 0.0 0.0, the yield point, and one beyond it'
    else if (strain(1) /= 0.0_wp .or. stress(1) /= 0.0_wp) then
      wrong = 1
      what = 'the first point is not 0.0, 0.0'
      remedy = 'a curve from the origin'
    else if (stress(2) <= 0.0_wp .or. abs(strain(2) - stress(2)/young) > &
             same_strain*abs(stress(2)/young)) then
      wrong = 2
      what = 'the yield point (the second one) is not on the elastic line of the MAT1'
      remedy = 'strain = stress/E within 1 %'
      if (stress(2) > 0.0_wp) remedy = 'strain '//short_real(stress(2)/young)//', stress/E, within 1 %'
    else
      call check_beyond_yield([stress(2)/young, strain(3:)], stress(2:), young, wrong, what, remedy)
      if (wrong > 0) then
        wrong = wrong + 1
        what = 'point '//text_of(wrong)//': '//what
      end if
    end if
  end subroutine check_curve

  !> The first point behind the yield point that cannot be, and why; 0 where all can.
  pure subroutine check_beyond_yield(strain, stress, young, wrong, what, remedy)
    real(wp), intent(in) :: strain(:), stress(:), young   !! from the yield point on
    integer, intent(out) :: wrong
    character(len=:), allocatable, intent(out) :: what, remedy
    integer :: k

    do k = 1, size(strain) - 1
      wrong = k + 1
      if (strain(k + 1) <= strain(k)) then
        what = 'the strain does not rise'
        remedy = 'more than '//short_real(strain(k))
      else if (stress(k + 1) < stress(k)) then
        what = 'the stress falls (softening)'
        remedy = 'at least '//short_real(stress(k))
      else if (stress(k + 1) - stress(k) > young*(strain(k + 1) - strain(k))) then
        what = 'steeper than the elastic line of the MAT1'
        remedy = 'a slope of at most E'
      else
        cycle
      end if
      return
    end do
    wrong = 0
  end subroutine check_beyond_yield
end module epcont_model_yield_curve
