!> What is looked at before anything else where OpenBLAS is a part of the program; tools/cmake/static.cmake has it called.
module epcont_app_start
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_size_t
  use epcont_base_error, only: status_usage
  use epcont_base_kinds, only: i8
  use epcont_base_memory, only: has_memory
  use epcont_base_version, only: program_name
  implicit none
  private
  public :: check_start

  interface
    integer(c_size_t) function c_write(file, text, length) bind(c, name='write')
      import :: c_char, c_int, c_size_t
      integer(c_int), value :: file
      character(kind=c_char), intent(in) :: text(*)
      integer(c_size_t), value :: length
    end function c_write

    subroutine c_exit_now(status) bind(c, name='_exit')
      import :: c_int
      integer(c_int), value :: status
    end subroutine c_exit_now
  end interface

contains

  !> An OpenBLAS for OpenMP maps memory before the main program begins (268 MB on two cores; with more it may be more), and where it
  !! cannot have it, it waits without end. The runtime of Fortran has not begun either: WRITE is not to be had.
  subroutine check_start() bind(c, name='epcont_check_start')
    integer(i8), parameter :: memory = 300000000_i8   !! [bytes]
    integer(c_int), parameter :: standard_error = 2
    character(len=*), parameter :: text = &
      program_name//': less memory is free or allowed (ulimit -v) than any deck needs'//new_line('a')
    integer(c_size_t) :: written

    if (has_memory(memory)) return
    written = c_write(standard_error, text, len(text, kind=c_size_t))
    call c_exit_now(int(status_usage, c_int))
  end subroutine check_start
end module epcont_app_start
