!> Materials from MAT1, and their yielding from MATS1 and TABLES1.
module epcont_build_materials
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real
  use epcont_build_reference, only: check_unique, index_of, resolve
  use epcont_deck_card_kinds, only: card_mat1, card_mats1, card_tables1
  use epcont_deck_deck, only: deck_type
  use epcont_model_controls, only: uniaxial_curve
  use epcont_model_finding, only: findings
  use epcont_model_yield_curve, only: bilinear_curve, check_curve
  implicit none
  private
  public :: material_card, read_materials

  !> LIMIT1 and the table's yield stress may differ by this part.
  real(wp), parameter :: same_stress = 1.0e-4_wp
  !> Moduli that are all three given agree to this part.
  real(wp), parameter :: same_moduli = 1.0e-3_wp

  type :: material_card
    real(wp) :: young = 1.0_wp      !! [stress]
    real(wp) :: poisson = 0.0_wp
    type(uniaxial_curve) :: curve
  end type material_card

contains

  !> One material a MAT1, with its curve.
  pure subroutine read_materials(deck, material, found)
    type(deck_type), intent(in) :: deck   !! its cards
    type(material_card), allocatable, intent(out) :: material(:)   !! [MAT1]
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer, allocatable :: m(:), table(:)   ! the MAT1, the TABLES1 of each MATS1; 0: none
    integer :: i

    call check_unique(deck, [card_mat1], found)
    call check_unique(deck, [card_mats1], found)
    call check_unique(deck, [card_tables1], found)
    associate (mat1 => deck%card(card_mat1), mats1 => deck%card(card_mats1))
      allocate (material(mat1%count), m(mats1%count), table(mats1%count))
      do i = 1, mat1%count
        if (mat1%sound(i)) call read_elasticity(deck, i, material(i), found)
      end do
      call resolve(deck, card_mats1, 1, index_of(deck, card_mat1), found, m)
      call resolve(deck, card_mats1, mats1%column('TID'), index_of(deck, card_tables1), found, table)
      do i = 1, mats1%count
        if (m(i) == 0 .or. .not. mats1%sound(i)) cycle
        if (.not. mat1%sound(m(i)) .or. material(m(i))%young <= 0.0_wp) cycle   ! a fault of its MAT1
        call read_yielding(deck, i, table(i), material(m(i)), found)
      end do
    end associate
  end subroutine read_materials

  !> MAT1: E and NU from two of E, G, NU.
  pure subroutine read_elasticity(deck, i, material, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(material_card), intent(inout) :: material
    type(findings), intent(inout) :: found
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
        call found%add_error(card_mat1, i, e, ': of E, G and NU two are needed', 'E and NU, say')
      else if (.not. card%given(nu, i)) then
        poisson = young/(2.0_wp*shear) - 1.0_wp
        if (poisson < 0.0_wp .or. poisson >= 0.5_wp) &
          call found%add_error(card_mat1, i, g, ': E and G give NU = '//short_real(poisson), &
                               '0 <= NU < 0.5: G above E/3, up to E/2')
      else if (.not. card%given(e, i)) then
        young = 2.0_wp*shear*(1.0_wp + poisson)
      else if (card%given(g, i)) then
        if (abs(shear*2.0_wp*(1.0_wp + poisson) - young) > same_moduli*young) &
          call found%add_error(card_mat1, i, g, ': G is not E/(2(1 + NU))', 'a blank G')
      end if
    end associate
  end subroutine read_elasticity

  !> MATS1: the curve of its table, or the bilinear one of LIMIT1 and H.
  pure subroutine read_yielding(deck, i, table, material, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i, table           !! the MATS1, the TABLES1
    type(material_card), intent(inout) :: material
    type(findings), intent(inout) :: found
    integer :: h, limit

    associate (card => deck%card(card_mats1))
      h = card%column('H')
      limit = card%column('LIMIT1')
      if (.not. card%given(card%column('TID'), i)) then
        if (card%given(limit, i)) then
          material%curve = bilinear_curve(material%young, card%value(limit, i), card%value(h, i))
        else
          call found%add_error(card_mats1, i, limit, ': neither a table nor a yield stress', &
                               'TID, or LIMIT1 and H')
        end if
        return
      end if
      if (card%given(h, i)) &
        call found%add_error(card_mats1, i, h, ': field 5 (H) is given beside a table', &
                             'a blank H, or a blank TID')
      if (.not. card%given(limit, i) .and. card%word(card%column('TYPE'), i) == 'PLASTIC') &
        call found%add_error(card_mats1, i, limit, ': field 8 (LIMIT1) is blank', &
                             'the yield stress: the second stress of the table')
    end associate
    if (table == 0) return
    if (deck%card(card_tables1)%sound(table)) call read_table(deck, i, table, material, found)
  end subroutine read_yielding

  !> TABLES1. Its yield stress is kept and its yield strain replaced by that over E, so that the elastic part
  !! is MAT1's.
  pure subroutine read_table(deck, i, table, material, found)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i, table           !! the MATS1, the TABLES1
    type(material_card), intent(inout) :: material
    type(findings), intent(inout) :: found
    character(len=:), allocatable :: what, remedy
    integer :: limit, wrong

    associate (mats1 => deck%card(card_mats1), tables1 => deck%card(card_tables1))
      associate (first => tables1%list_start(table), last => tables1%list_start(table + 1) - 1)
        associate (strain => tables1%list(first:last)%point(1), stress => tables1%list(first:last)%point(2))
          call check_curve(strain, stress, material%young, wrong, what, remedy)
          if (wrong > 0) then
            call found%add_error(card_tables1, table, merge(-(first + wrong - 1), 0, wrong <= size(strain)), &
                                 ': '//what, remedy)
            return
          end if
          limit = mats1%column('LIMIT1')
          if (mats1%given(limit, i) .and. abs(mats1%value(limit, i) - stress(2)) > same_stress*stress(2)) &
            call found%add_error(card_mats1, i, limit, ': field 8 (LIMIT1) is '// &
                                 short_real(mats1%value(limit, i))// &
                                 ', the second stress of '//deck%identity(card_tables1, table)//' '// &
                                 short_real(stress(2)), &
                                 'the same stress in both')
          material%curve%strain = [0.0_wp, stress(2)/material%young, strain(3:)]
          material%curve%stress = stress
          material%curve%ends = .true.
        end associate
      end associate
    end associate
  end subroutine read_table
end module epcont_build_materials
