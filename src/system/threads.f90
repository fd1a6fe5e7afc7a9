!> Number of threads that the user allows. The BLAS always has one: with more it would split sums differently
!> and change the last digits of tables. (Several decks in parallel use more cores.)
module epcont_system_threads
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_procpointer, c_funptr, c_int, &
      c_null_char, c_null_ptr, c_ptr
  !$ use omp_lib, only: omp_get_max_threads, omp_in_parallel, omp_set_num_threads
  implicit none
  private
  public :: granted_threads, stated_threads, threads_now, threads_over, use_one_thread_each, use_threads

  !> One thread for the BLAS; that of OpenMP is unchanged.
  integer, parameter, public :: one_thread(2) = [1, 0]

  abstract interface
    subroutine set_threads(count) bind(c)
      import
      integer(c_int), value :: count
    end subroutine set_threads

    integer(c_int) function get_number() bind(c)
      import
    end function get_number
  end interface

  interface
    !> Address of a procedure of the program or its libraries; null if it does not exist. The BLAS is known
    !! only at run time.
    function c_dlsym(library, name) bind(c, name='dlsym') result(address)
      import
      type(c_ptr), value :: library
      character(kind=c_char), intent(in) :: name(*)
      type(c_funptr) :: address
    end function c_dlsym
  end interface

contains

  !> Number of threads in OMP_NUM_THREADS. It is 1 if this variable is not set (decks in parallel use cores
  !! better), if the program has no OpenMP, or if the BLAS may not be called in parallel: an OpenBLAS built
  !! for threads (1) or OpenMP (2) locks its buffers, another one (0) shares them. It is also 1 in a parallel
  !! region.
  integer function granted_threads()
    granted_threads = 1
    !$ if (omp_in_parallel()) return
    !$ if (blas_number('openblas_get_parallel') /= 0) granted_threads = max(1, stated_threads())
  end function granted_threads

  !> Number of threads for a loop over nodes, elements or points that each take at least a tenth of a
  !! microsecond; one if most of the work is done before others start.
  integer function threads_over(pieces) result(threads)
    integer, intent(in) :: pieces
    integer, parameter :: many = 20000

    threads = 1
    if (pieces >= many) threads = granted_threads()
  end function threads_over

  !> Read the number in OMP_NUM_THREADS (the first of a list) without READ; 0 if it is not set.
  integer function stated_threads() result(threads)
    character(len=8) :: words
    integer :: i

    call get_environment_variable('OMP_NUM_THREADS', words)
    words = adjustl(words)
    threads = 0
    do i = 1, len(words)
      if (words(i:i) < '0' .or. words(i:i) > '9') exit
      threads = 10*threads + iachar(words(i:i)) - iachar('0')
    end do
  end function stated_threads

  !> Number of threads that the BLAS uses, and that OpenMP gives the caller; 0 if unknown.
  function threads_now() result(threads)
    integer :: threads(2)

    threads = [blas_number('openblas_get_num_threads'), 0]
    !$ threads(2) = omp_get_max_threads()
  end function threads_now

  !> Set the numbers of threads; only OpenBLAS has a procedure for it. Its OpenMP variant also sets OpenMP's
  !! number, so OpenMP is set last.
  subroutine use_threads(threads)
    integer, intent(in) :: threads(2)   !! as `threads_now` returns them
    procedure(set_threads), pointer :: set
    type(c_funptr) :: address

    address = c_dlsym(c_null_ptr, 'openblas_set_num_threads'//c_null_char)
    if (c_associated(address)) then
      call c_f_procpointer(address, set)
      call set(int(threads(1), c_int))
    end if
    !$ if (threads(2) > 0) call omp_set_num_threads(threads(2))
  end subroutine use_threads

  !> Use one thread for all calls inside a parallel region. Otherwise the second number of a list in
  !! OMP_NUM_THREADS would count, and a BLAS with OpenMP would use it.
  subroutine use_one_thread_each()
    !$ call omp_set_num_threads(1)
  end subroutine use_one_thread_each

  !> Ask OpenBLAS for a number; 0 for another BLAS.
  integer function blas_number(name)
    character(len=*), intent(in) :: name   !! of its procedure
    procedure(get_number), pointer :: get
    type(c_funptr) :: address

    blas_number = 0
    address = c_dlsym(c_null_ptr, name//c_null_char)
    if (.not. c_associated(address)) return
    call c_f_procpointer(address, get)
    blas_number = int(get())
  end function blas_number
end module epcont_system_threads
