!> A list of arrays that a program saves and reads again. The same procedure stores the arrays, and restores
!> them in the same order.
module epcont_base_archive
  use epcont_base_kinds, only: i8, wp
  implicit none
  private
  public :: archive, checksum

  type :: archive
    real(wp), allocatable :: value(:)        !! shapes and values of the arrays, with free space
    integer(i8) :: used = 0_i8               !! values that are stored, or have been restored
    logical :: reading = .false.             !! restore arrays instead of storing them
  contains
    generic :: pass => pass_mask, pass_vector, pass_matrix
    procedure, private :: pass_mask
    procedure, private :: pass_vector
    procedure, private :: pass_matrix
  end type archive

contains

  !> Store or restore logical values.
  pure subroutine pass_mask(self, mask)
    class(archive), intent(inout) :: self
    logical, intent(inout), allocatable :: mask(:)   !! any length
    real(wp), allocatable :: vector(:)

    if (allocated(mask)) vector = merge(1.0_wp, 0.0_wp, mask)
    call self%pass(vector)
    if (allocated(vector)) mask = vector > 0.0_wp
  end subroutine pass_mask

  !> Store or restore a vector.
  pure subroutine pass_vector(self, vector)
    class(archive), intent(inout) :: self
    real(wp), intent(inout), allocatable :: vector(:)   !! any length
    real(wp), allocatable :: matrix(:, :)

    if (allocated(vector)) matrix = reshape(vector, [1, size(vector)])
    call self%pass(matrix)
    if (allocated(matrix)) vector = matrix(1, :)
  end subroutine pass_vector

  !> Store or restore a matrix. Arrays may be unallocated.
  pure subroutine pass_matrix(self, matrix)
    class(archive), intent(inout) :: self
    real(wp), intent(inout), allocatable :: matrix(:, :)   !! any shape
    integer :: shape_of(2)

    shape_of = -1
    if (self%reading) then
      if (allocated(matrix)) deallocate (matrix)
      shape_of = nint(self%value(self%used + 1:self%used + 2))
      self%used = self%used + 2 + product(max(0, shape_of))
      if (any(shape_of < 0)) return
      matrix = reshape(self%value(self%used + 1 - product(shape_of):self%used), shape_of)
    else
      if (allocated(matrix)) shape_of = shape(matrix)
      call append(self, real(shape_of, wp))
      if (allocated(matrix)) call append(self, reshape(matrix, [size(matrix)]))
    end if
  end subroutine pass_matrix

  !> Append values. If there is no space, it is doubled.
  pure subroutine append(self, values)
    type(archive), intent(inout) :: self
    real(wp), intent(in) :: values(:)
    real(wp), allocatable :: longer(:)

    if (.not. allocated(self%value)) allocate (self%value(0))
    if (self%used + size(values) > size(self%value)) then
      allocate (longer(2*(self%used + size(values))))
      longer(:self%used) = self%value(:self%used)
      call move_alloc(longer, self%value)
    end if
    self%value(self%used + 1:self%used + size(values)) = values
    self%used = self%used + size(values)
  end subroutine append

  !> Compute a number that a change of any bit almost certainly changes: the remainder of a polynomial of the
  !! values modulo a prime.
  pure real(wp) function checksum(values)
    real(wp), intent(in) :: values(:)   !! any
    integer(i8), parameter :: prime = 2147483647_i8, factor = 48271_i8
    integer(i8) :: sum
    integer :: i

    sum = 0_i8
    do i = 1, size(values)
      sum = modulo(factor*sum + modulo(transfer(values(i), sum), prime), prime)
    end do
    checksum = real(sum, wp)
  end function checksum
end module epcont_base_archive
