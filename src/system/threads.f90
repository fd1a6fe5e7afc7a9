!> How many threads the user grants, and one for the BLAS, whatever the environment says: with more, sums are
!> cut differently, and the last digits of the tables are others. (Decks run side by side use more cores.)
module epcont_system_threads
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_procpointer, c_funptr, c_int, &
                                         c_null_char, c_null_ptr, c_ptr
  implicit none
  private
  public :: granted_threads, stated_threads, use_one_thread

  abstract interface
    subroutine set_threads(count) bind(c)
      import :: c_int
      integer(c_int), value :: count
    end subroutine set_threads

    integer(c_int) function get_parallel() bind(c)
      import :: c_int
    end function get_parallel
  end interface

  interface
    !> Where a procedure of the program or its libraries is; null: nowhere. Which BLAS there is, is not known
    !! before.
    function c_dlsym(library, name) bind(c, name='dlsym') result(address)
      import :: c_char, c_funptr, c_ptr
      type(c_ptr), value :: library
      character(kind=c_char), intent(in) :: name(*)
      type(c_funptr) :: address
    end function c_dlsym
  end interface

contains

  !> As many as OMP_NUM_THREADS says; 1 where it is not set (decks side by side use cores better), where the
  !! program is built without OpenMP, or where the BLAS is not known to bear calls side by side.
  integer function granted_threads()
    granted_threads = 1
    !$ if (blas_may_be_shared()) granted_threads = max(1, stated_threads())
  end function granted_threads

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

  !> Tell OpenBLAS; another BLAS has no such procedure.
  subroutine use_one_thread()
    procedure(set_threads), pointer :: set
    type(c_funptr) :: address

    address = c_dlsym(c_null_ptr, 'openblas_set_num_threads'//c_null_char)
    if (.not. c_associated(address)) return
    call c_f_procpointer(address, set)
    call set(1_c_int)
  end subroutine use_one_thread

  !> Whether threads may call the BLAS at the same time: an OpenBLAS that is built for threads locks its
  !! buffers, one that is not shares them, and of another nothing is known.
  logical function blas_may_be_shared()
    procedure(get_parallel), pointer :: parallel
    type(c_funptr) :: address

    blas_may_be_shared = .false.
    address = c_dlsym(c_null_ptr, 'openblas_get_parallel'//c_null_char)
    if (.not. c_associated(address)) return
    call c_f_procpointer(address, parallel)
    blas_may_be_shared = parallel() /= 0   ! 0 sequential, 1 threads, 2 OpenMP
  end function blas_may_be_shared
end module epcont_system_threads
