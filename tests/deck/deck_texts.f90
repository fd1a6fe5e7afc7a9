!> Decks and their messages as one text each, whose lines end with bars.
module deck_texts
  use epcont_base_error, only: error_type
  use epcont_base_text, only: text_of
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_base_diagnostic, only: diagnostics
  implicit none
  private
  public :: bars, read_lines, told, write_lines

  character(len=*), parameter, public :: path = 'bad.dat'
  character(len=1), parameter :: newline = new_line('a')

contains

  subroutine write_lines(file, text)
    character(len=*), intent(in) :: file, text
    integer :: unit

    open (newunit=unit, file=file, access='stream', form='unformatted', status='replace')
    write (unit) replaced(text, '|', newline)
    close (unit)
  end subroutine write_lines

  !> Write a deck and read it.
  subroutine read_lines(text, deck, faults)
    character(len=*), intent(in) :: text
    type(deck_type), intent(out) :: deck
    type(diagnostics), intent(out) :: faults
    type(error_type), allocatable :: error

    call write_lines(path, text)
    call read_deck(path, deck, faults, error)
  end subroutine read_lines

  !> A text with bars for line ends.
  pure function bars(text)
    character(len=*), intent(in) :: text
    character(len=len(text)) :: bars

    bars = replaced(text, newline, '|')
  end function bars

  !> All messages for a deck, from a short form: `11:7-9: fault|remedy|` each, or `0: ...`
  !! for the deck as a whole; with its name, the line, carets below the position, and their number.
  function told(cards, faults) result(words)
    character(len=*), intent(in) :: cards, faults
    character(len=:), allocatable :: words
    character(len=*), parameter :: noun(2, 2) = reshape(['error   ', 'warning ', 'errors  ', 'warnings'], [2, 2])
    character(len=:), allocatable :: count, place, remedy, rest, what
    integer :: first, found(2), k, last, line

    words = ''
    found = 0
    rest = faults
    do while (len(rest) > 0)
      what = part(rest, 1)
      remedy = part(rest, 2)
      rest = rest(len(what) + len(remedy) + 3:)
      k = merge(2, 1, index(what, ': warning: ') > 0)
      found(k) = found(k) + 1
      if (what(:2) == '0:') then
        words = words//path//what(2:)//'|  '//remedy//'|'
      else
        place = replaced(replaced(what(:index(what, ': ') - 1), ':', ' '), '-', ' ')//' 0'
        read (place, *) line, first, last
        words = words//path//':'//what//'|  '//part(cards, line)//'|'// &
                repeat(' ', first + 1)//repeat('^', max(first, last) - first + 1)//' '//remedy//'|'
      end if
    end do
    count = ''
    do k = 1, 2
      if (found(k) > 0) count = count//', '//text_of(found(k))//' '//trim(noun(k, min(found(k), 2)))
    end do
    if (len(count) > 0) words = words//path//': '//count(3:)//'|'
  end function told

  !> One of the parts of a text, each ended by a bar.
  pure function part(text, which)
    character(len=*), intent(in) :: text
    integer, intent(in) :: which
    character(len=:), allocatable :: part
    integer :: k

    part = text
    do k = 2, which
      part = part(index(part, '|') + 1:)
    end do
    part = part(:index(part, '|') - 1)
  end function part

  !> A text with a character replaced.
  pure function replaced(text, old, new) result(other)
    character(len=*), intent(in) :: text
    character(len=1), intent(in) :: old, new
    character(len=len(text)) :: other
    integer :: i

    other = text
    do i = 1, len(text)
      if (text(i:i) == old) other(i:i) = new
    end do
  end function replaced
end module deck_texts
