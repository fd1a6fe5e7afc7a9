!> The text of a deck: its file and the files it includes, cut into lines in deck order.
!>
!> All files lie one after the other in one buffer, a newline behind each; a line is a stretch of it.
!> INCLUDE and ENDDATA are dealt with here, so that what reads the cards sees one run of lines.
module epcont_deck_source
  use epcont_base_error, only: error_type, raise, status_usage
  use epcont_base_kinds, only: i8
  use epcont_base_text, only: shown, text_of, upper
  use epcont_deck_diagnostic, only: diagnostics, place_type
  implicit none
  private
  public :: source, read_source

  !> How deep files may include files, the deck itself not counted.
  integer, parameter :: deepest = 8
  !> How many INCLUDE lines a deck may have: files that include each other twice would double at every depth.
  integer, parameter :: most_files = 10000
  !> What ends a line.
  character(len=*), parameter :: newline = achar(10)

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
  contains
    procedure :: deck_name
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
    logical :: ended

    allocate (lines%line(1024), lines%files(0))
    lines%text = ''
    call load(lines, path, 0, trouble)
    if (allocated(trouble)) then
      call raise(error, status_usage, path//': '//trouble)
      return
    end if
    call cut(lines, 1, faults, ended)
    if (.not. ended) call faults%add_error(place_type(), 'ENDDATA is missing: the deck looks cut off', &
                                           'ENDDATA as the last line')
  end subroutine read_source

  !> Append the bytes of a file to the buffer; `trouble` says why that cannot be done.
  subroutine load(self, path, parent, trouble)
    type(source), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer, intent(in) :: parent
    character(len=:), allocatable, intent(out) :: trouble
    type(source_file), allocatable :: longer(:)
    integer(i8) :: bytes
    integer :: unit, status
    logical :: exists

    inquire (file=path, exist=exists)
    if (.not. exists) then
      trouble = 'no such file'
      return
    end if
    inquire (file=path//'/.', exist=exists)
    if (exists) then
      trouble = 'a directory, not a file'
      return
    end if
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', &
          iostat=status)
    if (status /= 0) then
      trouble = 'cannot be opened for reading'
      return
    end if
    inquire (unit=unit, size=bytes)
    if (bytes < 0) then
      trouble = 'not a file that can be read'
    else if (self%used + bytes >= huge(1) - 1) then   ! behind come a newline and the place of a next line
      trouble = 'the deck is larger than 2 GiB'
    else
      call grow_text(self, self%used + int(bytes) + 1)
      read (unit, iostat=status) self%text(self%used + 1:self%used + max(int(bytes), 1))
      if (bytes > 0 .and. status /= 0) trouble = 'cannot be read'
      if (bytes == 0 .and. status == 0) trouble = 'a pipe or a device, not a file of known size'
    end if
    close (unit, iostat=status)
    if (allocated(trouble)) return
    allocate (longer(size(self%files) + 1))
    longer(:size(self%files)) = self%files
    longer(size(longer)) = source_file(path, parent, self%used + 1, self%used + int(bytes))
    call move_alloc(longer, self%files)
    self%used = self%used + int(bytes) + 1
    self%text(self%used:self%used) = newline
  end subroutine load

  !> Room for `length` characters. The first file gets just its size; included ones make the buffer double.
  subroutine grow_text(self, length)
    type(source), intent(inout) :: self
    integer, intent(in) :: length
    character(len=:), allocatable :: longer
    integer(i8) :: wanted

    if (length <= len(self%text)) return
    wanted = length
    if (self%used > 0) wanted = min(max(wanted, 2_i8*len(self%text)), int(huge(1), i8))
    allocate (character(len=int(wanted)) :: longer)
    longer(:self%used) = self%text(:self%used)
    call move_alloc(longer, self%text)
  end subroutine grow_text

  !> Cut a file into lines and, where it includes another, that one too. `ended`: it had its ENDDATA.
  recursive subroutine cut(self, file, faults, ended)
    type(source), intent(inout) :: self
    integer, intent(in) :: file
    type(diagnostics), intent(inout) :: faults
    logical, intent(out) :: ended
    integer :: at, last, special, next, line, number, end_of_file
    character(len=7) :: word

    ended = .false.
    at = self%files(file)%first
    end_of_file = self%files(file)%last
    number = 0
    do while (at <= end_of_file .and. .not. ended)
      number = number + 1
      call find_end(self%text, at, last, special, next)
      if (self%count == size(self%line)) call double_lines(self)
      self%count = self%count + 1
      line = self%count
      self%line(line) = source_line(at, last, special, number, file)
      word = statement(self%text(at:last))
      ended = word == 'ENDDATA'
      if (word == 'INCLUDE') call include_file(self, line, faults)
      if (ended .or. word == 'INCLUDE') self%line(line)%last = at - 1
      at = next
    end do
  end subroutine cut

  !> Room for twice as many lines.
  subroutine double_lines(self)
    type(source), intent(inout) :: self
    type(source_line), allocatable :: longer(:)

    allocate (longer(2*self%count))
    longer(:self%count) = self%line
    call move_alloc(longer, self%line)
  end subroutine double_lines

  !> The end of the line that begins at `first`: its last character that is neither comment nor blank, and
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
        if (text(at:at) == newline) exit
        if (text(at:at) == '$') then
          comment = min(comment, at)
        else
          special = min(special, at)
        end if
      end if
      at = at + 1
    end do
    next = at + 1
    last = at - 1
    if (last >= first) then
      if (text(last:last) == achar(13)) last = last - 1
    end if
    last = min(last, comment - 1)
    do last = last, first, -1   ! codes: a character compared with a blank becomes a call
      if (iachar(text(last:last)) /= iachar(' ')) exit
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
    at = max(verify(line, ' '), 1)
    if (len(line) < at + 6) return
    word = upper(line(at:at + 6))
    if (word /= 'ENDDATA' .and. word /= 'INCLUDE') word = ''
    if (word == '' .or. len(line) == at + 6) return
    if (scan(upper(line(at + 7:at + 7)), 'ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789*') > 0) word = ''
  end function statement

  !> Read the file that the INCLUDE line `line` names, or say why not.
  recursive subroutine include_file(self, line, faults)
    type(source), intent(inout) :: self
    integer, intent(in) :: line
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: path, trouble
    type(place_type) :: place
    integer :: parent
    logical :: ended

    call quoted_name(self, line, place, path)
    if (.not. allocated(path)) then
      call faults%add_error(place, 'INCLUDE needs the name of a file between quotes', 'INCLUDE ''file''')
      return
    end if
    parent = self%line(line)%file
    path = relative_to(self%files(parent)%name, path)
    select case (files_above(self, parent, path))
    case (0)
      call faults%add_error(place, 'INCLUDE: '//shown(path)//' includes itself', &
                            'a file that does not lead back here')
    case (deepest + 1:)
      call faults%add_error(place, 'INCLUDE: files are included more than '//text_of(deepest)//' deep', &
                            'fewer levels')
    case default
      if (size(self%files) > most_files) then
        call faults%add_error(place, 'INCLUDE: more than '//text_of(most_files)//' files', 'fewer files')
        return
      end if
      call load(self, path, parent, trouble)
      if (allocated(trouble)) then
        call faults%add_error(place, 'INCLUDE: '//shown(path)//': '//trouble, &
                              'a name relative to the file of this line')
      else
        call cut(self, size(self%files), faults, ended)
      end if
    end select
  end subroutine include_file

  !> The name between the quotes of an INCLUDE line; not allocated where there is none.
  subroutine quoted_name(self, line, place, name)
    type(source), intent(in) :: self
    integer, intent(in) :: line
    type(place_type), intent(out) :: place  !! the name, or where it should be
    character(len=:), allocatable, intent(out) :: name
    character(len=:), allocatable :: text
    integer :: from, to

    text = self%text_of_line(line)
    from = verify(text, ' ') + 7
    if (from <= len(text)) then
      if (verify(text(from:), ' ') > 0) from = from + verify(text(from:), ' ') - 1
    end if
    place = place_type(line, from, max(from, len(text)))
    if (from >= len(text)) return
    if (scan(text(from:from), '''"') == 0) return
    to = from + index(text(from + 1:), text(from:from))
    if (to /= len(text) .or. to == from + 1) return
    if (verify(text(from + 1:to - 1), ' ') > 0) name = text(from + 1:to - 1)
  end subroutine quoted_name

  !> `name` as seen from the directory of `file`.
  pure function relative_to(file, name) result(path)
    character(len=*), intent(in) :: file, name
    character(len=:), allocatable :: path

    path = trim(name)
    if (path(1:1) /= '/') path = file(:index(file, '/', back=.true.))//path
  end function relative_to

  !> How many files lead down to `file`, the deck and itself included; 0 where `path` is one of them.
  pure integer function files_above(self, file, path) result(files)
    type(source), intent(in) :: self
    integer, intent(in) :: file
    character(len=*), intent(in) :: path
    integer :: at

    files = 0
    at = file
    do while (at > 0)
      files = files + 1
      if (self%files(at)%name == path) exit
      at = self%files(at)%parent
    end do
    if (at > 0) files = 0
  end function files_above

  !> The name of the deck as the user gave it.
  pure function deck_name(self) result(name)
    class(source), intent(in) :: self
    character(len=:), allocatable :: name

    name = self%files(1)%name
  end function deck_name

  !> The name of the file of a line.
  pure function file_name(self, line) result(name)
    class(source), intent(in) :: self
    integer, intent(in) :: line   !! in deck order
    character(len=:), allocatable :: name

    name = self%files(self%line(line)%file)%name
  end function file_name

  !> A line as it is read, without comment.
  pure function text_of_line(self, line) result(text)
    class(source), intent(in) :: self
    integer, intent(in) :: line   !! in deck order
    character(len=:), allocatable :: text

    text = self%text(self%line(line)%first:self%line(line)%last)
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
    last = min(first + from + most - 2, self%used)
    last = first - 2 + index(self%text(first:last)//newline, newline)
    text = self%text(first + from - 1:last)
    if (len(text) == 0) return
    if (text(len(text):) == achar(13)) text = text(:len(text) - 1)
    text = trim(text)
  end function whole_line

  !> Is there nothing to read in a line?
  pure logical function blank(self, line)
    class(source), intent(in) :: self
    integer, intent(in) :: line   !! in deck order

    blank = self%line(line)%last < self%line(line)%first
  end function blank

end module epcont_deck_source
