!> METHOD NEWTON: consistent tangent, contact exact in each step, line search on the energy.
!>
!> Total theory makes the scene a convex minimisation: each step is a direction in which the energy falls, and
!> all points along it satisfy supports and contact, since both its ends do. The search looks for the zero of
!> the slope (f_int - f).d, since differences of the energy itself drown in rounding.
module epcont_plasticity_newton
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: slope_rounding
  use epcont_element_kinematics, only: components
  use epcont_material_linear_law, only: linear_law
  use epcont_material_material_law, only: point_state
  use epcont_material_scene_materials, only: scene_materials
  use epcont_model_model, only: model_type
  use epcont_plasticity_method, only: plastic_method
  use epcont_linear_scene_state, only: scene_state
  implicit none
  private
  public :: newton_method

  !> Parts of the secant matrix mixed into a tangent that could not be factored, tried one after the other.
  real(wp), parameter :: blends(4) = [1.0e-6_wp, 1.0e-4_wp, 1.0e-2_wp, 1.0_wp]
  !> A step serves in full when the slope at its end is at most this part of that at its beginning.
  real(wp), parameter :: flat_enough = 0.5_wp
  !> The search ends when the slope is at most this part of that at the beginning.
  real(wp), parameter :: found_enough = 0.1_wp
  !> Slopes evaluated in one search.
  integer, parameter :: most_slopes = 30

  type, extends(plastic_method) :: newton_method
    logical :: takes_full_step = .true.   !! prescribed displacements and overlaps go in with the first step
    integer :: blend = 0                  !! which of `blends`; 0: none
  contains
    procedure :: restart
    procedure :: linearise
    procedure :: stiffen
    procedure :: advance
    procedure :: blended
  end type newton_method

contains

  pure subroutine restart(self)
    class(newton_method), intent(inout) :: self

    self%takes_full_step = .true.
  end subroutine restart

  !> Tangents: stress(strain) + D_t (d strain).
  pure subroutine linearise(self, materials, about, law)
    class(newton_method), intent(inout) :: self
    type(scene_materials), intent(in) :: materials
    type(scene_state), intent(in) :: about
    type(linear_law), intent(inout) :: law

    self%blend = 0
    call set_law(materials, about, 0.0_wp, law)
  end subroutine linearise

  !> Part of the secant matrix in the last tangent.
  pure real(wp) function blended(self)
    class(newton_method), intent(in) :: self

    blended = 0.0_wp
    if (self%blend > 0) blended = blends(self%blend)
  end function blended

  !> D_t + w (D_secant - D_t): a flat curve makes D_t semidefinite.
  pure subroutine stiffen(self, materials, about, law, possible)
    class(newton_method), intent(inout) :: self
    type(scene_materials), intent(in) :: materials
    type(scene_state), intent(in) :: about
    type(linear_law), intent(inout) :: law
    logical, intent(out) :: possible

    possible = self%blend < size(blends)
    if (.not. possible) return
    self%blend = self%blend + 1
    call set_law(materials, about, blends(self%blend), law)
  end subroutine stiffen

  pure subroutine set_law(materials, about, blend, law)
    type(scene_materials), intent(in) :: materials
    type(scene_state), intent(in) :: about
    real(wp), intent(in) :: blend
    type(linear_law), intent(inout) :: law
    real(wp) :: matrix(components, components)
    integer :: p

    do p = 1, size(about%point)
      associate (m => materials%section(materials%of_point(p))%law, strain => about%strain(:, p), &
                 state => about%point(p))
        if (.not. m%yields) cycle
        law%initial_stress(:, p) = 0.0_wp
        matrix = m%secant_matrix(state)
        if (state%yielded) then
          matrix = blend*matrix + (1.0_wp - blend)*m%tangent_matrix(strain, state)
          law%initial_stress(:, p) = state%stress - matmul(matrix, strain)
        end if
        call law%set_matrix(p, matrix)
      end associate
    end do
  end subroutine set_law

  !> Go along the step as far as the energy falls.
  pure subroutine advance(self, model, materials, part, found, about)
    class(newton_method), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(scene_materials), intent(in) :: materials
    real(wp), intent(in) :: part
    type(scene_state), intent(in) :: found
    type(scene_state), intent(inout) :: about
    type(point_state), allocatable :: point(:)
    real(wp) :: length

    length = 1.0_wp
    if (.not. self%takes_full_step) call find_length(model, materials, self%volume, part, about, found, length, point)
    self%takes_full_step = .false.
    if (length < 1.0_wp) then
      about%displacement = about%displacement + length*(found%displacement - about%displacement)
      about%strain = about%strain + length*(found%strain - about%strain)
      call move_alloc(point, about%point)
    else
      about%displacement = found%displacement
      about%strain = found%strain
      about%point = found%point
    end if
  end subroutine advance

  !> The zero of the slope of the energy, from 0 to 1: regula falsi of Illinois.
  pure subroutine find_length(model, materials, volume, part, about, found, length, point)
    type(model_type), intent(in) :: model
    type(scene_materials), intent(in) :: materials
    real(wp), intent(in) :: volume(:)   !! of each point
    real(wp), intent(in) :: part
    type(scene_state), intent(in) :: about, found
    real(wp), intent(out) :: length
    type(point_state), allocatable, intent(out) :: point(:)   !! at that length; not allocated for 1
    real(wp), allocatable :: along(:, :), travel(:, :)
    real(wp) :: begin, low, high, slope, slope_low, slope_high, terms
    integer :: k, side

    length = 1.0_wp
    along = found%strain - about%strain
    travel = found%displacement - about%displacement
    call find_slope(about%point, begin, terms)
    call find_slope(found%point, slope_high, terms)
    if (begin >= -slope_rounding*terms .or. slope_high <= -flat_enough*begin) return
    low = 0.0_wp
    high = 1.0_wp
    slope_low = begin
    side = 0
    do k = 1, most_slopes
      length = (low*slope_high - high*slope_low)/(slope_high - slope_low)
      point = materials%states(about%strain + length*along)
      call find_slope(point, slope, terms)
      if (abs(slope) <= -found_enough*begin) return
      if (slope > 0.0_wp) then
        high = length
        slope_high = slope
        if (side > 0) slope_low = 0.5_wp*slope_low
        side = 1
      else
        low = length
        slope_low = slope
        if (side < 0) slope_high = 0.5_wp*slope_high
        side = -1
      end if
    end do

  contains

    !> (f_int - f).d with the stresses of some states, and the sum of the magnitudes of its terms.
    pure subroutine find_slope(state, value, magnitude)
      type(point_state), intent(in) :: state(:)
      real(wp), intent(out) :: value, magnitude
      real(wp) :: term
      integer :: p

      value = -part*sum(model%load*travel)
      magnitude = part*sum(abs(model%load*travel))
      do p = 1, size(state)
        term = volume(p)*dot_product(state(p)%stress, along(:, p))
        value = value + term
        magnitude = magnitude + abs(term)
      end do
    end subroutine find_slope
  end subroutine find_length
end module epcont_plasticity_newton
