!> Choices of the PARAMs for the contact solver and the plastic iteration.
module epcont_build_choices
  use epcont_base_kinds, only: wp
  use epcont_deck_card_kinds, only: card_mats1, card_param
  use epcont_deck_deck, only: deck_type
  use epcont_model_controls, only: controls_type, method_name, original_controls, rule_name, &
      solver_name
  use epcont_model_finding, only: findings
  implicit none
  private
  public :: read_controls, check_once

  !> PARAMs that PARAM ORIGINAL YES replaces (`original_controls`).
  character(len=8), parameter :: chosen(*) = [character(len=8) :: &
    'SOLVER', 'RULE', 'METHOD', 'TOL', 'MUP', 'ACCURACY', 'NLOAD', 'THEORY']

contains

  !> Read the choices; each has a default.
  pure type(controls_type) function read_controls(deck) result(controls)
    type(deck_type), intent(in) :: deck   !! its cards

    if (deck%parameter_word('ORIGINAL') == 'YES') controls = original_controls
    controls%most_iterations = nint(deck%parameter_value('MAXIT', real(controls%most_iterations, wp)))
    controls%search = deck%parameter_value('SEARCH', controls%search)
    controls%corner = deck%parameter_value('CORNER', controls%corner)
    if (controls%original) return
    controls%method = choice('METHOD', method_name, controls%method)
    controls%rule = choice('RULE', rule_name, controls%rule)
    controls%solver = choice('SOLVER', solver_name, controls%solver)
    controls%accuracy = deck%parameter_value('ACCURACY', controls%accuracy)
    controls%tolerance = deck%parameter_value('TOL', controls%tolerance)
    controls%load_steps = nint(deck%parameter_value('NLOAD', real(controls%load_steps, wp)))
    controls%paper_ratio = deck%parameter_word('MUP') == 'PAPER'
    controls%by_increments = deck%parameter_word('THEORY') == 'FLOW'
    associate (mats1 => deck%card(card_mats1))
      if (deck%parameter_row('THEORY') == 0) controls%by_increments = &
        any(mats1%value(mats1%column('HR'), :) > 1.0_wp) .or. deck%is_sequence() .and. &
        any(mats1%word(mats1%column('TYPE'), :) == 'PLASTIC')
    end associate

  contains

    !> Position, from 0, of the word of a PARAM among the names of its choices; `default` if the PARAM is
    !! absent or has another word.
    pure integer function choice(parameter, names, default)
      character(len=*), intent(in) :: parameter, names(:)
      integer, intent(in) :: default

      choice = findloc(names == deck%parameter_word(parameter), .true., dim=1) - 1
      if (choice < 0) choice = default
    end function choice
  end function read_controls

  !> Check that each PARAM is given once, and not together with an ORIGINAL YES that replaces it. Note a
  !! choice of earlier versions.
  pure subroutine check_once(deck, original, found)
    type(deck_type), intent(in) :: deck   !! its cards
    logical, intent(in) :: original       !! PARAM ORIGINAL YES
    type(findings), intent(inout) :: found   !! errors are added
    character(len=:), allocatable :: beside   ! PARAM that ORIGINAL replaces
    integer :: row

    beside = ''
    associate (name => deck%card(card_param)%word(1, :))
      do row = 1, deck%card(card_param)%count
        if (any(name(:row - 1) == name(row)) .and. name(row) /= '') &
          call found%add_error(card_param, row, 1, ' is given twice', 'remove one of the two')
        if (any(name(row) == chosen)) beside = beside//', '//trim(name(row))
      end do
    end associate
    if (deck%parameter_word('RULE') == 'BLOCK') call found%add_note( &
      card_param, deck%parameter_row('RULE'), 2, &
      ': BLOCK is no longer used: AUTO finds the same answer, by CONRY or JOINED')
    if (original .and. beside /= '') call found%add_error( &
      card_param, deck%parameter_row('ORIGINAL'), 2, &
      ': YES chooses what other PARAMs say: '//beside(3:), 'remove them, or ORIGINAL')
  end subroutine check_once
end module epcont_build_choices
