!> Nodes, sections and elements from their cards.
module epcont_build_mesh
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real
  use epcont_build_materials, only: material_card, read_materials
  use epcont_build_reference, only: card_index, check_unique, index_of, resolve
  use epcont_deck_card_kinds, only: card_grid, card_mat1, card_param, card_pshell, card_psolid
  use epcont_deck_deck, only: deck_type
  use epcont_element_element_kinds, only: element_kinds
  use epcont_element_kinematics, only: axisymmetric, plane_strain, plane_stress
  use epcont_model_element_shapes, only: complete_elements
  use epcont_model_finding, only: findings
  use epcont_model_given, only: add_elements, new_scene, set_sections
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_nodes, build_sections, build_elements, element_cards

contains

  !> GRID.
  subroutine build_nodes(deck, model, found)
    type(deck_type), intent(in) :: deck   !! its cards
    type(model_type), intent(out) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: i, z

    call check_unique(deck, [card_grid], found)
    associate (grid => deck%card(card_grid))
      model = new_scene(grid%value([grid%column('X1'), grid%column('X2')], :))
      model%node_id = int(grid%value(1, :))
      z = grid%column('X3')
      do i = 1, grid%count
        if (grid%value(z, i) /= 0.0_wp) &
          call found%add_error(card_grid, i, z, ': field 6 (X3) is '//short_real(grid%value(z, i))// &
                               ', off the plane', &
                               '0.0: scenes lie in the x-y plane')
      end do
    end associate
  end subroutine build_nodes

  !> PSHELL, then PSOLID, with their materials.
  subroutine build_sections(deck, model, found)
    type(deck_type), intent(in) :: deck   !! its cards
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    type(material_card), allocatable :: card(:)
    type(material_card) :: material(deck%card(card_pshell)%count + deck%card(card_psolid)%count)
    type(card_index) :: materials
    integer, dimension(size(material)) :: kinematics, named
    integer :: i

    call check_unique(deck, [card_pshell, card_psolid], found)
    call read_materials(deck, card, found)
    materials = index_of(deck, card_mat1)
    associate (shell => deck%card(card_pshell), solid => deck%card(card_psolid))
      call resolve(deck, card_pshell, shell%column('MID1'), materials, found, named(:shell%count))
      call resolve(deck, card_psolid, solid%column('MID'), materials, found, named(shell%count + 1:))
      kinematics = axisymmetric
      do i = 1, size(named)
        if (named(i) > 0) material(i) = card(named(i))
        if (i <= shell%count) call choose_kinematics(deck, i, kinematics(i), found)
      end do
      call set_sections(model, material%young, material%poisson, kinematics)
      model%curve = material%curve
      model%thickness(:shell%count) = shell%value(shell%column('T'), :)
      model%property_id = nint([shell%value(1, :), solid%value(1, :)])
      model%material_id = nint([shell%value(shell%column('MID1'), :), solid%value(solid%column('MID'), :)])
    end associate
  end subroutine build_sections

  !> Plane strain or plane stress, from PSHELL or PARAM PLANE.
  pure subroutine choose_kinematics(deck, i, kinematics, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i             !! which PSHELL
    integer, intent(out) :: kinematics
    type(findings), intent(inout) :: found
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
        call found%add_error(card_pshell, i, mid2, &
                             ': field 5 (MID2) says plane strain, PARAM PLANE says STRESS', &
                             'one of the two only')
      else if (.not. shell%given(mid2, i) .and. plane == 0) then
        call found%add_error(card_pshell, i, mid2, ': neither plane strain nor plane stress is chosen', &
                             '-1 here for plane strain, or PARAM,PLANE,STRAIN or PARAM,PLANE,STRESS')
      end if
    end associate
  end subroutine choose_kinematics

  !> The cards of elements, in the order in which they are read: those that the table of elements names.
  pure function element_cards(deck) result(cards)
    type(deck_type), intent(in) :: deck   !! its cards
    integer, allocatable :: cards(:)
    character(len=8) :: name
    integer :: c

    allocate (cards(0))
    associate (kinds => element_kinds())
      do c = 1, size(deck%card)
        name = deck%card(c)%entry%name
        if (any(kinds%plane_card == name .or. kinds%ring_card == name)) cards = [cards, c]
      end do
    end associate
  end function element_cards

  !> All elements, card by card.
  subroutine build_elements(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck   !! its cards
    type(card_index), intent(in) :: nodes   !! ids of GRID
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer, allocatable :: cards(:), node(:, :), section(:)
    integer :: c, k, n
    logical :: ring

    cards = element_cards(deck)
    do c = 1, size(cards)
      associate (card => deck%card(cards(c)))
        ring = any(model%kinds%ring_card == card%entry%name)
        ! Without id and section
        allocate (node(size(card%entry%field) - 2, card%count), section(card%count))
        call resolve(deck, cards(c), 2, index_of(deck, merge(card_psolid, card_pshell, ring)), found, section)
        if (ring) where (section > 0) section = section + deck%card(card_pshell)%count
        do k = 1, size(node, 1)
          call resolve(deck, cards(c), 2 + k, nodes, found, node(k, :))
        end do
        n = size(node, 1)
        ! In their order along the boundary
        if (ring .and. n > 4) node = node([(k, k=1, n, 2), (k, k=2, n, 2)], :)
        call add_elements(model, card%entry%name, node, section)
        model%element_id(model%elements - card%count + 1:) = int(card%value(1, :))
        deallocate (node, section)
      end associate
    end do
    call complete_elements(model, found)
  end subroutine build_elements
end module epcont_build_mesh
