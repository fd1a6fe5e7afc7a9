!> Large pages: one of 2 MB is mapped in one step where 512 of 4 kB take 512, and the processor finds it
!> sooner. Nothing but speed depends on them.
module epcont_system_large_pages
  use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_loc, c_size_t
  use epcont_base_kinds, only: i8, wp
  implicit none
  private
  public :: use_large_pages, use_small_pages, prepare_heap, take_heap

  integer(c_intptr_t), parameter :: page = 4096            !! where advice may begin [bytes]
  integer(c_intptr_t), parameter :: large_page = 2097152   !! [bytes]
  !> MADV_HUGEPAGE and MADV_NOHUGEPAGE of Linux; others refuse them, to no harm.
  integer(c_int), parameter :: advice_large_pages = 14, advice_small_pages = 15

  !> Parameters of glibc's `mallopt`.
  integer(c_int), parameter :: trim_threshold = -1, top_pad = -2, mmap_threshold = -3, arena_max = -8
  !> by which the heap grows; memory is taken when touched; the first of them in large pages [bytes]
  integer(c_int), parameter, public :: heap_step = 67108864
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

    call advise(transfer(c_loc(array), page), size(array, kind=c_intptr_t)*bits/8, advice_large_pages)
  end subroutine use_large_pages

  !> Ask for small ones again, where large ones take long to come: those that are free in a virtual machine
  !! may have been given back to its host, which then takes tens of times as long to find one.
  subroutine use_small_pages(array, bits)
    type(*), contiguous, target, intent(in) :: array(:)   !! of numbers
    integer, intent(in) :: bits                           !! that one of them takes

    call advise(transfer(c_loc(array), page), size(array, kind=c_intptr_t)*bits/8, advice_small_pages)
  end subroutine use_small_pages

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
      call advise(first, sbrk(0_c_intptr_t) - first, advice_large_pages)
    else
      ignored = mallopt(top_pad, 0_c_int)   ! memory is short: ask for no more than is needed
    end if
  end subroutine prepare_heap

  !> Take memory of the heap that will be needed soon, in large pages while these come fast: from the first
  !! on that does not, in small ones.
  recursive subroutine take_heap(bytes)
    integer(i8), intent(in) :: bytes
    real(wp), parameter :: slow = 1.0e-3_wp   ! of one page, five times the usual [s]
    real(wp), allocatable, target, volatile :: array(:)
    integer(i8) :: begun, ended, most, rate
    integer(c_intptr_t) :: from
    integer :: i, status

    most = min(bytes, int(largest_in_heap - large_page, i8))
    allocate (array(most*8/storage_size(array)), stat=status)
    if (status /= 0) return
    do i = 1, size(array), int(large_page*8/storage_size(array))
      call system_clock(begun, rate)
      array(i) = 0.0_wp
      call system_clock(ended)
      if (ended - begun <= slow*rate) cycle
      from = transfer(c_loc(array(i)), from)
      call advise(from, sbrk(0_c_intptr_t) - from, advice_small_pages)
      return
    end do
    if (bytes > most) call take_heap(bytes - most)
  end subroutine take_heap

  !> Advise the system of memory that begins at an address.
  subroutine advise(first, bytes, advice)
    integer(c_intptr_t), intent(in) :: first, bytes
    integer(c_int), intent(in) :: advice
    integer(c_intptr_t) :: from, length
    integer(c_int) :: ignored

    from = (first + page - 1)/page*page
    length = bytes - (from - first)
    if (length >= large_page) ignored = madvise(from, int(length, c_size_t), advice)
  end subroutine advise
end module epcont_system_large_pages
