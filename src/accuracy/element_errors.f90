!> Errors of one element: differences between its own strains and the recovered strains, and the stress error.
!>
!> With s the stress and e the strain of an element, and * for recovered values, the square of the error is
!> the integral of (s* - s).(e* - e); s* is the stress on the material's curve at e*. For elastic elements
!> this is the energy norm. For yielded elements it lies between the norms of the tangent and of the secant.
!> For any curve it is zero only if the error is zero.
module epcont_accuracy_element_errors
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: element_kind, most_nodes, most_places
  use epcont_element_kinematics, only: components, directions
  use epcont_material_elasticity, only: cross_modulus
  use epcont_material_material_law, only: point_state
  use epcont_material_model_materials, only: model_materials
  implicit none
  private
  public :: element_errors

  type :: element_errors
    real(wp) :: part(most_places) = 0.0_wp        !! part of the volume of each point of comparison
    real(wp) :: own(components, most_places)      !! strains
    real(wp) :: error(components, most_places)    !! recovered strains minus own strains
    !> Recovered minus own stress, times `part` [components, places]
    real(wp) :: stress(components, most_places)
    !> Weights with which another field enters the product of this stress error and its strain error: weights
    !! of its recovered strains [energy] and of its displacements [force] [any, nodes]
    real(wp) :: of_strain(components, most_nodes), of_displacement(directions, most_nodes)
  contains
    procedure :: compare
    procedure :: find_stress
    procedure :: energy
    procedure :: find_weights
  end type element_errors

contains

  !> Find an element's own strains at its points of comparison, and their errors.
  pure subroutine compare(self, kind, volume, strain, place, smooth)
    class(element_errors), intent(inout) :: self
    type(element_kind), intent(in) :: kind                     !! of the element
    real(wp), intent(in) :: volume(kind%points)                !! of its points
    real(wp), intent(in) :: strain(components, kind%points)    !! at its points
    integer, intent(in) :: place(kind%nodes)                   !! positions of its nodes in `smooth`
    real(wp), intent(in) :: smooth(components, *)              !! recovered strains [components, any]
    integer :: i, k

    do k = 1, kind%places
      self%part(k) = 0.0_wp
      self%own(:, k) = 0.0_wp
      do i = 1, kind%points
        self%part(k) = self%part(k) + kind%v(i, k)*volume(i)
        self%own(:, k) = self%own(:, k) + kind%p(i, k)*strain(:, i)
      end do
      self%error(:, k) = -self%own(:, k)
      do i = 1, kind%nodes
        self%error(:, k) = self%error(:, k) + kind%n(i, k)*smooth(:, place(i))
      end do
    end do
  end subroutine compare

  !> Find the stress error, on the material's curve.
  pure subroutine find_stress(self, kind, materials, first, state)
    class(element_errors), intent(inout) :: self
    type(element_kind), intent(in) :: kind            !! of the element
    type(model_materials), intent(in) :: materials
    integer, intent(in) :: first                      !! its first integration point
    type(point_state), allocatable, intent(in) :: state(:)   !! of the answer; not allocated if nothing yields
                                                             !! [points]
    type(point_state) :: after, before
    integer :: k

    associate (law => materials%section(materials%of_point(first)))
      do k = 1, kind%places
        if (law%yields) then
          associate (point => first - 1 + min(k, kind%points))
            if (kind%sees_points) then
              before = state(point)
            else
              before = materials%state_at(point, self%own(:, k))
            end if
            after = materials%state_at(point, self%own(:, k) + self%error(:, k))
          end associate
          if (before%yielded .or. after%yielded) then
            self%stress(:, k) = self%part(k)*(after%stress - before%stress)
            cycle
          end if
        end if
        associate (e => self%error(:, k), double => 2.0_wp*self%part(k)*law%shear, &
                   cross => self%part(k)*cross_modulus(law%bulk, law%shear, law%sheet))
          ! the component zz of both is zero in plane stress
          self%stress(:3, k) = cross*(e(1) + e(2) + e(3)) + double*e(:3)
          self%stress(4, k) = 0.5_wp*double*e(4)
        end associate
      end do
    end associate
  end subroutine find_stress

  !> Square of the error: stress error times strain error [energy].
  pure real(wp) function energy(self, kind)
    class(element_errors), intent(in) :: self
    type(element_kind), intent(in) :: kind   !! of the element
    integer :: k

    energy = 0.0_wp
    do k = 1, kind%places
      energy = energy + (self%stress(1, k)*self%error(1, k) + self%stress(2, k)*self%error(2, k)) + &
               (self%stress(3, k)*self%error(3, k) + self%stress(4, k)*self%error(4, k))
    end do
  end function energy

  !> Find the weights of another field. Its own strains are subtracted, and so are its displacements, which
  !! cause them.
  pure subroutine find_weights(self, kind, b)
    class(element_errors), intent(inout) :: self
    type(element_kind), intent(in) :: kind
    !> Strain matrix at each point [1/length]
    real(wp), intent(in) :: b(components, directions, kind%nodes, kind%points)
    real(wp) :: at_point(components)
    integer :: c, i, k, p

    do i = 1, kind%nodes
      self%of_displacement(:, i) = 0.0_wp
      self%of_strain(:, i) = 0.0_wp
      do k = 1, kind%places
        self%of_strain(:, i) = self%of_strain(:, i) + kind%n(i, k)*self%stress(:, k)
      end do
    end do
    do p = 1, kind%points
      at_point = 0.0_wp
      do k = 1, kind%places
        at_point = at_point + kind%p(p, k)*self%stress(:, k)
      end do
      do i = 1, kind%nodes
        do c = 1, directions
          self%of_displacement(c, i) = self%of_displacement(c, i) + &
            (at_point(1)*b(1, c, i, p) + at_point(2)*b(2, c, i, p)) + &
            (at_point(3)*b(3, c, i, p) + at_point(4)*b(4, c, i, p))
        end do
      end do
    end do
  end subroutine find_weights
end module epcont_accuracy_element_errors
