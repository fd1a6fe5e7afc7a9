!> Whether the system has memory to give, before it is needed.
module epcont_system_memory
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_long, c_size_t
  use epcont_base_kinds, only: i8
  implicit none
  private
  public :: has_memory, peak_memory

  !> What libraries take for themselves: OpenBLAS maps 134 MB with its first call, and where it cannot have
  !! them it waits without end; besides, the heap grows in large steps.
  integer(i8), parameter, public :: memory_of_libraries = 200000000_i8   !! [bytes]
  !> And what a thread more takes: again 134 MB of OpenBLAS, its stack, and a step of the heap.
  integer(i8), parameter, public :: memory_of_thread = 210000000_i8      !! [bytes]

  !> Arguments of Linux' `mmap`: pages to be read and written, of this process alone, with no file behind
  !! them.
  integer(c_int), parameter :: readable_writable = 3, private_anonymous = 34, no_file = -1

  interface
    integer(c_intptr_t) function c_mmap(address, length, protection, flags, file, offset) bind(c, name='mmap')
      import
      integer(c_intptr_t), value :: address
      integer(c_size_t), value :: length
      integer(c_int), value :: protection, flags, file
      integer(c_long), value :: offset
    end function c_mmap

    integer(c_int) function c_munmap(address, length) bind(c, name='munmap')
      import
      integer(c_intptr_t), value :: address
      integer(c_size_t), value :: length
    end function c_munmap

    integer(c_int) function c_getrusage(who, usage) bind(c, name='getrusage')
      import
      integer(c_int), value :: who
      integer(c_long), intent(out) :: usage(*)
    end function c_getrusage
  end interface

contains

  !> Does the system give `bytes` in one piece? They are given back untouched. (The heap would keep them, and
  !! libraries and threads want theirs beside it.)
  logical function has_memory(bytes) result(yes)
    integer(i8), intent(in) :: bytes   !! wanted
    integer(c_intptr_t) :: address

    address = c_mmap(0_c_intptr_t, int(bytes, c_size_t), readable_writable, private_anonymous, no_file, &
                     0_c_long)
    yes = address /= -1
    if (yes) yes = c_munmap(address, int(bytes, c_size_t)) == 0
  end function has_memory

  !> The most that this process has ever held, its libraries included [bytes].
  integer(i8) function peak_memory() result(bytes)
    integer(c_int), parameter :: myself = 0
    !> of Linux' struct rusage, and where in it the kilobytes stand
    integer, parameter :: longs = 18, maximum = 5
    integer(c_long) :: usage(longs)

    bytes = 0
    if (c_getrusage(myself, usage) == 0) bytes = 1024_i8*usage(maximum)
  end function peak_memory
end module epcont_system_memory
