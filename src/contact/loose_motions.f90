!> Rigid-body modes that a set of pairs does not restrain: the x with A x = 0 in the rows of these pairs.
!>
!> For many bodies A is large, and its singular values would take longer than everything else. Modes that
!> are connected through pairs form a band in the order in which they are found from pair to pair.
module epcont_contact_loose_motions
  use epcont_base_kinds, only: wp
  use epcont_flexibility_motion_matrix, only: motion_matrix
  use epcont_linalg_band_rows, only: null_vectors, rotate_in
  implicit none
  private
  public :: loose_motions

contains

  !> Find a basis of the modes that these pairs do not restrain, each of length one.
  function loose_motions(motion, pairs, tolerance) result(loose)
    type(motion_matrix), intent(in) :: motion   !! A, largest entry of each column one [n, m]
    integer, intent(in) :: pairs(:)       !! without repetition
    real(wp), intent(in) :: tolerance     !! a mode with a smaller remainder is not restrained
    real(wp), allocatable :: loose(:, :)  !! [m, any]
    real(wp), allocatable :: more(:, :), own(:, :), r(:, :)
    integer, allocatable :: rows(:), together(:)   ! pairs, modes
    type(motion_matrix) :: by_pair        ! A'
    logical :: counts(motion%pairs), met(motion%motions())
    integer :: band, j, k

    by_pair = motion%turned()
    counts = .false.
    counts(pairs) = .true.
    allocate (loose(size(met), 0))
    met = .false.
    do j = 1, size(met)
      if (met(j)) cycle
      call meet_all(j)
      allocate (r(band, size(together)), source=0.0_wp)
      call rotate_all_in(r)
      own = null_vectors(r, tolerance)
      deallocate (r)
      if (size(own, 2) == 0) cycle
      allocate (more(size(met), size(own, 2)), source=0.0_wp)
      more(together, :) = own
      loose = reshape([loose, more], [size(met), size(loose, 2) + size(own, 2)])
      deallocate (more)
    end do

  contains

    !> Find modes connected with one mode, and their pairs, in order.
    subroutine meet_all(first)
      integer, intent(in) :: first
      integer :: at, i, k, last
      integer :: queue(size(met))

      queue(1) = first
      met(first) = .true.
      rows = [integer ::]
      last = 1
      at = 1
      band = 1
      do while (at <= last)
        do i = motion%start(queue(at)), motion%start(queue(at) + 1) - 1
          if (.not. counts(motion%pair(i))) cycle
          counts(motion%pair(i)) = .false.
          rows = [rows, motion%pair(i)]
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

    !> Rotate the rows of their pairs into r, in this order: then each row meets few others.
    subroutine rotate_all_in(r)
      real(wp), intent(inout) :: r(:, :)
      real(wp) :: row(band)
      integer :: first, i, place(size(met))

      place(together) = [(k, k=1, size(together))]
      do i = 1, size(rows)
        associate (mode => by_pair%pair(by_pair%start(rows(i)):by_pair%start(rows(i) + 1) - 1), &
                   closing => by_pair%closing(by_pair%start(rows(i)):by_pair%start(rows(i) + 1) - 1))
          first = minval(place(mode))
          row = 0.0_wp
          row(place(mode) - first + 1) = closing
        end associate
        call rotate_in(r, first, row)
      end do
    end subroutine rotate_all_in
  end function loose_motions
end module epcont_contact_loose_motions
