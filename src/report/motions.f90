!> Faults of free bodies in words, with the card that would hold them.
module epcont_report_motions
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_base_tolerances, only: no_effect
  use epcont_deck_card_kinds, only: card_grid
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics, place_type
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: motion_fault, motion_not_held, motion_too_many
  use epcont_report_names, only: grid_name
  implicit none
  private
  public :: report_motion_faults

contains

  !> Say what is wrong with each body.
  subroutine report_motion_faults(deck, model, found, faults)
    type(deck_type), intent(in) :: deck          !! whose cards are named
    type(model_type), intent(in) :: model        !! the model
    type(motion_fault), intent(in) :: found(:)   !! what is wrong with the SUPORT freedoms of bodies
    type(diagnostics), intent(inout) :: faults   !! all faults of the deck
    character(len=:), allocatable :: body
    type(place_type) :: place
    integer :: i

    do i = 1, size(found)
      associate (fault => found(i))
        place = deck%place(card_grid, fault%node, 0)
        body = 'the body of '//grid_name(model, fault%node)
        if (fault%kind == motion_not_held) then
          if (fault%moving /= fault%node) then
            place = deck%place(card_grid, fault%moving, 0)
            body = 'a part of '//body//', with '//grid_name(model, fault%moving)//','
          end if
          call faults%add_error(place, body//' is free to move: '//motion_list(model, fault), &
                                'hold it by SPC1, or solve for the motion by '//suport_card(model, fault))
        else if (fault%kind == motion_too_many) then
          call faults%add_error(place, body//' has '//plural(fault%motions, 'free motion')//' and '// &
                                plural(fault%references, 'SUPORT freedom'), &
                                'as many SUPORT freedoms as free motions')
        else
          call faults%add_error(place, body//': its SUPORT freedoms hardly tell its free motions apart', &
                                'SUPORT nodes farther from each other')
        end if
      end associate
    end do
  end subroutine report_motion_faults

  !> The motions that nothing holds.
  pure function motion_list(model, fault) result(text)
    type(model_type), intent(in) :: model
    type(motion_fault), intent(in) :: fault
    character(len=:), allocatable :: text
    integer :: k

    text = ''
    do k = 1, size(fault%freedom, 2)
      if (k > 1) text = text//', '
      if (fault%turn(k) > no_effect) then
        text = text//'it turns, '//grid_name(model, fault%freedom(1, k))//' moving along ('
      else
        text = text//'it shifts along ('
      end if
      text = text//component(fault%direction(1, k))//', '//component(fault%direction(2, k))//')'
    end do
  end function motion_list

  !> A component of a unit vector, rounding taken off.
  pure function component(value) result(text)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: text

    text = short_real(real(nint(value*1.0e4_wp), wp)*1.0e-4_wp)
  end function component

  !> The card to paste, in free field.
  pure function suport_card(model, fault) result(text)
    type(model_type), intent(in) :: model
    type(motion_fault), intent(in) :: fault
    character(len=:), allocatable :: text
    integer :: k

    text = 'SUPORT'
    do k = 1, size(fault%freedom, 2)
      text = text//','//text_of(model%node_id(fault%freedom(1, k)))//','//text_of(fault%freedom(2, k))
    end do
  end function suport_card
end module epcont_report_motions
