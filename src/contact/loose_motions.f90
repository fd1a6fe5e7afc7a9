!> Motions that some pairs do not hold: the x with A x = 0 in their rows.
!>
!> Of many bodies A is large, and its singular values would take longer than all the rest. Motions that
!> hang together through the pairs are looked at by themselves; where the Cholesky factor of A'A, banded in
!> the order in which they are met from pair to pair, says that all of them are held, there is nothing to
!> look for.
module epcont_contact_loose_motions
  use epcont_base_kinds, only: wp
  use epcont_flexibility_motion_matrix, only: motion_matrix
  use epcont_linalg_dense, only: least_eigenvalue, null_space
  implicit none
  private
  public :: loose_motions

  !> Singular values that far above the tolerance, as the factor has them, are above it: its estimate of the
  !! smallest is hardly ever off by 10.
  real(wp), parameter :: clearly = 100.0_wp

contains

  !> Orthonormal basis of the motions that these pairs do not hold.
  function loose_motions(motion, pairs, tolerance) result(loose)
    type(motion_matrix), intent(in) :: motion   !! A, largest entry of each column one [n, m]
    integer, intent(in) :: pairs(:)       !! each once
    real(wp), intent(in) :: tolerance     !! a singular value up to this is zero
    real(wp), allocatable :: loose(:, :)  !! [m, any]
    real(wp), allocatable :: more(:, :), own(:, :)
    integer, allocatable :: motions(:), together(:)
    type(motion_matrix) :: by_pair        ! A'
    logical :: counts(motion%pairs), met(motion%motions())
    integer :: band, j, k   ! rows of the band of A'A

    by_pair = motion%turned()
    counts = .false.
    counts(pairs) = .true.
    allocate (loose(size(met), 0))
    met = .false.
    do j = 1, size(met)
      if (met(j)) cycle
      call meet_all(j)
      if (are_held()) cycle
      motions = pack([(k, k=1, size(met))], [(any(together == k), k=1, size(met))])
      own = null_space(motion%rows(pairs, motions), tolerance)
      allocate (more(size(met), size(own, 2)), source=0.0_wp)
      more(motions, :) = own
      loose = reshape([loose, more], [size(met), size(loose, 2) + size(own, 2)])
      deallocate (more)
    end do

  contains

    !> The motions that hang together with one, in the order in which they are met.
    subroutine meet_all(first)
      integer, intent(in) :: first
      integer :: at, i, k, last
      integer :: queue(size(met))

      queue(1) = first
      met(first) = .true.
      last = 1
      at = 1
      band = 1
      do while (at <= last)
        do i = motion%start(queue(at)), motion%start(queue(at) + 1) - 1
          if (.not. counts(motion%pair(i))) cycle
          do k = by_pair%start(motion%pair(i)), by_pair%start(motion%pair(i) + 1) - 1
            associate (next => by_pair%pair(k))
              if (met(next)) cycle
              last = last + 1
              queue(last) = next
              met(next) = .true.
            end associate
          end do
        end do
        band = max(band, last - at + 1)
        at = at + 1
      end do
      together = queue(:last)
    end subroutine meet_all

    !> Are all singular values of these motions clearly above the tolerance?
    logical function are_held() result(held)
      real(wp), allocatable :: square(:, :)

      square = banded_square()
      ! A'A has its rounding, too.
      held = least_eigenvalue(square) > clearly**2*max(tolerance**2, epsilon(1.0_wp)*maxval(square(1, :)))
    end function are_held

    !> A'A of these motions, its diagonal and what is below it [band, motions].
    pure function banded_square() result(square)
      real(wp), allocatable :: square(:, :)
      integer :: place(size(met))
      integer :: i, j, k

      place(together) = [(k, k=1, size(together))]
      allocate (square(band, size(together)), source=0.0_wp)
      do j = 1, size(together)
        do i = motion%start(together(j)), motion%start(together(j) + 1) - 1
          if (.not. counts(motion%pair(i))) cycle
          do k = by_pair%start(motion%pair(i)), by_pair%start(motion%pair(i) + 1) - 1
            associate (row => place(by_pair%pair(k)) - j + 1)
              if (row >= 1) square(row, j) = square(row, j) + motion%closing(i)*by_pair%closing(k)
            end associate
          end do
        end do
      end do
    end function banded_square
  end function loose_motions
end module epcont_contact_loose_motions
