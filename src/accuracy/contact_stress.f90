!> What the smooth strains say at the pairs: the pressure, and how much the surfaces there give way.
module epcont_accuracy_contact_stress
  use epcont_accuracy_patches, only: patch_table
  use epcont_base_kinds, only: wp
  use epcont_material_curve, only: material_type
  use epcont_material_total_theory, only: respond, response_type
  use epcont_model_model, only: model_type, plane_stress
  use epcont_result_contact_line, only: contact_line
  implicit none
  private
  public :: smooth_pressures, surface_compliance

contains

  !> The normal stress at each pair, as a pressure, on the side on which its area lies [stress] [pairs].
  pure function smooth_pressures(model, table, material, line, smooth) result(pressure)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    type(material_type), intent(in) :: material(:)   !! of each section
    type(contact_line), intent(in) :: line
    real(wp), intent(in) :: smooth(:, :)             !! strains [4, places]
    real(wp), allocatable :: pressure(:)
    type(response_type) :: response
    integer :: k

    allocate (pressure(model%pairs), source=0.0_wp)
    do k = 1, model%pairs
      associate (node => line%node(k), n => model%normal(:, k))
        if (table%around%start(node) == table%around%start(node + 1)) cycle
        ! The first place of a node has its own number, and that of an element around it.
        response = respond(material(model%section(table%around%group(table%around%start(node)))), smooth(:, node))
        associate (s => response%stress)
          pressure(k) = -(s(1)*n(1)**2 + s(2)*n(2)**2 + 2.0_wp*s(4)*n(1)*n(2))
        end associate
      end associate
    end do
  end function smooth_pressures

  !> 1/E*, of both sides of a pair: (1 - nu**2)/E, 1/E of sheets, 0 of nodes without elements [1/stress].
  pure real(wp) function surface_compliance(model, table, pair) result(compliance)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    integer, intent(in) :: pair
    integer :: i, section

    compliance = 0.0_wp
    do i = model%row_start(pair), min(model%row_start(pair) + 1, model%row_start(pair + 1) - 1)
      associate (node => model%row_node(i))
        if (table%around%start(node) == table%around%start(node + 1)) cycle
        section = model%section(table%around%group(table%around%start(node)))
        compliance = compliance + (1.0_wp - merge(0.0_wp, model%poisson(section)**2, model%kinematics(section) == plane_stress)) &
                                  /model%young(section)
      end associate
    end do
  end function surface_compliance
end module epcont_accuracy_contact_stress
