!> MUMPS behind a few doors, for `epcont_linalg_sparse` alone; `mumps_none.f90` stands in where there is no MUMPS.
!>
!> The doors have C binding so that either file serves at link time, and so that `epcont_linalg_sparse` can declare them
!> pure, as the routines of LAPACK are declared: what they change hangs on the handle, and they print nothing.
!>
!> The library is loaded when it is wanted: with all that it is linked with that takes a millisecond, and most decks do without it.
!>
!> Numbers of the form ICNTL(7) are those of the MUMPS Users' Guide.
module epcont_linalg_mumps
  use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_f_procpointer, c_funptr, c_int, c_int64_t, c_loc, &
                                         c_null_funptr, c_null_ptr, c_ptr
  use epcont_base_kinds, only: i8
  use epcont_base_memory, only: has_memory
  use epcont_base_one_thread, only: use_one_thread
  use epcont_base_shared_library, only: entry_in, loading_fault, open_library
  implicit none
  private
  public :: mumps_fault, mumps_analyse, mumps_factor, mumps_solve, mumps_inverse_entries, mumps_release

  include 'dmumps_struc.h'

  include 'library_name.inc'   ! written by tools/cmake/mumps.cmake
  !> What has to be there before it is loaded: OpenBLAS maps 268 MB then (on two cores), and waits without end for them.
  integer(i8), parameter :: memory_of_library = 400000000_i8   !! [bytes]

  !> Values of JOB.
  integer, parameter :: job_begin = -1, job_end = -2, job_analyse = 1, job_factor = 2, job_solve = 3
  !> ICNTL(7). Of AMD, AMF, QAMD, SCOTCH and PORD (Debian's has no METIS) AMF orders fastest and leaves least to do up to 100 000
  !! equations. Beyond, PORD saves a quarter of each factorization but orders for as long as four; SCOTCH is level with it, but its
  !! order was seen to change from run to run.
  integer, parameter :: amf = 2
  !> Right-hand sides that ICNTL(30) takes at a time; 64 are up to a fifth slower.
  integer, parameter :: block_size = 256
  !> INFOG(1): the work space was too small.
  integer, parameter :: too_small(2) = [-8, -9]
  !> INFOG(1): a pivot is zero. (To list such pivots and go on, ICNTL(24), is nothing for SYM = 1.)
  integer, parameter :: zero_pivot = -10

contains

  !> Why there is no MUMPS, as a C string; null: there is.
  function mumps_fault() result(fault) bind(c, name='epcont_mumps_fault')
    type(c_ptr) :: fault

    fault = c_null_ptr
    if (.not. has_memory(memory_of_library)) return   ! the analysis will say so
    if (.not. c_associated(dmumps_address())) fault = loading_fault()
  end function mumps_fault

  !> Call MUMPS: once loaded, the library is found again within microseconds.
  subroutine dmumps(id)
    type(dmumps_struc), intent(inout) :: id
    procedure(dmumps), pointer :: loaded

    call c_f_procpointer(dmumps_address(), loaded)
    call loaded(id)
  end subroutine dmumps

  !> Load the library, and find its only entry; null: there is none. It may bring a BLAS of its own, which is to
  !! have one thread like the program's.
  type(c_funptr) function dmumps_address() result(address)
    type(c_ptr) :: library

    address = c_null_funptr
    library = open_library(library_name)
    if (.not. c_associated(library)) return
    call use_one_thread(library)
    address = entry_in(library, 'dmumps_')
  end function dmumps_address

  !> Begin, and choose the order of elimination.
  subroutine mumps_analyse(solver, order, start, row, blocks, first, megabytes) bind(c, name='epcont_mumps_analyse')
    type(c_ptr), intent(inout) :: solver
    integer(c_int), value, intent(in) :: order
    integer(c_int), intent(in) :: start(order + 1), row(*)   !! lower triangle by columns
    integer(c_int), value, intent(in) :: blocks
    integer(c_int), intent(in) :: first(blocks + 1)          !! equation of each block: its equations have one pattern
    integer(c_int), intent(out) :: megabytes                 !! that factoring will take; 0: the analysis failed
    type(dmumps_struc), pointer :: id
    integer :: j, status

    call mumps_release(solver)
    megabytes = 0
    if (.not. has_memory(memory_of_library)) return
    if (.not. c_associated(dmumps_address())) return
    allocate (id)
    id%comm = 0
    id%par = 1
    id%sym = 1
    id%job = job_begin
    call dmumps(id)
    if (id%infog(1) < 0) then
      deallocate (id)
      return
    end if
    solver = c_loc(id)
    id%icntl(1:3) = -1   ! no messages
    id%icntl(4) = 0
    id%icntl(7) = amf
    id%icntl(8) = 1      ! scaled to a diagonal of ones, so that a pivot is its ratio to its diagonal entry
    id%icntl(15) = 1     ! analysis of blocks
    id%icntl(16) = 1     ! one thread
    id%icntl(28) = 1     ! sequential analysis
    id%n = order
    id%nnz = start(order + 1) - 1
    id%nblk = blocks
    allocate (id%irn(id%nnz), id%jcn(id%nnz), id%blkptr(blocks + 1), stat=status)
    if (status == 0) then
      id%irn = row(:id%nnz)
      do j = 1, order
        id%jcn(start(j):start(j + 1) - 1) = j
      end do
      id%blkptr = first
      id%job = job_analyse
      call dmumps(id)
    end if
    if (status /= 0 .or. id%infog(1) < 0) then
      call mumps_release(solver)
    else
      megabytes = max(id%infog(17), 1)
    end if
  end subroutine mumps_analyse

  !> Factor. `info` 0: done; 1: the matrix is not definite; -1: MUMPS could not, for want of memory.
  subroutine mumps_factor(solver, entries, a, smallest_ratio, info) bind(c, name='epcont_mumps_factor')
    type(c_ptr), value, intent(in) :: solver
    integer(c_int), value, intent(in) :: entries
    real(c_double), intent(in) :: a(entries)
    real(c_double), intent(out) :: smallest_ratio   !! smallest pivot over its diagonal entry; 0 unless all are positive
    integer(c_int), intent(out) :: info
    type(dmumps_struc), pointer :: id
    integer :: attempt, status

    call c_f_pointer(solver, id)
    smallest_ratio = 0.0_c_double
    info = -1
    id%icntl(14) = 20
    allocate (id%a(entries), source=a, stat=status)
    if (status /= 0) return
    do attempt = 1, 3
      id%job = job_factor
      call dmumps(id)
      if (all(id%infog(1) /= too_small)) exit
      id%icntl(14) = 4*id%icntl(14)
    end do
    deallocate (id%a)
    if (id%infog(1) < 0 .and. id%infog(1) /= zero_pivot) return
    info = 1
    if (id%infog(1) == zero_pivot .or. id%infog(12) > 0) return
    info = 0
    smallest_ratio = id%rinfog(19)
  end subroutine mumps_factor

  !> Solve in place.
  subroutine mumps_solve(solver, order, columns, x) bind(c, name='epcont_mumps_solve')
    type(c_ptr), value, intent(in) :: solver
    integer(c_int), value, intent(in) :: order, columns
    real(c_double), target, intent(inout) :: x(order*columns)
    type(dmumps_struc), pointer :: id

    call c_f_pointer(solver, id)
    id%nrhs = columns
    id%lrhs = order
    id%rhs => x
    id%job = job_solve
    call dmumps(id)
    nullify (id%rhs)
  end subroutine mumps_solve

  !> Entries of the inverse in some rows and columns, lower triangle packed by columns.
  subroutine mumps_inverse_entries(solver, order, count, equation, packed) bind(c, name='epcont_mumps_inverse_entries')
    type(c_ptr), value, intent(in) :: solver
    integer(c_int), value, intent(in) :: order, count
    integer(c_int), intent(in) :: equation(count)   !! ascending
    real(c_double), target, intent(out) :: packed(count*(count + 1)/2)
    type(dmumps_struc), pointer :: id
    integer :: j, k, last

    call c_f_pointer(solver, id)
    allocate (id%irhs_ptr(order + 1), id%irhs_sparse(size(packed)))
    last = 0
    k = 1
    do j = 1, count
      id%irhs_ptr(last + 1:equation(j)) = k
      last = equation(j)
      id%irhs_sparse(k:k + count - j) = equation(j:)
      k = k + count - j + 1
    end do
    id%irhs_ptr(last + 1:) = k
    packed = 0.0_c_double
    id%rhs_sparse => packed
    id%nz_rhs = size(packed)
    id%nrhs = order
    id%icntl(27) = block_size
    id%icntl(30) = 1
    id%job = job_solve
    call dmumps(id)
    id%icntl(30) = 0
    nullify (id%rhs_sparse)
    deallocate (id%irhs_ptr, id%irhs_sparse)
  end subroutine mumps_inverse_entries

  !> Give back all that hangs on the handle, and the handle.
  subroutine mumps_release(solver) bind(c, name='epcont_mumps_release')
    type(c_ptr), intent(inout) :: solver
    type(dmumps_struc), pointer :: id

    if (.not. c_associated(solver)) return
    call c_f_pointer(solver, id)
    if (associated(id%irn)) deallocate (id%irn)
    if (associated(id%jcn)) deallocate (id%jcn)
    if (associated(id%blkptr)) deallocate (id%blkptr)
    id%job = job_end
    call dmumps(id)
    deallocate (id)
    solver = c_null_ptr
  end subroutine mumps_release
end module epcont_linalg_mumps
