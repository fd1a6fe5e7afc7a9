!> What is done before anything else where OpenBLAS is a part of the program: tools/cmake/static.cmake has it
!> called before OpenBLAS and the runtime of OpenMP look at the environment and at memory.
module epcont_app_start
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
  use epcont_app_ending, only: stop_now
  use epcont_base_error, only: status_usage
  use epcont_base_kinds, only: i8
  use epcont_system_memory, only: has_memory
  use epcont_system_threads, only: stated_threads
  implicit none
  private
  public :: prepare_start

  !> What OpenBLAS maps for each thread before the main program begins, and what the program wants beside it
  !! [bytes].
  integer(i8), parameter :: memory_of_blas = 134217728_i8, memory_beside = 32000000_i8
  integer(c_int), parameter :: processors_online = 84   !! `sysconf` of Linux

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
  end interface

contains

  !> One thread unless the environment says more, and threads that wait give up their core. Where OpenBLAS
  !! cannot have its memory, room for each thread but for no more than there are processors, it waits without
  !! end: that is refused. (The runtime of Fortran has not begun: READ and WRITE are not to be had.)
  subroutine prepare_start() bind(c, name='epcont_prepare_start')
    integer(c_int) :: ignored
    integer(i8) :: threads

    ignored = c_setenv('OMP_NUM_THREADS'//c_null_char, '1'//c_null_char, 0_c_int)
    ignored = c_setenv('OMP_WAIT_POLICY'//c_null_char, 'PASSIVE'//c_null_char, 0_c_int)
    threads = max(1_c_long, min(int(stated_threads(), c_long), c_sysconf(processors_online)))
    if (.not. has_memory(threads*memory_of_blas + memory_beside)) call stop_now(status_usage, &
      'less memory is free or allowed (ulimit -v) than OpenBLAS takes for OMP_NUM_THREADS')
  end subroutine prepare_start
end module epcont_app_start
