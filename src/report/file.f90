!> Texts by lines, and files of them. A file appears whole or not at all: it is written under a temporary
!> name, then renamed. A lock gives one run the right to write the files of one name.
!>
!> Files are written by C streams, which report whether all data has reached the disk; Fortran's `close` does
!> not.
module epcont_report_file
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, c_null_char, c_null_ptr, &
      c_ptr, c_size_t
  use epcont_base_error, only: error_type, raise, status_usage
  use epcont_base_kinds, only: i8
  use epcont_base_text, only: newline
  implicit none
  private
  public :: text_file, make_directory, remove_file, file_lock, lock_files, unlock_files

  !> A text in memory, to which lines are added.
  type :: text_file
    character(len=:), allocatable, private :: text   !! with free space
    integer(i8), private :: used = 0        !! characters in use
    character(len=40) :: mark = ''          !! follows each heading; empty if the answer is valid
  contains
    procedure :: characters => put
    procedure :: line
    procedure :: say
    procedure :: heading
    procedure :: add
    procedure :: is_empty
    procedure :: lines
    procedure :: write_to
  end type text_file

  integer(c_int), parameter :: no_file = -1

  !> The right to write the files of one name, until it is released or the process ends in any way.
  type :: file_lock
    private
    integer(c_int) :: descriptor = no_file
    character(len=:), allocatable :: path
  end type file_lock

  !> SIGHUP, SIGINT and SIGTERM: requests to end in good order.
  integer(c_int), parameter :: stop_signals(3) = [1_c_int, 2_c_int, 15_c_int]

  interface
    type(c_ptr) function c_fopen(path, mode) bind(c, name='fopen')
      import
      character(kind=c_char), intent(in) :: path(*), mode(*)
    end function c_fopen
    integer(c_size_t) function c_fwrite(text, size, count, stream) bind(c, name='fwrite')
      import
      character(kind=c_char), intent(in) :: text(*)
      integer(c_size_t), value :: size, count
      type(c_ptr), value :: stream
    end function c_fwrite
    integer(c_int) function c_fclose(stream) bind(c, name='fclose')
      import
      type(c_ptr), value :: stream
    end function c_fclose
    integer(c_int) function c_fileno(stream) bind(c, name='fileno')
      import
      type(c_ptr), value :: stream
    end function c_fileno
    integer(c_int) function c_flock(descriptor, operation) bind(c, name='flock')
      import
      integer(c_int), value :: descriptor, operation
    end function c_flock
    integer(c_int) function c_fcntl(descriptor, command, argument) bind(c, name='fcntl')
      import
      integer(c_int), value :: descriptor, command, argument
    end function c_fcntl
    integer(c_int) function c_close(descriptor) bind(c, name='close')
      import
      integer(c_int), value :: descriptor
    end function c_close
    type(c_ptr) function c_errno_location() bind(c, name='__errno_location')
      import
    end function c_errno_location
    integer(c_int) function c_rename(old, new) bind(c, name='rename')
      import
      character(kind=c_char), intent(in) :: old(*), new(*)
    end function c_rename
    integer(c_int) function c_unlink(path) bind(c, name='unlink')
      import
      character(kind=c_char), intent(in) :: path(*)
    end function c_unlink
    integer(c_int) function c_mkdir(path, mode) bind(c, name='mkdir')
      import
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
    end function c_mkdir
    integer(c_int) function c_sighold(signal) bind(c, name='sighold')
      import
      integer(c_int), value :: signal
    end function c_sighold
    integer(c_int) function c_sigrelse(signal) bind(c, name='sigrelse')
      import
      integer(c_int), value :: signal
    end function c_sigrelse
  end interface

contains

  !> Make a directory, if it does not exist. Errors appear when a file is opened.
  subroutine make_directory(path)
    character(len=*), intent(in) :: path   !! of the directory
    integer(c_int), parameter :: all_may = int(o'777', c_int)
    integer(c_int) :: ignored

    ignored = c_mkdir(path//c_null_char, all_may)
  end subroutine make_directory

  !> Remove a file, if it exists.
  subroutine remove_file(path)
    character(len=*), intent(in) :: path   !! of the file
    integer(c_int) :: ignored

    ignored = c_unlink(path//c_null_char)
  end subroutine remove_file

  !> Lock the files that begin with `stem`. The lock is a system lock on a file beside them, which ends with a
  !! killed process. If this file cannot be made, the error appears when results are written. File systems
  !! without locks have no protection.
  subroutine lock_files(stem, lock, error)
    character(len=*), intent(in) :: stem                  !! path of the files, without their suffixes
    type(file_lock), intent(out) :: lock                  !! valid if the lock was taken
    type(error_type), allocatable, intent(out) :: error   !! another run has the lock
    integer(c_int), parameter :: exclusive_at_once = 6, would_wait = 11   ! LOCK_EX + LOCK_NB, EWOULDBLOCK
    integer(c_int), parameter :: duplicate = 0, first = 3   ! F_DUPFD; the first descriptor after the standard
                                                            ! streams
    integer(c_int), pointer :: errno
    type(c_ptr) :: stream
    integer(c_int) :: ignored
    logical :: exists

    lock%path = stem//'.lock'
    do
      stream = c_fopen(lock%path//c_null_char, 'a'//c_null_char)
      if (.not. c_associated(stream)) return
      ! if a standard stream is closed, its descriptor must stay unused, or output would go to this file
      lock%descriptor = c_fcntl(c_fileno(stream), duplicate, first)
      ignored = c_fclose(stream)
      if (lock%descriptor == no_file) return
      if (c_flock(lock%descriptor, exclusive_at_once) /= 0) then
        call c_f_pointer(c_errno_location(), errno)
        if (errno /= would_wait) return
        call close_lock(lock)
        call raise(error, status_usage, stem//'.lst: another run is at work on these results: '// &
                   'wait for it, or take another -o DIR')
        return
      end if
      inquire (file=lock%path, exist=exists)
      if (exists) return
      call close_lock(lock)   ! the previous owner has removed the file after we opened it
    end do
  end subroutine lock_files

  !> Close the lock file.
  subroutine close_lock(lock)
    type(file_lock), intent(inout) :: lock
    integer(c_int) :: ignored

    ignored = c_close(lock%descriptor)
    lock%descriptor = no_file
  end subroutine close_lock

  !> Release the lock.
  subroutine unlock_files(lock)
    type(file_lock), intent(inout) :: lock   !! ends here

    if (lock%descriptor == no_file) return
    call remove_file(lock%path)
    call close_lock(lock)
  end subroutine unlock_files

  !> Append a line, without trailing blanks.
  subroutine line(self, text)
    class(text_file), intent(inout) :: self
    character(len=*), intent(in) :: text   !! of the line

    call put(self, trim(text))
    call put(self, newline)
  end subroutine line

  !> Append a line, indented by two blanks.
  subroutine say(self, text)
    class(text_file), intent(inout) :: self
    character(len=*), intent(in) :: text   !! of the line

    call self%line('  '//text)
  end subroutine say

  !> Append characters, of any kind.
  subroutine put(self, text)
    class(text_file), intent(inout) :: self
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: longer
    integer(i8) :: needed

    needed = self%used + len(text, i8)
    if (.not. allocated(self%text)) self%text = ''
    if (needed > len(self%text, i8)) then   ! double the space
      allocate (character(len=2*needed) :: longer)
      longer(:self%used) = self%text(:self%used)
      call move_alloc(longer, self%text)
    end if
    self%text(self%used + 1:needed) = text
    self%used = needed
  end subroutine put

  !> Append the text of another object, which is empty afterwards.
  subroutine add(self, other, without_head)
    class(text_file), intent(inout) :: self
    class(text_file), intent(inout) :: other
    logical, intent(in) :: without_head   !! leave out its first line
    integer(i8) :: first

    first = 1
    if (without_head) first = index(other%text(:other%used), newline, kind=i8) + 1
    call put(self, other%text(first:other%used))
    deallocate (other%text)
    other%used = 0
  end subroutine add

  !> Is there no text?
  pure logical function is_empty(self)
    class(text_file), intent(in) :: self

    is_empty = self%used == 0
  end function is_empty

  !> Return all lines.
  pure function lines(self) result(text)
    class(text_file), intent(in) :: self
    character(len=:), allocatable :: text

    text = self%text(:self%used)
  end function lines

  !> Append a blank line and a heading, marked if the answer is not valid.
  subroutine heading(self, text)
    class(text_file), intent(inout) :: self
    character(len=*), intent(in) :: text   !! of the heading

    call self%line('')
    call self%line(text//self%mark)
  end subroutine heading

  !> Write the text to a file. Meanwhile stop signals wait, so that no partial file remains.
  subroutine write_to(self, path, error)
    class(text_file), intent(in) :: self                  !! not empty
    character(len=*), intent(in) :: path                  !! of the file
    type(error_type), allocatable, intent(out) :: error   !! the file cannot be written
    type(c_ptr) :: stream
    logical :: whole

    call hold_signals(.true.)
    stream = c_fopen(path//'.part'//c_null_char, 'w'//c_null_char)
    if (c_associated(stream)) then
      whole = c_fwrite(self%text, 1_c_size_t, self%used, stream) == self%used
      whole = c_fclose(stream) == 0 .and. whole
      if (.not. whole) then
        call raise(error, status_usage, path//': cannot be written: is the disk full?')
      else if (c_rename(path//'.part'//c_null_char, path//c_null_char) /= 0) then
        call raise(error, status_usage, path//': cannot be written: is there a directory of that name?')
      end if
      if (allocated(error)) call remove_file(path//'.part')
    else
      call raise(error, status_usage, path// &
                 ': cannot be written: the directory does not exist or is not writable')
    end if
    call hold_signals(.false.)
  end subroutine write_to

  !> Delay stop signals, or deliver them: then a delayed signal stops the program.
  subroutine hold_signals(hold)
    logical, intent(in) :: hold
    integer(c_int) :: ignored
    integer :: i

    do i = 1, size(stop_signals)
      if (hold) ignored = c_sighold(stop_signals(i))
      if (.not. hold) ignored = c_sigrelse(stop_signals(i))
    end do
  end subroutine hold_signals
end module epcont_report_file
