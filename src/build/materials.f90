!> Materials from MAT1, and their yielding from MATS1 and TABLES1.
module epcont_build_materials
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real
  use epcont_build_reference, only: index_of, resolve
  use epcont_deck_card_kinds, only: card_mat1, card_mats1, card_tables1
  use epcont_deck_deck, only: deck_type
  use epcont_model_controls, only: uniaxial_curve
  use epcont_model_finding, only: findings
  use epcont_model_yield_curve, only: bilinear_curve, curve_fault, fault_of_curve
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
  subroutine read_materials(deck, material, found)
    type(deck_type), intent(in) :: deck                            !! its cards
    type(material_card), allocatable, intent(out) :: material(:)   !! [MAT1]
    type(findings), intent(inout) :: found                         !! what is wrong with it is added
    integer, dimension(deck%card(card_mats1)%count) :: m, table    ! the MAT1, the TABLES1; 0: none
    integer :: i

    associate (mat1 => deck%card(card_mat1), mats1 => deck%card(card_mats1))
      allocate (material(mat1%count))
      do i = 1, mat1%count
        if (mat1%sound(i)) call read_elasticity(i, material(i)%young, material(i)%poisson)
      end do
      call resolve(deck, card_mats1, 1, index_of(deck, card_mat1), found, m)
      call resolve(deck, card_mats1, mats1%column('TID'), index_of(deck, card_tables1), found, table)
      do i = 1, mats1%count
        if (m(i) == 0 .or. .not. mats1%sound(i)) cycle
        if (.not. mat1%sound(m(i)) .or. material(m(i))%young <= 0.0_wp) cycle   ! a fault of its MAT1
        call read_yielding(i, material(m(i)))
      end do
    end associate

  contains

    !> MAT1: E and NU from two of E, G, NU.
    subroutine read_elasticity(i, young, poisson)
      integer, intent(in) :: i
      real(wp), intent(out) :: young, poisson
      real(wp) :: shear

      associate (mat1 => deck%card(card_mat1))
        young = mat1%number('E', i)
        shear = mat1%number('G', i)
        poisson = mat1%number('NU', i)
        if (count([mat1%has('E', i), mat1%has('G', i), mat1%has('NU', i)]) < 2) then
          call refuse(card_mat1, i, 'E', ': of E, G and NU two are needed', 'E and NU, say')
        else if (.not. mat1%has('NU', i)) then
          poisson = young/(2.0_wp*shear) - 1.0_wp
          if (poisson < 0.0_wp .or. poisson >= 0.5_wp) &
            call refuse(card_mat1, i, 'G', ': E and G give NU = '//short_real(poisson), &
                        '0 <= NU < 0.5: G above E/3, up to E/2')
        else if (.not. mat1%has('E', i)) then
          young = 2.0_wp*shear*(1.0_wp + poisson)
        else if (mat1%has('G', i) .and. &
                 abs(2.0_wp*shear*(1.0_wp + poisson) - young) > same_moduli*young) then
          call refuse(card_mat1, i, 'G', ': G is not E/(2(1 + NU))', 'a blank G')
        end if
      end associate
    end subroutine read_elasticity

    !> MATS1: the curve of its table, or the bilinear one of LIMIT1 and H.
    subroutine read_yielding(i, material)
      integer, intent(in) :: i
      type(material_card), intent(inout) :: material

      associate (mats1 => deck%card(card_mats1))
        if (.not. mats1%has('TID', i)) then
          if (mats1%has('LIMIT1', i)) then
            material%curve = bilinear_curve(material%young, mats1%number('LIMIT1', i), mats1%number('H', i))
          else
            call refuse(card_mats1, i, 'LIMIT1', ': neither a table nor a yield stress', &
                        'TID, or LIMIT1 and H')
          end if
          return
        end if
        if (mats1%has('H', i)) call refuse(card_mats1, i, 'H', ': field 5 (H) is given beside a table', &
                                           'a blank H, or a blank TID')
        if (.not. mats1%has('LIMIT1', i) .and. mats1%word(mats1%column('TYPE'), i) == 'PLASTIC') &
          call refuse(card_mats1, i, 'LIMIT1', ': field 8 (LIMIT1) is blank', &
                      'the yield stress: the second stress of the table')
      end associate
      if (table(i) == 0) return
      if (deck%card(card_tables1)%sound(table(i))) call read_table(i, material%young, material%curve)
    end subroutine read_yielding

    !> TABLES1. Its yield stress is kept and its yield strain replaced by that over E, so that the elastic
    !! part is MAT1's.
    subroutine read_table(i, young, curve)
      integer, intent(in) :: i   !! the MATS1
      real(wp), intent(in) :: young
      type(uniaxial_curve), intent(inout) :: curve
      type(curve_fault) :: fault
      real(wp) :: limit

      associate (tables1 => deck%card(card_tables1), t => table(i))
        associate (first => tables1%list_start(t), last => tables1%list_start(t + 1) - 1)
          associate (strain => tables1%list(first:last)%point(1), stress => tables1%list(first:last)%point(2))
            fault = fault_of_curve(strain, stress, young)
            if (fault%point > 0) then
              call found%add_error(card_tables1, t, merge(1 - first - fault%point, 0, &
                                   fault%point <= size(strain)), ': '//fault%what, fault%remedy)
              return
            end if
            limit = deck%card(card_mats1)%number('LIMIT1', i)
            if (deck%card(card_mats1)%has('LIMIT1', i) .and. abs(limit - stress(2)) > same_stress*stress(2)) &
              call refuse(card_mats1, i, 'LIMIT1', ': field 8 (LIMIT1) is '//short_real(limit)// &
                          ', the second stress of '//tables1%identity(t)//' '//short_real(stress(2)), &
                          'the same stress in both')
            curve%strain = [0.0_wp, stress(2)/young, strain(3:)]
            curve%stress = stress
            curve%ends = .true.
          end associate
        end associate
      end associate
    end subroutine read_table

    !> A field is at fault.
    subroutine refuse(card, i, name, what, remedy)
      integer, intent(in) :: card, i
      character(len=*), intent(in) :: name, what, remedy   !! the field's name; what is wrong; what would be right

      call found%add_error(card, i, deck%card(card)%column(name), what, remedy)
    end subroutine refuse
  end subroutine read_materials
end module epcont_build_materials
