!> What the PARAMs choose for the contact solver and the plastic iteration.
module epcont_build_choices
  use epcont_base_kinds, only: wp
  use epcont_deck_card_kinds, only: card_param
  use epcont_deck_deck, only: deck_type
  use epcont_model_controls, only: controls_type, method_name, original_controls, precision_name, &
                                   rule_name, solver_name
  use epcont_model_finding, only: findings
  implicit none
  private
  public :: read_controls, check_once

  !> What PARAM ORIGINAL YES leaves no choice of.
  character(len=8), parameter :: chosen(*) = [character(len=8) :: &
    'SOLVER', 'FLEXIB', 'RULE', 'METHOD', 'TOL', 'MUP', 'PRECIS', 'ACCURACY', 'NLOAD']

contains

  !> The choices; where nothing is said of one, its default.
  pure type(controls_type) function read_controls(deck) result(controls)
    type(deck_type), intent(in) :: deck   !! its cards

    if (deck%parameter_word('ORIGINAL', 'NO') == 'YES') controls = original_controls
    controls%method = choice(deck, 'METHOD', method_name, controls%method, lbound(method_name, 1))
    controls%rule = choice(deck, 'RULE', rule_name, controls%rule, lbound(rule_name, 1))
    controls%solver = choice(deck, 'SOLVER', solver_name, controls%solver, lbound(solver_name, 1))
    controls%precision = choice(deck, 'PRECIS', precision_name, controls%precision, lbound(precision_name, 1))
    controls%accuracy = deck%parameter_value('ACCURACY', controls%accuracy)
    controls%tolerance = deck%parameter_value('TOL', controls%tolerance)
    controls%most_iterations = nint(deck%parameter_value('MAXIT', real(controls%most_iterations, wp)))
    controls%load_steps = nint(deck%parameter_value('NLOAD', real(controls%load_steps, wp)))
    controls%search = deck%parameter_value('SEARCH', controls%search)
    controls%corner = deck%parameter_value('CORNER', controls%corner)
    if (deck%parameter_word('FLEXIB', 'AUTO') == 'INVERT') controls%by_inversion = .true.
    if (deck%parameter_word('MUP', 'EXACT') == 'PAPER') controls%paper_ratio = .true.
  end function read_controls

  !> The number of the word that a PARAM says among the names of its choices; `default` where it says none of
  !! these.
  pure integer function choice(deck, parameter, names, default, first)
    type(deck_type), intent(in) :: deck
    character(len=*), intent(in) :: parameter, names(:)
    integer, intent(in) :: default
    integer, intent(in) :: first     !! number of the first name

    choice = findloc(names == deck%parameter_word(parameter, ''), .true., dim=1) + first - 1
    if (choice < first) choice = default
  end function choice

  !> Each PARAM stands once, and none beside ORIGINAL YES that this chooses: of two, one would be ignored.
  pure subroutine check_once(deck, found)
    type(deck_type), intent(in) :: deck   !! its cards
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: row

    associate (param => deck%card(card_param))
      do row = 1, param%count
        if (any(param%word(1, :row - 1) == param%word(1, row)) .and. param%word(1, row) /= '') &
          call found%add_error(card_param, row, 1, ' is there twice', 'one of the two')
        if (any(param%word(1, row) == chosen) .and. deck%parameter_word('ORIGINAL', 'NO') == 'YES') &
          call found%add_error(card_param, row, 1, ': PARAM ORIGINAL YES chooses that', 'one of the two')
      end do
    end associate
  end subroutine check_once
end module epcont_build_choices
