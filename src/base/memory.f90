!> Whether the system has memory to give, before it is needed.
module epcont_base_memory
  use, intrinsic :: iso_c_binding, only: c_int, c_long
  use epcont_base_kinds, only: i8, wp
  implicit none
  private
  public :: has_memory, peak_memory

  !> What libraries take for themselves: OpenBLAS maps 134 MB with its first call, and where it cannot have them it waits
  !! without end; besides, the heap grows in large steps.
  integer(i8), parameter, public :: memory_of_libraries = 200000000_i8   !! [bytes]

  interface
    integer(c_int) function c_getrusage(who, usage) bind(c, name='getrusage')
      import :: c_int, c_long
      integer(c_int), value :: who
      integer(c_long), intent(out) :: usage(*)
    end function c_getrusage
  end interface

contains

  !> Does the system give `bytes` in one piece? They are given back untouched.
  logical function has_memory(bytes) result(yes)
    integer(i8), intent(in) :: bytes
    real(wp), allocatable :: array(:)
    integer :: status

    allocate (array(bytes/8), stat=status)
    yes = status == 0
    if (yes) array(1) = 0.0_wp   ! lest a compiler leave out what nothing uses
  end function has_memory

  !> The most that this process has ever held, its libraries included [bytes].
  integer(i8) function peak_memory() result(bytes)
    integer(c_int), parameter :: myself = 0
    integer, parameter :: longs = 18, maximum = 5   !! of Linux' struct rusage, and where in it the kilobytes stand
    integer(c_long) :: usage(longs)

    bytes = 0
    if (c_getrusage(myself, usage) == 0) bytes = 1024_i8*usage(maximum)
  end function peak_memory
end module epcont_base_memory
