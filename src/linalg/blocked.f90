!> Cholesky factors in blocks of columns, panels or fronts: what both do alike.
module epcont_linalg_blocked
  use epcont_base_kinds, only: i8, wp
  use epcont_linalg_assembled, only: assembled_matrix
  use epcont_linalg_lapack, only: dgemm, dgemv
  implicit none
  private
  public :: blocked_matrix, begin_blocks, diagonal, forward, backward

  !> Block p has the columns first(p) to first(p+1)-1, which are stored full, from entries(start(p)) on: the
  !! rows of these equations, and below them those that they are coupled with.
  type, abstract, extends(assembled_matrix) :: blocked_matrix
    integer, allocatable :: first(:)       !! column of each block [blocks + 1]
    integer, allocatable :: columns(:)     !! of each block [blocks]
    integer, allocatable :: height(:)      !! rows of each block [blocks]
    integer(i8), allocatable :: start(:)   !! of each block in `entries` [blocks + 1]
    real(wp), allocatable :: entries(:)
  contains
    procedure :: get_trailing_factor
  end type blocked_matrix

contains

  !> A matrix of zeros in these blocks, or word that there is no memory for it. (A function would hand back a
  !! copy of the whole matrix.)
  subroutine begin_blocks(self, first, height, trailing)
    class(blocked_matrix), intent(inout) :: self
    integer, intent(in) :: first(:)         !! [blocks + 1]
    integer, intent(in) :: height(:)        !! [blocks]
    integer, intent(in) :: trailing         !! as in `begin`
    logical :: stale(first(size(first)) - 1)
    integer :: p, status

    self%trailing = trailing
    self%order = size(stale)
    self%first = first
    self%height = height
    self%columns = first(2:) - first(:size(height))
    allocate (self%start(size(first)), source=1_i8)
    do p = 1, size(height)
      self%start(p + 1) = self%start(p) + int(height(p), i8)*self%columns(p)
    end do
    allocate (self%pivot_ratio(self%order))
    allocate (self%entries(self%start(size(first))), stat=status)   ! one more: where columns would go on
    self%lacks_memory = status /= 0
    if (self%lacks_memory) return
    stale = .true.
    call self%clear(stale)
  end subroutine begin_blocks

  !> L22, its columns gathered from the last blocks.
  pure subroutine get_trailing_factor(self, x)
    class(blocked_matrix), intent(in) :: self
    real(wp), allocatable, intent(out) :: x(:, :)
    integer :: before, i, j, p
    integer(i8) :: at

    allocate (x(self%trailing, self%trailing), source=0.0_wp)
    before = self%order - self%trailing
    do p = 1, size(self%height)
      do j = max(self%first(p), before + 1), self%first(p + 1) - 1
        at = self%start(p) + int(j - self%first(p), i8)*(self%height(p) + 1)
        do i = j, self%first(p) + self%height(p) - 1
          x(i - before, j - before) = self%entries(at + i - j)
        end do
      end do
    end do
  end subroutine get_trailing_factor

  !> Diagonal of columns that are stored full.
  pure function diagonal(height, columns, k)
    integer, intent(in) :: height, columns
    real(wp), intent(in) :: k(height, columns)
    real(wp) :: diagonal(columns)
    integer :: j

    diagonal = [(k(j, j), j=1, columns)]
  end function diagonal

  !> Solve with columns of a factor that are stored full, and take them off the rows below. Only a few are
  !! solved for at a time, by loops, which take less than the calls that `trsm` makes for each column.
  pure subroutine forward(height, columns, l, sides, leading, y)
    integer, intent(in) :: height, columns
    real(wp), intent(in) :: l(height, columns)
    integer, intent(in) :: sides                      !! right-hand sides
    integer, intent(in) :: leading                    !! dimension of y
    real(wp), intent(inout) :: y(leading, sides)      !! [height, sides]
    integer, parameter :: few = 16
    integer :: first, i, k, last

    do first = 1, columns, few
      last = min(first + few - 1, columns)
      do i = first, last
        do k = 1, sides   ! next to each other: each step of one side waits for the one before
          y(i, k) = y(i, k)/l(i, i)
          y(i + 1:last, k) = y(i + 1:last, k) - l(i + 1:last, i)*y(i, k)
        end do
      end do
      if (last == height) return
      if (sides == 1) then
        call dgemv('N', height - last, last - first + 1, -1.0_wp, l(last + 1, first), height, y(first, 1), &
                  1, 1.0_wp, y(last + 1, 1), 1)
      else
        call dgemm('N', 'N', height - last, sides, last - first + 1, -1.0_wp, l(last + 1, first), height, &
                  y(first, 1), leading, 1.0_wp, y(last + 1, 1), leading)
      end if
    end do
  end subroutine forward

  !> The same with its transpose.
  pure subroutine backward(height, columns, l, sides, leading, y)
    integer, intent(in) :: height, columns, sides, leading
    real(wp), intent(in) :: l(height, columns)
    real(wp), intent(inout) :: y(leading, sides)
    integer, parameter :: few = 16
    integer :: first, i, k, last

    do first = 1 + (columns - 1)/few*few, 1, -few
      last = min(first + few - 1, columns)
      if (last < height .and. sides == 1) then
        call dgemv('T', height - last, last - first + 1, -1.0_wp, l(last + 1, first), height, &
                  y(last + 1, 1), 1, 1.0_wp, y(first, 1), 1)
      else if (last < height) then
        call dgemm('T', 'N', last - first + 1, sides, height - last, -1.0_wp, l(last + 1, first), height, &
                  y(last + 1, 1), leading, 1.0_wp, y(first, 1), leading)
      end if
      ! Row by row: each step of a dot product would wait for the one before.
      do i = last, first, -1
        do k = 1, sides
          y(i, k) = y(i, k)/l(i, i)
          y(first:i - 1, k) = y(first:i - 1, k) - l(i, first:i - 1)*y(i, k)
        end do
      end do
    end do
  end subroutine backward
end module epcont_linalg_blocked
