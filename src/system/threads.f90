!> How many threads the user grants, and one for the BLAS, whatever the environment says: with more, sums are
!> cut differently, and the last digits of the tables are others. (Decks run side by side use more cores.)
module epcont_system_threads
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_procpointer, c_funptr, c_int, &
      c_null_char, c_null_ptr, c_ptr
  !$ use omp_lib, only: omp_get_max_threads, omp_in_parallel, omp_set_num_threads
  implicit none
  private
  public :: granted_threads, stated_threads, threads_now, threads_over, use_one_thread_each, use_threads

  !> For the BLAS; as many as there are for OpenMP.
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
    !> Where a procedure of the program or its libraries is; null: nowhere. Which BLAS there is, is not known
    !! before.
    function c_dlsym(library, name) bind(c, name='dlsym') result(address)
      import
      type(c_ptr), value :: library
      character(kind=c_char), intent(in) :: name(*)
      type(c_funptr) :: address
    end function c_dlsym
  end interface

contains

  !> As many as OMP_NUM_THREADS says; 1 where it is not set (decks side by side use cores better), where the
  !! program is built without OpenMP, or where the BLAS is not known to bear calls side by side: an OpenBLAS
  !! that is built for threads (1) or OpenMP (2) locks its buffers, one that is not (0) shares them. And 1 for
  !! who works beside others already.
  integer function granted_threads()
    granted_threads = 1
    !$ if (omp_in_parallel()) return
    !$ if (blas_number('openblas_get_parallel') /= 0) granted_threads = max(1, stated_threads())
  end function granted_threads

  !> Threads for a loop over so many nodes, elements or points that each take a tenth of a microsecond at
  !! least: one where others would begin after most of it is done.
  integer function threads_over(pieces) result(threads)
    integer, intent(in) :: pieces
    integer, parameter :: many = 20000

    threads = 1
    if (pieces >= many) threads = granted_threads()
  end function threads_over

  !> The number in OMP_NUM_THREADS, of a list the first, without READ; 0 where there is none.
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

  !> How many threads there are for the BLAS, and by OpenMP for whoever calls; 0: not known.
  function threads_now() result(threads)
    integer :: threads(2)

    threads = [blas_number('openblas_get_num_threads'), 0]
    !$ threads(2) = omp_get_max_threads()
  end function threads_now

  !> Tell OpenBLAS; another BLAS has no such procedure. One that uses OpenMP tells that, so it comes last.
  subroutine use_threads(threads)
    integer, intent(in) :: threads(2)   !! as `threads_now` has them
    procedure(set_threads), pointer :: set
    type(c_funptr) :: address

    address = c_dlsym(c_null_ptr, 'openblas_set_num_threads'//c_null_char)
    if (c_associated(address)) then
      call c_f_procpointer(address, set)
      call set(int(threads(1), c_int))
    end if
    !$ if (threads(2) > 0) call omp_set_num_threads(threads(2))
  end subroutine use_threads

  !> Within a parallel region: whatever each of its threads calls has one. Of a list in OMP_NUM_THREADS the
  !! second number would count there, and a BLAS that uses OpenMP would take it.
  subroutine use_one_thread_each()
    !$ call omp_set_num_threads(1)
  end subroutine use_one_thread_each

  !> What OpenBLAS says; 0: it is another BLAS.
  integer function blas_number(name)
    character(len=*), intent(in) :: name   !! of the procedure that says it
    procedure(get_number), pointer :: get
    type(c_funptr) :: address

    blas_number = 0
    address = c_dlsym(c_null_ptr, name//c_null_char)
    if (.not. c_associated(address)) return
    call c_f_procpointer(address, get)
    blas_number = int(get())
  end function blas_number
end module epcont_system_threads
