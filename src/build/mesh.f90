!> Nodes, sections and elements from their cards.
module epcont_build_mesh
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real
  use epcont_build_materials, only: material_card, read_materials
  use epcont_build_reference, only: card_index, index_of, resolve
  use epcont_deck_card_kinds, only: card_grid, card_mat1, card_pshell, card_psolid
  use epcont_deck_deck, only: deck_type
  use epcont_element_element_kinds, only: element_kinds
  use epcont_element_kinematics, only: axisymmetric, plane_strain, plane_stress
  use epcont_model_element_shapes, only: complete_elements
  use epcont_model_finding, only: findings
  use epcont_model_given, only: add_elements, new_scene, set_sections
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_mesh, element_cards

contains

  !> Nodes, sections with their materials, elements.
  subroutine build_mesh(deck, nodes, model, found)
    type(deck_type), intent(in) :: deck       !! its cards
    type(card_index), intent(in) :: nodes     !! ids of GRID
    type(model_type), intent(out) :: model    !! the scene
    type(findings), intent(inout) :: found    !! what is wrong with it is added
    integer, allocatable :: cards(:)
    integer :: i

    associate (grid => deck%card(card_grid))
      model = new_scene(grid%value([grid%column('X1'), grid%column('X2')], :))
      model%node_id = int(grid%value(1, :))
      associate (z => grid%value(grid%column('X3'), :))
        do i = 1, grid%count
          if (z(i) /= 0.0_wp) &
            call found%add_error(card_grid, i, grid%column('X3'), ': field 6 (X3) is '//short_real(z(i))// &
                                 ', off the plane', '0.0: scenes lie in the x-y plane')
        end do
      end associate
    end associate
    call read_sections()
    cards = element_cards(deck)
    do i = 1, size(cards)
      call read_elements(cards(i))
    end do
    call complete_elements(model, found)

  contains

    !> PSHELL, then PSOLID, with their materials.
    subroutine read_sections()
      type(material_card), allocatable :: card(:)
      type(material_card) :: material(deck%card(card_pshell)%count + deck%card(card_psolid)%count)
      type(card_index) :: materials
      integer, dimension(size(material)) :: kinematics, named
      integer :: s

      call read_materials(deck, card, found)
      materials = index_of(deck, card_mat1)
      associate (shell => deck%card(card_pshell), solid => deck%card(card_psolid))
        call resolve(deck, card_pshell, shell%column('MID1'), materials, found, named(:shell%count))
        call resolve(deck, card_psolid, solid%column('MID'), materials, found, named(shell%count + 1:))
        kinematics = axisymmetric
        do s = 1, size(named)
          if (named(s) > 0) material(s) = card(named(s))
          if (s <= shell%count) call choose_kinematics(s, kinematics(s))
        end do
        call set_sections(model, material%young, material%poisson, kinematics)
        model%curve = material%curve
        model%thickness(:shell%count) = shell%value(shell%column('T'), :)
        model%property_id = nint([shell%value(1, :), solid%value(1, :)])
        model%material_id = nint([shell%value(shell%column('MID1'), :), solid%value(solid%column('MID'), :)])
      end associate
    end subroutine read_sections

    !> Plane strain or plane stress of a PSHELL: it says so, or PARAM PLANE.
    subroutine choose_kinematics(i, kinematics)
      integer, intent(in) :: i
      integer, intent(out) :: kinematics

      kinematics = merge(plane_stress, plane_strain, deck%parameter_word('PLANE', 'STRAIN') == 'STRESS')
      associate (shell => deck%card(card_pshell))
        if (.not. shell%sound(i)) return
        if (shell%has('MID2', i) .and. kinematics == plane_stress) then
          call found%add_error(card_pshell, i, shell%column('MID2'), &
                               ': field 5 (MID2) says plane strain, PARAM PLANE says STRESS', &
                               'one of the two only')
        else if (.not. shell%has('MID2', i) .and. deck%parameter_row('PLANE') == 0) then
          call found%add_error(card_pshell, i, shell%column('MID2'), &
                               ': neither plane strain nor plane stress is chosen', &
                               '-1 here for plane strain, or PARAM,PLANE,STRAIN or PARAM,PLANE,STRESS')
        end if
      end associate
    end subroutine choose_kinematics

    !> The elements of a table.
    subroutine read_elements(card)
      integer, intent(in) :: card
      integer :: k, n
      integer, allocatable :: node(:, :), section(:)
      logical :: ring

      associate (table => deck%card(card))
        ring = any(model%kinds%ring_card == table%entry%name)
        n = size(table%entry%field) - 2   ! without id and section
        allocate (node(n, table%count), section(table%count))
        call resolve(deck, card, 2, index_of(deck, merge(card_psolid, card_pshell, ring)), found, section)
        if (ring) where (section > 0) section = section + deck%card(card_pshell)%count
        do k = 1, n
          call resolve(deck, card, 2 + k, nodes, found, node(k, :))
        end do
        ! In their order along the boundary
        if (ring .and. n > 4) node = node([(k, k=1, n, 2), (k, k=2, n, 2)], :)
        call add_elements(model, table%entry%name, node, section)
        model%element_id(model%elements - table%count + 1:) = int(table%value(1, :))
      end associate
    end subroutine read_elements
  end subroutine build_mesh

  !> The cards of elements, in the order in which they are read: those that the table of elements names.
  pure function element_cards(deck) result(cards)
    type(deck_type), intent(in) :: deck   !! its cards
    integer, allocatable :: cards(:)
    character(len=8) :: name(size(deck%card))
    integer :: c

    name = deck%card%entry%name
    associate (kinds => element_kinds())
      cards = pack([(c, c=1, size(name))], &
                   [(any(kinds%plane_card == name(c) .or. kinds%ring_card == name(c)), c=1, size(name))])
    end associate
  end function element_cards
end module epcont_build_mesh
