!> How many threads the user grants.
module epcont_system_threads
  use epcont_system_one_thread, only: blas_may_be_shared
  implicit none
  private
  public :: granted_threads, stated_threads

contains

  !> As many as OMP_NUM_THREADS says; 1 where it is not set (decks side by side use cores better), where the program is
  !! built without OpenMP, or where the BLAS is not known to bear calls side by side.
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
end module epcont_system_threads
