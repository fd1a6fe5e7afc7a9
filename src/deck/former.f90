!> PARAMs of earlier versions of epcont, and words that some of them allowed.
module epcont_deck_former
  use epcont_base_diagnostic, only: diagnostics
  use epcont_base_text, only: upper
  use epcont_deck_card, only: card_fields
  implicit none
  private
  public :: report_former

  type :: former_entry
    character(len=8) :: name, word   !! word blank: any value of this PARAM
    logical :: is_error   !! otherwise a note: without this PARAM the result is the same or more accurate
    character(len=60) :: reason, remedy
  end type former_entry

  type(former_entry), parameter :: former(*) = [ &
    former_entry('FLEXIB', '', .false., 'the flexibility always follows by inversion', 'remove the card'), &
    former_entry('PRECIS', '', .false., 'epcont always calculates in double precision', 'remove the card'), &
    former_entry('RULE', 'BLOCK', .false., 'AUTO finds the same answer, by CONRY or JOINED', &
                 'remove the card'), &
    former_entry('SOLVER', 'SPARSE', .true., 'FRONTAL factors large bodies', 'use AUTO, BAND or FRONTAL')]

contains

  !> If a card has a former PARAM, or a former word of a PARAM, add an error or a note.
  subroutine report_former(card, name, faults, is_former)
    type(card_fields), intent(in) :: card        !! a PARAM with a name
    character(len=*), intent(in) :: name         !! in upper case
    type(diagnostics), intent(inout) :: faults   !! an error or a note is added
    logical, intent(out) :: is_former            !! the card is reported and has no effect
    character(len=:), allocatable :: subject, word
    integer :: i

    word = ''
    if (card%filled(2)) word = upper(card%text(card%slot(2)%first:card%slot(2)%last))
    i = findloc(former%name == name .and. (former%word == '' .or. former%word == word), .true., dim=1)
    is_former = i > 0
    if (.not. is_former) return
    subject = 'PARAM '//trim(name)
    if (former(i)%word /= '') subject = subject//' '//word
    if (former(i)%is_error) then
      call faults%add_error(card%place(2), subject//' is no longer supported: '//trim(former(i)%reason), &
                            trim(former(i)%remedy))
    else
      call faults%add_note(card%place(1), subject//' is no longer used: '//trim(former(i)%reason)//'; '// &
                           trim(former(i)%remedy))
    end if
  end subroutine report_former
end module epcont_deck_former
