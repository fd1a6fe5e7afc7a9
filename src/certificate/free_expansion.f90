!> Effects of thermal and plastic strains on the certificate: the stresses if all these strains were
!> fixed. If bodies expand freely, all stresses, forces and work are rounding errors of these stresses.
module epcont_certificate_free_expansion
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: most_nodes, most_points
  use epcont_element_kinematics, only: directions, plane_stress
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: expansion_type, free_strains, held_stress

  !> The references for stresses, forces and work are at least this part of those with fixed expansion.
  real(wp), parameter, public :: part_of_held = 1.0e-3_wp

  type :: expansion_type
    real(wp) :: work = 0.0_wp         !! of the stresses in thermal and plastic strains
    ! If all expansion were fixed:
    real(wp) :: held_force = 0.0_wp   !! the largest at a node [force]
    real(wp) :: held_work = 0.0_wp    !! work of the stresses
  contains
    procedure :: add_element
    procedure :: include
  end type expansion_type

contains

  !> Find the thermal strain along each axis at the integration points of an element.
  pure subroutine free_strains(model, element, rise, volume, strain)
    type(model_type), intent(in) :: model        !! model
    integer, intent(in) :: element               !! number of the element
    !> Temperature above that without thermal strain; not allocated: zero [element's nodes, elements]
    real(wp), allocatable, intent(in) :: rise(:, :)
    real(wp), intent(in) :: volume(most_points)  !! of the integration points [length**3]
    real(wp), intent(out) :: strain(most_points)
    real(wp) :: share(most_nodes), slope(directions, most_nodes)
    integer :: k, p

    strain = 0.0_wp
    if (.not. allocated(rise)) return
    associate (s => model%mesh%section(element), kind => model%mesh%kinds(model%mesh%kind(element)))
      do p = 1, kind%points
        call kind%shape(kind%point(:, p), share, slope)   ! derivatives are not used
        do k = 1, kind%nodes
          strain(p) = strain(p) + model%sections%expansion(s)*share(k)*rise(k, element)
        end do
      end do
      if (kind%mean_dilatation .and. model%sections%kinematics(s) /= plane_stress) &
        strain = sum(strain(:kind%points)*volume(:kind%points))/sum(volume(:kind%points))
    end associate
  end subroutine free_strains

  !> Find the largest stress along one axis if all thermal expansion were fixed [stress].
  pure real(wp) function held_stress(model) result(stress)
    type(model_type), intent(in) :: model   !! model
    integer :: e

    stress = 0.0_wp
    if (.not. allocated(model%loads%rise)) return
    do e = 1, model%mesh%elements
      associate (s => model%mesh%section(e))
        stress = max(stress, model%sections%young(s)*abs(model%sections%expansion(s))* &
                     maxval(abs(model%loads%rise(:model%mesh%node_count(e), e))))
      end associate
    end do
  end function held_stress

  !> Add the contribution of an element.
  pure subroutine add_element(self, young, stress, unit, volume, inelastic)
    class(expansion_type), intent(inout) :: self
    real(wp), intent(in) :: young                 !! E of its section [stress]
    real(wp), intent(in) :: stress(:, :)          !! at its points [stress] [components, places]
    real(wp), intent(in) :: unit(:, :, :, :)      !! strains [components, directions, nodes, places]
    real(wp), intent(in) :: volume(:)             !! of the points [places]
    real(wp), intent(in) :: inelastic(:, :)       !! thermal and plastic strains [components, places]
    real(wp) :: force
    integer :: c, k, p

    if (all(inelastic == 0.0_wp)) return
    do p = 1, size(stress, 2)
      self%work = self%work + volume(p)*dot_product(inelastic(:, p), stress(:, p))
      self%held_work = self%held_work + volume(p)*young*maxval(abs(inelastic(:, p)))**2
    end do
    do k = 1, size(unit, 3)
      do c = 1, size(unit, 2)
        force = 0.0_wp
        do p = 1, size(stress, 2)
          force = force + volume(p)*young*abs(dot_product(inelastic(:, p), unit(:, c, k, p)))
        end do
        self%held_force = max(self%held_force, force)
      end do
    end do
  end subroutine add_element

  !> Add the sums of other elements.
  pure subroutine include(self, others)
    class(expansion_type), intent(inout) :: self
    type(expansion_type), intent(in) :: others   !! their sums

    self%work = self%work + others%work
    self%held_work = self%held_work + others%held_work
    self%held_force = max(self%held_force, others%held_force)
  end subroutine include
end module epcont_certificate_free_expansion
