!> A model of sections that yield, without a mesh, and strains to test them.
module yielding_model
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: plane_strain, plane_stress
  use epcont_material_material_law, only: plastic_history, point_state
  use epcont_material_model_materials, only: model_materials
  use epcont_model_model, only: model_type
  use epcont_model_yield_curve, only: bilinear_curve
  implicit none
  private
  public :: new_yielding_model, state_at, strain_path

  !> Sections: five points in plane strain and in plane stress, perfectly plastic in both, nearly incompressible, elastic.
  integer, parameter, public :: sections = 6

contains

  pure function new_yielding_model(paper_ratio) result(model)
    logical, intent(in) :: paper_ratio
    type(model_type) :: model
    integer :: s

    model%sections%young = spread(200.0_wp, 1, 6)
    model%sections%poisson = [0.3_wp, 0.3_wp, 0.25_wp, 0.25_wp, 0.4999_wp, 0.3_wp]
    model%sections%kinematics = [plane_strain, plane_stress, plane_strain, plane_stress, plane_strain, &
                                 plane_strain]
    allocate (model%sections%curve(sections), model%mesh%section(0), model%mesh%point_element(0))
    do s = 1, 2
      model%sections%curve(s)%strain = [0.0_wp, 0.005_wp, 0.01_wp, 0.02_wp, 0.05_wp]
      model%sections%curve(s)%stress = [0.0_wp, 1.0_wp, 1.4_wp, 1.6_wp, 1.9_wp]
    end do
    do s = 3, 5
      model%sections%curve(s) = bilinear_curve(200.0_wp, 1.0_wp, 0.0_wp)
    end do
    model%controls%paper_ratio = paper_ratio
  end function new_yielding_model

  !> Result of the material law of a section at a strain, without committed states.
  pure function state_at(materials, section, strain) result(state)
    type(model_materials), intent(in) :: materials
    integer, intent(in) :: section
    real(wp), intent(in) :: strain(4)
    type(point_state) :: state

    call materials%section(section)%update(strain, plastic_history(), state)
  end function state_at

  !> Strains of all directions and sizes, from elastic to 50 times yield; every third in the plane only.
  pure function strain_path(k) result(strain)
    integer, intent(in) :: k   !! 1 to 200, say
    real(wp) :: strain(4)

    strain = 0.001_wp*1.03_wp**k*[cos(0.7_wp*k), sin(1.3_wp*k), sin(1.7_wp*k), 1.5_wp*cos(2.1_wp*k + 1.0_wp)]
    if (mod(k, 3) == 0) strain(3) = 0.0_wp
  end function strain_path
end module yielding_model
