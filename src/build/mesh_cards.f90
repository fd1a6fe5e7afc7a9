!> Nodes, materials, sections and elements from their cards.
module epcont_build_mesh_cards
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real
  use epcont_build_reference, only: card_index, index_of, resolve
  use epcont_deck_card_kinds, only: card_cgap, card_grid, card_mat1, card_mats1, card_param, card_pshell, &
      card_psolid, card_tables1, element_cards, ring_cards
  use epcont_deck_deck, only: deck_type
  use epcont_element_kinematics, only: axisymmetric, plane_strain, plane_stress
  use epcont_model_arrays, only: add_elements, new_scene, scene_type, set_sections
  use epcont_model_controls, only: uniaxial_curve
  use epcont_model_finding, only: findings, item_density, item_hardening, of_section
  use epcont_model_model, only: model_type
  use epcont_model_yield_curve, only: bilinear_curve, curve_fault, straighten
  implicit none
  private
  public :: read_mesh, take_ids

  real(wp), parameter :: &
    !> LIMIT1 and the table's yield stress may differ by this fraction.
    same_stress = 1.0e-4_wp, &
    !> If all three moduli are given, they agree to this fraction.
    same_moduli = 1.0e-3_wp

  type :: material_card
    real(wp) :: young = 1.0_wp      !! [stress]
    real(wp) :: poisson = 0.0_wp
    real(wp) :: expansion = 0.0_wp             !! [1/temperature]
    real(wp) :: reference_temperature = 0.0_wp
    real(wp) :: density = 1.0_wp    !! not zero, as a wrong card must not cause another error [mass/length**3]
    type(uniaxial_curve) :: curve
    integer :: yielding = 0         !! its MATS1, 0 if absent
  end type material_card

contains

  !> Read nodes, materials, sections and elements.
  subroutine read_mesh(deck, nodes, data, found)
    type(deck_type), intent(in) :: deck           !! its cards
    type(card_index), intent(in) :: nodes         !! ids of GRID
    type(scene_type), intent(out) :: data         !! gets nodes, sections and elements
    type(findings), intent(inout) :: found        !! errors are added
    type(material_card), allocatable :: material(:)   ! for each MAT1
    integer :: i

    associate (grid => deck%card(card_grid))
      data = new_scene(grid%value([grid%column('X1'), grid%column('X2')], :))
    end associate
    call read_materials(deck, found, material)
    call read_sections(deck, material, data, found)
    do i = 1, size(element_cards)
      call read_elements(element_cards(i))
    end do

  contains

    !> Read the elements of a table.
    subroutine read_elements(card)
      integer, intent(in) :: card
      integer :: k, n
      integer, allocatable :: node(:, :), section(:)
      logical :: ring

      associate (table => deck%card(card))
        ring = any(ring_cards == card)
        n = size(table%entry%field) - 2   ! without id and section
        allocate (node(n, table%count), section(table%count))
        call resolve(deck, card, 2, index_of(deck, merge(card_psolid, card_pshell, ring)), found, section)
        if (ring) where (section > 0) section = section + deck%card(card_pshell)%count
        do k = 1, n
          call resolve(deck, card, 2 + k, nodes, found, node(k, :))
        end do
        ! Reorder the nodes: corners first
        if (ring .and. n > 4) node = node([(k, k=1, n, 2), (k, k=2, n, 2)], :)
        call add_elements(data, table%entry%name, node, section)
      end associate
    end subroutine read_elements
  end subroutine read_mesh

  !> Take the ids of nodes, elements, sections and pairs from their cards.
  subroutine take_ids(deck, data, model)
    type(deck_type), intent(in) :: deck          !! its cards
    type(scene_type), intent(inout) :: data      !! gets the ids of sections
    type(model_type), intent(inout) :: model     !! gets the other ids
    integer :: i

    model%mesh%node_id = int(deck%card(card_grid)%value(1, :))
    model%mesh%element_id = [(int(deck%card(element_cards(i))%value(1, :)), i=1, size(element_cards))]
    associate (shell => deck%card(card_pshell), solid => deck%card(card_psolid))
      data%property_id = nint([shell%value(1, :), solid%value(1, :)])
      data%material_id = nint([shell%value(shell%column('MID1'), :), &
                               solid%value(solid%column('MID'), :)])
    end associate
    ! CGAPs that are switched off are no pairs.
    model%contact%pair_id = nint(deck%card(card_cgap)%value(1, :size(data%initial_gap)))
  end subroutine take_ids

  !> Report an error in a field.
  subroutine refuse(deck, card, i, name, what, remedy, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card, i
    character(len=*), intent(in) :: name, what, remedy   !! field, fault and remedy
    type(findings), intent(inout) :: found

    call found%add_error(card, i, deck%card(card)%column(name), what, remedy)
  end subroutine refuse

  !> Read one material for each MAT1, with its curve.
  subroutine read_materials(deck, found, material)
    type(deck_type), intent(in) :: deck
    type(findings), intent(inout) :: found
    type(material_card), allocatable, intent(inout) :: material(:)
    integer, dimension(deck%card(card_mats1)%count) :: m, table    ! the MAT1; the TABLES1, 0 if absent
    integer :: i

    associate (mat1 => deck%card(card_mat1), mats1 => deck%card(card_mats1))
      allocate (material(mat1%count))
      do i = 1, mat1%count
        if (mat1%sound(i)) call read_elasticity(deck, i, found, material)
      end do
      call resolve(deck, card_mats1, 1, index_of(deck, card_mat1), found, m)
      call resolve(deck, card_mats1, mats1%column('TID'), index_of(deck, card_tables1), found, table)
      do i = 1, mats1%count
        if (m(i) == 0 .or. .not. mats1%sound(i)) cycle
        if (material(m(i))%young > 0.0_wp) call read_yielding(deck, i, table(i), material(m(i)), found)
        material(m(i))%yielding = i
        material(m(i))%curve%kinematic = kinematic_part(deck, i, found)
        material(m(i))%curve%elastic = mats1%word(mats1%column('TYPE'), i) == 'NLELAST'
      end do
      if (deck%parameter_row('HRFRAC') > 0 .and. all(nint(mats1%value(mats1%column('HR'), :)) /= 3)) &
        call found%add_note(card_param, deck%parameter_row('HRFRAC'), 1, &
                            ' has no effect without HR 3 (MATS1)')
    end associate
  end subroutine read_materials

  !> Read MAT1: E and NU from two of E, G, NU.
  subroutine read_elasticity(deck, i, found, material)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(findings), intent(inout) :: found
    type(material_card), allocatable, intent(inout) :: material(:)
    real(wp) :: shear

    associate (mat1 => deck%card(card_mat1), young => material(i)%young, poisson => material(i)%poisson)
      young = mat1%number('E', i)
      shear = mat1%number('G', i)
      poisson = mat1%number('NU', i)
      material(i)%expansion = mat1%number('A', i)
      material(i)%reference_temperature = mat1%number('TREF', i)
      material(i)%density = mat1%number('RHO', i)
      if (count([mat1%has('E', i), mat1%has('G', i), mat1%has('NU', i)]) < 2) then
        call refuse(deck, card_mat1, i, 'E', ': two of E, G and NU are needed', &
                    'give E and NU, for example', found)
      else if (.not. mat1%has('NU', i)) then
        poisson = young/(2.0_wp*shear) - 1.0_wp
        if (poisson < 0.0_wp .or. poisson >= 0.5_wp) &
          call refuse(deck, card_mat1, i, 'G', ': E and G give NU = '//short_real(poisson), &
                      'give a G above E/3 and at most E/2: 0 <= NU < 0.5', found)
      else if (.not. mat1%has('E', i)) then
        young = 2.0_wp*shear*(1.0_wp + poisson)
      else if (mat1%has('G', i) .and. abs(2.0_wp*shear*(1.0_wp + poisson) - young) > same_moduli*young) then
        call refuse(deck, card_mat1, i, 'G', ': G is not E/(2(1 + NU))', 'leave G blank', found)
      end if
    end associate
  end subroutine read_elasticity

  !> Read MATS1: the curve of its table, or the bilinear curve of LIMIT1 and H.
  subroutine read_yielding(deck, i, table, material, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i, table   !! the MATS1, the TABLES1
    type(material_card), intent(inout) :: material
    type(findings), intent(inout) :: found

    associate (mats1 => deck%card(card_mats1))
      if (.not. mats1%has('TID', i)) then
        if (mats1%has('LIMIT1', i)) then
          material%curve = bilinear_curve(material%young, mats1%number('LIMIT1', i), mats1%number('H', i))
        else
          call refuse(deck, card_mats1, i, 'LIMIT1', ': neither a table nor a yield stress', &
                      'give TID, or LIMIT1 and H', found)
        end if
        return
      end if
      if (mats1%has('H', i)) call refuse(deck, card_mats1, i, 'H', ': field 5 (H) is given beside a table', &
          'leave H or TID blank', found)
      if (.not. mats1%has('LIMIT1', i) .and. mats1%word(mats1%column('TYPE'), i) == 'PLASTIC') &
        call refuse(deck, card_mats1, i, 'LIMIT1', ': field 8 (LIMIT1) is blank', &
                    'give the yield stress: the second stress of the table', found)
    end associate
    if (table > 0) call read_table(deck, i, table, material%young, material%curve, found)
  end subroutine read_yielding

  !> Read the kinematic part of the hardening: HR, and PARAM HRFRAC.
  real(wp) function kinematic_part(deck, i, found) result(part)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i   !! the MATS1
    type(findings), intent(inout) :: found

    part = 0.0_wp
    if (deck%card(card_mats1)%word(deck%card(card_mats1)%column('TYPE'), i) == 'NLELAST') then
      if (nint(deck%card(card_mats1)%number('HR', i)) > 1) call refuse(deck, card_mats1, i, 'HR', &
        ': field 7 (HR): NLELAST is elastic and does not harden', 'use HR 1, or TYPE PLASTIC', found)
      return
    end if
    select case (nint(deck%card(card_mats1)%number('HR', i)))
    case (2)
      part = 1.0_wp
    case (3)
      if (deck%parameter_row('HRFRAC') == 0) call refuse(deck, card_mats1, i, 'HR', &
        ': field 7 (HR) is 3, and the kinematic part of the hardening is missing', &
        'add PARAM HRFRAC, from 0 to 1; or use HR 1 (isotropic) or 2 (kinematic)', found)
      part = deck%parameter_value('HRFRAC', 1.0_wp)
    end select
  end function kinematic_part

  !> Read TABLES1. Its yield stress is kept; its yield strain is replaced by stress over E, so that the
  !! elastic part is that of the MAT1.
  subroutine read_table(deck, i, t, young, curve, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i, t   !! the MATS1, the TABLES1
    real(wp), intent(in) :: young
    type(uniaxial_curve), intent(inout) :: curve
    type(findings), intent(inout) :: found
    type(curve_fault) :: fault
    real(wp) :: limit
    integer :: first

    associate (tables1 => deck%card(card_tables1))
      first = tables1%list_start(t)
      curve%strain = tables1%list(first:tables1%list_start(t + 1) - 1)%number(1)
      curve%stress = tables1%list(first:tables1%list_start(t + 1) - 1)%number(2)
      call straighten(curve, young, fault)
      if (fault%point > 0) then
        call found%add_error(card_tables1, t, merge(1 - first - fault%point, 0, &
                             fault%point <= size(curve%strain)), ': '//fault%what, fault%remedy)
        return
      end if
      limit = deck%card(card_mats1)%number('LIMIT1', i)
      associate (stress => curve%stress(2))
        if (deck%card(card_mats1)%has('LIMIT1', i) .and. abs(limit - stress) > same_stress*stress) &
          call refuse(deck, card_mats1, i, 'LIMIT1', ': field 8 (LIMIT1) is '//short_real(limit)// &
                      ', the second stress of '//tables1%identity(t)//' '//short_real(stress), &
                      'give the same stress in both', found)
      end associate
    end associate
  end subroutine read_table

  !> Read PSHELL, then PSOLID.
  subroutine read_sections(deck, material, data, found)
    type(deck_type), intent(in) :: deck
    type(material_card), intent(in) :: material(:)
    type(scene_type), intent(inout) :: data
    type(findings), intent(inout) :: found
    type(material_card) :: section(deck%card(card_pshell)%count + deck%card(card_psolid)%count)
    type(card_index) :: materials
    integer, dimension(size(section)) :: kinematics, named
    integer :: s

    materials = index_of(deck, card_mat1)
    associate (shell => deck%card(card_pshell), solid => deck%card(card_psolid))
      call resolve(deck, card_pshell, shell%column('MID1'), materials, found, named(:shell%count))
      call resolve(deck, card_psolid, solid%column('MID'), materials, found, named(shell%count + 1:))
      kinematics = axisymmetric
      do s = 1, size(named)
        if (named(s) > 0) section(s) = material(named(s))
        ! Without a MAT1 the finding is at the section.
        if (named(s) > 0) call found%add_origin([of_section, s, item_density], &
            [card_mat1, named(s), deck%card(card_mat1)%column('RHO')])
        if (section(s)%yielding > 0) call found%add_origin([of_section, s, item_hardening], &
            [card_mats1, section(s)%yielding, deck%card(card_mats1)%column('HR')])
        if (s <= shell%count) call choose_kinematics(deck, s, kinematics(s), found)
      end do
      if (deck%parameter_word('PLANE') == 'STRESS' .and. all(kinematics /= plane_stress) .and. &
          shell%count > 0) &
        call found%add_note(card_param, deck%parameter_row('PLANE'), 2, &
                            ': no PSHELL leaves the choice to it')
      call set_sections(data, section%young, section%poisson, kinematics)
      data%curve = section%curve
      data%expansion = section%expansion
      data%reference_temperature = section%reference_temperature
      data%thickness(:shell%count) = shell%value(shell%column('T'), :)
      data%density = section%density
      where (data%thickness(:shell%count) > 0.0_wp) &
        data%density(:shell%count) = data%density(:shell%count) + &
                                      shell%value(shell%column('NSM'), :)/data%thickness(:shell%count)
      data%density = deck%parameter_value('WTMASS', 1.0_wp)*data%density
    end associate
  end subroutine read_sections

  !> Choose plane strain or plane stress for a PSHELL: the card gives plane strain, or PARAM PLANE chooses.
  subroutine choose_kinematics(deck, i, kinematics, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    integer, intent(out) :: kinematics
    type(findings), intent(inout) :: found
    logical :: strain

    kinematics = merge(plane_stress, plane_strain, deck%parameter_word('PLANE') == 'STRESS')
    associate (shell => deck%card(card_pshell))
      if (.not. shell%sound(i)) return
      strain = shell%number('MID2', i) < 0.0_wp
      if (strain) then
        kinematics = plane_strain
      else if (deck%parameter_row('PLANE') == 0) then
        call refuse(deck, card_pshell, i, 'MID2', ': neither plane strain nor plane stress is chosen', &
                    'write -1 here for plane strain, or add PARAM,PLANE,STRAIN or PARAM,PLANE,STRESS', found)
      end if
    end associate
  end subroutine choose_kinematics
end module epcont_build_mesh_cards
