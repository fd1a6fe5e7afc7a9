!> Nodes and sections from their cards.
module epcont_build_mesh
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index
  use epcont_base_text, only: short_real
  use epcont_build_materials, only: material_card, read_materials
  use epcont_build_reference, only: check_unique, index_of_ids, resolve
  use epcont_deck_card_kinds, only: card_grid, card_mat1, card_param, card_pshell, card_psolid
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_element_kinematics, only: axisymmetric, plane_strain, plane_stress
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_nodes, build_sections

contains

  !> GRID.
  subroutine build_nodes(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    integer :: i, z

    call check_unique(deck, [card_grid], faults)
    associate (grid => deck%card(card_grid))
      model%nodes = grid%count
      model%node_id = int(grid%value(1, :))
      allocate (model%x(2, grid%count))
      model%x(1, :) = grid%value(grid%column('X1'), :)
      model%x(2, :) = grid%value(grid%column('X2'), :)
      z = grid%column('X3')
      do i = 1, grid%count
        if (grid%value(z, i) == 0.0_wp) cycle
        call faults%add_error(deck%place(card_grid, i, z), deck%identity(card_grid, i)// &
                              ': field 6 (X3) is '//short_real(grid%value(z, i))//', off the plane', &
                              '0.0: scenes lie in the x-y plane')
      end do
    end associate
  end subroutine build_nodes

  !> PSHELL, then PSOLID, with their materials.
  subroutine build_sections(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    type(material_card), allocatable :: card(:)
    type(id_index) :: materials
    integer :: i, material, sections

    call check_unique(deck, [card_pshell, card_psolid], faults)
    call read_materials(deck, card, faults)
    materials = index_of_ids(deck, card_mat1)
    associate (shell => deck%card(card_pshell), solid => deck%card(card_psolid))
      sections = shell%count + solid%count
      allocate (model%thickness(sections), model%young(sections), source=1.0_wp)
      allocate (model%poisson(sections), source=0.0_wp)
      allocate (model%kinematics(sections), source=axisymmetric)
      allocate (model%curve(sections))
      model%property_id = nint([shell%value(1, :), solid%value(1, :)])
      model%material_id = nint([shell%value(shell%column('MID1'), :), solid%value(solid%column('MID'), :)])
      model%thickness(:shell%count) = shell%value(shell%column('T'), :)
      do i = 1, shell%count
        call resolve(deck, card_pshell, i, shell%column('MID1'), materials, 'MAT1', faults, material)
        if (material > 0) call set_material(card(material), i)
        call choose_kinematics(deck, i, model%kinematics(i), faults)
      end do
      do i = 1, solid%count
        call resolve(deck, card_psolid, i, solid%column('MID'), materials, 'MAT1', faults, material)
        if (material > 0) call set_material(card(material), shell%count + i)
      end do
    end associate

  contains

    subroutine set_material(from, section)
      type(material_card), intent(in) :: from
      integer, intent(in) :: section

      model%young(section) = from%young
      model%poisson(section) = from%poisson
      model%curve(section) = from%curve
    end subroutine set_material
  end subroutine build_sections

  !> Plane strain or plane stress, from PSHELL or PARAM PLANE.
  subroutine choose_kinematics(deck, i, kinematics, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i             !! which PSHELL
    integer, intent(out) :: kinematics
    type(diagnostics), intent(inout) :: faults
    integer :: mid2, plane

    plane = deck%parameter_row('PLANE')
    kinematics = plane_strain
    if (plane > 0) then
      if (deck%card(card_param)%word(2, plane) /= 'STRAIN') kinematics = plane_stress
    end if
    associate (shell => deck%card(card_pshell))
      if (.not. shell%sound(i)) return
      mid2 = shell%column('MID2')
      if (shell%given(mid2, i) .and. kinematics == plane_stress) then
        call faults%add_error(deck%place(card_pshell, i, mid2), deck%identity(card_pshell, i)// &
                              ': field 5 (MID2) says plane strain, PARAM PLANE says STRESS', 'one of the two only')
      else if (.not. shell%given(mid2, i) .and. plane == 0) then
        call faults%add_error(deck%place(card_pshell, i, mid2), deck%identity(card_pshell, i)// &
                              ': neither plane strain nor plane stress is chosen', &
                              '-1 here for plane strain, or PARAM,PLANE,STRAIN or PARAM,PLANE,STRESS')
      end if
    end associate
  end subroutine choose_kinematics
end module epcont_build_mesh
