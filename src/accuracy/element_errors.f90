!> Errors of one element: differences between its own strains and the recovered strains, for the answer and
!> several fields at once, and the stress error of the answer.
!>
!> With s the stress and e the strain of an element, and * for recovered values, the square of the error is
!> the integral of (s* - s).(e* - e); s* is the stress on the material's curve at e*. For elastic elements
!> this is the energy norm. For yielded elements it lies between the norms of the tangent and of the secant.
!> For any curve it is zero only if the error is zero.
module epcont_accuracy_element_errors
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: element_kind, most_places
  use epcont_element_kinematics, only: components
  use epcont_material_elasticity, only: cross_modulus
  use epcont_material_material_law, only: point_state
  use epcont_material_model_materials, only: model_materials
  use epcont_plan_forecast, only: loads_at_once
  implicit none
  private
  public :: element_errors, new_element_errors

  !> Number of fields that are compared at once, besides the answer.
  integer, parameter, public :: most_fields = loads_at_once
  integer, parameter :: most_width = components*(1 + most_fields)

  type :: element_errors
    integer :: fields = 0                    !! number of fields besides the answer
    integer :: width = components            !! components of all fields, those of the answer first
    integer :: places = 0                    !! number of points of comparison
    integer :: own_places = 0                !! number of points with own strains; 1 if all strains are equal
    real(wp) :: part(most_places) = 0.0_wp   !! part of the volume of each point
    real(wp) :: own(most_width, most_places)      !! strains
    real(wp) :: error(most_width, most_places)    !! recovered strains minus own strains
    !> Stress error of the answer (recovered minus own), times the part of the volume [components, places]
    real(wp) :: stress(components, most_places)
  contains
    procedure :: compare
    procedure :: find_stress
    procedure :: energy
  end type element_errors

contains

  !> Start a comparison of the answer and some other fields.
  pure function new_element_errors(fields) result(errors)
    integer, intent(in) :: fields   !! number of fields besides the answer
    type(element_errors) :: errors

    errors%fields = fields
    errors%width = components*(1 + fields)
  end function new_element_errors

  !> Find an element's own strains at its points of comparison, and their errors.
  pure subroutine compare(self, kind, volume, strain, place, smooth)
    class(element_errors), intent(inout) :: self
    type(element_kind), intent(in) :: kind                 !! of the element
    real(wp), intent(in) :: volume(kind%points)            !! of its points
    real(wp), intent(in) :: strain(self%width, *)          !! at its points
    integer, intent(in) :: place(kind%nodes)               !! positions of its nodes in `smooth`
    real(wp), intent(in) :: smooth(self%width, *)          !! recovered strains [width, any]
    real(wp) :: middle
    integer :: i, k, v

    self%places = kind%places
    self%own_places = merge(1, kind%places, kind%points == 1)
    do k = 1, kind%places
      self%part(k) = 0.0_wp
      do i = 1, kind%points
        self%part(k) = self%part(k) + kind%v(i, k)*volume(i)
      end do
    end do
    do k = 1, self%own_places
      call own_strain(k, self%own(:, k))
    end do
    if (kind%nodes == 3) then   ! the loop below, unrolled for the most frequent element
      do v = 1, self%width
        middle = 0.5_wp*(smooth(v, place(1)) + smooth(v, place(2)) + smooth(v, place(3))) - strain(v, 1)
        self%error(v, 1) = middle - 0.5_wp*smooth(v, place(1))
        self%error(v, 2) = middle - 0.5_wp*smooth(v, place(2))
        self%error(v, 3) = middle - 0.5_wp*smooth(v, place(3))
      end do
      return
    end if
    do k = 1, kind%places
      do v = 1, self%width
        self%error(v, k) = -self%own(v, min(k, self%own_places))
      end do
      do i = 1, kind%nodes, 2   ! all other types have an even number of nodes: half as many passes
        do v = 1, self%width
          self%error(v, k) = self%error(v, k) + (kind%n(i, k)*smooth(v, place(i)) + &
                                                 kind%n(i + 1, k)*smooth(v, place(i + 1)))
        end do
      end do
    end do

  contains

    !> Own strain at a place.
    pure subroutine own_strain(k, own)
      integer, intent(in) :: k
      real(wp), intent(inout) :: own(self%width)
      integer :: i, v

      if (kind%sees_points) then
        do v = 1, self%width
          own(v) = strain(v, k)
        end do
        return
      end if
      own = 0.0_wp
      do i = 1, kind%points
        do v = 1, self%width
          own(v) = own(v) + kind%p(i, k)*strain(v, i)
        end do
      end do
    end subroutine own_strain
  end subroutine compare

  !> Find the stress error of the answer, on the material's curve.
  pure subroutine find_stress(self, kind, materials, first, state)
    class(element_errors), intent(inout) :: self
    type(element_kind), intent(in) :: kind            !! of the element
    type(model_materials), intent(in) :: materials
    integer, intent(in) :: first                      !! its first integration point
    type(point_state), allocatable, intent(in) :: state(:)   !! of the answer; not allocated if nothing yields
                                                             !! [points]
    type(point_state) :: after, before
    real(wp) :: cross
    integer :: k

    associate (law => materials%section(materials%of_point(first)))
      cross = cross_modulus(law%bulk, law%shear, law%sheet)
      do k = 1, self%places
        if (law%yields) then
          associate (own => self%own(:components, min(k, self%own_places)), &
                     point => first - 1 + min(k, kind%points))
            if (kind%sees_points) then
              before = state(point)
            else
              before = materials%state_at(point, own)
            end if
            after = materials%state_at(point, own + self%error(:components, k))
          end associate
          if (before%yielded .or. after%yielded) then
            self%stress(:, k) = self%part(k)*(after%stress - before%stress)
            cycle
          end if
        end if
        call put_elastic_stress(self%part(k)*cross, self%part(k)*law%shear, self%error(1, k), &
                                self%stress(1, k))
      end do
    end associate
  end subroutine find_stress

  !> Product of the stress error of the answer and the strain error of a field. For the answer itself: the
  !! square of its error [energy].
  pure real(wp) function energy(self, field)
    class(element_errors), intent(in) :: self
    integer, intent(in) :: field   !! 0: the answer
    integer :: k, v

    energy = 0.0_wp
    v = components*field
    do k = 1, self%places
      energy = energy &
                + (self%stress(1, k)*self%error(v + 1, k) + self%stress(2, k)*self%error(v + 2, k)) &
                + (self%stress(3, k)*self%error(v + 3, k) + self%stress(4, k)*self%error(v + 4, k))
    end do
  end function energy

  !> Find the elastic stress of a strain; the component zz of both is zero in plane stress.
  pure subroutine put_elastic_stress(cross, shear, strain, stress)
    real(wp), intent(in) :: cross, shear          !! K - 2/3 G, G [stress]
    real(wp), intent(in) :: strain(components)    !! xx, yy, zz, xy
    real(wp), intent(out) :: stress(components)   !! the same [stress]
    real(wp) :: volumetric

    volumetric = cross*(strain(1) + strain(2) + strain(3))
    stress(1) = volumetric + 2.0_wp*shear*strain(1)
    stress(2) = volumetric + 2.0_wp*shear*strain(2)
    stress(3) = volumetric + 2.0_wp*shear*strain(3)
    stress(4) = shear*strain(4)
  end subroutine put_elastic_stress
end module epcont_accuracy_element_errors
