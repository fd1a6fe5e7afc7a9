!> Large pages: one of 2 MB is mapped in one step where 512 of 4 kB take 512, and the processor finds it
!> sooner. Nothing but speed depends on them, and what is given back is there for others.
module epcont_system_large_pages
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_loc, c_size_t
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: give_back, use_large_pages, prepare_heap

  integer(c_intptr_t), parameter :: page = 4096            !! where advice may begin [bytes]
  integer(c_intptr_t), parameter, public :: large_page = 2097152   !! [bytes]
  integer(c_int), parameter :: advice_large_pages = 14 !! MADV_HUGEPAGE of Linux; others refuse it, to no harm
  integer(c_int), parameter :: advice_not_needed = 4   !! MADV_DONTNEED

  !> Parameters of glibc's `mallopt`.
  integer(c_int), parameter :: trim_threshold = -1, top_pad = -2, mmap_threshold = -3, arena_max = -8
  !> by which the heap grows; memory is taken when touched [bytes]
  integer(c_int), parameter :: heap_step = 67108864
  !> arrays up to here are in the heap: glibc's own limit [bytes]
  integer(c_int), parameter :: largest_in_heap = 33554432

  interface
    integer(c_int) function madvise(address, length, advice) bind(c)
      import
      integer(c_intptr_t), value :: address
      integer(c_size_t), value :: length
      integer(c_int), value :: advice
    end function madvise

    integer(c_int) function mallopt(parameter, value) bind(c)
      import
      integer(c_int), value :: parameter, value
    end function mallopt

    integer(c_intptr_t) function sbrk(increment) bind(c)
      import
      integer(c_intptr_t), value :: increment
    end function sbrk
  end interface

contains

  !> Ask for large pages under an array that has not been touched yet.
  subroutine use_large_pages(array, bits)
    type(*), contiguous, target, intent(in) :: array(:)   !! of numbers
    integer, intent(in) :: bits                           !! that one of them takes

    call advise(transfer(c_loc(array), page), size(array, kind=c_intptr_t)*bits/8)
  end subroutine use_large_pages

  !> Give the memory of an array, as far as it has large pages of its own, back to the system: what stands
  !! there is lost.
  subroutine give_back(array, bits)
    type(*), contiguous, target, intent(in) :: array(:)   !! of numbers
    integer, intent(in) :: bits                           !! that one of them takes
    integer(c_intptr_t) :: first, from, length
    integer(c_int) :: ignored

    if (size(array) == 0) return
    first = transfer(c_loc(array), first)
    from = (first + large_page - 1)/large_page*large_page
    length = (first + size(array, kind=c_intptr_t)*bits/8 - from)/large_page*large_page
    if (length > 0) ignored = madvise(from, int(length, c_size_t), advice_not_needed)
  end subroutine give_back

  !> Let the heap grow in large steps and keep what is freed, with large pages under the first of them.
  !! Threads have no heaps of their own: each would take 128 MB of addresses, and keep what it frees from the
  !! others.
  subroutine prepare_heap()
    integer(c_int) :: ignored
    integer(c_intptr_t) :: first
    integer :: status
    real(wp), allocatable :: array(:)

    ignored = mallopt(mmap_threshold, largest_in_heap)
    ignored = mallopt(trim_threshold, huge(ignored))
    ignored = mallopt(top_pad, heap_step)
    ignored = mallopt(arena_max, 1_c_int)
    first = sbrk(0_c_intptr_t)
    allocate (array(heap_step/32), stat=status)   ! too large for what the heap has: it grows
    if (status == 0) then
      call advise(first, sbrk(0_c_intptr_t) - first)
    else
      ignored = mallopt(top_pad, 0_c_int)   ! memory is short: ask for no more than is needed
    end if
  end subroutine prepare_heap

  !> Advise the system of memory that begins at an address.
  subroutine advise(first, bytes)
    integer(c_intptr_t), intent(in) :: first, bytes
    integer(c_intptr_t) :: from, length
    integer(c_int) :: ignored

    from = (first + page - 1)/page*page
    length = bytes - (from - first)
    if (length >= large_page) ignored = madvise(from, int(length, c_size_t), advice_large_pages)
  end subroutine advise
end module epcont_system_large_pages
