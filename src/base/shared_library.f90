!> Procedures of shared libraries, found while the program runs.
module epcont_base_shared_library
  use, intrinsic :: iso_c_binding, only: c_char, c_funptr, c_int, c_null_char, c_ptr
  implicit none
  private
  public :: open_library, loading_fault, entry_in

  !> All that the library calls is looked for at once: what is missing is told here, and does not end the program later on.
  integer(c_int), parameter :: resolve_now = 2   !! RTLD_NOW

  interface
    function c_dlopen(name, flags) bind(c, name='dlopen') result(library)
      import :: c_char, c_int, c_ptr
      character(kind=c_char), intent(in) :: name(*)
      integer(c_int), value :: flags
      type(c_ptr) :: library
    end function c_dlopen

    !> What the last call had to complain of.
    function loading_fault() bind(c, name='dlerror') result(text)
      import :: c_ptr
      type(c_ptr) :: text   !! C string; null: nothing
    end function loading_fault

    function c_dlsym(library, name) bind(c, name='dlsym') result(address)
      import :: c_char, c_funptr, c_ptr
      type(c_ptr), value :: library
      character(kind=c_char), intent(in) :: name(*)
      type(c_funptr) :: address
    end function c_dlsym
  end interface

contains

  !> Load a library with all that it is linked with, once for however many calls; it stays. Null: it could not be.
  type(c_ptr) function open_library(name) result(library)
    character(len=*), intent(in) :: name

    library = c_dlopen(name//c_null_char, resolve_now)
  end function open_library

  !> Where a procedure is, in a library or in those that it is linked with; without a library, in all of the program. Null: nowhere.
  type(c_funptr) function entry_in(library, name) result(address)
    type(c_ptr), intent(in) :: library
    character(len=*), intent(in) :: name

    address = c_dlsym(library, name//c_null_char)
  end function entry_in
end module epcont_base_shared_library
