!> Bodies whose free motions and SUPORT freedoms do not fit, in words, with the card that would hold them.
module epcont_plan_loose_bodies
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_base_tolerances, only: no_effect
  use epcont_model_finding, only: findings, of_body, of_node
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: motion_fault, motion_not_held, motion_too_many
  implicit none
  private
  public :: find_loose_bodies

contains

  !> Say what is wrong with each body.
  pure subroutine find_loose_bodies(model, fault, found)
    type(model_type), intent(in) :: model        !! the scene
    type(motion_fault), intent(in) :: fault(:)   !! what is wrong with its bodies
    type(findings), intent(inout) :: found       !! what is wrong is added
    character(len=:), allocatable :: body
    integer :: i, node

    do i = 1, size(fault)
      node = fault(i)%node
      body = 'the body of '//model%name_of(of_node, node)
      select case (fault(i)%kind)
      case (motion_not_held)
        node = fault(i)%moving
        if (node /= fault(i)%node) body = 'a part of '//body//', with '//model%name_of(of_node, node)//','
        call found%add_error(of_body, node, 0, body//' is free to move: '//motion_list(model, fault(i)), &
                             'hold it by SPC1, or solve for the motion by '//suport_card(model, fault(i)))
      case (motion_too_many)
        call found%add_error(of_body, node, 0, body//' has '//plural(fault(i)%motions, 'free motion')// &
                             ' and '//plural(fault(i)%references, 'SUPORT freedom'), &
                             'as many SUPORT freedoms as free motions')
      case default
        call found%add_error(of_body, node, 0, body//': its SUPORT freedoms hardly tell its free motions'// &
                             ' apart', 'SUPORT nodes farther from each other')
      end select
    end do
  end subroutine find_loose_bodies

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
        text = text//'it turns, '//model%name_of(of_node, fault%freedom(1, k))//' moving along ('
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
end module epcont_plan_loose_bodies
