!> Text of the errors and warnings of a deck: file, line and columns, the line itself, and the remedy.
module epcont_deck_render
  use epcont_base_diagnostic, only: diagnostic, diagnostics, place_type, severity_error, severity_note, &
      severity_warning
  use epcont_base_text, only: newline, plural, shown, text_of
  use epcont_deck_source, only: source
  implicit none
  private
  public :: render, render_notes, included_file, printable

  !> Largest number of errors shown, and of warnings; and of similar ones. The others are only counted.
  integer, parameter :: most_shown = 50, most_alike = 5
  !> Columns of a line of the deck that are shown.
  integer, parameter :: width = 132

contains

  !> Errors and warnings in deck order. Each line ends with a newline; the last line counts them. Empty if
  !! there are no errors or warnings.
  pure function render(faults, lines) result(text)
    type(diagnostics), intent(in) :: faults   !! findings about the deck
    type(source), intent(in) :: lines   !! lines of the deck
    character(len=:), allocatable :: text
    integer, allocatable :: order(:), told(:)
    integer :: i, k, n(3)   ! number shown of each severity

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

    !> Do two findings have the same text after the names of their cards?
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

  !> Warnings and notes in deck order, one line each, for the listing. Without the name of the deck, and with
  !! included files named relative to it, the text does not depend on the working directory.
  pure function render_notes(faults, lines) result(text)
    type(diagnostics), intent(in) :: faults   !! findings about the deck
    type(source), intent(in) :: lines   !! lines of the deck
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

  !> Replace every byte of `text` that is not printable ASCII by a question mark.
  pure function printable(text)
    character(len=*), intent(in) :: text   !! any bytes
    character(len=len(text)) :: printable
    integer :: i

    do i = 1, len(text)
      printable(i:i) = text(i:i)
      if (text(i:i) < ' ' .or. iachar(text(i:i)) > 126) printable(i:i) = '?'
    end do
  end function printable

  !> One finding: `hertz.dat:41:25-32: GRID 17: field 4 (X1) is not a real number`, the line of the deck,
  !! carets and remedy.
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

    !> The line of the deck, and carets under the value (under the whole field if that is blank). A long line
    !! is cut.
    pure function excerpt() result(text)
      character(len=:), allocatable :: line, text
      integer :: first, last

      line = printable(lines%whole_line(fault%place%line, width))
      first = min(fault%place%first, width)
      last = min(fault%place%last, width)
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

  !> The fault; warnings are marked.
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

  !> Name of the included file of a line relative to the deck, and a colon; empty for lines of the deck
  !! itself.
  pure function included_file(lines, line) result(text)
    type(source), intent(in) :: lines   !! of the deck
    integer, intent(in) :: line         !! in deck order; 0 if there is no line
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
