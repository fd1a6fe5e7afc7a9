!> The strains of the answer and of unit loads against smooth ones: how far they are from these, as an energy
!> (Zienkiewicz and Zhu 1987), and what their errors have in common.
!>
!> With s the stress and e the strain of an element, and * for the smooth ones, the square of the error is the
!> integral of (s* - s).(e* - e), s* being the stress on the material's curve at e*. Of elastic elements that
!> is the energy norm. Of yielding ones it lies between those of the tangent and of the secant, and vanishes
!> only with the error, whatever the curve.
module epcont_accuracy_error_fields
  use epcont_accuracy_recovery, only: patch_table, recover_strains
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: element_kind, most_places
  use epcont_element_kinematics, only: components
  use epcont_flexibility_flexibility, only: pair_forces
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_scene_state, only: scene_state
  use epcont_material_elasticity, only: cross_modulus
  use epcont_material_material_law, only: point_state
  use epcont_material_scene_materials, only: scene_materials
  use epcont_model_model, only: model_type
  use epcont_plan_forecast, only: loads_at_once
  use epcont_plan_planned_scene, only: planned_scene
  implicit none
  private
  public :: compare_fields, error_fields, error_product, error_products

  !> Strains less smooth ones are errors: their energies, and their products with those of unit loads.
  type :: error_fields
    real(wp), allocatable :: smooth(:, :)   !! strains of the answer [components, places of the patches]
    real(wp), allocatable :: element(:)     !! [energy] [elements]
    real(wp) :: energy = 0.0_wp             !! of the answer
    real(wp), allocatable :: along(:, :)    !! of all elements, of each without its sign [energy] [2, loads]
    real(wp), allocatable :: missing(:)     !! part of the energy of each unit load [loads]
  end type error_fields

  !> What the errors of fields of strain have in common, and what each misses.
  type :: error_product
    real(wp), allocatable :: element(:, :)   !! [energy] [elements, fields]
    !> Part of the energy, of elastic bodies; not found of the first field [fields]
    real(wp), allocatable :: missing(:)
  end type error_product

contains

  !> Errors of the answer's strains, and what they have in common with those of unit loads.
  subroutine compare_fields(scene, linear, answer, table, unit_force, field)
    type(planned_scene), intent(in) :: scene     !! that was solved
    type(linear_problem), intent(in) :: linear   !! of the last solve
    class(scene_state), intent(in) :: answer     !! to it
    type(patch_table), intent(in) :: table       !! of its elements
    real(wp), intent(in) :: unit_force(:, :)     !! contact forces under each unit load [pairs, loads]
    type(error_fields), intent(out) :: field     !! what is off
    !> Of the answer, then of some unit loads [components, any, 1 + loads]
    real(wp), allocatable :: strain(:, :, :), smooth(:, :, :)
    type(error_product) :: product
    integer :: first, j, k, loads

    associate (model => scene%model, volume => linear%operator%volume)
      allocate (field%along(2, size(unit_force, 2)), field%missing(size(unit_force, 2)))
      do first = 1, max(1, size(unit_force, 2)), loads_at_once
        loads = min(loads_at_once, size(unit_force, 2) - first + 1)
        allocate (strain(components, model%points, 1 + loads))
        strain(:, :, 1) = answer%strain
        do j = 1, loads
          strain(:, :, 1 + j) = linear%operator%strains(model, linear%displacements( &
                                scene, pair_forces(model, unit_force(:, first - 1 + j)), 0.0_wp))
        end do
        smooth = recover_strains(model, table, volume, strain)
        product = error_products(model, table, linear%materials, volume, strain, smooth, answer%point)
        deallocate (strain)
        do j = 1, loads
          k = first - 1 + j
          field%along(:, k) = [sum(product%element(:, 1 + j)), sum(abs(product%element(:, 1 + j)))]
          field%missing(k) = product%missing(1 + j)
        end do
      end do
      do k = 1, model%points
        field%energy = field%energy + volume(k)*dot_product(answer%strain(:, k), answer%point_stress(:, k))
      end do
    end associate
    field%element = product%element(:, 1)
    field%smooth = smooth(:, :, 1)
  end subroutine compare_fields

  !> Integrals of error times error: what the stress of the first field, on the material's curve, is off by,
  !! times what the strain of each field is off by. Of the first field that is the square of its error. Each
  !! of the other fields by itself misses a part of its energy, too.
  pure function error_products(model, table, materials, volume, strain, smooth, state) result(product)
    type(model_type), intent(in) :: model                 !! the scene
    type(patch_table), intent(in) :: table                !! of its elements
    type(scene_materials), intent(in) :: materials        !! of its sections
    real(wp), intent(in) :: volume(:)                     !! of the integration points [points]
    real(wp), contiguous, intent(in) :: strain(:, :, :)   !! [components, points, fields]
    real(wp), contiguous, intent(in) :: smooth(:, :, :)   !! [components, places, fields]
    !> Of the first field, where anything yields [points]
    type(point_state), allocatable, intent(in) :: state(:)
    type(error_product) :: product
    type(point_state) :: before, after
    real(wp) :: own(components, most_places), error(components, most_places, size(strain, 3))
    real(wp) :: part(most_places), cross, one
    real(wp) :: energy(2, size(strain, 3))   !! of each field's error, and of its own strain
    logical :: yielded
    integer :: e, f, fields, k

    fields = size(strain, 3)
    allocate (product%element(model%elements, fields), product%missing(fields), source=0.0_wp)
    energy = 0.0_wp
    do e = 1, model%elements
      associate (first => model%first_point(e), last => model%first_point(e + 1) - 1, &
                 law => materials%section(model%section(e))%law, kind => model%kinds(model%kind(e)))
        cross = cross_modulus(law%bulk, law%shear, law%sheet)
        do k = 1, kind%places
          part(k) = sum(kind%v(:last - first + 1, k)*volume(first:last))
        end do
        do f = fields, 1, -1   ! last the first, whose own strain is wanted
          call compare(kind, table%place(:kind%nodes, e), strain(:, first:last, f), smooth(:, :, f), own, &
                       error(:, :, f))
          if (f == 1) exit
          do k = 1, kind%places
            energy(:, f) = energy(:, f) + &
                           part(k)*[elastic_product(cross, law%shear, error(:, k, f), error(:, k, f)), &
                                    elastic_product(cross, law%shear, own(:, k), own(:, k))]
          end do
        end do
        do k = 1, kind%places
          yielded = .false.
          if (law%yields) then
            if (kind%sees_points) then
              before = state(first - 1 + min(k, kind%points))
            else
              call law%update(own(:, k), point_state(), before)
            end if
            call law%update(own(:, k) + error(:, k, 1), point_state(), after)
            yielded = before%yielded .or. after%yielded
          end if
          do f = 1, fields
            if (yielded) then
              one = dot_product(after%stress - before%stress, error(:, k, f))
            else
              one = elastic_product(cross, law%shear, error(:, k, 1), error(:, k, f))
            end if
            product%element(e, f) = product%element(e, f) + part(k)*one
          end do
        end do
      end associate
    end do
    where (energy(1, :) > 0.0_wp) product%missing = energy(1, :)/sum(energy, dim=1)
  end function error_products

  !> An element's own strain at its places, and what the smooth one is beyond it.
  pure subroutine compare(kind, place, strain, smooth, own, error)
    type(element_kind), intent(in) :: kind
    integer, contiguous, intent(in) :: place(:)
    real(wp), contiguous, intent(in) :: strain(:, :)      !! [components, its points]
    real(wp), contiguous, intent(in) :: smooth(:, :)      !! [components, places of all]
    real(wp), intent(inout) :: own(components, most_places), error(components, most_places)
    real(wp) :: middle(components)
    integer :: i, k

    if (size(place) == 3) then   ! what follows below, for most of all elements
      middle = 0.5_wp*(smooth(:, place(1)) + smooth(:, place(2)) + smooth(:, place(3))) - strain(:, 1)
      do k = 1, 3
        own(:, k) = strain(:, 1)
        error(:, k) = middle - 0.5_wp*smooth(:, place(k))
      end do
      return
    end if
    do k = 1, kind%places
      own(:, k) = 0.0_wp
      do i = 1, size(strain, 2)
        own(:, k) = own(:, k) + kind%p(i, k)*strain(:, i)
      end do
      error(:, k) = -own(:, k)
      do i = 1, size(place)
        error(:, k) = error(:, k) + kind%n(i, k)*smooth(:, place(i))
      end do
    end do
  end subroutine compare

  !> The stress of one strain, elastic, times another strain; in a sheet their components zz are none.
  pure real(wp) function elastic_product(cross, shear, one, other) result(product)
    real(wp), intent(in) :: cross, shear
    real(wp), intent(in) :: one(components), other(components)

    product = cross*(one(1) + one(2) + one(3))*(other(1) + other(2) + other(3)) &
              + shear*(2.0_wp*(one(1)*other(1) + one(2)*other(2) + one(3)*other(3)) + one(4)*other(4))
  end function elastic_product
end module epcont_accuracy_error_fields
