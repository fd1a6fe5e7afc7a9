!> Text of a deck: its file and the included files, cut into lines in deck order.
!>
!> One buffer has all files, each followed by a newline; a line is a range of it. INCLUDE and ENDDATA are
!> processed here, so the card reader sees one sequence of lines.
module epcont_deck_source
  use epcont_base_diagnostic, only: diagnostics, place_type
  use epcont_base_error, only: error_type, raise, status_usage
  use epcont_base_kinds, only: i8
  use epcont_base_text, only: shown, text_of, upper
  implicit none
  private
  public :: source, read_source

  integer, parameter :: &
    !> Files of a deck. A file that includes itself by another name would do so for ever.
    most_files = 1000, &
    !> Usual length of a line [characters]; determines the initial number of lines.
    usual_line = 32
  !> Ends of a line: one of them, or a return followed by a newline.
  character(len=*), parameter :: newline = achar(10), return = achar(13)

  !> File of a deck.
  type :: source_file
    !> Name as given by the user; for an included file with the directory of its parent
    character(len=:), allocatable :: name
    integer :: first = 1                   !! its first character in the buffer
    integer :: last = 0                    !! its last character
  end type source_file

  !> A line without comment and trailing blanks; lines with INCLUDE or ENDDATA become blank.
  type :: source_line
    integer :: first, last   !! its characters in the buffer
    integer :: special       !! first comma or unprintable character; > last if there is no such character
    integer :: number        !! line number in its file
    integer :: file          !! its file
  end type source_line

  !> Lines of a deck.
  type :: source
    character(len=:), allocatable :: text        !! all files
    integer :: used = 0                          !! characters of `text` in use
    integer :: count = 0                         !! number of lines
    type(source_line), allocatable :: line(:)    !! [count or more]
    type(source_file), allocatable :: files(:)   !! [files]
    logical :: ended = .false.                   !! ENDDATA has been read
  contains
    procedure :: file_name
    procedure :: text_of_line
    procedure :: whole_line
    procedure :: blank
  end type source

contains

  !> Read the deck at `path` with all included files. `faults` collects errors inside; `error` is set if the
  !! deck itself cannot be read.
  subroutine read_source(path, lines, faults, error)
    character(len=*), intent(in) :: path   !! path of the deck
    type(source), intent(out) :: lines   !! lines of all its files
    type(diagnostics), intent(inout) :: faults   !! errors inside are added
    type(error_type), allocatable, intent(out) :: error   !! the deck itself cannot be read
    character(len=:), allocatable :: trouble

    allocate (lines%files(0))
    lines%text = ''
    call load(path, trouble, lines)
    if (allocated(trouble)) then
      call raise(error, status_usage, path//': '//trouble)
      return
    end if
    allocate (lines%line(1 + lines%used/usual_line))
    call cut(1, lines%ended)

  contains

    !> Cut a file into lines, and include other files. `ended`: the file had its ENDDATA.
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
        if (lines%count == size(lines%line)) lines%line = [lines%line, lines%line]   ! double the size
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

    !> Read the file that an INCLUDE line names, or report an error.
    recursive subroutine include_file(line)
      integer, intent(in) :: line
      character(len=:), allocatable :: name, remedy, trouble
      type(place_type) :: place
      integer :: k
      logical :: ended

      call find_quoted(lines%text_of_line(line), place, name)
      place%line = line
      if (.not. allocated(name)) then
        call faults%add_error(place, 'INCLUDE needs the name of a file between quotes', &
                              'write INCLUDE ''file''')
        return
      end if
      associate (parent => lines%files(lines%line(line)%file)%name)
        if (name(1:1) /= '/') name = parent(:index(parent, '/', back=.true.))//name
      end associate
      if (any([(lines%files(k)%name == name, k=1, size(lines%files))])) then
        trouble = shown(name)//' is a file of the deck already'
        remedy = 'include each file once'
      else if (size(lines%files) > most_files) then
        trouble = 'more than '//text_of(most_files)//' files'
        remedy = 'use fewer files'
      else
        call load(name, trouble, lines)
        if (allocated(trouble)) trouble = shown(name)//': '//trouble
        remedy = 'give a name relative to the file of this line'
      end if
      if (allocated(trouble)) then
        call faults%add_error(place, 'INCLUDE: '//trouble, remedy)
      else
        call cut(size(lines%files), ended)
      end if
    end subroutine include_file
  end subroutine read_source

  !> Append the bytes of a file to the buffer; `trouble` says why this is impossible.
  subroutine load(path, trouble, lines)
    character(len=*), intent(in) :: path
    character(len=:), allocatable, intent(out) :: trouble
    type(source), intent(inout) :: lines
    character(len=*), parameter :: unreadable = 'not a regular file, or without permission to read it'
    character(len=:), allocatable :: longer
    integer(i8) :: bytes
    integer :: first, last, status, unit
    logical :: exists, is_directory

    inquire (file=path, exist=exists)
    inquire (file=path//'/.', exist=is_directory)
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', &
          iostat=status)
    if (status /= 0) trouble = unreadable
    if (.not. exists) trouble = 'no such file'
    if (allocated(trouble)) return
    inquire (unit=unit, size=bytes)
    if (is_directory .or. bytes < 0) then
      trouble = unreadable
    else if (lines%used + bytes >= huge(1) - 1) then   ! a newline and the position of a next line follow
      trouble = 'the deck is larger than 2 GiB'
    else
      first = lines%used + 1
      last = lines%used + int(bytes)
      if (last >= len(lines%text)) then   ! the first file gets its own size; included files double the buffer
        allocate (character(len=max(last + 1, int(min(2_i8*len(lines%text), int(huge(1), i8))))) :: longer)
        longer(:lines%used) = lines%text(:lines%used)
        call move_alloc(longer, lines%text)
      end if
      read (unit, iostat=status) lines%text(first:max(last, first))
      if (bytes > 0 .eqv. status /= 0) trouble = unreadable   ! from a pipe of no size, a byte can be read
      ! Skip the byte-order mark of UTF-8.
      if (lines%text(first:min(first + 2, last)) == char(239)//char(187)//char(191)) first = first + 3
    end if
    close (unit, iostat=status)
    if (allocated(trouble)) return
    lines%files = [lines%files, source_file(first=first, last=last)]
    lines%files(size(lines%files))%name = path
    lines%used = last + 1
    lines%text(lines%used:lines%used) = newline
  end subroutine load

  !> Find the end of the line that begins at `first`: its last character before a comment and trailing blanks
  !! (or control characters: tabs, page ends, the end mark of DOS), and the first character of the next line.
  !! Also find its first comma or character that is not printable ASCII.
  pure subroutine find_end(text, first, last, special, next)
    character(len=*), intent(in) :: text
    integer, intent(in) :: first
    integer, intent(out) :: last, special, next
    integer :: at, comment, code
    ! By code: characters without a special meaning, that is, printable ASCII except `$` and `,`.
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

  !> INCLUDE or ENDDATA if the line is this statement; otherwise blank.
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
        'ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789*') > 0) word = ''   ! another word
  end function statement

  !> Name between the quotes of an INCLUDE line; not allocated if there is no name.
  pure subroutine find_quoted(text, place, name)
    character(len=*), intent(in) :: text
    type(place_type), intent(out) :: place  !! columns of the name, or those where it is missing
    character(len=:), allocatable, intent(out) :: name
    integer :: from, to

    from = verify(text, ' ') + 7
    from = from - 1 + max(1, verify(text(from:), ' '))
    place = place_type(0, from, max(from, len(text)))
    if (scan(text(from:min(from, len(text))), '''"') == 0) return
    to = from + index(text(from + 1:), text(from:from))
    if (to == len(text) .and. verify(text(from + 1:to - 1), ' ') > 0) name = trim(text(from + 1:to - 1))
  end subroutine find_quoted

  !> Name of the file of a line, as given by the user.
  pure function file_name(self, line) result(name)
    class(source), intent(in) :: self
    integer, intent(in) :: line   !! in deck order; 0 for the deck as a whole
    character(len=:), allocatable :: name

    name = self%files(1)%name
    if (line > 0) name = self%files(self%line(line)%file)%name
  end function file_name

  !> Text of a line without its comment; tabs become blanks.
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

  !> Text of a line in the file, with its comment, at most `most` characters.
  pure function whole_line(self, line, most) result(text)
    class(source), intent(in) :: self
    integer, intent(in) :: line   !! in deck order
    integer, intent(in) :: most   !! largest number of columns
    character(len=:), allocatable :: text
    integer :: first, last

    first = self%line(line)%first
    do last = first, self%used
      if (last - first == most .or. scan(self%text(last:last), newline//return) > 0) exit
    end do
    text = trim(self%text(first:last - 1))
  end function whole_line

  !> Is a line blank?
  pure logical function blank(self, line)
    class(source), intent(in) :: self
    integer, intent(in) :: line   !! in deck order

    blank = self%line(line)%last < self%line(line)%first
  end function blank
end module epcont_deck_source
