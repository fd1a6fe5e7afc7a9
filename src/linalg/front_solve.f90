!> Solutions with the Cholesky factor of a matrix in fronts, unit by unit, with the threads of the
!> factorization.
module epcont_linalg_front_solve
  use epcont_base_kinds, only: i8, wp
  use epcont_linalg_assembled, only: assembled_matrix, backward, forward
  use epcont_linalg_front_layout, only: front_layout
  use epcont_system_threads, only: use_one_thread_each
  implicit none
  private
  public :: front_factor

  type, abstract, extends(assembled_matrix) :: front_factor
    type(front_layout) :: layout
    integer :: threads = 1   !! of factorization and solutions
  contains
    procedure :: solve_lower
    procedure :: solve_upper
  end type front_factor

  !> Contribution of a unit to the equations that it reaches [reached equations * right-hand sides].
  type :: left_part
    real(wp), allocatable :: entries(:)
  end type left_part

contains

  !> Forward substitution, children first. The contribution of a unit to later units is kept until its parent
  !! adds it, in the order of the units, so rounding does not depend on the number of threads. Fronts with
  !! zero right-hand sides are left out.
  subroutine solve_lower(self, x)
    class(front_factor), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)
    type(left_part) :: beyond(size(self%height))   ! contribution of each unit
    integer, allocatable :: unit(:)   ! only addresses of its elements are used: of units, and of no unit
    integer :: above, p

    unit = [self%layout%unit, 0]
    !$omp parallel num_threads(solve_threads(self)) private(above)
    call use_one_thread_each()
    !$omp master   ! libgomp leaks the dependences of tasks that another thread makes
    do p = 1, size(beyond)
      if (unit(p) /= p) cycle
      above = merge(self%layout%parent(p), size(unit), self%layout%parent(p) > 0)
      !$omp task firstprivate(p) depend(in: unit(above)) depend(inout: unit(p))
      call take_unit(p, self%layout%of_unit%of(p))
      !$omp end task
    end do
    !$omp end master
    !$omp end parallel

  contains

    !> Substitute in the fronts of a unit, with the contributions of units below.
    subroutine take_unit(u, front)
      integer, intent(in) :: u, front(:)
      real(wp) :: own(maxval(self%height(front))*size(x, 2))   ! threads would wait for the heap
      integer :: i, k

      allocate (beyond(u)%entries(self%layout%reached(u)*size(x, 2)), source=0.0_wp)
      associate (below => self%layout%below, first => self%first)
        do i = 1, size(front)
          do k = below%start(front(i)), below%start(front(i) + 1) - 1
            associate (q => below%group(k))
              if (.not. allocated(beyond(q)%entries)) cycle   ! it is of this unit
              call add(u, q, self%layout%reached(q), 0, beyond(q)%entries, beyond(u)%entries)
              deallocate (beyond(q)%entries)
            end associate
          end do
          if (any(x(first(front(i)):first(front(i) + 1) - 1, :) /= 0.0_wp)) &
            call take_front(u, front(i), self%height(front(i)), own)
        end do
      end associate
    end subroutine take_unit

    !> Substitute in a front, with a matrix of its own rows.
    subroutine take_front(u, p, h, own)
      integer, intent(in) :: u, p, h
      real(wp), intent(inout) :: own(h, size(x, 2))

      associate (f => self%first(p), l => self%first(p + 1) - 1, n => self%columns(p))
        own(:n, :) = x(f:l, :)
        own(n + 1:, :) = 0.0_wp
        call forward(h, n, self%entries(self%start(p)), size(x, 2), h, own)
        x(f:l, :) = own(:n, :)
        call add(u, p, h, n, own, beyond(u)%entries)
      end associate
    end subroutine take_front

    !> Add to the equations that a front reaches; those of later units are kept apart.
    subroutine add(u, p, rows, before, part, apart)
      integer, intent(in) :: u, p
      integer, intent(in) :: rows, before   !! rows of part, and rows before those of these equations
      real(wp), intent(in) :: part(rows, size(x, 2))
      real(wp), intent(inout) :: apart(self%layout%reached(u), size(x, 2))
      integer :: at, i

      associate (start => self%layout%rows%start, row => self%layout%rows%group)
        at = start(u)
        do i = before + 1, rows
          associate (equation => row(start(p) + i - before - 1))
            if (equation < self%first(u + 1)) then
              x(equation, :) = x(equation, :) + part(i, :)
            else
              do while (row(at) < equation)
                at = at + 1
              end do
              apart(at - start(u) + 1, :) = apart(at - start(u) + 1, :) + part(i, :)
            end if
          end associate
        end do
      end associate
    end subroutine add
  end subroutine solve_lower

  !> Backward substitution, parents first.
  subroutine solve_upper(self, x, first)
    class(front_factor), intent(in) :: self
    real(wp), contiguous, intent(inout) :: x(:, :)
    integer, intent(in) :: first
    integer, allocatable :: unit(:)   ! only addresses of its elements are used: of units, and of no unit
    integer :: above, p

    unit = [self%layout%unit, 0]
    !$omp parallel num_threads(solve_threads(self)) private(above)
    call use_one_thread_each()
    !$omp master   ! see solve_lower
    do p = size(self%height), 1, -1
      if (unit(p) /= p .or. self%first(p + 1) <= first) cycle
      above = merge(self%layout%parent(p), size(unit), self%layout%parent(p) > 0)
      !$omp task firstprivate(p) depend(in: unit(above)) depend(inout: unit(p))
      call take_unit(self%layout%of_unit%of(p))
      !$omp end task
    end do
    !$omp end master
    !$omp end parallel

  contains

    !> Substitute in the fronts of a unit, the highest first.
    subroutine take_unit(front)
      integer, intent(in) :: front(:)
      real(wp) :: own(maxval(self%height(front))*size(x, 2))   ! of each front
      integer :: i

      do i = size(front), 1, -1
        if (self%first(front(i) + 1) > first) call take_front(front(i), self%height(front(i)), own)
      end do
    end subroutine take_unit

    !> Substitute in a front, with a matrix of its own rows.
    subroutine take_front(p, h, own)
      integer, intent(in) :: p, h
      real(wp), intent(inout) :: own(h, size(x, 2))
      integer :: i, k

      associate (f => self%first(p), l => self%first(p + 1) - 1, n => self%columns(p), &
                 row => self%layout%rows%group, before => self%layout%rows%start(p) - 1)
        own(:n, :) = x(f:l, :)
        do k = 1, size(x, 2)
          do i = n + 1, h
            own(i, k) = x(row(before + i - n), k)
          end do
        end do
        call backward(h, n, self%entries(self%start(p)), size(x, 2), h, own)
        x(f:l, :) = own(:n, :)
      end associate
    end subroutine take_front
  end subroutine solve_upper

  !> Threads of a solution: one if others would begin when most of it is done.
  pure integer function solve_threads(self) result(threads)
    class(front_factor), intent(in) :: self
    integer, parameter :: many = 2000000   ! entries: 2 ms

    threads = merge(self%threads, 1, size(self%entries, kind=i8) >= many)
  end function solve_threads
end module epcont_linalg_front_solve
