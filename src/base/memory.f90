!> Whether the system has memory to give, before it is needed.
module epcont_base_memory
  use epcont_base_kinds, only: i8, wp
  implicit none
  private
  public :: has_memory

  !> What libraries take for themselves: OpenBLAS maps 134 MB with its first call, and where it cannot have them it waits
  !! without end; besides, the heap grows in large steps.
  integer(i8), parameter, public :: memory_of_libraries = 200000000_i8   !! [bytes]

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
end module epcont_base_memory
