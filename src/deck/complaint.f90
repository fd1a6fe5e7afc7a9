!> Faults of cards in words: which card, which field, what is wrong with it.
module epcont_deck_complaint
  use epcont_base_kinds, only: i8
  use epcont_base_text, only: text_of, upper
  use epcont_deck_card, only: card_fields
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_entry, only: card_entry, field_entry, largest_id, slot_of
  use epcont_deck_field, only: scan_integer, scan_sound, scan_word
  use epcont_deck_source, only: source
  use epcont_deck_spelling, only: likely_name
  use epcont_deck_value, only: fault_of
  implicit none
  private
  public :: add_fault, add_value_fault, add_unknown, field_text, identity

  !> Words of case control, which without BEGIN BULK are taken for cards.
  character(len=*), parameter :: control_words = &
    ' SOL CEND TITLE SUBTITLE LABEL LOAD ECHO DISPLACEMENT STRESS SPCFORCES SUBCASE BEGIN '

contains

  !> A name that is not in the catalogue.
  subroutine add_unknown(lines, card, entry, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(card_entry), intent(in) :: entry(:)
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: name, remedy, word
    character(len=8) :: names(size(entry))
    integer :: k

    names = entry%name
    name = upper(lines%text(card%name_first:card%name_last))
    if (lines%text(lines%first(card%line):lines%first(card%line)) == '+' .or. &
        lines%text(lines%first(card%line):lines%first(card%line)) == '*' .or. name == '') then
      call faults%add_error(card%name_place(lines), 'a continuation line without a card before it', 'the name of a card')
      return
    end if
    k = likely_name(name, names)
    word = name(:scan(name//' ', ' =(') - 1)
    remedy = 'epcont --cards lists the cards that are read'
    if (k > 0) remedy = 'did you mean '//trim(entry(k)%name)//'?'
    if (name == 'CQUAD8' .or. name == 'CQUAD9' .or. name == 'CQUAD') remedy = 'CTRIA6 or CQUAD4'
    if (index(control_words, ' '//word//' ') > 0 .and. len(word) > 0) remedy = 'one line BEGIN BULK behind case control'
    call faults%add_error(card%name_place(lines), 'unknown card '//name, remedy)
  end subroutine add_unknown

  !> A field whose value cannot be taken; `outcome` is that of `read_value`.
  subroutine add_value_fault(lines, card, slot, entry, outcome, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    integer, intent(in) :: slot
    type(field_entry), intent(in) :: entry
    integer, intent(in) :: outcome
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: what, remedy

    call fault_of(lines%text(card%first(slot):card%last(slot)), entry, outcome, what, remedy)
    call add_fault(lines, card, entry, what, remedy, faults)
  end subroutine add_value_fault

  !> A fault of one field: `GRID 17: field 4 (X1) is ...`.
  subroutine add_fault(lines, card, entry, what, remedy, faults)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    type(field_entry), intent(in) :: entry
    character(len=*), intent(in) :: what, remedy
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: name

    name = trim(entry%name)
    if (card%name == 'PARAM' .and. entry%number == 3) name = 'VALUE'
    call faults%add_error(card%place(lines, slot_of(entry%number)), &
                          identity(lines, card)//': '//field_text(entry%number, name)//' '//what, remedy)
  end subroutine add_fault

  !> `field 4 (X1)`.
  pure function field_text(number, name) result(text)
    integer, intent(in) :: number
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: text

    text = 'field '//text_of(number)
    if (len(name) > 0) text = text//' ('//name//')'
  end function field_text

  !> `GRID 17`, or `GRID` where the id is not one; `PARAM PLANE`.
  pure function identity(lines, card) result(text)
    type(source), intent(in) :: lines
    type(card_fields), intent(in) :: card
    character(len=:), allocatable :: text
    integer(i8) :: id
    integer :: outcome
    character(len=8) :: word

    text = trim(card%name)
    if (.not. card%filled(1)) return
    if (text == 'PARAM') then
      call scan_word(lines%text(card%first(1):card%last(1)), word, outcome)
      if (outcome == scan_sound) text = text//' '//trim(word)
    else
      call scan_integer(lines%text(card%first(1):card%last(1)), id, outcome)
      if (outcome == scan_sound .and. id > 0 .and. id <= largest_id) text = text//' '//text_of(id)
    end if
  end function identity
end module epcont_deck_complaint
