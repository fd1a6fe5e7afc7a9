!> Nodes, sections and elements from their cards.
module epcont_model_mesh
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index
  use epcont_base_text, only: short_real, text_of
  use epcont_deck_deck, only: card_ctria3, card_grid, card_mat1, card_param, card_pshell, deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_model_materials, only: material_card, read_materials
  use epcont_model_model, only: model_type
  use epcont_model_reference, only: check_unique, index_of_ids, resolve
  implicit none
  private
  public :: build_nodes, build_sections, build_elements

  !> An area up to this part of the square of the longest edge is rounding: the corners lie on one line.
  real(wp), parameter :: sliver = 1.0e-12_wp

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
      model%node_id = nint(grid%value(1, :))
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

  !> PSHELL with its material.
  subroutine build_sections(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    type(id_index) :: materials
    type(material_card), allocatable :: card(:)
    integer :: i, material, mid2, plane

    call read_materials(deck, card, faults)
    materials = index_of_ids(deck, card_mat1)
    plane = deck%parameter_row('PLANE')
    associate (shell => deck%card(card_pshell))
      allocate (model%thickness(shell%count), model%young(shell%count), model%poisson(shell%count), source=1.0_wp)
      allocate (model%plane_strain(shell%count), source=.true.)
      allocate (model%curve(shell%count))
      model%thickness = shell%value(shell%column('T'), :)
      mid2 = shell%column('MID2')
      do i = 1, shell%count
        call resolve(deck, card_pshell, i, shell%column('MID1'), materials, 'MAT1', faults, material)
        if (material > 0) then
          model%young(i) = card(material)%young
          model%poisson(i) = card(material)%poisson
          model%curve(i) = card(material)%curve
        end if
        if (plane > 0) model%plane_strain(i) = deck%card(card_param)%word(2, plane) == 'STRAIN'
        if (.not. shell%sound(i)) cycle
        if (shell%given(mid2, i) .and. .not. model%plane_strain(i)) then
          call faults%add_error(deck%place(card_pshell, i, mid2), deck%identity(card_pshell, i)// &
                                ': field 5 (MID2) says plane strain, PARAM PLANE says STRESS', 'one of the two only')
        else if (.not. shell%given(mid2, i) .and. plane == 0) then
          call faults%add_error(deck%place(card_pshell, i, mid2), deck%identity(card_pshell, i)// &
                                ': neither plane strain nor plane stress is chosen', &
                                '-1 here for plane strain, or PARAM,PLANE,STRAIN or PARAM,PLANE,STRESS')
        end if
      end do
    end associate
  end subroutine build_sections

  !> CTRIA3, turned counter-clockwise.
  subroutine build_elements(deck, nodes, model, faults)
    type(deck_type), intent(in) :: deck
    type(id_index), intent(in) :: nodes
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    type(id_index) :: sections
    integer :: first, i, k, pid

    call check_unique(deck, [card_pshell], faults)
    sections = index_of_ids(deck, card_pshell)
    associate (tria => deck%card(card_ctria3))
      model%elements = tria%count
      model%element_id = nint(tria%value(1, :))
      allocate (model%corner(3, tria%count), model%section(tria%count))
      first = tria%column('G1')
      pid = tria%column('PID')
      do i = 1, tria%count
        call resolve(deck, card_ctria3, i, pid, sections, 'PSHELL', faults, model%section(i))
        do k = 1, 3
          call resolve(deck, card_ctria3, i, first + k - 1, nodes, 'GRID', faults, model%corner(k, i))
        end do
        if (all(model%corner(:, i) > 0)) call check_shape(deck, i, model, faults)
      end do
    end associate
  end subroutine build_elements

  !> Turn the element counter-clockwise; corners on one line are a fault.
  subroutine check_shape(deck, i, model, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    real(wp) :: area, longest, x(2, 3)

    x = model%corners(i)
    longest = maxval(sum((x - cshift(x, 1, dim=2))**2, dim=1))
    area = model%area(i)
    if (abs(area) <= sliver*longest) then
      call faults%add_error(deck%place(card_ctria3, i, 4), deck%identity(card_ctria3, i)// &
                            ': its corners '//text_of(model%node_id(model%corner(1, i)))//', '// &
                            text_of(model%node_id(model%corner(2, i)))//' and '// &
                            text_of(model%node_id(model%corner(3, i)))//' lie on one line', 'corners that span an area')
    else if (area < 0.0_wp) then
      model%corner(2:3, i) = model%corner([3, 2], i)
    end if
  end subroutine check_shape
end module epcont_model_mesh
