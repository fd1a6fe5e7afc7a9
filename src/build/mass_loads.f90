!> Body loads from GRAV and RFORCE.
module epcont_build_mass_loads
  use epcont_base_kinds, only: wp
  use epcont_build_reference, only: card_index, resolve
  use epcont_deck_card_kinds, only: card_grav, card_rforce
  use epcont_deck_deck, only: deck_type
  use epcont_model_arrays, only: body_load
  use epcont_model_finding, only: findings
  use epcont_model_load_cases, only: set_body_load
  implicit none
  private
  public :: read_mass_loads

contains

  !> Make one body load for each GRAV, then for each RFORCE; those that no case uses keep the factor 0.
  subroutine read_mass_loads(deck, nodes, rings, x, used, body, found)
    type(deck_type), intent(in) :: deck        !! its cards
    type(card_index), intent(in) :: nodes      !! ids of GRID
    logical, intent(in) :: rings               !! are elements axisymmetric?
    real(wp), intent(in) :: x(:, :)            !! coordinates of the nodes [length] [2, nodes]
    integer, intent(in) :: used(:)             !! sets of loads
    type(set_body_load), allocatable, intent(out) :: body(:)
    type(findings), intent(inout) :: found     !! errors are added
    integer :: i

    associate (grav => deck%card(card_grav), rforce => deck%card(card_rforce))
      allocate (body(grav%count + rforce%count))
      body%set = nint([grav%value(1, :), rforce%value(1, :)])
      ! In a part of a longer history, the loads at its start or in later parts may use any of them.
      body%given%factor = [(merge(1.0_wp, 0.0_wp, deck%is_part() .or. any(used == body(i)%set)), &
                            i=1, size(body))]
      call read_gravity(body(:grav%count)%given)
      call read_spins(body(grav%count + 1:)%given)
    end associate

  contains

    !> Read GRAV.
    subroutine read_gravity(load)
      type(body_load), intent(inout) :: load(:)
      real(wp) :: direction(2)
      integer :: i

      associate (card => deck%card(card_grav))
        do i = 1, size(load)
          if (load(i)%factor == 0.0_wp .or. .not. card%sound(i)) cycle
          direction = [card%number('N1', i), card%number('N2', i)]
          if (all(direction == 0.0_wp)) &
            call found%add_error(card_grav, i, card%column('N1'), ': N1 and N2 are 0.0: no direction', &
                                 'give the direction in which it acts, such as 0.0 and -1.0')
          ! As for FORCE: rounding of a right angle is set to zero.
          where (abs(direction) < epsilon(1.0_wp)*maxval(abs(direction))) direction = 0.0_wp
          load(i)%acceleration = card%number('A', i)*direction
        end do
      end associate
    end subroutine read_gravity

    !> Read RFORCE.
    subroutine read_spins(load)
      type(body_load), intent(inout) :: load(:)
      integer :: centre(size(load)), i
      character(len=2) :: axis, other

      axis = merge('R2', 'R3', rings)
      other = merge('R3', 'R2', rings)
      call resolve(deck, card_rforce, 2, nodes, found, centre)
      associate (card => deck%card(card_rforce))
        do i = 1, size(load)
          if (load(i)%factor == 0.0_wp .or. .not. card%sound(i)) cycle
          if (.not. (card%has('A', i) .or. card%has('RACC', i))) call found%add_error( &
            card_rforce, i, card%column('A'), ': fields 5 (A) and 13 (RACC) are blank: no rotation', &
            'give A, or RACC on the next line')
          if (card%number(axis, i) == 0.0_wp .or. card%number(other, i) /= 0.0_wp) call found%add_error( &
            card_rforce, i, card%column(axis), ': the axis is not '//merge('y', 'z', rings), &
            'write '//axis//' 1.0, '//other//' 0.0: plane models rotate about z, axisymmetric models about y')
          load(i)%spin = card%number('A', i)*card%number(axis, i)
          load(i)%spin_up = card%number('RACC', i)*card%number(axis, i)
          if (centre(i) > 0) load(i)%centre = x(:, centre(i))
        end do
      end associate
    end subroutine read_spins
  end subroutine read_mass_loads
end module epcont_build_mass_loads
