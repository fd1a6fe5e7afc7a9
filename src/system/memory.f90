!> Memory of the system: check that there is enough before it is needed, set the growth of the heap, report
!> the peak.
module epcont_system_memory
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_long, c_signed_char, c_size_t
  use epcont_base_kinds, only: i8
  implicit none
  private
  public :: has_memory, peak_memory, prepare_heap

  !> Memory of libraries: OpenBLAS maps 134 MB with its first call, and waits forever if it cannot have them;
  !! the heap grows in large steps.
  integer(i8), parameter, public :: memory_of_libraries = 200000000_i8   !! [bytes]
  !> Memory of one more thread: again 134 MB of OpenBLAS, its stack, and a step of the heap.
  integer(i8), parameter, public :: memory_of_thread = 210000000_i8      !! [bytes]

  !> Arguments of Linux' `mmap`: readable and writable pages, private to this process, without a file.
  integer(c_int), parameter :: readable_writable = 3, private_anonymous = 34, no_file = -1

  !> Parameters of glibc's `mallopt`.
  integer(c_int), parameter :: trim_threshold = -1, top_pad = -2, mmap_threshold = -3, arena_max = -8
  !> Growth step of the heap; memory is used when it is touched [bytes].
  integer(c_int), parameter :: heap_step = 67108864
  !> Arrays of at most this size are in the heap: glibc's own limit [bytes].
  integer(c_int), parameter :: largest_in_heap = 33554432
  !> Alignment of `madvise` [bytes]; MADV_HUGEPAGE of Linux, which other systems ignore.
  integer(c_intptr_t), parameter :: page = 4096
  integer(c_int), parameter :: advice_large_pages = 14

  interface
    integer(c_int) function mallopt(parameter, value) bind(c)
      import
      integer(c_int), value :: parameter, value
    end function mallopt

    integer(c_int) function madvise(address, length, advice) bind(c)
      import
      integer(c_intptr_t), value :: address
      integer(c_size_t), value :: length
      integer(c_int), value :: advice
    end function madvise

    integer(c_intptr_t) function sbrk(increment) bind(c)
      import
      integer(c_intptr_t), value :: increment
    end function sbrk

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

  !> Let the heap grow in large steps and keep freed memory, with large pages under the first step: one page
  !! of 2 MB replaces 512 faults of small pages. Threads get no heaps of their own: each would reserve 128 MB
  !! of addresses, and keep its freed memory from the others.
  subroutine prepare_heap()
    integer(c_int) :: ignored
    integer(c_intptr_t) :: first
    integer(c_signed_char), allocatable :: array(:)
    integer :: status

    ignored = mallopt(mmap_threshold, largest_in_heap)
    ignored = mallopt(trim_threshold, huge(ignored))
    ignored = mallopt(top_pad, heap_step)
    ignored = mallopt(arena_max, 1_c_int)
    first = (sbrk(0_c_intptr_t) + page - 1)/page*page
    allocate (array(heap_step/4), stat=status)   ! too large for the heap, which grows
    if (status == 0) then
      ignored = madvise(first, int(sbrk(0_c_intptr_t) - first, c_size_t), advice_large_pages)
    else
      ignored = mallopt(top_pad, 0_c_int)   ! memory is short: ask only for what is needed
    end if
  end subroutine prepare_heap

  !> Can the system provide `bytes` in one piece? They are returned untouched. The heap would keep them, but
  !! libraries and threads need memory beside it.
  logical function has_memory(bytes) result(yes)
    integer(i8), intent(in) :: bytes   !! required
    integer(c_intptr_t) :: address

    address = c_mmap(0_c_intptr_t, int(bytes, c_size_t), readable_writable, private_anonymous, no_file, &
                     0_c_long)
    yes = address /= -1
    if (yes) yes = c_munmap(address, int(bytes, c_size_t)) == 0
  end function has_memory

  !> Find the peak memory of this process, with its libraries [bytes].
  integer(i8) function peak_memory() result(bytes)
    integer(c_int), parameter :: myself = 0
    !> size of Linux' struct rusage, and position of the peak in kilobytes
    integer, parameter :: longs = 18, maximum = 5
    integer(c_long) :: usage(longs)

    bytes = 0
    if (c_getrusage(myself, usage) == 0) bytes = 1024_i8*usage(maximum)
  end function peak_memory
end module epcont_system_memory
