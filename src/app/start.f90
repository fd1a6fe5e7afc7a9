!> What is done before anything else where OpenBLAS is a part of the program: tools/cmake/static.cmake has it called before
!> OpenBLAS and the runtime of OpenMP look at the environment and at memory.
module epcont_app_start
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char, c_size_t
  use epcont_base_error, only: status_usage
  use epcont_base_kinds, only: i8
  use epcont_base_version, only: program_name
  use epcont_system_memory, only: has_memory
  implicit none
  private
  public :: prepare_start

  !> What OpenBLAS maps for each thread before the main program begins, and what the program wants beside it [bytes].
  integer(i8), parameter :: memory_of_blas = 134217728_i8, memory_beside = 32000000_i8
  integer(c_int), parameter :: processors_online = 84   !! `sysconf` of Linux
  integer(c_int), parameter :: standard_error = 2

  interface
    integer(c_int) function c_setenv(name, value, replace) bind(c, name='setenv')
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: name(*), value(*)
      integer(c_int), value :: replace
    end function c_setenv

    integer(c_long) function c_sysconf(name) bind(c, name='sysconf')
      import :: c_int, c_long
      integer(c_int), value :: name
    end function c_sysconf

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

  !> One thread unless the environment says more, and threads that wait give up their core. Where OpenBLAS cannot have its memory it
  !! waits without end: that is refused. (The runtime of Fortran has not begun: READ and WRITE are not to be had.)
  subroutine prepare_start() bind(c, name='epcont_prepare_start')
    character(len=*), parameter :: text = &
      program_name//': less memory is free or allowed (ulimit -v) than OpenBLAS takes for OMP_NUM_THREADS'//new_line('a')
    integer(c_int) :: ignored
    integer(c_size_t) :: written

    ignored = c_setenv('OMP_NUM_THREADS'//c_null_char, '1'//c_null_char, 0_c_int)
    ignored = c_setenv('OMP_WAIT_POLICY'//c_null_char, 'PASSIVE'//c_null_char, 0_c_int)
    if (has_memory(threads_of_blas()*memory_of_blas + memory_beside)) return
    written = c_write(standard_error, text, len(text, kind=c_size_t))
    call c_exit_now(int(status_usage, c_int))
  end subroutine prepare_start

  !> As many threads as OpenBLAS makes room for: those of OMP_NUM_THREADS, of a list the first, and no more than processors.
  integer(i8) function threads_of_blas() result(threads)
    character(len=8) :: words
    integer :: i

    call get_environment_variable('OMP_NUM_THREADS', words)
    threads = 0
    do i = 1, len(words)
      if (words(i:i) < '0' .or. words(i:i) > '9') exit
      threads = 10*threads + iachar(words(i:i)) - iachar('0')
    end do
    threads = max(1_i8, min(threads, int(c_sysconf(processors_online), i8)))
  end function threads_of_blas
end module epcont_app_start
