!> How many threads the user grants.
module epcont_system_threads
  use epcont_system_one_thread, only: blas_may_be_shared
  implicit none
  private
  public :: granted_threads

contains

  !> As many as OMP_NUM_THREADS says; 1 where it is not set (decks side by side use cores better), where the program is built
  !! without OpenMP, or where the BLAS is not known to bear calls side by side.
  integer function granted_threads()
    character(len=80) :: words   ! room for the list of OpenMP, the number of each level
    integer :: status

    granted_threads = 1
    call get_environment_variable('OMP_NUM_THREADS', words, status=status)
    if (status /= 0) return
    !$ if (blas_may_be_shared()) read (words, *, iostat=status) granted_threads
    if (status /= 0) granted_threads = 1
    granted_threads = max(1, granted_threads)
  end function granted_threads
end module epcont_system_threads
