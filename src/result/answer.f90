!> The answer to a scene: displacements, contact and stresses, and how they were found.
module epcont_result_answer
  use epcont_base_kinds, only: wp
  use epcont_plasticity_load_path, only: followed_loads
  use epcont_result_body_force, only: body_force
  use epcont_result_displacement_gradient, only: gradient_type
  use epcont_result_line_pressure, only: line_pressure
  use epcont_result_locking, only: locking_type
  use epcont_result_zones, only: contact_zone
  implicit none
  private
  public :: answer_type

  !> Where more of a pivot is lost, the factors may be too stiff to tell what is wrong.
  real(wp), parameter :: largest_mended = 1.0e-4_wp

  type, extends(followed_loads) :: answer_type
    real(wp), allocatable :: reaction(:, :)          !! of the supports [force] [2, nodes]
    real(wp), allocatable :: angle(:)                !! of platens that turn [radian] [platens]
    real(wp), allocatable :: moment(:)               !! of their supports [force*length] [platens]
    ! Of the elements: means over their points, by volume.
    real(wp), allocatable :: stress(:, :)            !! xx, yy, zz, xy [stress] [4, elements]
    real(wp), allocatable :: equivalent_stress(:)    !! von Mises [stress] [elements]
    real(wp), allocatable :: equivalent_strain(:)    !! (2-2) [elements]
    real(wp), allocatable :: secant_modulus(:)       !! E' of the curve at that strain [stress] [elements]
    ! At the integration point of each element where it is largest.
    real(wp), allocatable :: largest_stress(:)       !! von Mises [stress] [elements]
    integer, allocatable :: largest_at(:)            !! that point [elements]
    !> Beyond the yield point, at any of its points [elements]
    logical, allocatable :: plastic(:)
    logical, allocatable :: beyond(:)                !! beyond the end of the material's table [elements]
    !> At the pairs; negative: no boundary there [stress] [pairs]
    real(wp), allocatable :: pressure(:)
    !> Pressure on the master line less that on the slave line (`compare_sides`) [stress] [pairs]
    real(wp), allocatable :: apart(:)
    type(contact_zone), allocatable :: zones(:)      !! runs of touching pairs
    type(line_pressure), allocatable :: lines(:)     !! of each line contact
    type(body_force), allocatable :: bodies(:)       !! what contact exerts on each that has elements
    real(wp) :: shortfall = 0.0_wp                   !! of stresses from the curve by (2-4), at most, relative
    type(locking_type) :: locking                    !! of three-node elements
    type(gradient_type) :: gradient                  !! of displacements that are not small
    !> Of displacements and forces by refinement's last step, relative
    real(wp) :: last_correction = huge(1.0_wp)
  contains
    procedure :: largest_pressure
    procedure :: lost
    procedure :: rounding
  end type answer_type

contains

  !> The largest pressure of all pairs; negative where those that touch have none, since no boundary belongs
  !! to them [stress].
  pure real(wp) function largest_pressure(self)
    class(answer_type), intent(in) :: self

    largest_pressure = 0.0_wp
    if (any(self%contact%touching)) largest_pressure = maxval(self%pressure, mask=self%contact%touching)
  end function largest_pressure

  !> What rounding has taken of the weakest pivot; or, where the answer was refined by factors that tell the
  !! error, of the answer.
  pure real(wp) function lost(self)
    class(answer_type), intent(in) :: self

    lost = epsilon(1.0_wp)/self%weakest%ratio
    if (lost <= largest_mended) lost = min(lost, self%last_correction)
  end function lost

  !> What rounding may have taken of displacements and forces, at most: by the condition, or by what a step of
  !! refinement changed.
  pure real(wp) function rounding(self)
    class(answer_type), intent(in) :: self

    rounding = min(self%condition*epsilon(1.0_wp), max(self%last_correction, epsilon(1.0_wp)))
  end function rounding
end module epcont_result_answer
