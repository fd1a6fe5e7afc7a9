!> The answer of a model: displacements, contact and stresses, and how they were found.
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

  !> States of a pair with friction.
  integer, parameter, public :: pair_open = 0, pair_sticks = 1, pair_slips = 2

  !> If rounding takes a larger part of a pivot, the factors may be too stiff to show the error.
  real(wp), parameter :: largest_mended = 1.0e-4_wp

  type, extends(followed_loads) :: answer_type
    real(wp), allocatable :: reaction(:, :)          !! of the supports [force] [2, nodes]
    real(wp), allocatable :: angle(:)                !! of rotating platens [rad] [platens]
    real(wp), allocatable :: moment(:)               !! reactions of their supports [force*length] [platens]
    ! Of the elements: means over their integration points, by volume.
    real(wp), allocatable :: stress(:, :)            !! xx, yy, zz, xy [stress] [4, elements]
    real(wp), allocatable :: equivalent_stress(:)    !! von Mises [stress] [elements]
    real(wp), allocatable :: equivalent_strain(:)    !! (2-2) [elements]
    real(wp), allocatable :: secant_modulus(:)       !! E' of the curve at this strain [stress] [elements]
    !> Plastic strain xx, yy, zz, xy (engineering), and accumulated; not allocated in total theory [5,
    !! elements]
    real(wp), allocatable :: plastic_strain(:, :)
    ! At the integration point of each element with the largest von Mises stress.
    real(wp), allocatable :: largest_stress(:)       !! von Mises [stress] [elements]
    integer, allocatable :: largest_at(:)            !! this point [elements]
    !> Yielded at one integration point or more [elements]
    logical, allocatable :: plastic(:)
    logical, allocatable :: beyond(:)                !! beyond the end of the material's table [elements]
    !> At the pairs; negative if no boundary belongs to a pair [stress] [pairs]
    real(wp), allocatable :: pressure(:)
    !> Pressure on the master line minus pressure on the slave line (`compare_sides`) [stress] [pairs]
    real(wp), allocatable :: apart(:)
    type(contact_zone), allocatable :: zones(:)      !! runs of pairs in contact
    !> Runs of pairs that stick; forces are those of friction, and pressures the shear tractions up to slip
    type(contact_zone), allocatable :: stick_zones(:)
    type(line_pressure), allocatable :: lines(:)     !! of each line contact
    type(body_force), allocatable :: bodies(:)       !! contact resultants on bodies with elements
    real(wp) :: shortfall = 0.0_wp                   !! largest part by which (2-4) leaves a stress below the
                                                     !! curve
    type(locking_type) :: locking                    !! of three-node elements
    type(gradient_type) :: gradient                  !! large displacement gradients
    !> Change of displacements and forces by the last step of refinement, relative
    real(wp) :: last_correction = huge(1.0_wp)
  contains
    procedure :: largest_pressure
    procedure :: friction_states
    procedure :: shear
    procedure :: lost
    procedure :: rounding
  end type answer_type

contains

  !> Find the largest pressure of all pairs; negative if no boundary belongs to the pairs in contact [stress].
  pure real(wp) function largest_pressure(self)
    class(answer_type), intent(in) :: self

    largest_pressure = 0.0_wp
    if (any(self%contact%touching)) largest_pressure = maxval(self%pressure, mask=self%contact%touching)
  end function largest_pressure

  !> State of each pair with friction [tangential rows].
  pure function friction_states(self, sliding) result(state)
    class(answer_type), intent(in) :: self
    integer, intent(in) :: sliding(:)   !! pair of each tangential row
    integer :: state(size(sliding))

    state = pair_open
    where (self%contact%touching(sliding)) state = merge(pair_sticks, pair_slips, self%contact%sticking)
  end function friction_states

  !> Shear traction of each pair with friction; zero without a pressure [stress] [tangential rows].
  pure function shear(self, sliding)
    class(answer_type), intent(in) :: self
    integer, intent(in) :: sliding(:)   !! pair of each tangential row
    real(wp) :: shear(size(sliding))

    shear = 0.0_wp
    where (self%contact%force(sliding) > 0.0_wp .and. self%pressure(sliding) > 0.0_wp) &
      shear = self%pressure(sliding)*self%contact%friction_force/self%contact%force(sliding)
  end function shear

  !> Find the part of the weakest pivot that rounding has taken; or, if the answer was refined with factors
  !! that show the error, the part of the answer.
  pure real(wp) function lost(self)
    class(answer_type), intent(in) :: self

    lost = epsilon(1.0_wp)/self%weakest%ratio
    if (lost <= largest_mended) lost = min(lost, self%last_correction)
  end function lost

  !> Find an upper bound of the rounding error of displacements and forces, from the condition number or from
  !! the last step of refinement.
  pure real(wp) function rounding(self)
    class(answer_type), intent(in) :: self

    rounding = min(self%condition*epsilon(1.0_wp), max(self%last_correction, epsilon(1.0_wp)))
  end function rounding
end module epcont_result_answer
