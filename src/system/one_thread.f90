!> One thread for the BLAS, whatever the environment says: with more, sums are cut differently, and the last digits of the
!> tables are others. (Decks run side by side use more cores.)
module epcont_system_one_thread
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_procpointer, c_funptr, c_int, c_null_char, c_null_ptr, c_ptr
  implicit none
  private
  public :: blas_may_be_shared, use_one_thread

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
    function c_dlsym(library, name) bind(c, name='dlsym') result(address)
      import :: c_char, c_funptr, c_ptr
      type(c_ptr), value :: library
      character(kind=c_char), intent(in) :: name(*)
      type(c_funptr) :: address
    end function c_dlsym
  end interface

contains

  !> Tell OpenBLAS; another BLAS has no such procedure.
  subroutine use_one_thread()
    procedure(set_threads), pointer :: set
    type(c_funptr) :: address

    address = procedure_of('openblas_set_num_threads')
    if (.not. c_associated(address)) return
    call c_f_procpointer(address, set)
    call set(1_c_int)
  end subroutine use_one_thread

  !> Whether threads may call the BLAS at the same time: an OpenBLAS that is built for threads locks its buffers, one that is
  !! not shares them, and of another nothing is known.
  logical function blas_may_be_shared()
    procedure(get_parallel), pointer :: parallel
    type(c_funptr) :: address

    blas_may_be_shared = .false.
    address = procedure_of('openblas_get_parallel')
    if (.not. c_associated(address)) return
    call c_f_procpointer(address, parallel)
    blas_may_be_shared = parallel() /= 0   ! 0 sequential, 1 threads, 2 OpenMP
  end function blas_may_be_shared

  !> Where a procedure of the program or its libraries is; null: nowhere. Which BLAS there is, is not known before.
  type(c_funptr) function procedure_of(name) result(address)
    character(len=*), intent(in) :: name

    address = c_dlsym(c_null_ptr, name//c_null_char)
  end function procedure_of
end module epcont_system_one_thread
