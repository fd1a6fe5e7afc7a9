!> Locking: three-node elements in a nearly incompressible material (elastic with Poisson's ratio near 0.5, or
!> far in the plastic range). They are too stiff, and their mean stresses scatter from element to element.
module epcont_result_locking
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: plane_stress
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: locking_type, find_locking

  !> The material is nearly incompressible from this Poisson's ratio of the secant body on.
  real(wp), parameter, public :: high_poisson = 0.45_wp

  type :: locking_type
    integer :: elements = 0            !! number of three-node elements beyond this ratio
    !> Scatter of their mean stress about that of their neighbours, r.m.s. over equivalent stress, r.m.s.
    real(wp) :: scatter = 0.0_wp
  end type locking_type

contains

  !> Count these elements, and find the scatter of their mean stress.
  pure function find_locking(model, volume, stress, equivalent_stress, secant_modulus) result(locking)
    type(model_type), intent(in) :: model           !! model
    real(wp), intent(in) :: volume(:)               !! of the integration points [points]
    real(wp), intent(in) :: stress(:, :)            !! xx, yy, zz, xy [4, elements]
    real(wp), intent(in) :: equivalent_stress(:)    !! [elements]
    real(wp), intent(in) :: secant_modulus(:)       !! [elements]
    type(locking_type) :: locking
    real(wp), allocatable :: about(:), weight(:)
    logical, allocatable :: locks(:)
    real(wp) :: scatter, size_of_stress
    integer :: e

    allocate (about(model%mesh%nodes), weight(model%mesh%nodes), source=0.0_wp)
    allocate (locks(model%mesh%elements), source=.false.)
    do e = 1, model%mesh%elements
      associate (s => model%mesh%section(e))
        if (.not. model%mesh%kinds(model%mesh%kind(e))%locks .or. &
            model%sections%kinematics(s) == plane_stress) cycle
        locks(e) = 0.5_wp - &
          (0.5_wp - model%sections%poisson(s))*secant_modulus(e)/model%sections%young(s) >= high_poisson
      end associate
      if (.not. locks(e)) cycle
      associate (node => model%mesh%connectivity(:3, e), v => volume(model%mesh%first_point(e)))
        about(node) = about(node) + v*sum(stress(:3, e))/3.0_wp
        weight(node) = weight(node) + v
      end associate
    end do
    locking%elements = count(locks)
    if (locking%elements == 0) return
    where (weight > 0.0_wp) about = about/weight
    scatter = 0.0_wp
    size_of_stress = 0.0_wp
    do e = 1, model%mesh%elements
      if (.not. locks(e)) cycle
      associate (v => volume(model%mesh%first_point(e)))
        scatter = scatter + v*(sum(stress(:3, e)) - sum(about(model%mesh%connectivity(:3, e))))**2/9.0_wp
        size_of_stress = size_of_stress + v*equivalent_stress(e)**2
      end associate
    end do
    if (size_of_stress > 0.0_wp) locking%scatter = sqrt(scatter/size_of_stress)
  end function find_locking
end module epcont_result_locking
