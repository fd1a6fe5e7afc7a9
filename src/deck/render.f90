!> Faults of a deck as text: file, line and columns, the line itself, and what would be right.
module epcont_deck_render
  use epcont_base_diagnostic, only: diagnostic, diagnostics, place_type, severity_error, severity_note, &
      severity_warning
  use epcont_base_text, only: newline, plural, shown, text_of
  use epcont_deck_source, only: source
  implicit none
  private
  public :: render, render_notes, included_file, printable

  !> Errors shown, and as many warnings, and of those that say the same; of the others only the number.
  integer, parameter :: most_shown = 50, most_alike = 5
  !> Columns shown of a line of the deck.
  integer, parameter :: width = 132

contains

  !> The errors and warnings in deck order, each line of text ended by a newline; the last line counts them.
  !! Empty where there are none.
  pure function render(faults, lines) result(text)
    type(diagnostics), intent(in) :: faults   !! of the deck
    type(source), intent(in) :: lines   !! its lines
    character(len=:), allocatable :: text
    integer, allocatable :: order(:), told(:)
    integer :: i, k, n(3)   ! those told of each severity

    text = ''
    order = faults%in_deck_order()
    told = [integer ::]
    n = 0
    do i = 1, size(order)
      associate (fault => faults%list(order(i)))
        if (fault%severity == severity_note .or. n(fault%severity) == most_shown) cycle
        if (count([(are_alike(faults%list(told(k)), fault), k=1, size(told))]) == most_alike) cycle
        n(fault%severity) = n(fault%severity) + 1
        told = [told, order(i)]
        text = text//paragraph(fault, lines)
      end associate
    end do
    if (len(text) > 0) &
      text = text//shown(lines%file_name(0))//': '//tally()//newline

  contains

    !> Is the same said of both, behind the names of their cards?
    pure logical function are_alike(one, other)
      type(diagnostic), intent(in) :: one, other

      are_alike = one%what(index(one%what, ': ') + 1:) == other%what(index(other%what, ': ') + 1:)
    end function are_alike

    !> `63 errors (50 shown), 1 warning`.
    pure function tally() result(text)
      character(len=:), allocatable :: text
      character(len=*), parameter :: noun(2) = ['error  ', 'warning']
      integer :: found(2), i

      text = ''
      found = [faults%errors, faults%warnings]
      do i = 1, 2
        if (found(i) == 0) cycle
        if (len(text) > 0) text = text//', '
        text = text//plural(found(i), trim(noun(i)))
        if (found(i) > n(i)) text = text//' ('//text_of(n(i))//' shown)'
      end do
    end function tally
  end function render

  !> Warnings and notes in deck order, one line each, for the listing: without the name of the deck, and of
  !! included files the name as seen from it, so that it does not matter from where the deck was read.
  pure function render_notes(faults, lines) result(text)
    type(diagnostics), intent(in) :: faults   !! of the deck
    type(source), intent(in) :: lines   !! its lines
    character(len=:), allocatable :: text
    integer, allocatable :: order(:)
    integer :: i

    text = ''
    order = faults%in_deck_order()
    do i = 1, size(order)
      associate (fault => faults%list(order(i)))
        if (fault%severity == severity_error) cycle
        text = text//included_file(lines, fault%place%line)//columns(fault%place, lines)//said(fault)
        if (len(fault%remedy) > 0) text = text//'; '//printable(fault%remedy)
        text = text//newline
      end associate
    end do
  end function render_notes

  !> `text` with every byte that is no printable ASCII character replaced by a question mark.
  pure function printable(text)
    character(len=*), intent(in) :: text   !! any bytes
    character(len=len(text)) :: printable
    integer :: i

    do i = 1, len(text)
      printable(i:i) = text(i:i)
      if (text(i:i) < ' ' .or. iachar(text(i:i)) > 126) printable(i:i) = '?'
    end do
  end function printable

  !> One fault: `hertz.dat:41:25-32: GRID 17: field 4 (X1) is not a real number`, line of the deck, carets and
  !! remedy.
  pure function paragraph(fault, lines) result(text)
    type(diagnostic), intent(in) :: fault
    type(source), intent(in) :: lines
    character(len=:), allocatable :: text

    text = shown(lines%file_name(fault%place%line))//':'
    if (fault%place%line > 0) then
      text = text//columns(fault%place, lines)//said(fault)//newline//excerpt()
    else
      text = text//' '//said(fault)//newline
      if (len(fault%remedy) > 0) text = text//'  '//fault%remedy//newline
    end if

  contains

    !> The line of the deck, and below it carets under the value (or the whole field, where that is blank).
    !! Of a line too long to show, the part that holds the place.
    pure function excerpt() result(text)
      character(len=:), allocatable :: line, text
      integer :: first, last, left

      left = max(0, min(fault%place%first - 1, fault%place%last - width))
      line = printable(lines%whole_line(fault%place%line, left + 1, width))
      first = fault%place%first - left
      last = min(fault%place%last - left, width)
      associate (field => line(first:min(last, len(line))))
        if (len_trim(field) > 0) then
          last = first - 1 + len_trim(field)
          first = first - 1 + verify(field, ' ')
        end if
      end associate
      text = '  '//line//newline//repeat(' ', first + 1)//repeat('^', last - first + 1)
      if (len(fault%remedy) > 0) text = text//' '//printable(fault%remedy)
      text = text//newline
    end function excerpt
  end function paragraph

  !> What is wrong, a warning named as such.
  pure function said(fault) result(text)
    type(diagnostic), intent(in) :: fault
    character(len=:), allocatable :: text

    text = printable(fault%what)
    if (fault%severity == severity_warning) text = 'warning: '//text
  end function said

  !> `41:25-32: `; empty for the deck as a whole.
  pure function columns(place, lines) result(text)
    type(place_type), intent(in) :: place
    type(source), intent(in) :: lines
    character(len=:), allocatable :: text

    text = ''
    if (place%line == 0) return
    text = text_of(lines%line(place%line)%number)//':'//text_of(place%first)
    if (place%last > place%first) text = text//'-'//text_of(place%last)
    text = text//': '
  end function columns

  !> The included file that a line is of, as seen from the deck, and a colon; empty where it is of the deck.
  pure function included_file(lines, line) result(text)
    type(source), intent(in) :: lines   !! of the deck
    integer, intent(in) :: line         !! in deck order; 0: none
    character(len=:), allocatable :: text, directory

    text = ''
    if (line == 0) return
    if (lines%line(line)%file == 1) return
    text = lines%file_name(line)//':'
    directory = lines%file_name(0)
    directory = directory(:index(directory, '/', back=.true.))
    if (index(text, directory) == 1) text = text(len(directory) + 1:)
    text = shown(text)
  end function included_file
end module epcont_deck_render
