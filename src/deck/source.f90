!> The text of a deck: its file and the files it includes, cut into lines in deck order.
!>
!> All files lie one after the other in one buffer, a newline behind each; a line is a stretch of it.
!> INCLUDE and ENDDATA are dealt with here, so that what reads the cards sees one run of lines.
module epcont_deck_source
  use epcont_base_diagnostic, only: diagnostics, place_type
  use epcont_base_error, only: error_type, raise, status_usage
  use epcont_base_kinds, only: i8
  use epcont_base_text, only: shown, text_of, upper
  implicit none
  private
  public :: source, read_source

  integer, parameter :: &
    !> How deep files may include files, the deck itself not counted.
    deepest = 8, &
    !> How many INCLUDE lines a deck may have: files that include each other twice would double at every
    !! depth.
    most_files = 10000, &
    !> Characters of a line, as they are mostly: that is the room for lines at first.
    usual_line = 32
  !> What ends a line: either of them, or a return with a newline behind it.
  character(len=*), parameter :: newline = achar(10), return = achar(13)

  !> One file of the deck.
  type :: source_file
    !> as the user gave it; an included one with the directory of its parent
    character(len=:), allocatable :: name
    integer :: parent = 0                  !! the file that includes it
    integer :: first = 1                   !! its first character in the buffer
    integer :: last = 0                    !! its last
  end type source_file

  !> One line, without comment and trailing blanks; one that INCLUDE or ENDDATA has used up is blank.
  type :: source_line
    integer :: first, last   !! its characters in the buffer
    integer :: special       !! first comma or character that is not printable; > last: none
    integer :: number        !! line number in its file
    integer :: file          !! its file
  end type source_line

  !> The lines of a deck.
  type :: source
    character(len=:), allocatable :: text        !! all files
    integer :: used = 0                          !! characters of `text` in use
    integer :: count = 0                         !! number of lines
    type(source_line), allocatable :: line(:)    !! [count or more]
    type(source_file), allocatable :: files(:)   !! [files]
    logical :: ended = .false.                   !! the deck has its ENDDATA
  contains
    procedure :: file_name
    procedure :: text_of_line
    procedure :: whole_line
    procedure :: blank
  end type source

contains

  !> Read the deck at `path` with all that it includes.
  !! Faults inside go to `faults`; `error` only where the deck itself cannot be read.
  subroutine read_source(path, lines, faults, error)
    character(len=*), intent(in) :: path   !! of the deck
    type(source), intent(out) :: lines   !! of all its files
    type(diagnostics), intent(inout) :: faults   !! inside, which are added
    type(error_type), allocatable, intent(out) :: error   !! where the deck itself cannot be read
    character(len=:), allocatable :: trouble

    allocate (lines%files(0))
    lines%text = ''
    call load(path, 0, trouble, lines)
    if (allocated(trouble)) then
      call raise(error, status_usage, path//': '//trouble)
      return
    end if
    allocate (lines%line(1 + lines%used/usual_line))
    call cut(1, lines%ended)

  contains

    !> Cut a file into lines and, where it includes another, that one too. `ended`: it had its ENDDATA.
    recursive subroutine cut(file, ended)
      integer, intent(in) :: file
      logical, intent(out) :: ended
      integer :: at, end_of_file, last, line, next, number, special
      character(len=7) :: word

      ended = .false.
      at = lines%files(file)%first
      end_of_file = lines%files(file)%last
      number = 0
      do while (at <= end_of_file .and. .not. ended)
        number = number + 1
        call find_end(lines%text, at, last, special, next)
        if (lines%count == size(lines%line)) lines%line = [lines%line, lines%line]   ! room for twice as many
        lines%count = lines%count + 1
        line = lines%count
        lines%line(line) = source_line(at, last, special, number, file)
        word = statement(lines%text(at:last))
        ended = word == 'ENDDATA'
        if (word == 'INCLUDE') call include_file(line)
        if (ended .or. word == 'INCLUDE') lines%line(line)%last = at - 1
        at = next
      end do
    end subroutine cut

    !> Read the file that the INCLUDE line `line` names, or say why not.
    recursive subroutine include_file(line)
      integer, intent(in) :: line
      character(len=:), allocatable :: name, remedy, trouble
      type(place_type) :: place
      integer :: parent, depth
      logical :: ended

      call find_quoted(lines%text_of_line(line), place, name)
      place%line = line
      if (.not. allocated(name)) then
        call faults%add_error(place, 'INCLUDE needs the name of a file between quotes', 'INCLUDE ''file''')
        return
      end if
      parent = lines%line(line)%file
      if (name(1:1) /= '/') &
        name = lines%files(parent)%name(:index(lines%files(parent)%name, '/', back=.true.))//name
      depth = files_above(parent, name)
      if (depth == 0) then
        trouble = shown(name)//' includes itself'
        remedy = 'a file that does not lead back here'
      else if (depth > deepest) then
        trouble = 'files are included more than '//text_of(deepest)//' deep'
        remedy = 'fewer levels'
      else if (size(lines%files) > most_files) then
        trouble = 'more than '//text_of(most_files)//' files'
        remedy = 'fewer files'
      else
        call load(name, parent, trouble, lines)
        if (allocated(trouble)) trouble = shown(name)//': '//trouble
        remedy = 'a name relative to the file of this line'
      end if
      if (allocated(trouble)) then
        call faults%add_error(place, 'INCLUDE: '//trouble, remedy)
      else
        call cut(size(lines%files), ended)
      end if
    end subroutine include_file

    !> How many files lead down to `file`, the deck and itself included; 0 where `name` is one of them.
    pure integer function files_above(file, name) result(files)
      integer, intent(in) :: file
      character(len=*), intent(in) :: name
      integer :: at

      files = 0
      at = file
      do while (at > 0)
        files = files + 1
        if (lines%files(at)%name == name) exit
        at = lines%files(at)%parent
      end do
      if (at > 0) files = 0
    end function files_above
  end subroutine read_source

  !> Append the bytes of a file to the buffer; `trouble` says why that cannot be done.
  subroutine load(path, parent, trouble, lines)
    character(len=*), intent(in) :: path
    integer, intent(in) :: parent
    character(len=:), allocatable, intent(out) :: trouble
    type(source), intent(inout) :: lines
    character(len=:), allocatable :: longer
    integer(i8) :: bytes
    integer :: first, last, status, unit
    logical :: exists, is_directory

    inquire (file=path, exist=exists)
    inquire (file=path//'/.', exist=is_directory)
    if (.not. exists) then
      trouble = 'no such file'
    else if (is_directory) then
      trouble = 'a directory, not a file'
    else
      open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', &
            iostat=status)
      if (status /= 0) trouble = 'cannot be opened for reading'
    end if
    if (allocated(trouble)) return
    inquire (unit=unit, size=bytes)
    if (bytes < 0) then
      trouble = 'not a file that can be read'
    else if (lines%used + bytes >= huge(1) - 1) then   ! behind come a newline and the place of a next line
      trouble = 'the deck is larger than 2 GiB'
    else
      first = lines%used + 1
      last = lines%used + int(bytes)
      if (last >= len(lines%text)) then   ! the first file gets just its size; included ones make it double
        allocate (character(len=max(last + 1, int(min(2_i8*len(lines%text), int(huge(1), i8))))) :: longer)
        longer(:lines%used) = lines%text(:lines%used)
        call move_alloc(longer, lines%text)
      end if
      read (unit, iostat=status) lines%text(first:max(last, first))
      if (bytes > 0 .and. status /= 0) trouble = 'cannot be read'
      if (bytes == 0 .and. status == 0) trouble = 'a pipe or a device, not a file of known size'
      ! The mark that editors put before UTF-8 says nothing.
      if (lines%text(first:min(first + 2, last)) == char(239)//char(187)//char(191)) first = first + 3
    end if
    close (unit, iostat=status)
    if (allocated(trouble)) return
    lines%files = [lines%files, source_file(parent=parent, first=first, last=last)]
    lines%files(size(lines%files))%name = path
    lines%used = last + 1
    lines%text(lines%used:lines%used) = newline
  end subroutine load

  !> The end of the line that begins at `first`: its last character that is no comment and no blank (or
  !! control character: tabs, page ends, the mark of DOS that ends a file), and
  !! the first character of the next line. On the way, its first comma or character that is not printable
  !! ASCII.
  pure subroutine find_end(text, first, last, special, next)
    character(len=*), intent(in) :: text
    integer, intent(in) :: first
    integer, intent(out) :: last, special, next
    integer :: at, comment, code
    ! By code, the characters that mean nothing but themselves: printable ASCII but `$` and `,`.
    logical, parameter :: plain(0:255) = [(code >= 32 .and. code <= 126 .and. &
        all(code /= iachar(['$', ','])), code=0, 255)]

    comment = huge(1)
    special = huge(1)
    at = first
    do
      if (.not. plain(iachar(text(at:at)))) then
        if (text(at:at) == newline .or. text(at:at) == return) exit
        if (text(at:at) == '$') then
          comment = min(comment, at)
        else
          special = min(special, at)
        end if
      end if
      at = at + 1
    end do
    next = at + 1
    if (text(at:at) == return) next = next + index(text(next:next), newline)
    do last = min(at, comment) - 1, first, -1   ! codes: a character compared with a blank becomes a call
      if (iachar(text(last:last)) > iachar(' ')) exit
    end do
  end subroutine find_end

  !> INCLUDE or ENDDATA if the line is that statement, else blank.
  pure function statement(line) result(word)
    character(len=*), intent(in) :: line
    character(len=7) :: word
    integer :: at

    word = ''
    if (len(line) == 0) return
    if (.not. any(line(1:1) == ['I', 'i', 'E', 'e', ' '])) return
    at = verify(line, ' ')
    if (len(line) < at + 6) return
    word = upper(line(at:at + 6))
    if (all(word /= ['ENDDATA', 'INCLUDE']) .or. scan(upper(line(at + 7:min(at + 7, len(line)))), &
        'ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789*') > 0) word = ''   ! no such word, or a longer one
  end function statement

  !> The name between the quotes of an INCLUDE line; not allocated where there is none.
  pure subroutine find_quoted(text, place, name)
    character(len=*), intent(in) :: text
    type(place_type), intent(out) :: place  !! columns of the name, or where it should be
    character(len=:), allocatable, intent(out) :: name
    integer :: from, to

    from = verify(text, ' ') + 7
    from = from - 1 + max(1, verify(text(from:), ' '))
    place = place_type(0, from, max(from, len(text)))
    if (scan(text(from:min(from, len(text))), '''"') == 0) return
    to = from + index(text(from + 1:), text(from:from))
    if (to == len(text) .and. verify(text(from + 1:to - 1), ' ') > 0) name = trim(text(from + 1:to - 1))
  end subroutine find_quoted

  !> The name of the file of a line, as the user gave it.
  pure function file_name(self, line) result(name)
    class(source), intent(in) :: self
    integer, intent(in) :: line   !! in deck order; 0: of the deck as a whole
    character(len=:), allocatable :: name

    name = self%files(1)%name
    if (line > 0) name = self%files(self%line(line)%file)%name
  end function file_name

  !> A line as it is read, without comment, tabs as blanks.
  pure function text_of_line(self, line) result(text)
    class(source), intent(in) :: self
    integer, intent(in) :: line   !! in deck order
    character(len=:), allocatable :: text
    integer :: at

    text = self%text(self%line(line)%first:self%line(line)%last)
    do at = 1, len(text)
      if (text(at:at) == achar(9)) text(at:at) = ' '
    end do
  end function text_of_line

  !> A line as it stands in the file, comment and all, but no longer than `most` characters from `from` on.
  pure function whole_line(self, line, from, most) result(text)
    class(source), intent(in) :: self
    integer, intent(in) :: line   !! in deck order
    integer, intent(in) :: from   !! first column wanted
    integer, intent(in) :: most   !! columns wanted
    character(len=:), allocatable :: text
    integer :: first, last

    first = self%line(line)%first
    do last = first, self%used
      if (last - first - from + 1 == most .or. scan(self%text(last:last), newline//return) > 0) exit
    end do
    text = trim(self%text(first + from - 1:last - 1))
  end function whole_line

  !> Is there nothing to read in a line?
  pure logical function blank(self, line)
    class(source), intent(in) :: self
    integer, intent(in) :: line   !! in deck order

    blank = self%line(line)%last < self%line(line)%first
  end function blank
end module epcont_deck_source
