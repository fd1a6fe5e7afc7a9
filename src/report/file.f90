!> Files that appear whole or not at all: written beside their place, then renamed.
module epcont_report_file
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  use epcont_base_error, only: error_type, raise, status_usage
  implicit none
  private
  public :: text_file, new_text_file, make_directory

  type :: text_file
    character(len=:), allocatable :: mark          !! stands behind each heading; empty where the answer is valid
    integer, private :: unit = -1
    character(len=:), allocatable, private :: path
  contains
    procedure :: line
    procedure :: finish
  end type text_file

  interface
    integer(c_int) function c_rename(old, new) bind(c, name='rename')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: old(*), new(*)
    end function c_rename
    integer(c_int) function c_mkdir(path, mode) bind(c, name='mkdir')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
    end function c_mkdir
  end interface

contains

  !> Make a directory, where there is none; that it cannot be written to shows when a file is opened.
  subroutine make_directory(path)
    character(len=*), intent(in) :: path
    integer(c_int), parameter :: all_may = int(o'777', c_int)
    integer(c_int) :: ignored

    ignored = c_mkdir(path//c_null_char, all_may)
  end subroutine make_directory

  !> Begin a file.
  subroutine new_text_file(path, file, error)
    character(len=*), intent(in) :: path
    type(text_file), intent(out) :: file
    type(error_type), allocatable, intent(out) :: error
    integer :: status

    file%path = path
    file%mark = ''
    open (newunit=file%unit, file=path//'.part', status='replace', action='write', iostat=status)
    if (status /= 0) call raise(error, status_usage, path//': cannot be written: a directory that is there, writable')
  end subroutine new_text_file

  !> Add a line, without blanks at its end.
  subroutine line(self, text)
    class(text_file), intent(in) :: self
    character(len=*), intent(in) :: text

    write (self%unit, '(a)') trim(text)
  end subroutine line

  !> Close the file and give it its name.
  subroutine finish(self, error)
    class(text_file), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    integer :: status

    close (self%unit, iostat=status)
    if (status == 0) status = c_rename(self%path//'.part'//c_null_char, self%path//c_null_char)
    if (status /= 0) call raise(error, status_usage, self%path//': cannot be written: is the disk full?')
  end subroutine finish
end module epcont_report_file
