!> Materials from MAT1, and their yielding from MATS1 and TABLES1.
module epcont_build_materials
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_build_reference, only: check_unique, index_of_ids, resolve
  use epcont_deck_card_kinds, only: card_mat1, card_mats1, card_tables1
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_model_controls, only: uniaxial_curve
  implicit none
  private
  public :: material_card, read_materials

  !> LIMIT1 and the table's yield stress may differ by this part.
  real(wp), parameter :: same_stress = 1.0e-4_wp
  !> The table's yield strain and LIMIT1/E may differ by this part; LIMIT1/E is used.
  real(wp), parameter :: same_strain = 1.0e-2_wp

  type :: material_card
    real(wp) :: young = 1.0_wp      !! [stress]
    real(wp) :: poisson = 0.0_wp
    type(uniaxial_curve) :: curve
  end type material_card

contains

  !> One material a MAT1, with its curve.
  subroutine read_materials(deck, material, faults)
    type(deck_type), intent(in) :: deck
    type(material_card), allocatable, intent(out) :: material(:)
    type(diagnostics), intent(inout) :: faults
    type(id_index) :: materials, tables
    integer :: i, m

    call check_unique(deck, [card_mat1], faults)
    call check_unique(deck, [card_mats1], faults)
    call check_unique(deck, [card_tables1], faults)
    allocate (material(deck%card(card_mat1)%count))
    do i = 1, size(material)
      if (deck%card(card_mat1)%sound(i)) call read_elasticity(deck, i, material(i), faults)
    end do
    materials = index_of_ids(deck, card_mat1)
    tables = index_of_ids(deck, card_tables1)
    do i = 1, deck%card(card_mats1)%count
      call resolve(deck, card_mats1, i, 1, materials, 'MAT1', faults, m)
      if (m == 0 .or. .not. deck%card(card_mats1)%sound(i)) cycle
      if (.not. deck%card(card_mat1)%sound(m) .or. material(m)%young <= 0.0_wp) cycle   ! a fault of its MAT1
      call read_yielding(deck, i, tables, material(m), faults)
    end do
  end subroutine read_materials

  !> MAT1: E and NU from two of E, G, NU.
  subroutine read_elasticity(deck, i, material, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(material_card), intent(inout) :: material
    type(diagnostics), intent(inout) :: faults
    real(wp) :: shear
    integer :: e, g, nu

    associate (card => deck%card(card_mat1), young => material%young, poisson => material%poisson)
      e = card%column('E')
      g = card%column('G')
      nu = card%column('NU')
      young = card%value(e, i)
      poisson = card%value(nu, i)
      shear = card%value(g, i)
      if (count(card%given([e, g, nu], i)) < 2) then
        call faults%add_error(deck%place(card_mat1, i, e), deck%identity(card_mat1, i)// &
                              ': of E, G and NU two are needed', 'E and NU, say')
      else if (.not. card%given(nu, i)) then
        poisson = young/(2.0_wp*shear) - 1.0_wp
        if (poisson < 0.0_wp .or. poisson >= 0.5_wp) &
          call faults%add_error(deck%place(card_mat1, i, g), deck%identity(card_mat1, i)//': E and G give NU = '// &
                                short_real(poisson), '0 <= NU < 0.5: G above E/3, up to E/2')
      else if (.not. card%given(e, i)) then
        young = 2.0_wp*shear*(1.0_wp + poisson)
      else if (card%given(g, i)) then
        if (abs(shear*2.0_wp*(1.0_wp + poisson) - young) > 1.0e-3_wp*young) &
          call faults%add_error(deck%place(card_mat1, i, g), deck%identity(card_mat1, i)// &
                                ': G is not E/(2(1 + NU))', 'a blank G')
      end if
    end associate
  end subroutine read_elasticity

  !> MATS1: the curve of its table, or the bilinear one of LIMIT1 and H.
  subroutine read_yielding(deck, i, tables, material, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(id_index), intent(in) :: tables
    type(material_card), intent(inout) :: material
    type(diagnostics), intent(inout) :: faults
    integer :: h, limit, table, tid

    associate (card => deck%card(card_mats1))
      tid = card%column('TID')
      h = card%column('H')
      limit = card%column('LIMIT1')
      if (.not. card%given(tid, i)) then
        if (card%given(limit, i)) then
          call make_bilinear(card%value(limit, i), card%value(h, i), material)
        else
          call faults%add_error(deck%place(card_mats1, i, limit), deck%identity(card_mats1, i)// &
                                ': neither a table nor a yield stress', 'TID, or LIMIT1 and H')
        end if
        return
      end if
      if (card%given(h, i)) call faults%add_error(deck%place(card_mats1, i, h), deck%identity(card_mats1, i)// &
        ': field 5 (H) is given beside a table', 'a blank H, or a blank TID')
      if (.not. card%given(limit, i) .and. card%word(card%column('TYPE'), i) == 'PLASTIC') &
        call faults%add_error(deck%place(card_mats1, i, limit), deck%identity(card_mats1, i)// &
                              ': field 8 (LIMIT1) is blank', 'the yield stress: the second stress of the table')
      call resolve(deck, card_mats1, i, tid, tables, 'TABLES1', faults, table)
      if (table == 0) return
      if (deck%card(card_tables1)%sound(table)) call read_table(deck, i, table, material, faults)
    end associate
  end subroutine read_yielding

  !> H is the slope over plastic strain: E H/(E + H) over total strain.
  pure subroutine make_bilinear(yield_stress, hardening, material)
    real(wp), intent(in) :: yield_stress, hardening
    type(material_card), intent(inout) :: material
    real(wp) :: slope, yield_strain

    slope = material%young*(hardening/(material%young + hardening))
    yield_strain = yield_stress/material%young
    material%curve%strain = [0.0_wp, yield_strain, 2.0_wp*yield_strain]
    material%curve%stress = [0.0_wp, yield_stress, yield_stress + slope*yield_strain]
    material%curve%ends = .false.
  end subroutine make_bilinear

  !> TABLES1. Its yield stress is kept and its yield strain replaced by that over E, so that the elastic part is
  !! MAT1's.
  subroutine read_table(deck, i, table, material, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i, table           !! the MATS1, the TABLES1
    type(material_card), intent(inout) :: material
    type(diagnostics), intent(inout) :: faults
    real(wp), allocatable :: strain(:), stress(:)
    character(len=:), allocatable :: what, remedy
    real(wp) :: limit
    integer :: first, point, wrong

    associate (tables => deck%card(card_tables1))
      first = tables%list_start(table)
      strain = tables%list(first:tables%list_start(table + 1) - 1)%point(1)
      stress = tables%list(first:tables%list_start(table + 1) - 1)%point(2)
    end associate
    call check_table(strain, stress, material%young, wrong, what, remedy)
    if (wrong == 0) then
      point = deck%card(card_mats1)%column('LIMIT1')
      if (deck%card(card_mats1)%given(point, i)) then
        limit = deck%card(card_mats1)%value(point, i)
        if (abs(limit - stress(2)) > same_stress*stress(2)) &
          call faults%add_error(deck%place(card_mats1, i, point), deck%identity(card_mats1, i)//': field 8 (LIMIT1) is '// &
                                short_real(limit)//', the second stress of '//deck%identity(card_tables1, table)//' '// &
                                short_real(stress(2)), 'the same stress in both')
      end if
      strain(2) = stress(2)/material%young
      material%curve%strain = strain
      material%curve%stress = stress
      material%curve%ends = .true.
    else if (wrong <= size(strain)) then
      call faults%add_error(deck%list_place(card_tables1, first + wrong - 1), deck%identity(card_tables1, table)//': '// &
                            what, remedy)
    else
      call faults%add_error(deck%place(card_tables1, table, 0), deck%identity(card_tables1, table)//': '//what, remedy)
    end if
  end subroutine read_table

  !> The first point of a curve that cannot be, and why; 0 where all can. A number beyond the last point: one is missing.
  pure subroutine check_table(strain, stress, young, wrong, what, remedy)
    real(wp), intent(in) :: strain(:), stress(:), young
    integer, intent(out) :: wrong
    character(len=:), allocatable, intent(out) :: what, remedy

    if (size(strain) < 3) then
      wrong = size(strain) + 1
      what = 'has '//plural(size(strain), 'point')
      remedy = 'at least 3: 0.0 0.0, the yield point, and one beyond it'
    else if (strain(1) /= 0.0_wp .or. stress(1) /= 0.0_wp) then
      wrong = 1
      what = 'the first point is not 0.0, 0.0'
      remedy = 'a curve from the origin'
    else if (stress(2) <= 0.0_wp .or. abs(strain(2) - stress(2)/young) > same_strain*abs(stress(2)/young)) then
      wrong = 2
      what = 'the yield point (the second one) is not on the elastic line of the MAT1'
      remedy = 'strain = stress/E within 1 %'
      if (stress(2) > 0.0_wp) remedy = 'strain '//short_real(stress(2)/young)//', stress/E, within 1 %'
    else
      call check_beyond_yield([stress(2)/young, strain(3:)], stress(2:), young, wrong, what, remedy)
      if (wrong > 0) then
        wrong = wrong + 1
        what = 'point '//text_of(wrong)//': '//what
      end if
    end if
  end subroutine check_table

  !> The first point behind the yield point that cannot be, and why; 0 where all can.
  pure subroutine check_beyond_yield(strain, stress, young, wrong, what, remedy)
    real(wp), intent(in) :: strain(:), stress(:), young   !! from the yield point on
    integer, intent(out) :: wrong
    character(len=:), allocatable, intent(out) :: what, remedy
    integer :: k

    do k = 1, size(strain) - 1
      wrong = k + 1
      if (strain(k + 1) <= strain(k)) then
        what = 'the strain does not rise'
        remedy = 'more than '//short_real(strain(k))
      else if (stress(k + 1) < stress(k)) then
        what = 'the stress falls (softening)'
        remedy = 'at least '//short_real(stress(k))
      else if (stress(k + 1) - stress(k) > young*(strain(k + 1) - strain(k))) then
        what = 'steeper than the elastic line of the MAT1'
        remedy = 'a slope of at most E'
      else
        cycle
      end if
      return
    end do
    wrong = 0
  end subroutine check_beyond_yield
end module epcont_build_materials
