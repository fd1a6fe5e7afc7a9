!> Which set of supports or loads is used.
module epcont_build_sets
  use epcont_base_text, only: text_of
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics, place_type
  implicit none
  private
  public :: chosen_set

contains

  !> The set that SPC = or LOAD = names; without it the only set there is. 0 where there is none.
  subroutine chosen_set(deck, cards, choice, choice_place, word, faults, set)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: cards(:)                !! tables whose first field is the set
    integer, intent(in) :: choice                  !! 0: none
    type(place_type), intent(in) :: choice_place
    character(len=*), intent(in) :: word           !! SPC or LOAD
    type(diagnostics), intent(inout) :: faults
    integer, intent(out) :: set
    logical :: used
    integer :: c, i, id

    set = choice
    used = .false.
    do c = 1, size(cards)
      do i = 1, deck%card(cards(c))%count
        if (.not. deck%card(cards(c))%given(1, i)) cycle
        id = nint(deck%card(cards(c))%value(1, i))
        if (set == 0) set = id
        used = used .or. id == set
        if (id == set) cycle
        if (choice == 0) then
          call faults%add_error(deck%place(cards(c), i, 1), deck%identity(cards(c), i)// &
                                ': the deck has several sets, '//text_of(set)//' and '//text_of(id)//', and chooses none', &
                                word//' = '//text_of(set)//' before BEGIN BULK')
          return
        end if
        call faults%add_note(deck%place(cards(c), i, 1), deck%identity(cards(c), i)//': set not used')
      end do
    end do
    if (choice > 0 .and. .not. used) &
      call faults%add_error(choice_place, word//' = '//text_of(choice)//': the deck has no such set', &
                            'the set of the cards in the deck')
  end subroutine chosen_set
end module epcont_build_sets
