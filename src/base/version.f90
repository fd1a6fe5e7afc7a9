!> Name and version of the program.
module epcont_base_version
  implicit none
  private

  character(len=*), parameter, public :: program_name = 'epcont'
  !> Kept equal to the version in CMakeLists.txt (a test compares them).
  character(len=*), parameter, public :: program_version = '0.6.0'
  !> Of the manual page: the day it was last changed (a test compares them).
  character(len=*), parameter, public :: program_date = '2026-11-29'
end module epcont_base_version
