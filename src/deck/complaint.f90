!> Faults of cards in words: which card, which field, what is wrong with it.
module epcont_deck_complaint
  use epcont_base_text, only: upper
  use epcont_deck_card, only: card_fields
  use epcont_deck_diagnostic, only: diagnostics, place_type
  use epcont_deck_spelling, only: suggestion
  use epcont_deck_table, only: card_table
  implicit none
  private
  public :: add_fault, add_unknown

  !> Words of case control, which without BEGIN BULK are taken for cards.
  character(len=*), parameter :: control_words = &
    ' SOL CEND TITLE SUBTITLE LABEL LOAD ECHO DISPLACEMENT STRESS SPCFORCES SUBCASE BEGIN '

contains

  !> A name that is not in the catalogue.
  subroutine add_unknown(card, names, faults)
    type(card_fields), intent(in) :: card   !! whose name is not known
    character(len=*), intent(in) :: names(:)   !! those that are
    type(diagnostics), intent(inout) :: faults   !! what is wrong is added to them
    character(len=:), allocatable :: name, remedy, word
    type(place_type) :: place

    place = card%place(0)
    name = upper(card%text(card%name_first:card%name_last))
    if (scan(card%text(1:1), '+*') > 0 .or. name == '') then
      call faults%add_error(place, 'a continuation line without a card before it', 'the name of a card')
      return
    end if
    word = name(:scan(name//' ', ' =(') - 1)
    remedy = suggestion(name, names, 'epcont --cards lists the cards that are read')
    if (name == 'CQUAD9' .or. name == 'CQUAD') remedy = 'CTRIA6, CQUAD4 or CQUAD8'
    if (index(control_words, ' '//word//' ') > 0 .and. len(word) > 0) &
      remedy = 'one line BEGIN BULK behind case control'
    call faults%add_error(place, 'unknown card '//name, remedy)
  end subroutine add_unknown

  !> A fault of one field of the last card of a table: `GRID 17: field 4 (X1) is ...`.
  subroutine add_fault(card, table, slot, what, remedy, faults)
    type(card_fields), intent(in) :: card   !! the fields of the card
    type(card_table), intent(in) :: table   !! the card is its last
    integer, intent(in) :: slot                  !! which field
    character(len=*), intent(in) :: what         !! is wrong with it
    character(len=*), intent(in) :: remedy       !! what would be right
    type(diagnostics), intent(inout) :: faults   !! what is wrong is added to them

    call faults%add_error(card%place(slot), &
                          table%identity(table%count)//': '//table%entry%field_text(slot)//' '//what, remedy)
  end subroutine add_fault
end module epcont_deck_complaint
