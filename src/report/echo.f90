!> List the cards of a deck if case control has ECHO.
module epcont_report_echo
  use epcont_base_sorting, only: sorted_order
  use epcont_base_text, only: text_of
  use epcont_deck_card, only: continues
  use epcont_deck_deck, only: deck_type
  use epcont_deck_render, only: included_file, printable
  use epcont_report_columns, only: right
  use epcont_report_file, only: text_file
  implicit none
  private
  public :: list_cards

  !> Width of the deck's text in the listing; longer lines are continued.
  integer, parameter :: width = 120

contains

  !> List the lines of the deck that are not blank, unchanged, or its cards sorted by name, without comments.
  subroutine list_cards(file, deck)
    class(text_file), intent(inout) :: file   !! the listing
    type(deck_type), intent(in) :: deck       !! with its text
    integer, allocatable :: place(:)   ! of each card name
    integer :: k, line

    if (deck%echo_unsorted) then
      call file%heading('LINES OF THE DECK')
      do line = 1, deck%source%count
        call list_line(line, deck%source%whole_line(line, huge(1)))
      end do
    end if
    if (.not. deck%echo_sorted) return
    call file%heading('CARDS OF THE DECK, SORTED')
    place = [(count(lle(deck%card%entry%name, deck%card(k)%entry%name)), k=1, size(deck%card))]
    do k = 1, size(deck%card)
      call list_kind(findloc(place, k, dim=1))
    end do

  contains

    !> List cards of one name by their ids, with their continuation lines.
    subroutine list_kind(kind)
      integer, intent(in) :: kind
      integer, allocatable :: order(:)
      integer :: i

      order = sorted_order(nint(deck%card(kind)%value(1, :deck%card(kind)%count)))
      do i = 1, deck%card(kind)%count
        line = deck%card(kind)%line(order(i))
        call list_line(line, deck%source%text_of_line(line))
        do line = line + 1, deck%source%count
          if (deck%source%blank(line)) cycle
          if (.not. continues(deck%source%text_of_line(line))) exit
          call list_line(line, deck%source%text_of_line(line))
        end do
      end do
    end subroutine list_kind

    !> List a line with its number in its file, unless it is blank.
    subroutine list_line(line, said)
      integer, intent(in) :: line
      character(len=*), intent(in) :: said
      character(len=:), allocatable :: text
      integer :: from

      if (said == '') return
      text = printable(said)
      call file%line(right(included_file(deck%source, line)//text_of(deck%source%line(line)%number), 9)// &
                     '  '//text(:min(width, len(text))))
      do from = width + 1, len(text), width
        call file%line(repeat(' ', 11)//text(from:min(from + width - 1, len(text))))
      end do
    end subroutine list_line
  end subroutine list_cards
end module epcont_report_echo
