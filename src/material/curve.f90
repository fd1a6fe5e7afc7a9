!> Equivalent stress over deviatoric equivalent strain, of a material with a piecewise linear uniaxial curve.
!>
!> With e = sqrt(2/3 e_ij e_ij) and elastic mean stress, a uniaxial state of total strain eps and stress sigma
!> has e = eps - (1 - 2 nu) sigma/(3E). The points of the uniaxial curve, shifted in this way, give sigma_i =
!> curve(e) for every deformation (MUP EXACT). MUP PAPER uses Poisson's ratio (2-4) in the equivalent strain
!> eps_i instead. Then e = eps_i (1 - (1 - 2 nu) sigma_s/(3 sigma_i)), a quadratic equation for eps_i on each
!> segment.
module epcont_material_curve
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference
  use epcont_material_elasticity, only: elasticity
  use epcont_model_controls, only: uniaxial_curve
  implicit none
  private
  public :: curve_value, deviatoric_curve, new_curve

  type :: deviatoric_curve
    type(elasticity) :: elastic
    logical :: paper_ratio = .false.        !! MUP PAPER
    logical :: ends = .false.               !! the table ends at the last point
    ! Starts at the yield point, extrapolated with the last slope. Not allocated if the material is elastic.
    real(wp), allocatable :: deviatoric(:)  !! e at the points [points]
    real(wp), allocatable :: total(:)       !! eps at the points [points]
    real(wp), allocatable :: stress(:)      !! [stress] [points]
    real(wp), allocatable :: slope(:)       !! d sigma/d e after each point [stress] [points]
    real(wp), allocatable :: total_slope(:) !! d sigma/d eps after each point [stress] [points]
  contains
    procedure :: at_strain
    procedure :: hardening
  end type deviatoric_curve

  !> Values of the curve at a strain.
  type :: curve_value
    real(wp) :: modulus = 1.0_wp   !! E_D = 3 G of a secant body: equivalent stress over e [stress]
    real(wp) :: total = 0.0_wp     !! equivalent strain eps_i (2-2)
    real(wp) :: slope = 1.0_wp     !! d sigma_i/d e [stress]; undefined for MUP PAPER
    logical :: yielded = .false.   !! yielded
    logical :: beyond = .false.    !! beyond the last point of a table
  end type curve_value

contains

  !> Convert a curve over total strain to a curve over e.
  pure function new_curve(uniaxial, elastic, paper_ratio) result(curve)
    type(uniaxial_curve), intent(in) :: uniaxial   !! starts at (0, 0)
    type(elasticity), intent(in) :: elastic        !! initial elasticity
    logical, intent(in) :: paper_ratio             !! MUP PAPER
    type(deviatoric_curve) :: curve
    real(wp), allocatable :: rise(:), width(:)
    integer :: n

    curve%elastic = elastic
    if (.not. allocated(uniaxial%strain)) return
    curve%paper_ratio = paper_ratio
    n = size(uniaxial%strain)
    curve%ends = any(uniaxial%endless /= [uniaxial%strain(n), uniaxial%stress(n)])
    curve%total = uniaxial%strain(2:)
    curve%stress = uniaxial%stress(2:)
    rise = curve%stress(2:) - curve%stress(:n - 2)
    width = curve%total(2:) - curve%total(:n - 2)
    rise = [rise, rise(n - 2)]
    width = [width, width(n - 2)]
    curve%total_slope = rise/width
    curve%slope = rise/(width - elastic%shift*rise)
    curve%deviatoric = curve%total - elastic%shift*curve%stress
    if (paper_ratio) &
      curve%deviatoric = curve%total*(1.0_wp - elastic%young*elastic%shift*curve%stress(1)/curve%stress)
  end function new_curve

  !> Stress over plastic strain right after the yield point [stress].
  pure real(wp) function hardening(self)
    class(deviatoric_curve), intent(in) :: self

    associate (elastic => 3.0_wp*self%elastic%shear)
      hardening = elastic*(self%slope(1)/(elastic - self%slope(1)))
    end associate
  end function hardening

  !> Evaluate the curve at a deviatoric equivalent strain.
  pure function at_strain(self, e) result(point)
    class(deviatoric_curve), intent(in) :: self
    real(wp), intent(in) :: e   !! deviatoric equivalent strain
    type(curve_value) :: point
    real(wp) :: secant
    integer :: k

    associate (young => self%elastic%young, shift => self%elastic%shift)
      point%modulus = 3.0_wp*self%elastic%shear
      point%slope = point%modulus
      point%total = e*(1.0_wp + shift*point%modulus)
      if (.not. allocated(self%deviatoric)) return
      if (e <= self%deviatoric(1)) return
      point%yielded = .true.
      if (self%ends) point%beyond = e > self%deviatoric(size(self%deviatoric))*(1.0_wp + least_difference)
      k = size(self%deviatoric)
      do while (e < self%deviatoric(k))
        k = k - 1
      end do
      if (self%paper_ratio) then
        call find_paper_secant(point%total, secant)
        point%modulus = young/(young/secant - young*shift)  ! (2-5)
      else
        point%modulus = (self%stress(k) + self%slope(k)*(e - self%deviatoric(k)))/e
        point%slope = self%slope(k)
        point%total = e*(1.0_wp + shift*point%modulus)
      end if
    end associate

  contains

    !> Find eps_i, and E' = sigma_i/eps_i, with (2-4). On sigma = a + b eps, the equation e = eps (1 -
    !! c/sigma) is b eps**2 + (a - c - b e) eps = e a.
    pure subroutine find_paper_secant(strain, secant)
      real(wp), intent(out) :: strain, secant
      real(wp) :: a, b, c, half

      b = self%total_slope(k)
      a = self%stress(k) - b*self%total(k)
      c = self%elastic%young*self%elastic%shift*self%stress(1)
      half = 0.5_wp*(a - c - b*e)
      ! Positive root, without cancellation for b = 0.
      if (half > 0.0_wp) then
        strain = e*a/(half + sqrt(half**2 + b*e*a))
      else
        strain = (sqrt(half**2 + b*e*a) - half)/b
      end if
      secant = a/strain + b
    end subroutine find_paper_secant
  end function at_strain
end module epcont_material_curve
