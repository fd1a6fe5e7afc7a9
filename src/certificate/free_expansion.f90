!> What temperatures do to an answer, for its certificate: strains that stresses do not come of, and what the
!> stresses would be if nothing gave way to these. Where bodies expand freely all stresses, forces and work
!> are what rounding leaves of that.
module epcont_certificate_free_expansion
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: most_nodes, most_points
  use epcont_element_kinematics, only: directions, plane_stress
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: expansion_type, free_strains, held_stress

  !> Stresses, forces and work are compared with no less than such a part of those of bodies that are held.
  real(wp), parameter, public :: part_of_held = 1.0e-3_wp

  type :: expansion_type
    real(wp) :: work = 0.0_wp         !! of the stresses on free strains
    ! If nothing gave way:
    real(wp) :: held_force = 0.0_wp   !! the largest at a node [force]
    real(wp) :: held_work = 0.0_wp    !! of the stresses that would be
  contains
    procedure :: add_element
    procedure :: include
  end type expansion_type

contains

  !> What a part of the temperatures strains the integration places of an element by, along each axis, where
  !! it is free to.
  pure subroutine free_strains(model, element, load_factor, volume, strain)
    type(model_type), intent(in) :: model        !! model
    integer, intent(in) :: element               !! which of its elements
    real(wp), intent(in) :: load_factor          !! of the temperatures
    real(wp), intent(in) :: volume(most_points)  !! that belong to the places [length**3]
    real(wp), intent(out) :: strain(most_points)
    real(wp) :: share(most_nodes), slope(directions, most_nodes)
    integer :: k, p

    strain = 0.0_wp
    if (.not. allocated(model%temperature)) return
    associate (s => model%section(element), kind => model%kinds(model%kind(element)))
      do p = 1, kind%points
        call kind%shape(kind%point(:, p), share, slope)   ! derivatives are not looked at
        do k = 1, kind%nodes
          strain(p) = strain(p) + load_factor*model%expansion(s)*share(k)* &
                      (model%temperature(model%connectivity(k, element)) - model%reference_temperature(s))
        end do
      end do
      if (kind%mean_dilatation .and. model%kinematics(s) /= plane_stress) &
        strain = sum(strain(:kind%points)*volume(:kind%points))/sum(volume(:kind%points))
    end associate
  end subroutine free_strains

  !> The largest stress along one axis if nothing gave way to the temperatures [stress].
  pure real(wp) function held_stress(model, load_factor) result(stress)
    type(model_type), intent(in) :: model   !! model
    real(wp), intent(in) :: load_factor     !! of the temperatures
    integer :: e

    stress = 0.0_wp
    if (.not. allocated(model%temperature)) return
    do e = 1, model%elements
      associate (node => model%connectivity(:model%node_count(e), e), s => model%section(e))
        stress = max(stress, load_factor*model%young(s)*abs(model%expansion(s))* &
                     maxval(abs(model%temperature(node) - model%reference_temperature(s))))
      end associate
    end do
  end function held_stress

  !> Add what is of an element.
  pure subroutine add_element(self, young, stress, unit, volume, free)
    class(expansion_type), intent(inout) :: self
    real(wp), intent(in) :: young                 !! E of its section [stress]
    real(wp), intent(in) :: stress(:, :)          !! at its places [stress] [components, places]
    real(wp), intent(in) :: unit(:, :, :, :)      !! strains [components, directions, nodes, places]
    real(wp), intent(in) :: volume(:), free(:)    !! of the places, and their free strains [places]
    real(wp) :: force
    integer :: c, k, p

    if (all(free == 0.0_wp)) return
    do p = 1, size(stress, 2)
      self%work = self%work + volume(p)*free(p)*sum(stress(:3, p))
      self%held_work = self%held_work + volume(p)*young*free(p)**2
    end do
    do k = 1, size(unit, 3)
      do c = 1, size(unit, 2)
        force = 0.0_wp
        do p = 1, size(stress, 2)
          force = force + volume(p)*young*abs(free(p)*sum(unit(:3, c, k, p)))
        end do
        self%held_force = max(self%held_force, force)
      end do
    end do
  end subroutine add_element

  !> Add what is of other elements.
  pure subroutine include(self, others)
    class(expansion_type), intent(inout) :: self
    type(expansion_type), intent(in) :: others   !! of them

    self%work = self%work + others%work
    self%held_work = self%held_work + others%held_work
    self%held_force = max(self%held_force, others%held_force)
  end subroutine include
end module epcont_certificate_free_expansion
