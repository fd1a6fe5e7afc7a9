!> The strains of the answer and of unit loads against smooth ones: what their errors have in common.
module epcont_accuracy_error_fields
  use epcont_accuracy_discretisation, only: error_product, error_products, stored_energy
  use epcont_accuracy_patches, only: patch_table
  use epcont_accuracy_recovery, only: recover_strains
  use epcont_accuracy_unit_motion, only: unit_strains
  use epcont_base_kinds, only: wp
  use epcont_plan_forecast, only: loads_at_once
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_scene_state, only: scene_state
  implicit none
  private
  public :: compare_fields, error_fields

  !> Strains less smooth ones are errors: their energies, and their products with those of unit loads.
  type :: error_fields
    real(wp), allocatable :: smooth(:, :)   !! strains of the answer [4, places of the patches]
    real(wp), allocatable :: element(:)     !! [energy] [elements]
    real(wp) :: energy = 0.0_wp             !! of the answer
    real(wp), allocatable :: along(:, :)    !! of all elements, of each without its sign [energy] [2, loads]
    real(wp), allocatable :: missing(:)     !! part of the energy of each unit load [loads]
  end type error_fields

contains

  !> Errors of the answer's strains, and what they have in common with those of unit loads.
  pure subroutine compare_fields(scene, linear, answer, table, unit_force, field)
    type(planned_scene), intent(in) :: scene
    type(linear_problem), intent(in) :: linear   !! of the last solve
    class(scene_state), intent(in) :: answer
    type(patch_table), intent(in) :: table
    real(wp), intent(in) :: unit_force(:, :)   !! contact forces under each unit load [pairs, loads]
    type(error_fields), intent(out) :: field
    real(wp), allocatable :: strain(:, :, :), smooth(:, :, :)   !! of the answer, then of some unit loads [4, any, 1 + loads]
    type(error_product) :: product
    integer :: first, j, loads

    allocate (field%along(2, size(unit_force, 2)), field%missing(size(unit_force, 2)))
    associate (model => scene%model, volume => linear%operator%volume)
      do first = 1, max(1, size(unit_force, 2)), loads_at_once
        loads = min(loads_at_once, size(unit_force, 2) - first + 1)
        allocate (strain(4, model%points, 1 + loads))
        strain(:, :, 1) = answer%strain
        do j = 1, loads
          strain(:, :, 1 + j) = unit_strains(scene, linear, unit_force(:, first - 1 + j))
        end do
        smooth = recover_strains(model, table, volume, strain)
        product = error_products(model, table, linear%materials, volume, strain, smooth, answer%point)
        do j = 1, loads
          field%along(:, first - 1 + j) = [sum(product%element(:, 1 + j)), sum(abs(product%element(:, 1 + j)))]
        end do
        field%missing(first:first + loads - 1) = product%missing(2:)
        deallocate (strain)
      end do
      field%energy = stored_energy(volume, answer%strain, answer%point_stress)
    end associate
    field%element = product%element(:, 1)
    field%smooth = smooth(:, :, 1)
  end subroutine compare_fields
end module epcont_accuracy_error_fields
