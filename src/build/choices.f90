!> What the PARAMs choose for the contact solver and the plastic iteration, and whether the scene allows it.
module epcont_build_choices
  use epcont_base_kinds, only: wp
  use epcont_deck_card_kinds, only: card_param, card_pshell, card_psolid
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_element_kinematics, only: plane_strain
  use epcont_model_controls, only: method_name, method_newton, precision_name, rule_name, solver_name
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: build_controls

contains

  subroutine build_controls(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    character(len=8) :: word
    integer :: k, row, s

    call check_once(deck, faults)
    word = deck%parameter_word('METHOD', 'AUTO')
    do k = lbound(method_name, 1), ubound(method_name, 1)
      if (method_name(k) == word) model%controls%method = k
    end do
    word = deck%parameter_word('RULE', 'AUTO')
    do k = lbound(rule_name, 1), ubound(rule_name, 1)
      if (rule_name(k) == word) model%controls%rule = k
    end do
    word = deck%parameter_word('SOLVER', 'AUTO')
    do k = lbound(solver_name, 1), ubound(solver_name, 1)
      if (solver_name(k) == word) model%controls%solver = k
    end do
    word = deck%parameter_word('PRECIS', '')
    do k = lbound(precision_name, 1), ubound(precision_name, 1)
      if (precision_name(k) == word) model%controls%precision = k
    end do
    model%controls%accuracy = deck%parameter_value('ACCURACY', 0.0_wp)
    model%controls%tolerance = deck%parameter_value('TOL', 0.0_wp)
    model%controls%most_iterations = nint(deck%parameter_value('MAXIT', 100.0_wp))
    model%controls%load_steps = nint(deck%parameter_value('NLOAD', 1.0_wp))
    model%controls%paper_ratio = deck%parameter_word('MUP', 'EXACT') == 'PAPER'
    if (.not. model%controls%paper_ratio) return

    row = deck%parameter_row('MUP')
    if (model%controls%method == method_newton) &
      call faults%add_error(deck%place(card_param, row, 2), 'PARAM MUP: PAPER does not go with METHOD NEWTON', &
                            'METHOD SECANT, MODSEC or INISTR, or MUP EXACT')
    do s = 1, size(model%curve)
      if (model%kinematics(s) == plane_strain .or. .not. allocated(model%curve(s)%strain)) cycle
      call faults%add_error(deck%place(card_param, row, 2), 'PARAM MUP: PAPER is for plane strain, and '// &
                            section_name(deck, s)//' is not', 'MUP EXACT')
      return
    end do
  end subroutine build_controls

  !> The card of a section: PSHELL come first, then PSOLID.
  function section_name(deck, section) result(name)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: section
    character(len=:), allocatable :: name
    integer :: shells

    shells = deck%card(card_pshell)%count
    if (section <= shells) then
      name = deck%identity(card_pshell, section)
    else
      name = deck%identity(card_psolid, section - shells)
    end if
  end function section_name

  !> Each PARAM stands once: of two, one would be ignored.
  subroutine check_once(deck, faults)
    type(deck_type), intent(in) :: deck
    type(diagnostics), intent(inout) :: faults
    integer :: row

    associate (param => deck%card(card_param))
      do row = 2, param%count
        if (.not. any(param%word(1, :row - 1) == param%word(1, row)) .or. param%word(1, row) == '') cycle
        call faults%add_error(deck%place(card_param, row, 1), deck%identity(card_param, row)//' is there twice', &
                              'one of the two')
      end do
    end associate
  end subroutine check_once
end module epcont_build_choices
