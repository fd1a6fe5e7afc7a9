!> One thread for the BLAS, whatever the environment says: with more, sums are cut differently, and the last digits of the
!> tables are others. (Decks run side by side use more cores.)
module epcont_base_one_thread
  use, intrinsic :: iso_c_binding, only: c_associated, c_f_procpointer, c_funptr, c_int, c_null_ptr, c_ptr
  use epcont_base_shared_library, only: entry_in
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

contains

  !> Tell OpenBLAS; another BLAS has no such procedure.
  subroutine use_one_thread(library)
    type(c_ptr), intent(in) :: library   !! that calls it; null: the program
    procedure(set_threads), pointer :: set
    type(c_funptr) :: address

    address = entry_in(library, 'openblas_set_num_threads')
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
    address = entry_in(c_null_ptr, 'openblas_get_parallel')
    if (.not. c_associated(address)) return
    call c_f_procpointer(address, parallel)
    blas_may_be_shared = parallel() /= 0   ! 0 sequential, 1 threads, 2 OpenMP
  end function blas_may_be_shared
end module epcont_base_one_thread
